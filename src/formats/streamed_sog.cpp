#include "formats/streamed_sog.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/plausible.h"
#include "formats/sog_levels.h"
#include "formats/sog_source.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Taken = std::vector<SogLevels::Taken>;

constexpr int no_level = -1;

/// A SOG and what is taken of it.
struct Part {
  SogSource source;
  Taken taken;
};

SogSource open_part(const fs::path& path) {
  const MappedFile file(path);
  return sog_in_folder(path, parse_json(path.string(), as_text(file.bytes())));
}

/// What is taken of a file must be in it.
void check_taken(const fs::path& lod_meta, const fs::path& file, const SogSource& source,
                 std::span<const SogLevels::Taken> taken) {
  const SogSource::Range& last = taken.back().range;
  if (last.first + last.count <= source.count()) return;
  fail("{}: Gaussians {} to {} of {} are wanted, which has {}", lod_meta.string(), last.first,
       last.first + last.count - 1, file.string(), source.count());
}

/// Each file may have its million without a reason, but not a thousand files.
void check_total(const fs::path& lod_meta, std::size_t total, std::uint64_t bytes) {
  if (total <= most_gaussians_in(bytes)) return;
  fail("{}: {} Gaussians are wanted of files whose positions take {} bytes, which cannot hold them{}",
       lod_meta.string(), total, bytes, more_may_be_allowed);
}

/// The finest level that is there, or the one that was asked for.
int choose(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const auto range = [&] { return levels.count() == 1 ? "0" : fmt::format("0 to {}", levels.count() - 1); };
  if (lod && (*lod < 0 || *lod >= levels.count())) {
    fail("--lod {}: {} has the levels {}, 0 being the finest", *lod, path.string(), range());
  }
  std::set<int> there;
  std::optional<fs::path> missing;
  const auto of_levels = levels.missing();
  for (int level = 0; level < levels.count(); ++level) {
    const auto& absent = of_levels[static_cast<std::size_t>(level)];
    if (!absent) there.insert(level);
    if (absent && (!missing || level == lod)) missing = absent;
  }
  if (there.empty()) {
    fail("{}: no level of detail is complete; {} is missing: fetch it", path.string(), missing->string());
  }
  if (lod && there.count(*lod) == 0) {
    fail("--lod {}: {} is missing; the finest level that is there is {}", *lod, missing->string(),
         *there.begin());
  }
  const int level = lod.value_or(*there.begin());
  if (!lod && level > 0) {
    log_warning("{}: level 0 is not complete ({} is missing); level {} is drawn", path.string(),
                missing->string(), level);
  }
  return level;
}

/// What is taken of each file, and what to call it.
struct Selection {
  std::vector<Taken> taken;
  std::string name;
};

std::string name_of(const SogLevels& levels) {
  return fmt::format("streamed SOG, levels chosen of {}", levels.count());
}

void check_leaves(const fs::path& path, const std::vector<DetailPart>& leaves) {
  if (std::all_of(leaves.begin(), leaves.end(), [](const auto& leaf) { return leaf.levels.empty(); }))
    fail("{}: none of its levels of detail is there: fetch one", path.string());
}

/// A level for each leaf, so that they fit.
Selection choose(const fs::path& path, const SogLevels& levels, const DetailBudget& budget) {
  const std::vector<DetailPart> leaves = levels.leaves();
  check_leaves(path, leaves);
  std::size_t file = 0;
  while (!levels.there(file)) ++file;
  std::size_t most = budget.gaussians(open_part(levels.files()[file]).degree());
  const std::size_t around = levels.environment() ? open_part(*levels.environment()).count() : 0;
  most -= std::min(most, around);
  const std::vector<std::size_t> chosen = choose_levels(leaves, budget.eyes, most);
  std::vector<std::size_t> of_level(static_cast<std::size_t>(levels.count()), 0);
  std::size_t total = 0;
  std::vector<int> numbers(leaves.size(), no_level);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (leaves[i].levels.empty()) continue;
    const DetailPart::Level& level = leaves[i].levels[chosen[i]];
    numbers[i] = level.number;
    of_level[static_cast<std::size_t>(level.number)] += level.count;
    total += level.count;
  }
  if (total > most)
    log_warning("{}: even its coarsest levels of detail have {} Gaussians, and there is room for {}",
                path.string(), total, most);
  std::string parts;
  for (std::size_t level = 0; level < of_level.size(); ++level) {
    if (of_level[level] > 0)
      parts += fmt::format("{}{} Gaussians of level {}", parts.empty() ? "" : ", ", of_level[level], level);
  }
  log_info("{}: {}", path.string(), parts);
  return {levels.taken([&](std::size_t leaf) { return numbers[leaf]; }), name_of(levels)};
}

