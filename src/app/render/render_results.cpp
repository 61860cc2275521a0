// Prints and saves the results of `binosplat render`: a table, and JSON.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/load_scene.h"
#include "app/render/render_run.h"
#include "base/choices.h"
#include "base/log.h"
#include "base/statistics.h"
#include "lab/bench_settings.h"
#include "lab/fields.h"
#include "render/frame_plan.h"
#include "scene/scaffold.h"
#include "shared/choices.h"

namespace binosplat::app {

namespace {

using lab::object;
using nlohmann::ordered_json;

/// The value if `is`, else none, which JSON and table omit.
template <typename T>
std::optional<T> given(bool is, const T& value) {
  return is ? std::optional(value) : std::nullopt;
}

// Reported dB of a shot. If levels share the error of --quality, the dB include the levels' loss.
double reported_psnr(const Drawn& drawn) {
  const bool shares = drawn.levels && drawn.levels->predicted_psnr;
  const double frame = drawn.report.quality;
  return shares ? psnr_of_both(frame, *drawn.levels->predicted_psnr) : frame;
}

// Whether reported dB are estimated, not measured over the whole frame.
bool is_estimate(const Drawn& drawn) {
  return drawn.report.exact == ExactReason::not_exact || (drawn.levels && drawn.levels->predicted_psnr);
}

// GPU time of a frame in ms; none if the reference drew it.
std::optional<double> ms_of(const Report& report) { return given(!report.stages.empty(), report.gpu_ms); }

// Number of frames whose times count: all but the first, in which drivers compile shaders, and at least one.
std::size_t timed_frames(const RenderRun& run) { return std::max<std::size_t>(run.frames.size(), 2) - 1; }

// GPU times of frames by stage, and last of the whole "frame"; empty if the reference drew them.
std::vector<lab::Row> stage_rows(const RenderRun& run) {
  const std::span frames = std::span(run.frames).last(timed_frames(run));
  if (frames.front().stages.empty()) return {};
  std::vector<lab::Row> rows;
  const auto add = [&](const std::string& name, const auto& time_of) {
    std::vector<double> times;
    for (const Report& frame : frames) times.push_back(time_of(frame));
    rows.push_back(object("stage", name, "median_ms", quantile(times, 0.5), "p99_ms", quantile(times, 0.99)));
  };
  const auto& most =
      std::ranges::max_element(frames, {}, [](const auto& f) { return f.stages.size(); })->stages;
  for (const StageTime& stage : most) {
    add(stage.name, [&](const Report& frame) { return gl::time_of(frame.stages, stage.name); });
  }
  add("frame", [](const Report& frame) { return frame.gpu_ms; });
  return rows;
}

// The reason if most of the time is spent waiting for files.
std::string bottleneck_of(const RenderRun& run) {
  const RunTimes& times = run.times;
  const PictureOptions& o = run.options.picture;
  const std::string cores = fmt::format("on {} core{}", times.threads, times.threads == 1 ? "" : "s");
  if (run.outputs.video) {
    const bool is_ffmpeg = times.writing > times.encoding / times.threads;
    return is_ffmpeg ? "ffmpeg, which encodes the video, bounds this run"
                     : fmt::format("converting frames {} bounds this run: more cores would help", cores);
  }
  if (times.writing > times.encoding)
    return fmt::format("writing files {} bounds this run: a faster disk would help", cores);
  return fmt::format("encoding files {} bounds this run: {}", cores,
                     o.exr_half && o.exr_compression == ExrCompression::zip
                         ? "--exr-compression rle is faster"
                     : o.png_level.value_or(1) > 0 ? "--png-level 0 is faster"
                                                   : "more cores would help");
}

void tell_exact_pictures(const RenderRun& run) {
  if (!run.settings.quality || std::ranges::any_of(run.drawn, [](const Drawn& drawn) {
        return drawn.report.exact == ExactReason::not_exact;
      }))
    return;
  const ExactReason reason = run.drawn.front().report.exact;
  log_info(
      "--quality {:g} drew exact pictures only ({}{})", *run.settings.quality, name_of(reason),
      reason == ExactReason::unmeasured ? ": it is for the frames of --path, --tour or --frames 16" : "");
}

void print_run(const RenderRun& run) {
  const RunTimes& times = run.times;
  const std::size_t shots = run.drawn.size();
  if (times.all < 1000.0 || shots < 2) return;
  const auto percent = [&](double ms) { return static_cast<int>(std::lround(100.0 * ms / times.all)); };
  const int drawing = percent(times.all - times.reading - times.waiting), files = percent(times.waiting);
  fmt::print(
      "{} views in {:.1f} s, {:.3g} a second; of the time: drawing {} %, reading back {} %, waiting for "
      "files {} %\n",
      shots, 1e-3 * times.all, 1e3 * static_cast<double>(shots) / times.all, drawing, percent(times.reading),
      files);
  if (files > 50) fmt::print("{}\n", bottleneck_of(run));
  if (!run.context->software() && times.gpu < 0.5 * times.all)
    fmt::print(
        "The GPU had nothing to do for {} % of the time and may have run at a low clock: `binosplat bench` "
        "times a busy one\n",
        100 - percent(times.gpu));
}

double discomfort(const Drawn& drawn) {
  const stereo::DisparityRange& r = drawn.comfort->range;
  return std::max(r.near_degrees, -r.far_degrees);
}

// Warns of the least comfortable pair that options can improve, with the number of other such pairs.
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
      "{}{}: disparities beyond {:.0f} degree either way tire most eyes; --convergence {:.3g}{} avoids them",
      worst->shot.name, others > 0 ? fmt::format(" and {} other view{}", others, others == 1 ? "" : "s") : "",
      stereo::comfortable_degrees, better.convergence,
      better.ipd ? fmt::format(" --ipd {:.3g}", *better.ipd) : "");
}

