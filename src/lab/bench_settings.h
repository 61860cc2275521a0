#pragma once
// The settings of a measurement, with their names in suites, charts and files.

#include <optional>
#include <string>

#include "lab/results.h"
#include "render/frame_settings.h"
#include "stereo/foveate.h"
#include "stream/level_choice.h"

namespace binosplat::lab {

/// Parses `detail`: "5px" (or "5") or "40dB". Throws Error, which begins with `option`, for other text.
DetailRequest parse_detail(const std::string& text, const std::string& option = "`detail`");
/// "40dB" or "5px".
std::string text_of(const DetailRequest& detail);

/// Settings to measure: of whole pictures, or of foveated ones with the gaze along the eyes' axes.
struct BenchSettings : render::FrameSettings {
  std::optional<DetailRequest> detail;  // for scenes with levels of detail; none: the finest
  std::optional<float> far;             // end of the depth table, world units; none: fits the scene
  /// If one is set, the bench searches the largest tolerance that keeps this limit: of the mean dB lost
  /// against photos, or of the mean PSNR against exact pictures.
  std::optional<double> max_drop, min_psnr;
  bool found_on_training = false;  // searches that tolerance in training views, else in measured ones

  BenchSettings() = default;
  BenchSettings(const render::FrameSettings& whole)  // NOLINT(google-explicit-constructor): nothing is lost
      : render::FrameSettings(whole) {}

  bool finds_tolerance() const { return max_drop || min_psnr; }
};

/// The rule's name; "either" if frames choose it for a quality.
const char* rule_of(const render::FrameSettings& settings);

/// All values that affect the picture and its time, under their names in files.
Row row_of_settings(const BenchSettings& settings);

/// One line for legends: "exact", "adagscale, last, 0.5", "ellipse, inset 20, context 0.4". Omits the tile
/// test `ellipse` unless the rule is exact.
std::string describe(const BenchSettings& settings);

/// describe() without the requested number (tolerance, quality, dB lost, detail). Points of equal series are
/// one series of a chart.
std::string describe_series(const BenchSettings& settings);

/// Checks settings of a file as render::check() does. Also, an inexact rule needs exactly one of
/// tolerance, quality, max_drop and min_psnr. Errors begin with `place`.
void check(const std::string& place, const BenchSettings& settings);

/// Whether the picture is exact by definition: no dropped visible pairs, foveation, fp16 or coarser levels.
bool is_exact(const BenchSettings& settings);

}  // namespace binosplat::lab
