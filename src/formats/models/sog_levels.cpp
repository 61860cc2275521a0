#include "formats/models/sog_levels.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/path_questions.h"
#include "formats/containers/size_limits.h"
#include "formats/containers/zip_file.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_levels = 100;
constexpr std::uint64_t max_gaussians = std::uint64_t{1} << 32;
// Limit for errors, pixel widths and positions, so that products of these numbers stay finite.
constexpr double max_lost = 1e20;

std::vector<double> widths_of(const JsonValue& value) {
  if (value.size() == 0) value.fail_here("expected one width at least");
  std::vector<double> widths;
  for (const JsonValue& one : value.items()) {
    const double width = one.number(), before = widths.empty() ? 0.0 : widths.back();
    if (width <= before) one.fail_here("expected a width above {}, found {}", before, width);
    if (width > max_lost) one.fail_here("expected at most {}, found {}", max_lost, width);
    widths.push_back(width);
  }
  return widths;
}

/// Reads, for each direction, a list with one number for each pixel width.
std::vector<double> by_direction(const JsonValue& value, std::size_t widths) {
  std::vector<double> numbers;
  for (const JsonValue& direction : value.list_of(detail_directions).items()) {
    for (const JsonValue& one : direction.list_of(widths).items()) {
      numbers.push_back(one.number());
      if (numbers.back() < 0.0) one.fail_here("expected 0 or more, found {}", numbers.back());
      if (numbers.back() > max_lost) one.fail_here("expected at most {}, found {}", max_lost, numbers.back());
    }
  }
  return numbers;
}

void check_bound(const JsonValue& bound, const LodChunk& chunk) {
  if (!glm::all(glm::lessThanEqual(chunk.low, chunk.high)))
    bound.fail_here("expected a 'min' that is at most 'max' along each axis");
  if (glm::any(glm::greaterThan(glm::max(glm::abs(chunk.low), glm::abs(chunk.high)), glm::dvec3(max_lost))))
    bound.fail_here("expected numbers from -{0} to {0}", max_lost);
}

/// Returns whether a chunk's errors per visible pixel are bounded: not if only coarser levels are visible.
bool has_bounded_errors(const LodChunk& chunk) {
  return std::ranges::all_of(chunk.levels, [&](const LodChunk::Level& level) {
    return std::ranges::equal(level.errors, chunk.seen,
                              [](double error, double seen) { return error <= max_lost * seen; });
  });
}

// Calls see(node), in a fixed order, for every node of the tree that has Gaussians.
void walk(const JsonValue& root, const std::function<void(const JsonValue&)>& see) {
  std::vector<JsonValue> nodes{root.at("tree")};
  while (!nodes.empty()) {
    const JsonValue node = nodes.back();
    nodes.pop_back();
    if (!node.value().is_object()) node.fail_here("expected an object");
    if (node.has("lods")) see(node);
    if (!node.has("children")) continue;
    const std::vector<JsonValue> children = node.at("children").items();
    nodes.insert(nodes.end(), children.rbegin(), children.rend());
  }
}

}  // namespace

SogLevels::SogLevels(const fs::path& path, const nlohmann::json& json) : path_(path) {
  const JsonValue root(path.string(), json);
  if (root.has("version") && root.at("version").number() != 1)
    root.at("version").fail_here("unknown version {} of a streamed SOG: expected 1",
                                 root.at("version").number());
  count_ = static_cast<int>(root.at("lodLevels").whole(max_levels));
  if (count_ == 0) root.at("lodLevels").fail_here("expected one level at least");
  std::set<fs::path> named;  // refuses repeated names, by which a file could be used any number of times
  for (const JsonValue& name : root.at("filenames").items()) {
    files_.push_back(file(name));
    if (!named.insert(files_.back().lexically_normal()).second) name.fail_here("this file is named twice");
  }
  if (root.has("environment")) environment_ = file(root.at("environment"));
  walk(root, [&](const JsonValue& node) {
    const JsonValue lods = node.at("lods");
    if (!lods.value().is_object()) lods.fail_here("expected an object of levels by their numbers");
    std::vector<Place>& places = places_.emplace_back();
    std::size_t known = 0;
    for (int level = 0; level < count_; ++level) {
      const std::string key = std::to_string(level);
      if (lods.has(key)) places.push_back(place(level, lods.at(key)));
      known += lods.value().contains(key);
    }
    if (known < lods.value().size())
      lods.fail_here("expected only levels from 0 to {}, of 'lodLevels'", count_ - 1);
  });
}

bool SogLevels::exists(std::size_t file) const { return is_file(files_[file]); }

std::vector<SogLevels::FileRanges> SogLevels::ranges_in_use(
    const std::function<int(std::size_t chunk)>& level_of) const {
  std::vector<FileRanges> result(files_.size());
  for (std::size_t chunk = 0; chunk < places_.size(); ++chunk) {
    const int level = level_of(chunk);
    if (level < 0) continue;
    for (const Place& place : places_[chunk]) {
      if (place.level == level && place.range.count > 0) result[place.file].push_back({chunk, place.range});
    }
  }
  for (std::size_t i = 0; i < result.size(); ++i) sort(result[i], i);
  return result;
}

