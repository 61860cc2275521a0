// binosplat info: prints a model's contents and the memory that it takes to draw.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "app/command.h"
#include "app/models/load_scene.h"
#include "app/models/placed.h"
#include "app/open_context.h"
#include "app/render/shots.h"
#include "base/choices.h"
#include "base/text.h"
#include "compact/weights.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "formats/training/exposures.h"
#include "lab/fields.h"
#include "render/frame_plan.h"
#include "render/memory.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/summary.h"
#include "stereo/rig.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;
using lab::object;
using nlohmann::ordered_json;

struct SeenOfViews {
  std::size_t views = 0;
  std::size_t unseen = 0;                   // Gaussians that contribute to no pixel
  std::size_t gaussians_of_99_percent = 0;  // fewest with 99 % of the blending weight
};

std::optional<SeenOfViews> see(const Options& o, const Model& model) {
  if (o.camera.file.empty()) return std::nullopt;
  if (model.scaffold)
    fail("--cameras: {} is a Scaffold-GS model, which decodes Gaussians for each eye", o.scene.name);
  const CameraList list = listed_cameras(o.scene, o.camera);
  const std::vector<Camera> cameras = chosen_cameras({}, {}, list);
  const auto context = open_context({});
  compact::Weights weights = compact::weigh(*context, model, cameras, near_plane_of(o.camera, list, model));
  std::vector<double>& weight = weights.weight;
  SeenOfViews seen{cameras.size(), weights.unseen(), 0};
  std::sort(weight.begin(), weight.end(), std::greater<>());
  double left = 0.99 * std::accumulate(weight.begin(), weight.end(), 0.0);
  while (left > 0.0 && seen.gaussians_of_99_percent < weight.size())
    left -= weight[seen.gaussians_of_99_percent++];
  return seen;
}

/// The directions of the three axes in the cameras' world, in words.
std::string axes_in_words(const Model& model) {
  static const std::map<char, const char*> words = {{'R', "right"}, {'L', "left"},    {'U', "up"},
                                                    {'D', "down"},  {'F', "forward"}, {'B', "back"}};
  return fmt::format("x {}, y {}, z {}", words.at(model.axes.letters[0]), words.at(model.axes.letters[1]),
                     words.at(model.axes.letters[2]));
}

/// Memory of a headset's first frame, in a view that the model fills.
render::MemoryNeeds headset_needs(const Model& model) {
  const CoredModel cored(model);
  const Camera head = stereo::apply_preset(into_axes(frame_model(cored, 1280, 720), model.axes), "headset");
  const stereo::EyePair eyes = stereo::make_rig(head, {.near_plane = near_plane_for(cored)});
  return render::memory_needs(render::make_plan(eyes.views, {}, model));
}

void print_bounds(const char* name, const Bounds& b) {
  fmt::print("{:<14} {} to {}, {} to {}, {} to {}\n", name, coordinate(b.low.x), coordinate(b.high.x),
             coordinate(b.low.y), coordinate(b.high.y), coordinate(b.low.z), coordinate(b.high.z));
}

void print_bar(const std::string& label, std::size_t count, std::size_t all) {
  constexpr double widest = 40.0;
  const double share = static_cast<double>(count) / static_cast<double>(all);
  const auto length = static_cast<std::size_t>(std::ceil(widest * share));
  fmt::print("  {:<16} {:>10} {:>6.2f} %  {}\n", label, count, 100.0 * share, std::string(length, '#'));
}

/// The sizes of the files that `binosplat convert` would write.
void print_sizes(const Model& model) {
  std::vector<std::string> sizes;
  for (const ModelFormat format : written_formats()) {
    const std::uint64_t bytes = bytes_in(format, model.count(), model.degree);
    sizes.push_back(fmt::format("{} {}{}", row_of(format).name, format == ModelFormat::ply ? "" : "at most ",
                                megabytes(static_cast<std::int64_t>(bytes))));
  }
  fmt::print("{:<14} {}\n", "as a file", fmt::join(sizes, ", "));
}