/// One level for all.
Selection choose_one(const fs::path& path, const SogLevels& levels, std::optional<int> lod) {
  const int level = choose(path, levels, lod);
  log_info("{}: level of detail {} of {}", path.string(), level, levels.count());
  return {levels.taken(level), fmt::format("streamed SOG, level {} of {}", level, levels.count())};
}

std::vector<Part> open_parts(const fs::path& lod_meta, const SogLevels& levels,
                             const std::vector<Taken>& taken) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i].empty()) continue;
    parts.push_back({open_part(levels.files()[i]), taken[i]});
    check_taken(lod_meta, levels.files()[i], parts.back().source, taken[i]);
  }
  if (levels.environment()) {
    SogSource source = open_part(*levels.environment());
    const std::size_t count = source.count();
    parts.push_back({std::move(source), {{0, {0, count, 0}}}});
  }
  return parts;
}

std::vector<SogSource::Range> ranges_of(const Taken& taken) {
  std::vector<SogSource::Range> ranges;
  for (const SogLevels::Taken& of_leaf : taken) ranges.push_back(of_leaf.range);
  return ranges;
}

/// Copies Gaussians from one model to another of the same degree.
void copy(const Model& from, std::size_t first, std::size_t count, Model& to, std::size_t slot) {
  const auto take = [&](const auto& a, auto& b, std::size_t each) {
    std::copy_n(a.begin() + static_cast<std::ptrdiff_t>(first * each), count * each,
                b.begin() + static_cast<std::ptrdiff_t>(slot * each));
  };
  take(from.position, to.position, 1);
  take(from.scale, to.scale, 1);
  take(from.rotation, to.rotation, 1);
  take(from.opacity, to.opacity, 1);
  take(from.sh, to.sh, 3 * static_cast<std::size_t>(sh_count(from.degree)));
}

std::vector<DetailView> detail_views(std::span<const shared::View> views) {
  std::vector<DetailView> result;
  for (const shared::View& view : views) {
    result.push_back({.eye = glm::dvec3(view.anchor) + glm::dvec3(view.eye),
                      .forward = glm::dvec3(view.row_z),
                      .slope = std::sqrt(static_cast<double>(view.centre.w)),
                      .focal = std::max<double>(view.lens.x, view.lens.y),
                      .pixels = static_cast<double>(view.width) * view.height});
  }
  return result;
}

fs::path lod_meta_of(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / "lod-meta.json" : path;
}

/// What lod-meta.json says; none if the file is another one, or not there.
std::optional<nlohmann::json> parse_lod_meta(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  const MappedFile file(path);
  if (content_of(file.bytes()) != Content::json) return std::nullopt;
  nlohmann::json json = parse_json(path.string(), as_text(file.bytes()));
  return is_sog_levels(json) ? std::optional(std::move(json)) : std::nullopt;
}

nlohmann::json levels_json(const fs::path& path, const fs::path& asked) {
  auto json = parse_lod_meta(path);
  if (!json)
    fail("--detail: {} has no levels of detail to choose from; a streamed SOG's lod-meta.json has",
         asked.string());
  return std::move(*json);
}

}  // namespace

bool is_sog_levels(const nlohmann::json& root) { return root.is_object() && root.contains("lodLevels"); }

