#include "app/render_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "app/command.h"
#include "app/foveate_options.h"
#include "app/load_scene.h"
#include "app/render_summary.h"
#include "base/log.h"
#include "base/statistics.h"
#include "lab/fields.h"
#include "scene/scaffold.h"
#include "shared/axes.h"

namespace binosplat::app {

namespace {

using lab::FieldWriter;
using lab::object;
using nlohmann::ordered_json;

/// What is left out of the JSON otherwise.
template <typename T>
std::optional<T> given(bool is, const T& value) {
  return is ? std::optional(value) : std::nullopt;
}

std::optional<double> mean_photo_psnr(const RenderReport& report) {
  double sum = 0.0;
  int count = 0;
  for (const Drawn& drawn : report.drawn) {
    if (!drawn.photo_psnr) continue;
    sum += *drawn.photo_psnr;
    ++count;
  }
  if (count < 2) return std::nullopt;
  return sum / count;
}

ordered_json list(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

ordered_json eye_json(const Eye& eye) {
  const Camera& c = eye.camera;
  const auto& axes = c.rotation;
  return object("eye", given(!eye.side.empty(), eye.side), "width", c.width, "height", c.height, "fx", c.fx,
                "fy", c.fy, "cx", c.cx, "cy", c.cy, "position", list(c.position), "axes",
                object("x_right", list(axes[0]), "y_down", list(axes[1]), "z_forward", list(axes[2])));
}

// At which the optics of headsets put their screens.
constexpr double headset_focus_metres = 2.0;

ordered_json comfort_json(const Comfort& comfort) {
  const stereo::DisparityRange& r = comfort.range;
  return object("focus_metres", comfort.focus ? ordered_json(*comfort.focus) : ordered_json(), "near_px",
                r.near_px, "far_px", r.far_px, "near_degrees", r.near_degrees, "far_degrees", r.far_degrees,
                "vertical_px", r.vertical_px, "comfortable", stereo::comfortable(r));
}

double discomfort(const Drawn& drawn) {
  const stereo::DisparityRange& r = drawn.comfort->range;
  return std::max(r.near_degrees, -r.far_degrees);
}

// Warns of the pair that asks most of the eyes, and how many others do, of those that options can change.
void warn_of_discomfort(const std::vector<Drawn>& all) {
  const Drawn* worst = nullptr;
  int others = -1;
  for (const Drawn& drawn : all) {
    if (!drawn.comfort || !drawn.comfort->better) continue;
    ++others;
    if (worst == nullptr || discomfort(drawn) > discomfort(*worst)) worst = &drawn;
  }
  if (worst == nullptr) return;
  const stereo::ComfortableRig& better = *worst->comfort->better;
  log_warning(
      "{}{}: disparities beyond {:.0f} degree either way tire most eyes; --convergence {:.3g}{} is within",
      worst->shot.name, others > 0 ? fmt::format(" and {} other view{}", others, others == 1 ? "" : "s") : "",
      stereo::comfortable_degrees, better.convergence,
      better.ipd ? fmt::format(" --ipd {:.3g}", *better.ipd) : "");
}

std::string levels_text(const ShotLevels& levels) {
  std::string text = fmt::format("  levels of {} Gaussians", levels.gaussians);
  if (levels.predicted_psnr) text += fmt::format(", {:.2f} dB predicted", *levels.predicted_psnr);
  if (levels.finest_psnr) text += fmt::format(", {:.2f} dB against the finest", *levels.finest_psnr);
  if (levels.switched) {
    text += fmt::format("; switched: {:.0f} ms to read, {:.1f} to upload", levels.read_ms, levels.upload_ms);
    if (levels.switch_psnr) text += fmt::format(", {:.2f} dB to those before", *levels.switch_psnr);
  }
  return text;
}

ordered_json levels_json(const ShotLevels& l) {
  return object("gaussians", l.gaussians, "switched", l.switched, "read_ms", l.read_ms, "upload_ms",
                l.upload_ms, "switch_psnr_db", l.switch_psnr, "finest_psnr_db", l.finest_psnr,
                "predicted_psnr_db", l.predicted_psnr);
}

// Along a path: how much is drawn, how often it changes, and the worst of what that costs.
void print_levels(const RenderReport& report) {
  std::vector<double> gaussians, finest, switches, read, upload;
  for (const Drawn& drawn : report.drawn) {
    if (!drawn.levels) return;
    gaussians.push_back(static_cast<double>(drawn.levels->gaussians));
    if (drawn.levels->finest_psnr) finest.push_back(*drawn.levels->finest_psnr);
    if (drawn.levels->switch_psnr) switches.push_back(*drawn.levels->switch_psnr);
    if (!drawn.levels->switched) continue;
    read.push_back(drawn.levels->read_ms);
    upload.push_back(drawn.levels->upload_ms);
  }
  fmt::print("levels of detail: {:.0f} Gaussians (median), {} switches in {} views", quantile(gaussians, 0.5),
             read.size(), gaussians.size());
  if (!read.empty()) {
    fmt::print(" of {:.0f} ms to read and {:.1f} to upload (median; at most {:.0f} and {:.1f})",
               quantile(read, 0.5), quantile(upload, 0.5), quantile(read, 1.0), quantile(upload, 1.0));
  }
  if (!finest.empty()) {
    fmt::print("; against the finest {:.2f} dB (median), {:.2f} at worst", quantile(finest, 0.5),
               quantile(finest, 0.0));
  }
  if (!switches.empty()) {
    fmt::print("; across a switch {:.2f} dB (median), {:.2f} at worst", quantile(switches, 0.5),
               quantile(switches, 0.0));
  }
  fmt::print("\n");
}

ordered_json foveated_json(const stereo::FoveatedEye& eye) {
  const auto two = [](const glm::uvec2& v) { return ordered_json::array({v.x, v.y}); };
  return object("inset_begin", two(eye.inset_begin), "inset_end", two(eye.inset_end), "seam_px", eye.seam,
                "window", two(eye.window.size), "context", two({eye.context.width, eye.context.height}));
}

ordered_json view_json(const Drawn& drawn, const RenderOptions& options,
                       const std::optional<double>& convergence) {
  const render::FrameReport& r = drawn.report;
  const DrawingOptions& drawing = options.drawing;
  ordered_json json =
      object("name", drawn.shot.name, "units_per_metre", drawn.shot.units_per_metre, "ipd_metres",
             drawn.shot.ipd, "convergence_metres", drawn.shot.given_eyes ? std::nullopt : convergence,
             "cant_degrees", options.rig.cant, "eyes", ordered_json::array());
  for (const Eye& eye : drawn.shot.eyes) json["eyes"].push_back(eye_json(eye));
  FieldWriter{json}("visible", r.visible, "pairs", r.pairs, "gpu_ms", r.stages.empty() ? NAN : r.total_ms,
                    "tile", r.tile_size, "depth_orders", r.order_groups, "drawn_again", r.redrawn,
                    "tolerance", given(drawing.quality || !drawing.calibration.empty(), r.tolerance),
                    "probed_psnr_db", given(drawing.quality.has_value(), r.quality), "told_psnr_db",
                    given(drawing.quality.has_value(), reported_psnr(drawn)), "told_is_estimate",
                    given(drawing.quality.has_value(), is_estimate(drawn)), "photo_psnr_db",
                    drawn.photo_psnr);
  if (drawn.levels) json["levels_of_detail"] = levels_json(*drawn.levels);
  for (const stereo::FoveatedEye& eye : drawn.foveated) json["foveated"].push_back(foveated_json(eye));
  if (drawn.comfort) json["disparity"] = comfort_json(*drawn.comfort);
  if (drawn.most_shown)
    json["show"] = object("what", show_choices[options.output.show].name, "most", *drawn.most_shown);
  json["outputs"] = drawn.files;
  return json;
}

ordered_json settings_json(const RenderReport& report) {
  const DrawingOptions& o = report.options.drawing;
  const Background& background = report.options.output.background;
  const Model& model = report.model;
  const std::optional<DetailRequest>& detail = report.options.scene.detail;
  const bool vr180 = report.options.camera.lens.vr180();
  const int order = vr180 ? ORDER_DISTANCE : o.order.value_or(model.perspective.order);
  const int projection = vr180 ? PROJECTION_TANGENT : o.projection.value_or(model.perspective.projection);
  return object("vr180", given(vr180, true), "tiles", tiles_choices[o.tiles].name, "tile",
                o.tile ? ordered_json(*o.tile) : ordered_json("auto"), "precision",
                precision_choices[o.precision].name, "near", report.near_plane, "antialiased",
                model.antialiased, "order", order_choices[order].name, "projection",
                projection_choices[projection].name, "kernel_px2", model.kernel_px2, "th",
                th_choices[threshold_of(o)].name, "tolerance", o.tolerance, "transmittance",
                transmittance_choices[o.transmittance].name, "decode",
                given(model.scaffold != nullptr, decode_choices[o.decode.value_or(DECODE_EYES)].name),
                "detail_px", given(detail && !detail->db, detail ? detail->apart_px : 0.0), "detail_db",
                detail ? detail->db : std::nullopt, "quality_db", o.quality, "calibration",
                given(!o.calibration.empty(), o.calibration), "background",
                background ? list(glm::dvec3(*background)) : ordered_json(), "reference_until",
                o.reference_until ? std::optional(render::name_of(*o.reference_until)) : std::nullopt);
}

ordered_json scene_json(const RenderReport& report) {
  const SceneOptions& o = report.options.scene;
  const Model& model = report.model;
  const bool city = o.name == demo_city_name;
  ordered_json json = object("name", o.name, "seed", given(city, city_settings(o).seed), "count",
                             given(city, city_settings(o).count));
  if (o.repeat) json["repeat"] = object("x", o.repeat->x, "z", o.repeat->y, "spacing", *o.spacing);
  const bool follows = !report.drawn.empty() && report.drawn.back().levels;
  FieldWriter{json}("gaussians", follows ? report.drawn.back().levels->gaussians : model.count(), "left_out",
                    model.left_out, "degree", model.degree);
  if (const Scaffold* s = model.scaffold.get())
    json["scaffold"] = object("anchors", s->anchor_count(), "gaussians_per_anchor", s->offset_count,
                              "features", s->feature_count, "appearances", s->appearance_count(),
                              "appearance", given(s->appearance_count() > 0, s->appearance));
  return json;
}

}  // namespace

std::optional<Comfort> comfort_of(const Shot& shot, bool headset, const Picture& left) {
  if (shot.eyes.size() != 2) return std::nullopt;
  const std::array<Camera, 2> eyes = {shot.eyes[0].camera, shot.eyes[1].camera};
  // No screen stands in the plane of zero disparity of a headset, and canted eyes have no such plane.
  const bool canted = glm::dot(eyes[0].rotation[2], eyes[1].rotation[2]) < 1.0 - 1e-9;
  const auto focus = canted || headset ? std::optional(headset_focus_metres * shot.units_per_metre)
                                       : stereo::screen_distance(eyes);
  const auto range = stereo::disparity_range(eyes, left, focus);
  if (!range) return std::nullopt;
  Comfort comfort{
      *range, focus ? std::optional(*focus / shot.units_per_metre) : std::nullopt, canted || headset, {}};
  const bool own_rig = !shot.given_eyes && !canted && !headset;
  if (own_rig && !stereo::comfortable(*range)) {
    comfort.better = stereo::comfortable_rig(*range, eyes);
    comfort.better->convergence /= shot.units_per_metre;
    if (comfort.better->ipd) *comfort.better->ipd /= shot.units_per_metre;
  }
  return comfort;
}

std::string megabytes(std::int64_t bytes) {
  const double whole = std::round(static_cast<double>(bytes) / 1e6);
  if (whole < 10.0) return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
  std::string digits = fmt::format("{:.0f}", whole);
  for (int place = static_cast<int>(digits.size()) - 3; place > 0; place -= 3)
    digits.insert(static_cast<std::size_t>(place), ",");
  return digits + " MB";
}

void StageTimes::add(const render::FrameReport& report) { frames_.push_back(report); }

std::vector<StageTimes::Row> StageTimes::rows() const {
  if (frames_.empty()) return {};
  const std::size_t first = frames_.size() - frames();
  if (frames_[first].stages.empty()) return {};  // the GPU drew nothing: the reference did
  const auto row = [&](const std::string& name, const auto& time_of) {
    std::vector<double> times;
    for (std::size_t k = first; k < frames_.size(); ++k) times.push_back(time_of(frames_[k]));
    return Row{name, quantile(times, 0.5), quantile(times, 0.99)};
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; i < frames_[first].stages.size(); ++i) {
    rows.push_back(row(frames_[first].stages[i].name,
                       [i](const render::FrameReport& frame) { return frame.stages.at(i).ms; }));
  }
  rows.push_back(row("frame", [](const render::FrameReport& frame) { return frame.total_ms; }));
  return rows;
}

void print_needs(const render::MemoryNeeds& needs) {
  log_info("GPU memory: {} for the model, at least {} for a frame", megabytes(needs.model),
           megabytes(needs.frame));
}

void print(const RenderReport& report) {
  const bool together = is_way(report);
  if (together) print_way(report);
  for (const Drawn& drawn : report.drawn) {
    if (together) break;
    std::string line = fmt::format("{}: {}", drawn.shot.name, fmt::join(drawn.files, ", "));
    line += drawn.report.stages.empty()
                ? "  (by the float64 reference, on the CPU"
                : fmt::format("  ({} pairs, {:.3f} ms", drawn.report.pairs, drawn.report.total_ms);
    if (report.options.drawing.quality)
      line += fmt::format(", tolerance {:.4g} for {}{:.1f} dB", drawn.report.tolerance,
                          is_estimate(drawn) ? "an estimated " : "", reported_psnr(drawn));
    if (drawn.photo_psnr) line += fmt::format(", {:.4f} dB against the photo", *drawn.photo_psnr);
    fmt::print("{})\n", line);
    if (drawn.most_shown)
      fmt::print("  colours: {}: 0 (dark blue) to {} and more (yellow)\n",
                 show_choices[report.options.output.show].name, *drawn.most_shown);
    if (drawn.levels) fmt::print("{}\n", levels_text(*drawn.levels));
    for (std::size_t k = 0; k < drawn.foveated.size(); ++k) {
      const std::string& side = drawn.shot.eyes[k].side;
      fmt::print("  {}{}{}\n", side, side.empty() ? "" : ": ", describe(drawn.foveated[k]));
    }
    if (drawn.comfort) print_comfort(drawn);
  }
  warn_of_discomfort(report.drawn);
  tell_whether_quality_pays(report);
  if (const auto mean = mean_photo_psnr(report)) fmt::print("mean: {:.4f} dB against the photos\n", *mean);
  print_levels(report);
  const std::size_t frames = report.times.frames();
  const std::vector<StageTimes::Row> rows = report.times.rows();
  if (rows.empty() || is_quiet()) return;
  fmt::print("\n{:<12}{:>12}{:>12}\n", "stage", "median ms", "p99 ms");
  for (const StageTimes::Row& row : rows) {
    fmt::print("{:<12}{:>12.3f}{:>12.3f}\n", row.stage, row.median_ms, row.p99_ms);
  }
  fmt::print(
      "GPU time of {} frame{} on {}{}; {:.1f} MB in buffers; making the shaders' programs took {:.2f} s\n",
      frames, frames == 1 ? "" : "s", report.context.renderer(), frames == 1 ? " (--frames N for more)" : "",
      static_cast<double>(report.context.peak_bytes()) / 1e6, 1e-3 * report.context.making_ms());
  print_run(report);
}

void save(const std::filesystem::path& path, const RenderReport& report) {
  const gl::Context& context = report.context;
  ordered_json json = object(
      "version", BINOSPLAT_VERSION, "scene", scene_json(report), "device",
      object("backend", context.backend(), "renderer", context.renderer(), "opengl", context.version()),
      "settings", settings_json(report));
  if (report.exact_ms) json["exact_frame_ms"] = *report.exact_ms;
  json["views"] = ordered_json::array();
  for (const Drawn& drawn : report.drawn)
    json["views"].push_back(view_json(drawn, report.options, report.convergence));
  FieldWriter{json}("mean_photo_psnr_db", mean_photo_psnr(report), "frames", report.times.frames(), "stages",
                    ordered_json::array());
  for (const StageTimes::Row& row : report.times.rows())
    json["stages"].push_back(object("stage", row.stage, "median_ms", row.median_ms, "p99_ms", row.p99_ms));
  const RunTimes& run = report.run;
  json["run"] = object("seconds", 1e-3 * run.all, "reading_back_seconds", 1e-3 * run.reading,
                       "waiting_for_files_seconds", 1e-3 * run.waiting, "encoding_thread_seconds",
                       run.encoding, "writing_thread_seconds", run.writing, "threads", run.threads);
  json["memory"] = object("model_bytes", report.needs.model, "frame_bytes_at_least", report.needs.frame,
                          "gpu_bytes", context.allocated_bytes(), "gpu_peak_bytes", context.peak_bytes());
  save_json(path, json);
}

}  // namespace binosplat::app
