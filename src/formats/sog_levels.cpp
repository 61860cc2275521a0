// Streamed SOG: levels of detail from several SOG folders.

#include <algorithm>
#include <functional>
#include <mutex>
#include <set>

#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/progress.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "formats/sog.h"
#include "formats/sog_source.h"
#include "formats/zip_file.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;
using Ranges = std::vector<SogSource::Range>;

constexpr std::uint64_t most_levels = 100;
constexpr std::uint64_t most_gaussians = std::uint64_t{1} << 32;

/// What lod-meta.json says.
class Levels {
 public:
  Levels(const fs::path& path, const nlohmann::json& json)
      : folder_(path.parent_path()), root_(path.string(), json) {
    count_ = static_cast<int>(root_.at("lodLevels").whole(most_levels));
    if (count_ == 0) root_.at("lodLevels").fail_here("expected one level at least");
    const JsonValue names = root_.at("filenames");
    std::set<fs::path> named;  // twice, a file could be taken any number of times
    for (std::size_t i = 0; i < names.size(); ++i) {
      files_.push_back(file(names.at(i)));
      if (!named.insert(files_.back().lexically_normal()).second)
        names.at(i).fail_here("this file is named twice");
    }
    if (root_.has("environment")) environment_ = file(root_.at("environment"));
  }

  int count() const { return count_; }
  const std::vector<fs::path>& files() const { return files_; }
  const std::optional<fs::path>& environment() const { return environment_; }

  /// For each file what is taken of it, in order, where the tree's leaf number i has level_of(i); slots are
  /// not set.
  std::vector<Ranges> ranges(const std::function<int(std::size_t leaf)>& level_of) const {
    std::vector<Ranges> result(files_.size());
    std::size_t leaf = 0;
    walk([&](const JsonValue& node) {
      const JsonValue lods = node.at("lods");
      const std::string key = std::to_string(level_of(leaf++));
      if (!lods.has(key)) return;
      const auto [index, range] = part(lods.at(key));
      if (range.count > 0) result[index].push_back(range);
    });
    for (std::size_t i = 0; i < result.size(); ++i) sort(result[i], i);
    return result;
  }
  std::vector<Ranges> ranges(int level) const {
    return ranges([level](std::size_t) { return level; });
  }

  /// The tree's leaves, with the levels whose files are there.
  std::vector<DetailPart> leaves() const {
    std::vector<bool> there;
    std::error_code ignored;
    for (const fs::path& file : files_) there.push_back(fs::is_regular_file(file, ignored));
    std::vector<DetailPart> result;
    walk([&](const JsonValue& node) {
      const JsonValue bound = node.at("bound"), lods = node.at("lods");
      DetailPart leaf{corner(bound.at("min")), corner(bound.at("max")), {}};
      for (int level = 0; level < count_; ++level) {
        const std::string key = std::to_string(level);
        if (!lods.has(key)) continue;
        const auto [index, range] = part(lods.at(key));
        if (there[index]) leaf.levels.push_back({level, range.count});
      }
      result.push_back(std::move(leaf));
    });
    return result;
  }

  /// The first file that a level needs and that is not there.
  std::optional<fs::path> missing(int level) const {
    const std::vector<Ranges> wanted = ranges(level);
    std::error_code ignored;
    for (std::size_t i = 0; i < files_.size(); ++i) {
      if (!wanted[i].empty() && !fs::is_regular_file(files_[i], ignored)) return files_[i];
    }
    return std::nullopt;
  }

 private:
  fs::path file(const JsonValue& value) const {
    const std::string name = value.text();
    if (!stays_below(name))
      value.fail_here("a file must lie below lod-meta.json's folder; it is named '{}'", name);
    return folder_ / name;
  }

  /// Calls see(node) for every node of the tree that has Gaussians, always in one order.
  void walk(const std::function<void(const JsonValue&)>& see) const {
    std::vector<JsonValue> nodes{root_.at("tree")};
    while (!nodes.empty()) {
      const JsonValue node = nodes.back();
      nodes.pop_back();
      if (node.has("lods")) see(node);
      if (!node.has("children")) continue;
      const JsonValue children = node.at("children");
      for (std::size_t i = children.size(); i-- > 0;) nodes.push_back(children.at(i));
    }
  }

  static glm::dvec3 corner(const JsonValue& value) {
    const JsonValue three = value.list_of(3);
    return {three.at(0).number(), three.at(1).number(), three.at(2).number()};
  }

  /// Which file a leaf's level lies in, and where.
  std::pair<std::size_t, SogSource::Range> part(const JsonValue& lod) const {
    const std::uint64_t index = lod.at("file").whole(most_gaussians);
    if (index >= files_.size()) {
      lod.at("file").fail_here("there is no file {}: 'filenames' has {}, counted from 0", index,
                               files_.size());
    }
    return {index, {lod.at("offset").whole(most_gaussians), lod.at("count").whole(most_gaussians), 0}};
  }

