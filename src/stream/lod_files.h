#pragma once
// The files of a streamed SOG (formats/models/streamed_sog.h), which are read by chunk and level of detail.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/models/sog_levels.h"
#include "scene/model.h"
#include "stream/level_choice.h"
#include "stream/loss_correction.h"

namespace binosplat {

/// The constructor opens the files; the other functions are thread-safe.
class LodFiles {
 public:
  /// Instead of a level: the chunk has not been read.
  static constexpr std::size_t not_read = any_number;

  /// Opens the SOGs that exist and that lod-meta.json names. `path` is a lod-meta.json or its folder. Throws
  /// Error as load_streamed_sog() does, and for other kinds of files.
  explicit LodFiles(const std::filesystem::path& path);
  ~LodFiles();

  /// The path of lod-meta.json, for messages.
  std::string name() const;
  /// The model's properties, without Gaussians.
  const Model& properties() const { return properties_; }
  /// The chunks of the file's tree, with boxes relative to the model's origin.
  const std::vector<LodChunk>& chunks() const { return chunks_; }
  /// Returns the Gaussians that are part of every level.
  Model environment() const;
  std::size_t environment_count() const;

  /// Returns the number of Gaussians of the environment and of all chunks at these levels.
  std::size_t count(std::span<const std::size_t> levels) const;
  /// Returns count() of the finest levels.
  std::size_t finest() const;
  /// Returns how many Gaussians a model's capacity must have beyond count(): for partly filled blocks
  /// (ModelChunks) and, if the files have errors, for a calibration sample of at most an eighth of finest().
  std::size_t extra_capacity() const { return extra_capacity_; }
  bool has_errors() const;
  /// Throws Error if dB are requested and the file has no errors.
  void check(const DetailRequest& request) const;

  /// The Gaussians of a chunk at a level.
  struct LoadedChunk {
    std::size_t chunk = 0, level = 0;
    Model model;
  };
  using OnChunk = std::function<void(LoadedChunk loaded)>;

  /// Reads the chunks whose level in `from` differs from the choice's, and passes them to `on_chunk`, one at
  /// a time, on any thread. Chunks that get fewer Gaussians come first, so that the model never exceeds the
  /// larger of its old and new size. Within both groups of chunks, files that save more error per Gaussian
  /// come first; if levels are not chosen by dB, files of coarser levels do.
  ///
  /// With `may_continue`, passes on the chunks of a file as soon as the file is decoded, and begins no
  /// further file after `may_continue` has returned false. Throws Error if a file has become unreadable.
  void read(std::span<const std::size_t> from, const LevelChoice& choice, const OnChunk& on_chunk,
            const std::function<bool()>& may_continue = {}) const;
  ChunkModels read_finest(std::span<const std::size_t> chunks) const;

 private:
  struct Source;
  struct Reading;
  /// The ranges to read from each file, by the file's number.
  using RangesByFile = std::vector<SogLevels::FileRanges>;
  std::vector<LoadedChunk> read_file(std::size_t file, const SogLevels::FileRanges& ranges,
                                     std::span<const std::size_t> levels) const;
  void read_ranges(const Reading& reading, const RangesByFile& ranges, const OnChunk& on_chunk) const;
  RangesByFile ranges_to_read(const Reading& reading, bool shrinks) const;
  double worth(const Reading& reading, std::size_t file, const SogLevels::FileRanges& ranges) const;
  void check_ranges_of(const RangesByFile& ranges) const;

  std::unique_ptr<Source> source_;
  Model properties_;
  std::vector<LodChunk> chunks_;
  std::size_t extra_capacity_ = 0;
};

}  // namespace binosplat