void print_info(const SeenOfViews& seen, std::size_t all) {
  const auto share = [&](std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(all);
  };
  fmt::print(
      "\n{:.0f} % of the Gaussians ({}) touch no pixel in these {} views; {:.0f} % ({}) have 99 % of the "
      "blending weight\n{}\n",
      share(seen.unseen), seen.unseen, seen.views, share(seen.gaussians_of_99_percent),
      seen.gaussians_of_99_percent, "`binosplat trim` writes the smallest model that keeps them");
}

/// A model's training run and exposures, from files beside the model.
struct Trained {
  std::optional<TrainingRun> run;
  std::optional<Exposures> exposures;
};

Trained training_of(const Model& model, const fs::path& file) {
  Trained trained{run_of(model, file), {}};
  if (trained.run)
    for (std::vector<std::string>* texts : {&trained.run->differences, &trained.run->notes})
      std::ranges::transform(*texts, texts->begin(), with_options);
  if (const auto exposures = find_exposures(file)) trained.exposures.emplace(*exposures);
  return trained;
}

std::string in_words(const Exposures& exposures) {
  return fmt::format("{} of {} views, {}", exposures.file().string(), exposures.count(),
                     exposures.changes_any()
                         ? "which --photos gives to pictures before it compares them with photos"
                         : "none of which changes anything");
}

void print_info(const Trained& trained) {
  if (trained.run) {
    fmt::print("{:<14} by {}, says {}\n", "trained", trained.run->trainer, trained.run->file.string());
    std::string said;
    for (const auto& [key, value] : trained.run->keys)
      said += fmt::format("{}{} {}", said.empty() ? "" : ", ", key, value);
    if (!said.empty()) fmt::print("{:<14} {}\n", "", said);
    for (const std::string& sentence : trained.run->differences)
      fmt::print("{:<14} {}\n", "  differs", sentence);
    for (const std::string& sentence : trained.run->notes) fmt::print("{:<14} {}\n", "  note", sentence);
  }
  if (trained.exposures) fmt::print("{:<14} {}\n", "exposures", in_words(*trained.exposures));
}

ordered_json info_json(const Trained& trained) {
  ordered_json json;
  if (trained.run) {
    const TrainingRun& run = *trained.run;
    json["by"] = run.trainer;
    json["file"] = run.file.string();
    for (const auto& [key, value] : run.keys) json["says"][key] = value;
    json["not_drawn_so"] = run.differences;
    json["to_know"] = run.notes;
  }
  if (trained.exposures) {
    json["exposures"] =
        object("file", trained.exposures->file().string(), "views", trained.exposures->count(),
               "change_pictures", trained.exposures->changes_any());
  }
  return json;
}

