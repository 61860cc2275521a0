#pragma once
// A way to draw, by the names that options and charts use (shared/axes.h).

#include <compare>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "render/settings.h"
#include "stereo/foveate.h"

namespace binosplat::lab {

/// The PSNR in dB that means and charts take for equal pictures, which have none.
constexpr double equal_db = 100.0;

/// A way to draw that bench measures: of whole pictures, or foveated along the eyes' axes.
struct BenchSettings : render::FrameSettings {
  std::optional<stereo::Foveation> foveation;

  BenchSettings() = default;
  BenchSettings(const render::FrameSettings& whole)  // NOLINT(google-explicit-constructor): nothing is lost
      : render::FrameSettings(whole) {}
};

/// What decides the picture and its time, as files have it.
struct NamedSettings {
  std::string tiles;
  int tile = 0;  // px
  std::string th;
  std::optional<std::string> precision;      // where it is not full
  std::optional<std::string> transmittance;  // where th is not tau
  std::optional<double> tolerance;           // likewise: the decimal number that was meant
  std::optional<double> inset, context;      // where foveated: degrees, share of the pixels along an axis

  auto operator<=>(const NamedSettings&) const = default;  // NOLINT(modernize-use-nullptr): none is meant
};

NamedSettings named(const BenchSettings& settings);

void to_json(nlohmann::ordered_json& json, const NamedSettings& settings);
void from_json(const nlohmann::ordered_json& json, NamedSettings& settings);
/// Of named().
nlohmann::ordered_json to_json(const BenchSettings& settings);

/// One line for legends: "ellipse", "peripheral, last, 0.5", "ellipse, inset 20, context 0.4"; tiles are
/// named where they are not `ellipse`, tiles of another size than 16 px as "tile 8".
std::string describe(const BenchSettings& settings);

/// The same without the tolerance: what a line of the chart joins.
std::string describe_family(const BenchSettings& settings);

/// render::check_choice() of what a file says: Error begins with `place`. There a threshold needs a
/// tolerance.
void check(const std::string& place, const BenchSettings& settings);

/// Whether the picture is exact by definition: no pair that could be seen is left out, nothing is in fp16 or
/// in fewer pixels.
bool is_exact(const BenchSettings& settings);

}  // namespace binosplat::lab
