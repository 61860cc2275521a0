#pragma once
// The files of a streamed SOG (formats/streamed_sog.h), from which chunks are read at chosen levels of
// detail.

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

/// The constructor opens the files; several threads may call all else at a time.
class LodFiles {
 public:
  /// Stands for the level of a chunk that was not read.
  static constexpr std::size_t not_read = any_number;

  /// `path`: a lod-meta.json or the folder of one. Opens what is there of its SOGs. Throws Error as
  /// load_streamed_sog() does, and where it is anything else.
  explicit LodFiles(const std::filesystem::path& path);
  ~LodFiles();

  /// The path of lod-meta.json, for messages.
  std::string name() const;
  /// The model without its Gaussians.
  const Model& like() const { return like_; }
  /// The leaves of the file's tree, their boxes from the model's origin.
  const std::vector<LodChunk>& chunks() const { return chunks_; }
  /// The Gaussians that belong to every level.
  Model environment() const;
  std::size_t environment_count() const;

  /// The Gaussians of the environment and of all chunks at these levels.
  std::size_t count(std::span<const std::size_t> levels) const;
  /// The same at the finest levels.
  std::size_t finest() const;
  /// The Gaussians for which a model needs room beside those of its levels: for blocks that are half empty
  /// and, where the files have errors, for a calibration sample at its finest levels, an eighth of all
  /// Gaussians at most.
  std::size_t spare() const { return spare_; }
  /// Whether the files say what their levels lose, so that levels can be chosen by dB.
  bool has_errors() const;
  /// Throws Error where dB are asked for of a file that has no errors.
  void check(const DetailRequest& request) const;

  /// The Gaussians of a chunk at a level.
  struct Piece {
    std::size_t chunk = 0, level = 0;
    Model model;
  };
  using Take = std::function<void(Piece piece)>;

  /// Reads the chunks whose level in `from` differs from the choice's, and hands them to `take`, one at a
  /// time, on any thread. The order is:
  /// - chunks that get fewer Gaussians come first, so that there are never more than before or after;
  /// - then files that save the most error per Gaussian, where the choice is by dB; else coarse levels before
  ///   fine.
  ///
  /// With `goes_on`, a file is handed over as soon as it is decoded, and no other file is begun once
  /// `goes_on` returns false. Throws Error where a file has become unreadable.
  void read(std::span<const std::size_t> from, const LevelChoice& choice, const Take& take,
            const std::function<bool()>& goes_on = {}) const;
  /// Reads the finest levels of some chunks.
  ChunkModels finest_of(std::span<const std::size_t> chunks) const;

 private:
  struct Source;
  struct Reading;
  /// What is taken of each file, by the file's number.
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
