#include "app/render_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/log.h"
#include "base/statistics.h"
#include "shared/axes.h"

namespace binosplat::app {

namespace {

// What the eyes focus on.
std::string focus_text(const Comfort& comfort) {
  if (!comfort.focus) return "what is infinitely far";
  return fmt::format("{} at {:.3g} m", comfort.headset ? "a headset's focus" : "the screen", *comfort.focus);
}

/// The disparities of all frames.
void print_widest(const std::vector<Drawn>& all) {
  Drawn widest;
  for (const Drawn& drawn : all) {
    if (!drawn.comfort) continue;
    if (!widest.comfort) widest.comfort = drawn.comfort;
    stereo::DisparityRange& range = widest.comfort->range;
    const stereo::DisparityRange& r = drawn.comfort->range;
    range.near_px = std::max(range.near_px, r.near_px);
    range.far_px = std::min(range.far_px, r.far_px);
    range.near_degrees = std::max(range.near_degrees, r.near_degrees);
    range.far_degrees = std::min(range.far_degrees, r.far_degrees);
    range.vertical_px = std::max(range.vertical_px, r.vertical_px);
  }
  if (widest.comfort) print_comfort(widest);
}

// Where most of the time is waited for files.
std::string what_bounds(const RunTimes& run, const OutputOptions& o) {
  const std::string cores = fmt::format("on {} core{}", run.threads, run.threads == 1 ? "" : "s");
  if (run.is_video) {
    const bool is_ffmpeg = run.writing > run.encoding / run.threads;
    return is_ffmpeg ? "ffmpeg, which encodes the video, bounds this run"
                     : fmt::format("converting frames {} bounds this run: more cores would help", cores);
  }
  if (run.writing > run.encoding)
    return fmt::format("writing files {} bounds this run: a faster disk would help", cores);
  return fmt::format("encoding files {} bounds this run: {}", cores,
                     o.exr_half && o.exr_compression == ExrCompression::zip
                         ? "--exr-compression rle is faster"
                     : o.png_level > 0 ? "--png-level 0 is faster"
                                       : "more cores would help");
}

}  // namespace

double reported_psnr(const Drawn& drawn) {
  const bool shares = drawn.levels && drawn.levels->predicted_psnr;
  const double frame = drawn.report.quality;
  return shares ? psnr_of_both(frame, *drawn.levels->predicted_psnr) : frame;
}

bool is_estimate(const Drawn& drawn) {
  return drawn.report.quality_is_estimate || (drawn.levels && drawn.levels->predicted_psnr);
}

void print_comfort(const Drawn& drawn) {
  const stereo::DisparityRange& r = drawn.comfort->range;
  fmt::print("  disparity {:.1f} (far) to {:.1f} px (near), {:.2f} to {:.2f} degrees, against {}{}\n",
             r.far_px, r.near_px, r.far_degrees, r.near_degrees, focus_text(*drawn.comfort),
             r.vertical_px > 0.5 ? fmt::format("; vertical up to {:.1f} px", r.vertical_px) : "");
}

bool is_way(const RenderReport& report) {
  constexpr std::size_t few = 8;
  const std::vector<Drawn>& all = report.drawn;
  return all.size() > few && (report.options.camera.along_path() || all.front().files == all.back().files);
}

void print_way(const RenderReport& report) {
  const std::vector<Drawn>& all = report.drawn;
  std::vector<double> pairs, ms, reported, shown;
  for (const Drawn& drawn : all) {
    pairs.push_back(static_cast<double>(drawn.report.pairs));
    ms.push_back(drawn.report.total_ms);
    reported.push_back(reported_psnr(drawn));
    if (drawn.most_shown) shown.push_back(*drawn.most_shown);
  }
  const std::string &first = all.front().files.front(), &last = all.back().files.back();
  std::string line = fmt::format("{} frames: {}", all.size(), first);
  if (last != first) line += " to " + last;
  line += all.front().report.stages.empty()
              ? "  (by the float64 reference, on the CPU"
              : fmt::format("  ({:.0f} pairs, {:.3f} ms, medians", quantile(pairs, 0.5), quantile(ms, 0.5));
  if (report.options.drawing.quality)
    line += fmt::format("; {:.1f} dB, {:.1f} at worst, {} of them estimated", quantile(reported, 0.5),
                        quantile(reported, 0.0), std::ranges::count_if(all, is_estimate));
  fmt::print("{}{})\n", line, report.options.output.json.empty() ? "; each by itself: --json FILE" : "");
  if (!shown.empty())
    fmt::print("  colours: {}: 0 (dark blue) to {} to {} and more (yellow), by frame\n",
               show_choices[report.options.output.show].name, quantile(shown, 0.0), quantile(shown, 1.0));
  print_widest(all);
}

void tell_whether_quality_pays(const RenderReport& report) {
  const RenderOptions& o = report.options;
  if (!o.drawing.quality || report.drawn.empty()) return;
  double ms = 0.0;
  int attempts = 0;
  for (const Drawn& drawn : report.drawn) {
    ms += drawn.report.total_ms / static_cast<double>(report.drawn.size());
    attempts = std::max(attempts, drawn.report.attempts);
  }
  if (report.exact_ms && ms > *report.exact_ms) {
    log_warning(
        "--quality {:g} does not pay here: a frame took {:.3g} ms in the mean, the first one's search "
        "included, and an exact one takes {:.3g} ms: leave it out",
        *o.drawing.quality, ms, *report.exact_ms);
  } else if (!o.camera.along_path() && o.drawing.frames == 1) {
    log_info(
        "--quality {:g} draws a single picture exactly as well, and up to {} times until it holds: by itself "
        "an exact one is faster",
        *o.drawing.quality, attempts);
  }
}

void print_run(const RenderReport& report) {
  const RunTimes& run = report.run;
  const std::size_t shots = report.drawn.size();
  if (run.all < 1000.0 || shots < 2) return;
  const auto percent = [&](double ms) { return static_cast<int>(std::lround(100.0 * ms / run.all)); };
  const int drawing = percent(run.all - run.reading - run.waiting), files = percent(run.waiting);
  fmt::print(
      "{} views in {:.1f} s, {:.3g} a second; of the time: drawing {} %, reading back {} %, waiting for "
      "files {} %\n",
      shots, 1e-3 * run.all, 1e3 * static_cast<double>(shots) / run.all, drawing, percent(run.reading),
      files);
  if (files > 50) fmt::print("{}\n", what_bounds(run, report.options.output));
  if (!report.context.software() && run.gpu < 0.5 * run.all)
    fmt::print(
        "The GPU had nothing to do for {} % of the time and may have run at a low clock: `binosplat bench` "
        "times a busy one\n",
        100 - percent(run.gpu));
}

}  // namespace binosplat::app
