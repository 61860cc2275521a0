// binosplat convert: writes a model in another format, and measures the loss in dB.

#include "formats/model_output.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "app/blind.h"
#include "app/command.h"
#include "app/load_scene.h"
#include "app/measured_options.h"
#include "app/model_files.h"
#include "app/option_checks.h"
#include "app/shots.h"
#include "base/log.h"
#include "base/progress.h"
#include "formats/model_file.h"
#include "lab/bench_case.h"
#include "lab/fields.h"
#include "measure/metrics.h"
#include "render/frame.h"
#include "scene/axes.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;

struct ConvertOptions : MeasuredOptions {
  std::string output;
  std::optional<ModelFormat> to;  // none: chosen by the output's ending
  std::optional<int> harmonic_bits;
  std::optional<int> report;  // number of views
  std::string json;
};

/// Cameras and context for drawing the original and the written model, which may have different axes.
struct Views {
  std::vector<Camera> cameras;
  double near_plane = 0.0;
  std::unique_ptr<gl::Context> context;
};

struct ViewCost {
  std::string name;
  int width = 0, height = 0;
  double psnr = 0.0;
};

struct Converted {
  ModelFormat format = ModelFormat::ply;
  std::size_t count = 0;
  std::optional<std::uintmax_t> bytes_before;  // if the model is one file
  std::uintmax_t bytes = 0;
  std::vector<std::string> losses;
  std::vector<ViewCost> views;

  double bytes_each() const { return static_cast<double>(bytes) / static_cast<double>(count); }
};

ModelFormat format_of(const ConvertOptions& o) {
  return o.to ? *o.to : output_format(o.output, "; or say --to");
}

void check_convert(const ConvertOptions& o, ModelFormat format) {
  check_output(o.output);
  check_harmonic_bits(o.harmonic_bits, format);
  if (!o.json.empty()) check_output(o.json);
  if (!o.report && (o.camera.lens.size || !o.camera.file.empty() || !o.camera.views.empty()))
    fail("--cameras, --view and --size are for --report's pictures: add --report, or leave them out");
}

/// The cameras of --view, else the requested number of listed cameras, or of cameras around the model.
Views find_views(const ConvertOptions& o, CameraList list, const Model& model) {
  if (!list.listed) {
    log_info("no cameras beside {}: taking {} around the model", o.scene.name, *o.report);
    list = made_up_cameras(o.scene, {.orbit = o.report}, no_rig, list.hints, model);
  }
  Views views{{}, near_plane_of(o.camera, list), nullptr};
  const std::vector<Camera> all = chosen_cameras(o.camera.views, o.camera.lens, list);
  const std::size_t wanted = o.camera.views.empty() ? static_cast<std::size_t>(*o.report) : all.size();
  for (const std::size_t i : lab::spread_evenly(all.size(), wanted)) views.cameras.push_back(all[i]);
  views.context = open_context(o.context);
  leave_out_blind("convert --report", *views.context, model, views.near_plane, views.cameras);
  return views;
}

/// Draws the views as 8-bit pictures.
std::vector<Image> draw(const Views& views, const Model& model, const char* label) {
  render::Frame frame(*views.context, model);
  Progress progress(label, views.cameras.size());
  std::vector<Image> pictures;
  for (const Camera& camera : views.cameras) {
    const shared::View view = make_view(into_axes(camera, model.axes), views.near_plane);
    frame.draw({&view, 1});
    pictures.push_back(quantised(on_black(frame.read_pictures()[0])));
    progress.update(pictures.size());
  }
  return pictures;
}

const ViewCost& worst_of(const std::vector<ViewCost>& views) {
  return *std::min_element(views.begin(), views.end(),
                           [](const ViewCost& a, const ViewCost& b) { return a.psnr < b.psnr; });
}

std::string decibels_or_equal(double psnr) {
  return std::isinf(psnr) && psnr > 0.0 ? "equal" : fmt::format("{:.2f} dB", psnr);
}

void print_converted(const ConvertOptions& o, const Converted& c) {
  const char* format = row_of(c.format).name;
  fmt::print("{}: {}, {} Gaussians\n", o.output, format, c.count);
  fmt::print("{} bytes, {:.2f} a Gaussian", c.bytes, c.bytes_each());
  if (c.bytes_before) {
    fmt::print("; {} has {}, {:.2f} times as many", o.scene.name, *c.bytes_before,
               static_cast<double>(*c.bytes_before) / static_cast<double>(c.bytes));
  }
  fmt::print("\n");
  if (c.views.empty()) return;
  fmt::print("\nPSNR of 8-bit pictures against the original's\n");
  for (const ViewCost& view : c.views)
    fmt::print("  {:<24} {:>5} x {:<5} {:>10}\n", view.name, view.width, view.height,
               decibels_or_equal(view.psnr));
  const ViewCost& worst = worst_of(c.views);
  fmt::print("worst: {}, {}\n", worst.name, decibels_or_equal(worst.psnr));
}