void print_info(const Model& model, const NearPlane& near, const Trained& trained, const ModelSummary& s,
                const render::MemoryNeeds& needs) {
  const std::size_t n = model.count();
  fmt::print("{} ({})\n", model.name, model.format);
  fmt::print("{:<14} {}{}\n", "Gaussians", n,
             model.left_out > 0
                 ? fmt::format(" ({} more left out: values not finite, scales above 1e13, or no rotation)",
                               model.left_out)
                 : "");
  fmt::print("{:<14} degree {}{}\n", "harmonics", model.degree, model.lacks_degree_4 ? " of 4" : "");
  fmt::print("{:<14} {} ({})\n", "axes", model.axes.letters, axes_in_words(model));
  const auto says = [&](const std::string& by) {
    const std::string file = trained.run ? trained.run->file.filename().string() : "";
    if (trained.run && (by.empty() || by == trained.run->file))
      return by.empty() ? fmt::format("as usual: {} has no known key about it", file) : "says " + file;
    return by.empty() ? "as usual: no file about its training was found" : "says " + by;
  };
  fmt::print("{:<14} {:.4g} units, {}\n", "near plane", near.units, says(near.by));
  fmt::print("{:<14} {:.4g} px^2, {}\n", "low-pass", model.kernel_px2, says(model.kernel_by));
  fmt::print("{:<14} opacity {} for the low-pass, {}\n", "anti-aliasing",
             model.antialiased ? "compensated" : "not compensated", says(model.antialiased_by));
  fmt::print("{:<14} order by {}, {} projection, {}\n", "perspective", name_of(model.perspective.order),
             name_of(model.perspective.projection), says(model.perspective_by));
  if (model.linear) fmt::print("{:<14} linear light, {}\n", "colours", says(model.linear_by));
  print_info(trained);
  print_bounds("bounds", s.all);
  print_bounds("2 to 98 %", s.core);
  if (const glm::dvec3& o = model.axes.origin; o != glm::dvec3(0.0))
    fmt::print("{:<14} {},{},{}: positions are relative to it, to keep their precision\n", "origin",
               coordinate(o.x), coordinate(o.y), coordinate(o.z));
  fmt::print("{:<14} {} for the model, at least {} for a frame of a headset's eyes\n", "GPU memory",
             megabytes(needs.model), megabytes(needs.frame));
  if (model.scaffold) {
    fmt::print("\nopacities, scales and colours are decoded for each eye\n");
    return;
  }
  print_sizes(model);
  fmt::print("\nopacity (median {:.3f})\n", s.opacity_median);
  for (std::size_t k = 0; k < s.opacity.size(); ++k)
    print_bar(fmt::format("{:.1f} to {:.1f}", 0.1 * static_cast<double>(k), 0.1 * static_cast<double>(k + 1)),
              s.opacity[k], n);
  fmt::print("\nlargest scale (median {:.4g})\n", s.scale_median);
  for (const auto& [decade, count] : s.scale)
    print_bar(fmt::format("1e{:+} to 1e{:+}", decade, decade + 1), count, n);
  fmt::print("\nharmonics in use\n");
  for (int degree = 0; degree <= model.degree; ++degree)
    print_bar(fmt::format("degree {}", degree), s.degree[static_cast<std::size_t>(degree)], n);
  fmt::print("\nodd ones\n");
  print_bar("never visible", s.invisible, n);
  print_bar("without size", s.without_size, n);
  print_bar("flat", s.flat, n);
  print_bar("needles", s.needles, n);
  print_bar("far outside", s.far, n);
  print_bar("huge", s.huge, n);
}

ordered_json info_json(const Bounds& b) {
  return {{"low", {b.low.x, b.low.y, b.low.z}}, {"high", {b.high.x, b.high.y, b.high.z}}};
}

ordered_json info_json(const Model& model, const NearPlane& near, const ModelSummary& s,
                       const render::MemoryNeeds& needs) {
  ordered_json scale;
  for (const auto& [decade, count] : s.scale)
    scale.push_back({{"from", std::pow(10.0, decade)}, {"count", count}});
  ordered_json json = object(
      "name", model.name, "format", model.format, "gaussians", model.count(), "left_out", model.left_out,
      "degree", model.degree, "axes", model.axes.letters, "near_plane", near.units, "near_plane_by", near.by,
      "kernel_px2", model.kernel_px2, "kernel_px2_by", model.kernel_by, "antialiased", model.antialiased,
      "antialiased_by", model.antialiased_by, "linear", model.linear, "linear_by", model.linear_by,
      "order_by", model.perspective_by, "order", name_of(model.perspective.order), "projection",
      name_of(model.perspective.projection), "bounds", info_json(s.all), "core_bounds", info_json(s.core),
      "origin", std::array{model.axes.origin.x, model.axes.origin.y, model.axes.origin.z}, "gpu_bytes",
      object("model", needs.model, "headset_frame", needs.frame));
  if (model.scaffold) return json;  // the rest depends on the eye
  for (const ModelFormat format : written_formats())
    json["file_bytes"][word_of(format)] = bytes_in(format, model.count(), model.degree);
  lab::put(json, "opacity", object("median", s.opacity_median, "tenths", s.opacity), "largest_scale",
           object("median", s.scale_median, "decades", scale), "degrees_in_use", s.degree, "odd",
           object("invisible", s.invisible, "without_size", s.without_size, "flat", s.flat, "needles",
                  s.needles, "far", s.far, "huge", s.huge));
  return json;
}

