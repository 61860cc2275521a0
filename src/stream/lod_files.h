#pragma once
// The files of a streamed SOG (formats/streamed_sog.h), of which chunks are read at levels of detail that
// somebody chooses.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/sog_levels.h"
#include "scene/model.h"
#include "stream/calibration.h"
#include "stream/choice.h"

namespace binosplat {

/// Opens them once, and then only reads: several threads may call it at a time.
class LodFiles {
 public:
  /// In the place of a level: the chunk was not read.
  static constexpr std::size_t not_read = any_number;

  /// `path`: a lod-meta.json or the folder of one. Opens what is there of its SOGs. Throws Error as
  /// load_streamed_sog() does, and where it is anything else.
  explicit LodFiles(const std::filesystem::path& path);
  ~LodFiles();

  /// The path of lod-meta.json, for messages.
  std::string name() const;
  /// The model without Gaussians.
  const Model& like() const { return like_; }
  /// The leaves of its tree.
  const std::vector<LodChunk>& chunks() const { return chunks_; }
  /// The Gaussians that belong to every level.
  Model environment() const;
  std::size_t environment_count() const;

  /// Gaussians at such levels of the chunks, with the environment.
  std::size_t count(std::span<const std::size_t> levels) const;
  /// The same at the finest levels.
  std::size_t finest() const;
  /// Gaussians that a model has room for beside those of the levels chosen: half empty blocks, and for a
  /// calibration sample at its finest, of an eighth of all at most.
  std::size_t spare() const { return spare_; }
  /// Whether it says what its levels lose, so that they can be chosen by dB.
  bool has_errors() const;
  /// Throws Error where dB are asked for of a file that has no errors.
  void check(const DetailRequest& request) const;

  /// The Gaussians of a chunk at a level.
  struct Piece {
    std::size_t chunk = 0, level = 0;
    Model model;
  };
  using Take = std::function<void(Piece piece)>;

  /// Reads the chunks whose level in `from` is another one than the choice's, and hands them to `take`, one
  /// at a time, maybe in other threads; those that get fewer Gaussians first, so that there are never more
  /// than before or after, then by dB those files that save the most error per Gaussian, else coarse levels
  /// before fine ones. Asks `goes_on` after some, where it is not empty, and leaves out the rest if it does
  /// not; files then come as soon as they are decoded. Throws Error where a file has become unreadable.
  void read(std::span<const std::size_t> from, const LevelChoice& choice, const Take& take,
            const std::function<bool()>& goes_on = {}) const;
  /// Reads the finest levels of some chunks.
  ChunkModels finest_of(std::span<const std::size_t> chunks) const;

 private:
  struct Source;
  struct Reading;
  /// By number of the file, what is taken of it.
  using TakenOfAll = std::vector<SogLevels::TakenOfFile>;
  std::vector<Piece> read_file(std::size_t file, const SogLevels::TakenOfFile& taken,
                               std::span<const std::size_t> levels) const;
  void read_some(const Reading& reading, const TakenOfAll& taken, const Take& take) const;
  TakenOfAll taken_of(const Reading& reading, bool shrinks) const;
  double worth(const Reading& reading, std::size_t file, const SogLevels::TakenOfFile& taken) const;
  void check_taken_of(const TakenOfAll& taken) const;

  std::unique_ptr<Source> source_;
  Model like_;
  std::vector<LodChunk> chunks_;
  std::size_t spare_ = 0;
};

}  // namespace binosplat