std::vector<SogLevels::FileRanges> SogLevels::ranges_in_use(int level) const {
  return ranges_in_use([level](std::size_t) { return level; });
}

std::vector<bool> SogLevels::found() const {
  std::vector<bool> found;
  for (std::size_t i = 0; i < files_.size(); ++i) found.push_back(exists(i));
  return found;
}

std::vector<LodChunk> SogLevels::chunks(const nlohmann::json& json) const {
  const std::vector<bool> is_there = found();
  std::vector<LodChunk> result;
  walk(JsonValue(path_.string(), json), [&](const JsonValue& node) {
    const JsonValue bound = node.at("bound");
    LodChunk chunk{bound.at("min").vector<3>(), bound.at("max").vector<3>(), {}};
    check_bound(bound, chunk);
    if (node.has("pixels")) {
      chunk.pixels = widths_of(node.at("pixels"));
      chunk.seen = by_direction(node.at("seen"), chunk.pixels.size());
    }
    for (const Place& place : places_[result.size()]) {
      LodChunk::Level level{place.level, place.range.count};
      if (!chunk.pixels.empty()) {
        const JsonValue lod = node.at("lods").at(std::to_string(place.level));
        level.errors = by_direction(lod.at("errors"), chunk.pixels.size());
      }
      if (is_there[place.file]) chunk.levels.push_back(std::move(level));
    }
    if (!has_bounded_errors(chunk)) chunk.pixels.clear();
    result.push_back(std::move(chunk));
  });
  return result;
}

std::vector<std::optional<fs::path>> SogLevels::missing() const {
  const std::vector<bool> is_there = found();
  std::vector<std::size_t> first(static_cast<std::size_t>(count_), files_.size());
  for (const std::vector<Place>& places : places_) {
    for (const Place& place : places) {
      std::size_t& of_level = first[static_cast<std::size_t>(place.level)];
      if (place.range.count > 0 && !is_there[place.file]) of_level = std::min(of_level, place.file);
    }
  }
  std::vector<std::optional<fs::path>> result(first.size());
  for (std::size_t level = 0; level < result.size(); ++level)
    if (first[level] < files_.size()) result[level] = files_[first[level]];
  return result;
}

fs::path SogLevels::file(const JsonValue& value) const {
  const std::string name = value.text();
  if (!is_below_folder(name))
    value.fail_here("a file must lie below lod-meta.json's folder; it is named '{}'", name);
  return path_.parent_path() / name;
}

// Parses the file and the range of a chunk's level.
SogLevels::Place SogLevels::place(int level, const JsonValue& lod) const {
  const std::uint64_t index = lod.at("file").whole(max_gaussians);
  if (index >= files_.size())
    lod.at("file").fail_here("there is no file {}: 'filenames' has {}, counted from 0", index, files_.size());
  return {level, index, {lod.at("offset").whole(max_gaussians), lod.at("count").whole(max_gaussians), 0}};
}

void SogLevels::sort(FileRanges& ranges, std::size_t index) const {
  std::sort(ranges.begin(), ranges.end(),
            [](const ChunkRange& a, const ChunkRange& b) { return a.range.first < b.range.first; });
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    const SogSource::Range &before = ranges[i - 1].range, &now = ranges[i].range;
    if (now.first < before.first + before.count) {
      fail("{}: two leaves of the tree share Gaussian {} of {}; the file is damaged", path_, now.first,
           files_[index]);
    }
  }
}

std::vector<SogSource::Range> ranges_of(const SogLevels::FileRanges& chunks) {
  std::vector<SogSource::Range> ranges;
  for (const SogLevels::ChunkRange& of_chunk : chunks) ranges.push_back(of_chunk.range);
  return ranges;
}

void check_chunks(const fs::path& path, const std::vector<LodChunk>& chunks) {
  if (std::ranges::all_of(chunks, [](const LodChunk& chunk) { return chunk.levels.empty(); }))
    fail("{}: the files of all its levels of detail are missing: fetch one", path);
}

std::string format_of_chosen(const SogLevels& levels) {
  return fmt::format("streamed SOG, levels chosen of {}", levels.count());
}

void check_ranges(const std::filesystem::path& lod_meta, const std::filesystem::path& file,
                  const SogSource& source, std::span<const SogLevels::ChunkRange> ranges) {
  const SogSource::Range& last = ranges.back().range;
  if (last.first + last.count <= source.count()) return;
  fail("{}: it refers to Gaussians {} to {} of {}, which has {}", lod_meta, last.first,
       last.first + last.count - 1, file, source.count());
}

void check_total(const std::filesystem::path& lod_meta, std::size_t total, std::uint64_t bytes) {
  if (total <= max_gaussians_in(bytes)) return;
  fail("{}: it refers to {} Gaussians, but the positions in its files have {} bytes, too few to hold them{}",
       lod_meta, total, bytes, more_may_be_allowed);
}

}  // namespace binosplat
