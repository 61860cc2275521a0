#pragma once
// Levels of detail for single pictures, which wait for their levels.

#include "stream/streamed_model.h"

namespace binosplat {

class PictureStream : public StreamedModel {
 public:
  PictureStream(const std::filesystem::path& path, StreamSettings settings)
      : StreamedModel(path, std::move(settings)) {}

  /// Chooses, reads and uploads the levels for these views before it returns. If levels are chosen by dB,
  /// calibrates the levels' loss for these views, and chooses levels up to eleven times. With
  /// DetailRequest::heads_turn the choice starts from the previous views' levels. Calls `before_change`
  /// before the first change of levels, and returns whether there was one. Throws Error if a file has become
  /// unreadable.
  bool settle(std::span<const shared::View> views, const render::FrameSettings& settings,
              const std::function<void()>& before_change = {});

  /// Returns the calibrated prediction of the last picture's PSNR against the finest levels, in dB. None if
  /// levels are not chosen by dB, or before the first measurement.
  std::optional<double> reported_db() const;

 private:
  std::optional<LevelChoice> choice_;  // for the last picture; none if levels are not chosen by dB
};

}  // namespace binosplat
