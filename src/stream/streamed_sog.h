#pragma once
// A streamed SOG (formats/streamed_sog.h) whose levels of detail change while it is drawn.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/sog_levels.h"
#include "scene/model.h"
#include "shared/types.h"
#include "stream/detail.h"
#include "stream/level_chooser.h"
#include "stream/level_sample.h"

namespace binosplat {

/// A streamed SOG whose leaves change their levels as somebody moves through it. Its members may be called by
/// different threads, but not at a time; the chooser's by another one, too.
class StreamedSog {
 public:
  /// `path`: a lod-meta.json or the folder of one. Opens what is there of its SOGs. Throws Error as
  /// load_streamed_sog() does, and where it is anything else.
  explicit StreamedSog(const std::filesystem::path& path);
  ~StreamedSog();

  /// The model without Gaussians.
  const Model& like() const { return like_; }
  /// Its leaves, and at the end the environment.
  std::size_t parts() const { return leaves_.size() + 1; }
  /// Gaussians at the finest levels.
  std::size_t finest() const;
  /// Gaussians that a model has room for beside those of the levels chosen: half empty blocks, and where dB
  /// can be gone by a sample at its finest (stream/level_sample.h), of an eighth of all at most.
  std::size_t spare() const { return spare_; }

  /// Whether it says what its levels lose, so that they can be chosen by dB.
  bool has_errors() const { return have_errors(leaves_); }
  /// A need for frames that may lose so much together with levels, dB; 0: nothing.
  DetailNeed sharing(DetailNeed need, double together_db) const {
    if (need.shares && together_db > 0.0 && has_errors()) need.db = levels_share(together_db);
    return need;
  }

  /// Of its leaves. Another thread may choose by it while this scene is read.
  LevelChooser& chooser() { return *chooser_; }
  /// Goes by a choice from now on. True if there is something to read.
  bool choose(std::shared_ptr<const LevelsChosen> chosen);
  /// By one that is made now (LevelChooser::choose).
  bool choose(std::span<const shared::View> views, const DetailNeed& need, const DetailSeen& seen = {}) {
    return choose(chooser_->choose(views, need, seen));
  }
  /// The choice: for each leaf the place of its level among those that are there.
  const std::vector<std::size_t>& chosen() const { return chosen_->levels; }

  /// What the views of the last choice are taken to have against the finest levels, in dB, with the choice;
  /// none where dB were not chosen by. `found`: DetailNeed.
  std::optional<double> predicted_psnr(double found = 1.0) const {
    return choice() ? std::optional(psnr_of_error(found * choice()->error_of(chosen()))) : std::nullopt;
  }

  /// What the views of the last choice lose; none where dB were not chosen by.
  const std::shared_ptr<const DetailChoice>& choice() const { return chosen_->by_errors; }

  /// The Gaussians of a part at the level chosen.
  struct Piece {
    std::size_t part = 0;
    std::optional<std::size_t> level, before;  // places among the leaf's levels; none of the environment
    Model model;
  };
  using Take = std::function<void(Piece piece)>;

  /// Reads the leaves whose level is another one than when they were read last, and hands them to `take`, one
  /// at a time, maybe in other threads; those that get fewer Gaussians first, then by dB those files that
  /// save the most error per Gaussian, else coarse levels before fine ones. Asks `goes_on` after some, where
  /// it is not empty, and leaves out the rest if it does not; files then come as soon as they are decoded.
  /// Throws Error where a file has become unreadable.
  void read(const Take& take, const std::function<bool()>& goes_on = {});
  /// Reads the finest levels of some leaves, which does not count as read.
  PartModels finest_of(std::span<const std::size_t> leaves) const;
  /// Whether a piece that was read is of the level chosen now.
  bool wants(const Piece& piece) const {
    return piece.part == leaves_.size() || piece.level == level(piece.part);
  }
  /// The squared error that a piece saves by the choice for each of its Gaussians (DetailChoice::saved);
  /// infinite where it has fewer than the one before, or where no dB are gone by.
  double worth(const Piece& piece) const;
  /// The last piece that was read of a part counts as not read.
  void put_back(const Piece& piece) { read_[piece.part] = piece.before; }
  /// Nothing counts as read any more.
  void forget() {
    read_.assign(leaves_.size(), std::nullopt);
    environment_read_ = false;
    chooser_->forget();
  }

 private:
  struct Source;
  std::size_t level(std::size_t leaf) const { return chosen_->levels[leaf]; }
  double saved(std::size_t leaf, std::optional<std::size_t> before) const;
  double worth(std::size_t file, const SogLevels::TakenOfFile& taken, bool by_cache) const;
  std::vector<SogLevels::TakenOfFile> to_read(bool shrinks) const;
  void read_files(std::span<const std::size_t> files, std::span<const SogLevels::TakenOfFile> taken,
                  const Take& take, const std::function<bool()>& goes_on);
  void check_room(std::span<const std::vector<SogLevels::TakenOfFile>> all) const;
  std::vector<Piece> read_file(std::size_t file, const SogLevels::TakenOfFile& taken) const;

  std::unique_ptr<Source> source_;
  Model like_;
  std::vector<DetailPart> leaves_;
  std::size_t spare_ = 0;
  std::optional<LevelChooser> chooser_;
  std::shared_ptr<const LevelsChosen> chosen_ = std::make_shared<const LevelsChosen>();
  std::vector<std::optional<std::size_t>> read_;  // of the leaves
  bool environment_read_ = false;
};

}  // namespace binosplat