ordered_json list(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

ordered_json eye_json(const Eye& eye) {
  const Camera& c = eye.camera;
  const auto& axes = c.rotation;
  return object("eye", given(!eye.side.empty(), eye.side), "width", c.width, "height", c.height, "fx", c.fx,
                "fy", c.fy, "cx", c.cx, "cy", c.cy, "position", list(c.position), "axes",
                object("x_right", list(axes[0]), "y_down", list(axes[1]), "z_forward", list(axes[2])));
}

ordered_json comfort_json(const Comfort& comfort) {
  const stereo::DisparityRange& r = comfort.range;
  return object("focus_metres", comfort.focus ? ordered_json(*comfort.focus) : ordered_json(), "near_px",
                r.near_px, "far_px", r.far_px, "near_degrees", r.near_degrees, "far_degrees", r.far_degrees,
                "vertical_px", r.vertical_px, "comfortable", stereo::is_comfortable(r));
}

ordered_json levels_json(const ShotLevels& l) {
  return object("gaussians", l.gaussians, "switched", l.switched, "read_ms", l.read_ms, "upload_ms",
                l.upload_ms, "predicted_psnr_db", l.predicted_psnr);
}

ordered_json foveated_json(const stereo::FoveatedEye& eye) {
  const auto two = [](const glm::uvec2& v) { return ordered_json::array({v.x, v.y}); };
  return object("inset_begin", two(eye.inset_begin), "inset_end", two(eye.inset_end), "seam_px", eye.seam,
                "window", two(eye.window.size), "context", two({eye.context.width, eye.context.height}));
}

ordered_json view_json(const RenderRun& run, const Drawn& drawn) {
  const Report& r = drawn.report;
  const bool by_quality = run.settings.quality.has_value();
  ordered_json json =
      object("name", drawn.shot.name, "units_per_metre", drawn.shot.units_per_metre, "ipd_metres",
             drawn.shot.ipd, "convergence_metres", drawn.shot.given_eyes ? std::nullopt : run.convergence,
             "cant_degrees", run.options.rig.cant, "eyes", ordered_json::array());
  for (const Eye& eye : drawn.shot.eyes) json["eyes"].push_back(eye_json(eye));
  lab::put(json, "visible", r.visible, "pairs", r.pairs, "gpu_ms", ordered_json(ms_of(r).value_or(NAN)),
           "depth_orders", r.order_groups, "redraws", r.redraws, "threshold", name_of(r.threshold),
           "tolerance", given(by_quality || run.calibrated.is_calibrated(), r.tolerance), "probed_psnr_db",
           given(by_quality, r.quality), "reported_psnr_db", given(by_quality, reported_psnr(drawn)),
           "reported_is_estimate", given(by_quality, is_estimate(drawn)), "photo_psnr_db", drawn.photo_psnr);
  if (drawn.levels) json["levels_of_detail"] = levels_json(*drawn.levels);
  for (const stereo::FoveatedEye& eye : drawn.foveated) json["foveated"].push_back(foveated_json(eye));
  if (drawn.comfort) json["disparity"] = comfort_json(*drawn.comfort);
  if (drawn.max_shown)
    json["show"] = object("what", show_choices[run.options.picture.show].name, "max", *drawn.max_shown);
  json["outputs"] = ordered_json::array();
  for (const PictureFile& file : drawn.shot.files) json["outputs"].push_back(file.name);
  return json;
}

std::vector<lab::Row> view_rows(const RenderRun& run) {
  std::vector<lab::Row> rows;
  for (const Drawn& drawn : run.drawn) rows.push_back(view_json(run, drawn));
  return rows;
}

/// A view's row without what its table leaves out.
lab::Row table_row(lab::Row view) {
  view["view"] = view["name"];
  if (view.value("reported_is_estimate", false))
    view["estimated_psnr_db"] = std::exchange(view["reported_psnr_db"], nullptr);
  if (view.contains("show")) view["max " + lab::text(view["show"], "what")] = view["show"]["max"];
  if (view.contains("levels_of_detail") && !view["levels_of_detail"]["switched"])
    view["levels_of_detail"]["read_ms"] = view["levels_of_detail"]["upload_ms"] = nullptr;
  if (lab::number(view, "disparity/vertical_px") <= 0.5) view["disparity"]["vertical_px"] = nullptr;
  return view;
}

// Prints a row for each view, and a summary if there are several. Long paths and videos have only the
// summary.
void print_views(const RenderRun& run) {
  constexpr std::size_t max_listed_views = 8;
  const std::vector<Drawn>& all = run.drawn;
  std::vector<lab::Row> rows = view_rows(run), summary;
  std::ranges::transform(rows, rows.begin(), table_row);
  const std::string most = fmt::format("max {}", show_choices[run.options.picture.show].name);
  const std::vector<std::string> columns = {"view",
                                            "pairs",
                                            "gpu_ms",
                                            "tolerance",
                                            "reported_psnr_db",
                                            "estimated_psnr_db",
                                            "photo_psnr_db",
                                            most,
                                            "levels_of_detail/gaussians",
                                            "levels_of_detail/predicted_psnr_db",
                                            "levels_of_detail/read_ms",
                                            "levels_of_detail/upload_ms",
                                            "disparity/far_degrees",
                                            "disparity/near_degrees",
                                            "disparity/vertical_px",
                                            "disparity/focus_metres",
                                            "outputs"};
  if (all.size() > 1) summary = lab::summary_of(rows, columns);
  if (all.size() > max_listed_views && (run.outputs.video || run.options.camera.along_path())) {
    rows.clear();
    const std::string &first = all.front().shot.files.front().name, &last = all.back().shot.files.back().name;
    fmt::print("{} frames: {}{}{}\n", all.size(), first, first == last ? "" : " to " + last,
               run.options.json.empty() ? " (each by itself: --json FILE)" : "");
  }
  rows.insert(rows.end(), summary.begin(), summary.end());
  print_table(rows, columns);
}

ordered_json settings_json(const RenderRun& run) {
  const DrawingOptions& o = run.options.drawing;
  const render::FrameSettings& settings = run.settings;
  const Background& background = run.options.picture.background;
  const Model& model = run.model();
  const std::optional<DetailRequest>& detail = run.options.scene.detail;
  const bool vr180 = run.options.camera.lens.vr180();
  const Perspective seen =
      vr180 ? Perspective{Order::distance, Projection::tangent} : render::perspective_of(settings, model);
  return object("vr180", given(vr180, true), "tiles", tiles_choices[o.tiles].name, "precision",
                precision_choices[o.precision].name, "near", run.near_plane, "antialiased", model.antialiased,
                "order", name_of(seen.order), "projection", name_of(seen.projection), "kernel_px2",
                model.kernel_px2, "threshold", lab::rule_of(settings), "tolerance", settings.tolerance,
                "transmittance", name_of(render::chosen_transmittance(settings)), "detail_px",
                given(detail && !detail->db, detail ? detail->spacing_px : 0.0), "detail_db",
                detail ? detail->db : std::nullopt, "quality_db", o.quality, "calibration",
                given(!o.calibration.empty(), o.calibration), "background",
                background ? list(glm::dvec3(*background)) : ordered_json(), "reference_until",
                o.reference_until ? std::optional(render::name_of(*o.reference_until)) : std::nullopt);
}

ordered_json scene_json(const RenderRun& run) {
  const SceneOptions& o = run.options.scene;
  const Model& model = run.model();
  const bool city = o.name == demo_city_name;
  ordered_json json = object("name", o.name, "seed", given(city, city_settings(o).seed), "count",
                             given(city, city_settings(o).count));
  if (o.repeat) json["repeat"] = object("x", o.repeat->x, "z", o.repeat->y, "spacing", *o.spacing);
  if (!o.place.empty()) json["place"] = o.place;
  const bool follows = run.drawn.back().levels.has_value();
  lab::put(json, "gaussians", follows ? run.drawn.back().levels->gaussians : model.count(), "left_out",
           model.left_out, "degree", model.degree);
  if (const Scaffold* s = model.scaffold.get())
    json["scaffold"] = object("anchors", s->anchor_count(), "gaussians_per_anchor", s->offset_count,
                              "features", s->feature_count, "appearances", s->appearance_count(),
                              "appearance", given(s->appearance_count() > 0, s->appearance));
  return json;
}

}  // namespace

