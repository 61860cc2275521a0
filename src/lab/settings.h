#pragma once
// A way to draw, by the names that axes, charts and files use.

#include <optional>
#include <string>

#include "lab/results.h"
#include "render/settings.h"
#include "stereo/foveate.h"
#include "stream/choice.h"

namespace binosplat::lab {

/// As --detail has it: "5", px, or "40dB". Throws Error, which begins with `option`, for anything else.
DetailRequest parse_detail(const std::string& text, const std::string& option = "--detail");
/// "40dB" or "5px".
std::string text_of(const DetailRequest& detail);

/// A way to draw that is measured: of whole pictures, or foveated along the eyes' axes.
struct BenchSettings : render::FrameSettings {
  std::optional<stereo::Foveation> foveation;
  std::optional<DetailRequest> detail;  // of a scene with levels of detail; none: the finest
  std::optional<float> far;             // where the table by depth ends, world units; none: fits the scene
  /// The tolerance is the largest that costs so much in the mean: dB lost against photos, or left against
  /// exact pictures.
  std::optional<double> max_drop, min_psnr;
  bool found_on_training = false;  // in the views for training; else in those that are measured

  BenchSettings() = default;
  BenchSettings(const render::FrameSettings& whole)  // NOLINT(google-explicit-constructor): nothing is lost
      : render::FrameSettings(whole) {}

  bool finds_tolerance() const { return max_drop || min_psnr; }
};

/// What decides the picture and its time, as files have it.
Row named(const BenchSettings& settings);

/// One line for legends: "ellipse", "peripheral, last, 0.5", "ellipse, inset 20, context 0.4"; tiles are
/// named where they are not `ellipse`, tiles of another size than 16 px as "tile 8".
std::string describe(const BenchSettings& settings);

/// The same without the number that is asked for (tolerance, quality, dB lost, detail): what a line of a
/// chart joins.
std::string describe_family(const BenchSettings& settings);

/// render::check_choice() of what a file says: Error begins with `place`. There a threshold needs a
/// tolerance, or what it is to be found for.
void check(const std::string& place, const BenchSettings& settings);

/// Whether the picture is exact by definition: no pair that could be seen is left out, nothing is in fp16, in
/// fewer pixels or of coarser levels.
bool is_exact(const BenchSettings& settings);

}  // namespace binosplat::lab
