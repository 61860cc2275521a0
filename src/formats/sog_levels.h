#pragma once
// lod-meta.json of a streamed SOG: which Gaussians of which files are which leaf of its tree, at which level
// of detail.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "formats/json_file.h"
#include "formats/sog_source.h"

namespace binosplat {

/// Directions in which what levels lose is known: along x, against it, along y and so on.
constexpr std::size_t detail_directions = 6;

/// A chunk of a model: its box, and its levels from the finest to the coarsest.
struct LodChunk {
  struct Level {
    int number = 0;
    std::size_t count = 0;  // Gaussians
    /// The squared difference between pictures of the chunk at this level and at the finest, each drawn by
    /// itself over the chunk's mean colour: summed over pixels, the mean of channels. A number for each
    /// direction and, within it, each width of a pixel.
    std::vector<double> errors = {};
  };
  glm::dvec3 low{0.0}, high{0.0};
  std::vector<Level> levels;   // may be empty
  std::vector<double> pixels;  // widths, world units, from the narrowest; empty: the errors are not known
  std::vector<double> seen;    // what those pictures of the finest show (ChunkVisibility), px, likewise
};

class SogLevels {
 public:
  /// What is taken of a file for a leaf; the range's slot is not set.
  struct Taken {
    std::size_t leaf = 0;
    SogSource::Range range;
  };
  using TakenOfFile = std::vector<Taken>;

  /// Reads the parsed lod-meta.json at `path`. Throws Error, here as in all that follows, naming the key that
  /// is wrong.
  SogLevels(const std::filesystem::path& path, const nlohmann::json& json);

  int count() const { return count_; }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// The SOG that belongs to every level.
  const std::optional<std::filesystem::path>& environment() const { return environment_; }
  /// Whether a file is there: those of levels that are not drawn need not be.
  bool there(std::size_t file) const;

  /// For each file what is taken of it, in order, where the tree's leaf number i has level_of(i), or nothing
  /// is taken of it where that is below 0.
  std::vector<TakenOfFile> taken(const std::function<int(std::size_t leaf)>& level_of) const;
  std::vector<TakenOfFile> taken(int level) const;

  /// The tree's leaves, with the levels whose files are there, and their errors where those are told; from
  /// the same lod-meta.json.
  std::vector<LodChunk> leaves(const nlohmann::json& json) const;

  /// For each level the first file that it needs and that is not there.
  std::vector<std::optional<std::filesystem::path>> missing() const;

 private:
  /// Where a leaf's Gaussians of a level lie.
  struct Place {
    int level = 0;
    std::size_t file = 0;
    SogSource::Range range;
  };

  std::filesystem::path file(const JsonValue& value) const;
  std::vector<bool> found() const;
  Place place(int level, const JsonValue& lod) const;
  void sort(TakenOfFile& taken, std::size_t index) const;

  std::filesystem::path path_;
  int count_ = 0;
  std::vector<std::filesystem::path> files_;
  std::optional<std::filesystem::path> environment_;
  std::vector<std::vector<Place>> leaves_;
};

/// In place of the number of a level (SogLevels::taken).
inline constexpr int no_level = -1;

std::vector<SogSource::Range> ranges_of(const SogLevels::TakenOfFile& taken);

/// Throws Error if no leaf has a level that is there.
void check_leaves(const std::filesystem::path& path, const std::vector<LodChunk>& leaves);

/// The format of a model whose levels are chosen.
std::string format_of_chosen(const SogLevels& levels);

/// Throws Error unless what is taken of a file, which is something, is in it.
void check_taken(const std::filesystem::path& lod_meta, const std::filesystem::path& file,
                 const SogSource& source, std::span<const SogLevels::Taken> taken);

/// Throws Error where `total` Gaussians are too many for files of `bytes` bytes (SogSource::bytes) in all:
/// each may have its million without a reason, but not a thousand files.
void check_total(const std::filesystem::path& lod_meta, std::size_t total, std::uint64_t bytes);

}  // namespace binosplat