nlohmann::ordered_json converted_json(const ConvertOptions& o, const Converted& c) {
  nlohmann::ordered_json json =
      lab::object("version", BINOSPLAT_VERSION, "model", o.scene.name, "output", o.output, "format",
                  word_of(c.format), "gaussians", c.count, "bytes", c.bytes, "bytes_per_gaussian",
                  c.bytes_each(), "losses", c.losses, "model_bytes", c.bytes_before);
  if (c.views.empty()) return json;
  const auto psnr = [](const ViewCost& view) {
    return lab::object("name", view.name, "width", view.width, "height", view.height, "equal",
                       std::isinf(view.psnr) && view.psnr > 0.0, "psnr_db", view.psnr);  // null if equal
  };
  for (const ViewCost& view : c.views) json["views"].push_back(psnr(view));
  json["worst"] = psnr(worst_of(c.views));
  return json;
}

ExitCode convert(const ConvertOptions& o) {
  Converted done;
  done.format = format_of(o);
  check_convert(o, done.format);
  const CameraList list = o.report ? listed_cameras(o.scene, o.camera) : CameraList{};
  Model model = load_scene(o.scene, {}, list.cameras);
  refuse_scaffold(model, o.scene.name);
  Views views;
  std::vector<Image> originals;
  if (o.report) {
    views = find_views(o, list, model);
    originals = draw(views, model, "drawing the original");
  }

  const std::string axes = model.axes.letters, wanted(row_of(done.format).axes);
  if (axes != wanted)
    log_info("{}: its axes are turned from {} to {}, the ones of {}", o.output, axes, wanted,
             row_of(done.format).name);
  if (done.format == ModelFormat::spz)
    log_info(
        "{}: its axes are RUB, as the format has them and as the file says; programs that take them for "
        "a ply's (RDF), such as splat-transform 3.7, show it upside down",
        o.output);
  bring_into_axes(model, wanted);
  done.count = model.count();
  done.losses = write_model_file(o.output, model, done.format, o.harmonic_bits.value_or(8));
  for (const std::string& loss : done.losses) log_warning("{}", loss);
  std::error_code ignored;
  if (fs::is_regular_file(o.scene.name, ignored)) done.bytes_before = fs::file_size(o.scene.name);
  done.bytes = fs::file_size(o.output);
  if (o.report) {
    model = load_written(o.output, model);
    const std::vector<Image> pictures = draw(views, model, "drawing what was written");
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      done.views.push_back({views.cameras[i].name, pictures[i].width, pictures[i].height,
                            measure::psnr(originals[i], pictures[i])});
    }
  }
  print_converted(o, done);
  if (!o.json.empty()) save_json(o.json, converted_json(o, done));
  return ExitCode::done;
}

}  // namespace

void add_convert(CLI::App& program, Command& command) {
  CLI::App* sub =
      program.add_subcommand("convert", "Write a model in another format, and report what it loses");
  const auto o = std::make_shared<ConvertOptions>();
  sub->add_option("MODEL", o->scene.name, "A model file or folder, demo:room or demo:city")->required();
  sub->add_option("-o,--output", o->output, "The file to write: " + written_endings())
      ->type_name("FILE")
      ->required();
  Words<ModelFormat> formats;
  for (const ModelFormat format : written_formats()) formats.emplace_back(word_of(format), format);
  choose(*sub, "--to", o->to, "The format, if FILE's ending does not determine it", formats);
  add_harmonic_bits_option(*sub, o->harmonic_bits);
  add_lod_option(*sub, o->scene);
  add_axes_option(*sub, o->scene);
  add_place_option(*sub, o->scene);
  sub->add_option("--report", o->report,
                  "Draw N views of the original and of what was written, and print their\nPSNR")
      ->check(range(1, 10000))
      ->type_name("N");
  sub->add_option("--cameras", o->camera.file, "Cameras of the views, if not beside the model")
      ->type_name("FILE");
  add_names_option(*sub, "--view", o->camera.views, "Views by name, in place of the N of --report");
  add_size_option(*sub, o->camera.lens);
  sub->add_option("--json", o->json, "Write everything printed as JSON")->type_name("FILE");
  add_measured_options(*sub, *o);
  sub->footer(
      "Warnings name what the format cannot store. Cameras are those beside MODEL, or around it.\n"
      "Examples:\n"
      "  binosplat convert garden.ply -o garden.spz --report 3\n"
      "  binosplat convert scan.spz --axes rdf -o scan.ply");
  sub->callback([o, &command] { command = [o] { return convert(*o); }; });
}

}  // namespace binosplat::app
