#include "formats/streamed_sog.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <mutex>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/sog_cache.h"
#include "formats/sog_levels.h"
#include "formats/sog_source.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Taken = std::vector<SogLevels::Taken>;  // of a file

constexpr int no_level = -1;
constexpr std::size_t files_at_a_time = 8;  // each by several threads, and whole in memory meanwhile
// Bytes of decoded files that are kept: of some 80 million Gaussians, without which a head that moves through
// 20 million has files of 131,072 decoded again and again for a few leaves each, eight cores long.
std::size_t cached_most() {
  return static_cast<std::size_t>(std::min(std::exp2(31.0), memory_bytes() / 8.0));
}
// Decoding so many of a file takes as long as one takes to reach the GPU.
constexpr std::size_t decoded_for_one = 8;

/// A SOG and what is taken of it.
struct Part {
  SogSource source;
  Taken taken;
};

SogSource open_part(const fs::path& path) {
  const MappedFile file(path);
  return sog_in_folder(path, parse_json(path.string(), as_text(file.bytes())));
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
Selection choose(const fs::path& path, const SogLevels& levels, const nlohmann::json& root,
                 const DetailBudget& budget) {
  const std::vector<DetailPart> leaves = levels.leaves(root);
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
  if (total > most) warn_of_no_room(path.string(), total, most);
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
  const Selection choice =
      budget ? choose(lod_meta, levels, root, *budget) : choose_one(lod_meta, levels, lod);
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

/// What lod-meta.json says, and the SOGs that are there; none of another file.
struct StreamedSog::Source {
  fs::path path;
  SogLevels levels;
  std::vector<std::optional<SogSource>> files;  // the environment last, where there is one
  std::uint64_t bytes = 0;                      // of them (SogSource::bytes)
  SogCache cache{cached_most()};                // by the number of the file

  Source(const fs::path& lod_meta, const nlohmann::json& json) : path(lod_meta), levels(path, json) {
    files.resize(levels.files().size());
    parallel_for(files.size(), [&](std::size_t i) {
      if (levels.there(i)) files[i] = open_part(levels.files()[i]);
    });
    if (levels.environment()) files.emplace_back(open_part(*levels.environment()));
    for (const auto& file : files) bytes += file ? file->bytes() : 0;
  }

  /// Gaussians of the environment.
  std::size_t around() const { return levels.environment() ? files.back()->count() : 0; }

  const fs::path& name(std::size_t file) const {
    return file == levels.files().size() ? *levels.environment() : levels.files()[file];
  }
};

StreamedSog::StreamedSog(const fs::path& path) {
  const fs::path lod_meta = lod_meta_of(path);
  const nlohmann::json json = levels_json(lod_meta, path);
  source_ = std::make_unique<Source>(lod_meta, json);
  leaves_ = source_->levels.leaves(json);
  check_leaves(source_->path, leaves_);
  chooser_.emplace(source_->path.string(), leaves_, source_->around());
  for (int level = 0; level < source_->levels.count(); ++level)
    static_cast<void>(source_->levels.taken(level));  // throws where leaves share Gaussians
  read_.resize(leaves_.size());
  like_.name = source_->path.filename().string();
  like_.format = name_of(source_->levels);
  for (const auto& file : source_->files) {
    if (!file) continue;
    like_.degree = std::max(like_.degree, file->degree());
    like_.antialiased = like_.antialiased || file->antialiased();
    like_.perspective = file->perspective();
  }
}

StreamedSog::~StreamedSog() = default;

bool StreamedSog::choose(std::shared_ptr<const LevelsChosen> chosen) {
  chosen_ = std::move(chosen);
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf)
    if (!leaves_[leaf].levels.empty() && read_[leaf] != level(leaf)) return true;
  return source_->around() > 0 && !environment_read_;
}

// Leaves that get fewer Gaussians come first: never are there more than before or after, if all are taken.
void StreamedSog::read(const Take& take, const std::function<bool()>& goes_on) {
  const std::array<std::vector<Taken>, 2> all = {to_read(true), to_read(false)};
  check_room(all);
  for (std::size_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    const auto& levels = leaves_[leaf].levels;
    if (levels.empty() || read_[leaf] == level(leaf) || levels[level(leaf)].count > 0) continue;
    const auto before = std::exchange(read_[leaf], level(leaf));
    take({.part = leaf, .level = level(leaf), .before = before, .model = like_});
  }
  for (const std::vector<Taken>& taken : all) {
    std::vector<std::size_t> files;
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i].empty()) files.push_back(i);
    // Few Gaussians that mend much come before many that mend little.
    std::vector<double> first(taken.size());
    for (const std::size_t i : files) first[i] = worth(i, taken[i], goes_on != nullptr);
    std::ranges::stable_sort(files, std::greater<>(), [&](std::size_t i) { return first[i]; });
    for (std::size_t at = 0; at < files.size(); at += files_at_a_time) {
      std::vector<std::vector<Piece>> pieces(std::min(files_at_a_time, files.size() - at));
      parallel_for(pieces.size(),
                   [&](std::size_t i) { pieces[i] = read_file(files[at + i], taken[files[at + i]]); });
      for (std::vector<Piece>& of_file : pieces) {
        for (Piece& piece : of_file) {
          if (piece.level) read_[piece.part] = piece.level;
          environment_read_ = environment_read_ || !piece.level;
          take(std::move(piece));
        }
      }
      if (goes_on && !goes_on()) return;
    }
  }
}

