#pragma once
// A way to draw, by the names that options and charts use (shared/axes.h).

#include <nlohmann/json.hpp>
#include <string>

#include "render/settings.h"

namespace binosplat::study {

/// The PSNR in dB that means and charts take for equal pictures, which have none.
constexpr double equal_db = 100.0;

/// What decides the picture and its time: tiles, tile, th and, where they matter, precision, transmittance
/// and loss.
nlohmann::ordered_json to_json(const render::FrameSettings& settings);

/// One line for legends: "ellipse", "peripheral, last, 0.5"; tiles are named where they are not `ellipse`,
/// tiles of another size than 16 px as "tile 8".
std::string describe(const render::FrameSettings& settings);

/// The same without the loss: what a line of the chart joins.
std::string describe_family(const render::FrameSettings& settings);

/// render::check_choice() of what a file says: Error begins with `place`. There a threshold needs a loss.
void check(const std::string& place, const render::FrameSettings& settings);

/// Whether the picture is exact by definition: no pair that could be seen is left out, nothing is in fp16.
bool is_exact(const render::FrameSettings& settings);

}  // namespace binosplat::study