void print(const RenderRun& run) {
  print_views(run);
  warn_of_discomfort(run.drawn);
  tell_exact_pictures(run);
  const std::vector<lab::Row> rows = stage_rows(run);
  if (rows.empty()) fmt::print("(by the float64 reference, on the CPU)\n");
  if (rows.empty() || is_quiet()) return;
  const std::size_t frames = timed_frames(run);
  fmt::print("\n");
  print_table(rows, {"stage", "median_ms", "p99_ms"});
  fmt::print(
      "GPU time of {} frame{} on {}{}; {:.1f} MB in buffers; making the shaders' programs took {:.2f} s\n",
      frames, frames == 1 ? "" : "s", run.context->renderer(), frames == 1 ? " (--frames N for more)" : "",
      static_cast<double>(run.context->peak_bytes()) / 1e6, 1e-3 * run.context->compile_ms());
  print_run(run);
}

void save(const std::filesystem::path& path, const RenderRun& run) {
  const gl::Context& context = *run.context;
  const std::vector<lab::Row> views = view_rows(run);
  const std::vector<double> photo_db = lab::numbers(views, "photo_psnr_db");
  ordered_json json = object(
      "version", BINOSPLAT_VERSION, "scene", scene_json(run), "device",
      object("backend", context.backend(), "renderer", context.renderer(), "opengl", context.version()),
      "settings", settings_json(run), "views", views, "mean_photo_psnr_db",
      photo_db.size() < 2 ? std::nullopt : std::optional(mean(photo_db)), "frames", timed_frames(run),
      "stages", stage_rows(run));
  const RunTimes& times = run.times;
  json["run"] = object("seconds", 1e-3 * times.all, "reading_back_seconds", 1e-3 * times.reading,
                       "waiting_for_files_seconds", 1e-3 * times.waiting, "encoding_thread_seconds",
                       times.encoding, "writing_thread_seconds", times.writing, "threads", times.threads);
  json["memory"] = object("model_bytes", run.needs.model, "min_frame_bytes", run.needs.frame, "gpu_bytes",
                          context.allocated_bytes(), "gpu_peak_bytes", context.peak_bytes());
  save_json(path, json);
}

}  // namespace binosplat::app