// Prints the names that --view accepts.
ExitCode list_views(const Options& options) {
  CameraList list = listed_cameras(options.scene, options.camera);
  if (list.cameras.empty() && list.hints.unusable.empty())
    fail("{}: there are no cameras beside it; name their file with --cameras", options.scene.name);
  if (list.cameras.empty())  // as render makes them
    list = generate_cameras(options.scene, options.camera, no_rig, list.hints, load_scene(options.scene));
  std::size_t widest = 0;
  for (const Camera& camera : list.cameras) widest = std::max(widest, camera.name.size());
  fmt::print("{}: {} views\n", list.source, list.cameras.size());
  ordered_json json = ordered_json::array();
  for (const Camera& c : list.cameras) {
    const double fov = 2.0 * glm::degrees(std::atan(0.5 * c.height / c.fy));
    fmt::print("{:<{}}  {} x {} px, {:.1f} degrees high, at {},{},{}\n", c.name, widest, c.width, c.height,
               fov, coordinate(c.position.x), coordinate(c.position.y), coordinate(c.position.z));
    json.push_back(camera_json(c));
  }
  if (!options.json.empty()) save_json(options.json, json);
  return ExitCode::done;
}

ExitCode info(const Options& options) {
  if (options.list_views) return list_views(options);
  Model model;
  Trained trained;
  if (is_built_in(options.scene.name)) {
    model = load_scene(options.scene);
    model.format = "built in";
  } else {
    // load_model() would also log the training run; here it is printed below.
    const fs::path file = file_of(options.scene.name);
    model = load_model_alone(file, {.lod = options.scene.lod, .format = options.scene.format});
    trained = training_of(model, file);
    if (trained.run) follow(*trained.run, file, model);
  }
  CameraList list = listed_cameras(options.scene, options.camera);
  choose_axes(options.scene, list.cameras, model);
  if (!options.scene.place.empty() && !is_built_in(options.scene.name)) append_placed(options.scene, model);
  const ModelSummary summary = summarise(model);
  const render::MemoryNeeds needs = headset_needs(model);
  const std::optional<SeenOfViews> seen = see(options, model);
  if (!list.listed) list.near_plane = near_plane_for(model);  // as render makes cameras
  const NearPlane near = find_near_plane(options.camera, list, model);
  print_info(model, near, trained, summary, needs);
  if (seen) print_info(*seen, model.count());
  if (options.json.empty()) return ExitCode::done;
  ordered_json json = info_json(model, near, summary, needs);
  if (trained.run || trained.exposures) json["training"] = info_json(trained);
  if (seen)
    json["views"] = object("count", seen->views, "unseen", seen->unseen, "gaussians_of_99_percent",
                           seen->gaussians_of_99_percent);
  save_json(options.json, json);
  return ExitCode::done;
}

}  // namespace

void add_info(CLI::App& program, Command& command) {
  add_command(
      program, command,
      {"info", in::info, "Report what a model is made of",
       "Unusual: never visible: opacity below 1/255; flat: a hundred times thinner than wide; needles: a\n"
       "hundred times longer than wide; far outside: over five diagonals from the box \"2 to 98 %\", which\n"
       "reaches from the 2nd to the 98th percentile on each axis; huge: larger than this diagonal."},
      info);
}

}  // namespace binosplat::app
