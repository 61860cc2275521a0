#pragma once
// What bench has measured, as one JSON object:
//
//   {"format": "binosplat bench", "version": 1, "plan": {...}, "points": [...]}
//
// A point has the names of its chart (scene, eyes, size) and of its settings (settings, name), what Bench
// measured of it, or a "problem"; a point of the plan that is not measured yet has neither. Bench's numbers:
// frame_ms (the views' medians, in the mean), p99_ms, noise_ms (half the spread of the repeats), settled (the
// clock did), frames, submit_ms (CPU), stages_ms; pairs, visible and gpu_bytes of a frame; alphas and
// alphas_visible, evaluated and blended a pixel; profile (floors.h), where that was asked for; exact and
// photos: psnr_db, ssim and flip as means over the views, signed (mean of picture minus exact: below 0 is
// darker), drop_db (dB lost against the photo); views: the same by view. psnr_db is null where a view is
// equal.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/page.h"
#include "study/settings.h"

namespace binosplat::study {

/// Whether a point was measured without a problem.
bool is_measured(const nlohmann::ordered_json& point);

/// For each point whether it is on the Pareto front of its chart (same scene, eyes and size): none is both
/// quicker and nearer to exact.
std::vector<bool> pareto_front(const nlohmann::ordered_json& points);

/// A line a point, a column a number; empty where it was not measured.
std::string csv(const nlohmann::ordered_json& results);

/// The charts, by scene, eyes and size.
Page bench_page(const nlohmann::ordered_json& results);

/// What changed beyond noise since an older run, a line each; the last line counts. Points are matched by
/// scene, eyes, size and settings. Frame times count as changed when they differ by more than both runs'
/// noise and 2 %; PSNR by 0.01 dB; pairs by 0.1 %.
std::vector<std::string> compare_results(const nlohmann::ordered_json& before,
                                         const nlohmann::ordered_json& now);

}  // namespace binosplat::study