  void sort(Ranges& ranges, std::size_t index) const {
    std::sort(ranges.begin(), ranges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < ranges.size(); ++i) {
      if (ranges[i].first < ranges[i - 1].first + ranges[i - 1].count) {
        fail("{}: two leaves of the tree share Gaussian {} of {}; the file is damaged", root_.source(),
             ranges[i].first, files_[index].string());
      }
    }
  }

  fs::path folder_;
  JsonValue root_;
  int count_ = 0;
  std::vector<fs::path> files_;
  std::optional<fs::path> environment_;
};

/// A SOG and what is taken of it.
struct Part {
  SogSource source;
  Ranges ranges;
};

SogSource open_part(const fs::path& path) {
  const MappedFile file(path);
  return sog_in_folder(path, parse_json(path.string(), as_text(file.bytes())));
}

std::vector<Part> open_parts(const fs::path& lod_meta, const Levels& levels,
                             const std::vector<Ranges>& wanted) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].empty()) continue;
    parts.push_back({open_part(levels.files()[i]), wanted[i]});
    const SogSource::Range& last = wanted[i].back();
    if (last.first + last.count > parts.back().source.count()) {
      fail("{}: Gaussians {} to {} of {} are wanted, which has {}", lod_meta.string(), last.first,
           last.first + last.count - 1, levels.files()[i].string(), parts.back().source.count());
    }
  }
  if (levels.environment()) {
    SogSource source = open_part(*levels.environment());
    const std::size_t count = source.count();
    parts.push_back({std::move(source), {{0, count, 0}}});
  }
  return parts;
}

/// The finest level that is there, or the one that was asked for.
int choose(const fs::path& path, const Levels& levels, std::optional<int> lod) {
  const auto range = [&] { return levels.count() == 1 ? "0" : fmt::format("0 to {}", levels.count() - 1); };
  if (lod && (*lod < 0 || *lod >= levels.count())) {
    fail("--lod {}: {} has the levels {}, 0 being the finest", *lod, path.string(), range());
  }
  std::set<int> there;
  std::optional<fs::path> missing;
  for (int level = 0; level < levels.count(); ++level) {
    const auto absent = levels.missing(level);
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
struct Choice {
  std::vector<Ranges> wanted;
  std::string name;
};

/// A level for each leaf, so that they fit.
Choice choose(const fs::path& path, const Levels& levels, const DetailBudget& budget) {
  const std::vector<DetailPart> leaves = levels.leaves();
  const auto whole =
      std::find_if(leaves.begin(), leaves.end(), [](const auto& l) { return !l.levels.empty(); });
  if (whole == leaves.end()) fail("{}: none of its levels of detail is there: fetch one", path.string());
  std::error_code ignored;
  const auto there = std::find_if(levels.files().begin(), levels.files().end(),
                                  [&](const fs::path& file) { return fs::is_regular_file(file, ignored); });
  std::size_t most = budget.gaussians(open_part(*there).degree());
  const std::size_t around = levels.environment() ? open_part(*levels.environment()).count() : 0;
  most -= std::min(most, around);
  const std::vector<std::size_t> chosen = choose_levels(leaves, budget.eyes, most);
  std::vector<std::size_t> of_level(static_cast<std::size_t>(levels.count()), 0);
  std::size_t total = 0;
  std::vector<int> numbers(leaves.size(), -1);  // no level has that number
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
  return {levels.ranges([&](std::size_t leaf) { return numbers[leaf]; }),
          fmt::format("streamed SOG, levels chosen of {}", levels.count())};
}

/// One level for all.
Choice choose_one(const fs::path& path, const Levels& levels, std::optional<int> lod) {
  const int level = choose(path, levels, lod);
  log_info("{}: level of detail {} of {}", path.string(), level, levels.count());
  return {levels.ranges([&](std::size_t) { return level; }),
          fmt::format("streamed SOG, level {} of {}", level, levels.count())};
}

}  // namespace

Model load_streamed_sog(const fs::path& lod_meta, const nlohmann::json& root, std::optional<int> lod,
                        const std::optional<DetailBudget>& budget) {
  const Levels levels(lod_meta, root);
  const Choice choice = budget ? choose(lod_meta, levels, *budget) : choose_one(lod_meta, levels, lod);
  std::vector<Part> parts = open_parts(lod_meta, levels, choice.wanted);
  Model model;
  model.name = lod_meta.filename().string();
  model.format = choice.name;
  std::size_t total = 0;
  for (Part& part : parts) {
    model.degree = std::max(model.degree, part.source.degree());
    model.antialiased = model.antialiased || part.source.antialiased();
    for (SogSource::Range& range : part.ranges) {
      range.slot = total;
      total += range.count;
    }
  }
  if (total == 0) fail("{} holds no Gaussians ({})", lod_meta.string(), choice.name);
  model.resize(total);
  std::vector<std::uint8_t> kept(total);
  Progress progress("reading " + lod_meta.string(), total);
  std::mutex counting;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    parts[i].source.decode(model, parts[i].ranges, kept);
    const std::lock_guard<std::mutex> lock(counting);
    for (const SogSource::Range& range : parts[i].ranges) done += range.count;
    progress.update(done);
  });
  keep_only(model, kept);
  return model;
}

}  // namespace binosplat