bool is_streamed_sog(const fs::path& path) { return parse_lod_meta(lod_meta_of(path)).has_value(); }

Model load_streamed_sog(const fs::path& lod_meta, const nlohmann::json& root, std::optional<int> lod,
                        const std::optional<DetailBudget>& budget) {
  const SogLevels levels(lod_meta, root);
  const Selection choice = budget ? choose(lod_meta, levels, *budget) : choose_one(lod_meta, levels, lod);
  std::vector<Part> parts = open_parts(lod_meta, levels, choice.taken);
  Model model;
  model.name = lod_meta.filename().string();
  model.format = choice.name;
  std::size_t total = 0;
  std::uint64_t bytes = 0;
  for (Part& part : parts) {
    bytes += part.source.bytes();
    model.degree = std::max(model.degree, part.source.degree());
    model.antialiased = model.antialiased || part.source.antialiased();
    model.perspective = part.source.perspective();  // of all alike
    for (SogLevels::Taken& taken : part.taken) {
      taken.range.slot = total;
      total += taken.range.count;
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", lod_meta.string(), choice.name);
  check_total(lod_meta, total, bytes);
  model.resize(total);
  std::vector<std::uint8_t> kept(total);
  Progress progress("reading " + lod_meta.string(), total);
  std::mutex counting;
  std::size_t done = 0;
  parallel_for(parts.size(), [&](std::size_t i) {
    const std::vector<SogSource::Range> ranges = ranges_of(parts[i].taken);
    parts[i].source.decode(model, ranges, kept);
    const std::lock_guard<std::mutex> lock(counting);
    for (const SogSource::Range& range : ranges) done += range.count;
    progress.update(done);
  });
  keep_only(model, kept);
  return model;
}

/// lod-meta.json and the SOGs that are there; none of another file.
struct StreamedSog::Source {
  fs::path path;
  nlohmann::json json;
  SogLevels levels;
  std::vector<std::optional<SogSource>> files;  // the environment last, where there is one

  explicit Source(const fs::path& asked)
      : path(lod_meta_of(asked)), json(levels_json(path, asked)), levels(path, json) {
    files.resize(levels.files().size());
    parallel_for(files.size(), [&](std::size_t i) {
      if (levels.there(i)) files[i] = open_part(levels.files()[i]);
    });
    if (levels.environment()) files.emplace_back(open_part(*levels.environment()));
  }

  const fs::path& name(std::size_t file) const {
    return file == levels.files().size() ? *levels.environment() : levels.files()[file];
  }

  /// What is taken of each of the files, where leaf number i of so many has level_of(i).
  std::vector<Taken> wanted(const std::function<int(std::size_t)>& level_of, std::size_t leaves) const;
};

StreamedSog::StreamedSog(const fs::path& path) : source_(std::make_unique<Source>(path)) {
  leaves_ = source_->levels.leaves();
  check_leaves(source_->path, leaves_);
  model_.name = source_->path.filename().string();
  model_.format = name_of(source_->levels);
  for (const auto& file : source_->files) {
    if (!file) continue;
    degree_ = std::max(degree_, file->degree());
    model_.antialiased = model_.antialiased || file->antialiased();
    model_.perspective = file->perspective();
  }
  model_.degree = degree_;
}

StreamedSog::~StreamedSog() = default;

bool StreamedSog::choose(std::span<const shared::View> views, const DetailNeed& need,
                         std::span<const std::vector<SeenPart>> seen) {
  if (need.db &&
      std::none_of(leaves_.begin(), leaves_.end(), [](const auto& l) { return !l.pixels.empty(); })) {
    fail(
        "--detail {}dB: {} has no errors of its levels to go by; `binosplat levels` writes them; or use "
        "--detail PX",
        *need.db, source_->path.string());
  }
  const auto& environment = source_->levels.environment();
  const std::size_t around = environment ? source_->files.back()->count() : 0;
  const std::size_t most = need.most - std::min(need.most, around);
  const std::span<const std::size_t> before = by_views_ ? std::span(chosen_) : std::span<std::size_t>();
  const std::vector<DetailView> detail = detail_views(views);
  predicted_psnr_.reset();
  if (need.db && !views.empty()) {
    DetailChoice choice = choose_levels_within(leaves_, detail, std::pow(10.0, -0.1 * *need.db), most, seen,
                                               before, need.heads_turn);
    chosen_ = std::move(choice.levels);
    predicted_psnr_ = -10.0 * std::log10(choice.error);
  } else {
    std::vector<glm::dvec3> eyes;
    double focal = 0.0;
    for (const DetailView& view : detail) {
      eyes.push_back(view.eye);
      focal = std::max(focal, view.focal);
    }
    const double enough = views.empty() ? std::numeric_limits<double>::infinity() : need.apart_px / focal;
    chosen_ = choose_levels(leaves_, eyes, most, enough, before);
  }
  by_views_ = !views.empty();
  return chosen_ != levels_;
}

std::vector<Taken> StreamedSog::Source::wanted(const std::function<int(std::size_t)>& level_of,
                                               std::size_t leaves) const {
  std::vector<Taken> taken = levels.taken(level_of);
  if (levels.environment()) taken.emplace_back().push_back({leaves, {0, files.back()->count(), 0}});
  return taken;
}

Model StreamedSog::read() {
  const auto level_of = [&](std::size_t leaf) {
    return leaves_[leaf].levels.empty() ? no_level : leaves_[leaf].levels[chosen_[leaf]].number;
  };
  std::vector<Taken> taken = source_->wanted(level_of, leaves_.size());
  std::vector<Range> ranges(leaves_.size() + 1);
  std::size_t total = 0;
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i].empty()) continue;
    check_taken(source_->path, source_->name(i), *source_->files[i], taken[i]);
    bytes += source_->files[i]->bytes();
    for (SogLevels::Taken& of_leaf : taken[i]) {
      of_leaf.range.slot = total;
      total += of_leaf.range.count;
      ranges[of_leaf.leaf] = {of_leaf.range.slot, of_leaf.range.count};
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", source_->path.string(), model_.format);
  check_total(source_->path, total, bytes);
  Model model = without_gaussians(model_);
  model.resize(total);
  std::vector<std::uint8_t> kept(total);
  parallel_for(taken.size(), [&](std::size_t i) { fill(model, kept, taken[i], i); });
  close_gaps(ranges, kept);
  keep_only(model, kept);
  model_ = model;
  levels_ = chosen_;
  ranges_ = std::move(ranges);
  return model;
}

void StreamedSog::fill(Model& model, std::vector<std::uint8_t>& kept, std::span<const SogLevels::Taken> taken,
                       std::size_t file) const {
  std::vector<SogSource::Range> changed;
  for (const SogLevels::Taken& of_leaf : taken) {
    const std::size_t leaf = of_leaf.leaf;
    if (ranges_.empty() || (leaf < leaves_.size() && chosen_[leaf] != levels_[leaf])) {
      changed.push_back(of_leaf.range);
      continue;
    }
    const Range& before = ranges_[leaf];
    copy(model_, before.first, before.count, model, of_leaf.range.slot);
    std::fill_n(kept.begin() + static_cast<std::ptrdiff_t>(of_leaf.range.slot), before.count, 1);
  }
  if (changed.empty()) return;
  source_->files[file]->decode(model, changed, kept);
}

// Where leaves lie once keep_only has left out what is not kept.
void StreamedSog::close_gaps(std::vector<Range>& ranges, const std::vector<std::uint8_t>& kept) {
  std::vector<std::size_t> before(kept.size() + 1, 0);
  for (std::size_t i = 0; i < kept.size(); ++i) before[i + 1] = before[i] + kept[i];
  for (Range& range : ranges) {
    const std::size_t first = before[range.first];
    range = {first, before[range.first + range.count] - first};
  }
}

}  // namespace binosplat
