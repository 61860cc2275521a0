#pragma once
// lod-meta.json of a streamed SOG: the Gaussians of each chunk (a leaf of its tree) at each level of detail.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "formats/containers/json_file.h"
#include "formats/models/sog_source.h"

namespace binosplat {

/// Directions in which errors are stored: along x, against x, along y and so on.
constexpr std::size_t detail_directions = 6;

/// A chunk of a model: its box, and its levels from the finest to the coarsest.
struct LodChunk {
  struct Level {
    int number = 0;
    std::size_t count = 0;  // Gaussians
    /// Squared difference between pictures of the chunk, alone over its mean colour, at this and the finest
    /// level: the sum over pixels of the mean over channels, by direction, then by pixel width.
    std::vector<double> errors = {};
  };
  glm::dvec3 low{0.0}, high{0.0};
  std::vector<Level> levels;   // may be empty
  std::vector<double> pixels;  // pixel widths, world units, ascending; empty: errors are unknown
  std::vector<double> seen;    // visible area (ChunkVisibility) at the finest level, px, ordered as `errors`
};

class SogLevels {
 public:
  /// The range of a file's Gaussians that a chunk uses. Range::slot is not set.
  struct ChunkRange {
    std::size_t chunk = 0;
    SogSource::Range range;
  };
  using FileRanges = std::vector<ChunkRange>;

  /// `json` is the parsed lod-meta.json at `path`. All functions throw Error naming the key if it is wrong.
  SogLevels(const std::filesystem::path& path, const nlohmann::json& json);

  int count() const { return count_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// The SOG that is part of every level.
  const std::optional<std::filesystem::path>& environment() const { return environment_; }
  /// Returns whether a file exists. Files of unused levels may be missing.
  bool exists(std::size_t file) const;

  /// Returns, for each file, the ranges that are in use if chunk i has the level level_of(i). Ranges are in
  /// the file's order. A chunk with a negative level uses nothing.
  std::vector<FileRanges> ranges_in_use(const std::function<int(std::size_t chunk)>& level_of) const;
  std::vector<FileRanges> ranges_in_use(int level) const;

  /// Returns the chunks with their existing levels and, if stored, errors. `json` is the same lod-meta.json.
  std::vector<LodChunk> chunks(const nlohmann::json& json) const;

  /// Returns, for each level, the first missing file that the level needs.
  std::vector<std::optional<std::filesystem::path>> missing() const;

 private:
  /// The range of a chunk's level in a file.
  struct Place {
    int level = 0;
    std::size_t file = 0;
    SogSource::Range range;
  };

  std::filesystem::path file(const JsonValue& value) const;
  std::vector<bool> found() const;
  Place place(int level, const JsonValue& lod) const;
  void sort(FileRanges& ranges, std::size_t index) const;

  std::filesystem::path path_;
  int count_ = 0;
  std::vector<std::filesystem::path> files_;
  std::optional<std::filesystem::path> environment_;
  std::vector<std::vector<Place>> places_;
};

/// A level that uses nothing (SogLevels::ranges_in_use).
inline constexpr int no_level = -1;

std::vector<SogSource::Range> ranges_of(const SogLevels::FileRanges& chunks);

/// Throws Error if no chunk has a level with an existing file.
void check_chunks(const std::filesystem::path& path, const std::vector<LodChunk>& chunks);

/// Returns Model::format for a model whose levels are chosen by chunk.
std::string format_of_chosen(const SogLevels& levels);

/// Throws Error if a range exceeds the file. There must be at least one range.
void check_ranges(const std::filesystem::path& lod_meta, const std::filesystem::path& file,
                  const SogSource& source, std::span<const SogLevels::ChunkRange> ranges);

/// Throws Error if `total` Gaussians are too many for files of `bytes` bytes (SogSource::bytes) together. The
/// check of each file allows a million Gaussians beyond its size, this check a million for all files.
void check_total(const std::filesystem::path& lod_meta, std::size_t total, std::uint64_t bytes);

}  // namespace binosplat