std::vector<StreamedSog::Taken> StreamedSog::to_read(bool shrinks) const {
  const auto level_of = [&](std::size_t leaf) {
    const auto& levels = leaves_[leaf].levels;
    if (levels.empty() || read_[leaf] == level(leaf)) return no_level;
    const std::size_t before = read_[leaf] ? levels[*read_[leaf]].count : 0;
    return (levels[level(leaf)].count < before) == shrinks ? levels[level(leaf)].number : no_level;
  };
  std::vector<Taken> taken = source_->levels.taken(level_of);
  if (source_->around() > 0 && !environment_read_ && !shrinks)
    taken.emplace_back().push_back({leaves_.size(), {0, source_->around(), 0}});
  return taken;
}

std::size_t StreamedSog::finest() const {
  return chooser_->count(std::vector<std::size_t>(leaves_.size(), 0));
}

double StreamedSog::saved(std::size_t leaf, std::optional<std::size_t> before) const {
  return before ? choice()->saved(leaf, *before, level(leaf)) : INFINITY;
}

double StreamedSog::worth(const Piece& piece) const {
  if (!choice() || piece.part >= leaves_.size() || !piece.before || *piece.before < *piece.level)
    return INFINITY;
  return saved(piece.part, piece.before) / static_cast<double>(std::max<std::size_t>(piece.model.count(), 1));
}

double StreamedSog::worth(std::size_t file, std::span<const SogLevels::Taken> taken, bool by_cache) const {
  if (taken.front().leaf >= leaves_.size()) return INFINITY;
  if (!choice()) return leaves_[taken.front().leaf].levels[level(taken.front().leaf)].number;
  double sum = 0.0;
  // In no hurry the order is the same whatever was read before.
  std::size_t count =
      by_cache && source_->cache.has(file) ? 0 : source_->files[file]->count() / decoded_for_one;
  for (const SogLevels::Taken& of_leaf : taken) {
    sum += saved(of_leaf.leaf, read_[of_leaf.leaf]);
    count += of_leaf.range.count;
  }
  return sum / static_cast<double>(std::max<std::size_t>(count, 1));
}

void StreamedSog::check_room(std::span<const std::vector<Taken>> all) const {
  for (const std::vector<Taken>& taken : all) {
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i].empty()) check_taken(source_->path, source_->name(i), *source_->files[i], taken[i]);
  }
  const std::size_t total = chooser_->count(chosen());
  if (total == 0) fail("{} holds no Gaussians ({})", source_->path.string(), like_.format);
  check_total(source_->path, total, source_->bytes);
}

PartModels StreamedSog::finest_of(std::span<const std::size_t> leaves) const {
  std::vector<int> numbers(leaves_.size(), no_level);
  for (const std::size_t leaf : leaves) numbers[leaf] = leaves_[leaf].levels.front().number;
  const auto taken = source_->levels.taken([&](std::size_t leaf) { return numbers[leaf]; });
  std::vector<std::vector<Piece>> of_files(taken.size());
  parallel_for(taken.size(), [&](std::size_t i) {
    if (taken[i].empty()) return;
    check_taken(source_->path, source_->name(i), *source_->files[i], taken[i]);
    of_files[i] = read_file(i, taken[i]);
  });
  PartModels finest;
  for (std::vector<Piece>& of_file : of_files) {
    for (Piece& piece : of_file) {
      finest.parts.push_back(piece.part);
      finest.models.push_back(std::move(piece.model));
    }
  }
  return finest;
}

std::vector<StreamedSog::Piece> StreamedSog::read_file(std::size_t file, const Taken& taken) const {
  const SogSource& source = *source_->files[file];
  std::vector<Model> models =
      source.decode_each(like_, ranges_of(taken), *source_->cache.textures(file, source));
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const std::size_t leaf = taken[i].leaf;
    pieces.push_back({.part = leaf, .model = std::move(models[i])});
    if (leaf == leaves_.size()) continue;
    pieces.back().level = level(leaf);
    pieces.back().before = read_[leaf];
  }
  return pieces;
}

}  // namespace binosplat
