// binosplat trim: finds the smallest model within a bound on the loss.

#include <CLI/CLI.hpp>
#include <cstdio>

#include "app/bench/photos.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/model_files.h"
#include "app/models/split.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "base/output_file.h"
#include "compact/trim.h"
#include "formats/containers/content.h"
#include "formats/models/model_file.h"
#include "formats/models/model_output.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace {

namespace fs = std::filesystem;
using adagscale::Calibrator;
using nlohmann::ordered_json;

ModelFormat check_trim(const Options& o) {
  check_target("trim", "a bound", o.target, o);
  return output_format(o.output);
}

/// The input file, if a copy of it may be the output: it has the output's format, and its pictures do not
/// depend on other files.
std::optional<fs::path> same_format(const Options& o, const Model& model, ModelFormat format) {
  const fs::path file = model_file(o.scene.name);
  const auto run = run_of(model, file);
  const bool decides = run && (run->antialiased || run->kernel_px2 || run->near_plane || run->order);
  if (decides || !training_losses(model, format).empty()) return std::nullopt;
  const std::string_view name = row_of(format).name;
  // A SOG may be read from a meta.json with pictures, but is written as an archive.
  const bool same = (model.format == name || model.format.starts_with(fmt::format("{} ", name))) &&
                    (format != ModelFormat::sog || model_format_of(file) == format);
  return same && fs::is_regular_file(file) ? std::optional(file) : std::nullopt;
}

std::string size_of(const std::vector<adagscale::CalibrationView>& views) {
  return fmt::format("{} x {} px", views[0].camera.width, views[0].camera.height);
}

void print_trimmed(const Options& o, const compact::Trimmed& found, const compact::ViewSplit& views,
                   std::size_t gaussians, const std::vector<lab::Row>& steps) {
  fmt::print(
      "{} views weighed, {} to validate, {} to test; bound: {}{}\n", views.training.size(),
      views.validation.size(), views.test.size(),
      o.target.max_drop
          ? fmt::format("at most {} dB lost against the photos, mean of the validation views",
                        *o.target.max_drop)
          : fmt::format("{} dB against the exact pictures, mean of the validation views", *o.target.quality),
      views.validation_own.empty() ? ""
                                   : fmt::format(", at {} and, as `own`, at the cameras' own {}",
                                                 size_of(views.validation), size_of(views.validation_own)));
  fmt::print("{} of {} Gaussians touch no pixel of the views weighed, {:.1f} %\n\n", found.unseen, gaussians,
             100.0 * static_cast<double>(found.unseen) / static_cast<double>(gaussians));
  print_table(steps, {"step", "gaussians", "degree", "bytes", "validation/pairs", "validation/gpu_ms",
                      "validation/mean_db", "validation/worst_db", "validation/worst_view", "test/mean_db",
                      "validation_own_size/mean_db", "validation_own_size/worst_db",
                      "validation_own_size/worst_view", "test_own_size/mean_db"});
}

ordered_json trimmed_json(const Calibrator::Cost& cost,
                          const std::vector<adagscale::CalibrationView>& views) {
  ordered_json json = lab::object("mean_db", cost.mean_db, "worst_db", cost.worst_db, "worst_view",
                                  views[cost.worst_view].camera.name, "pairs", cost.pairs, "gpu_ms", cost.ms);
  for (std::size_t v = 0; v < views.size(); ++v)
    json["views"].push_back({{"name", views[v].camera.name}, {"db", cost.view_db[v]}});
  return json;
}

ordered_json trimmed_json(const Options& o, const compact::Trimmed& found, const compact::ViewSplit& views,
                          ModelFormat format, const std::vector<std::string>& losses,
                          const std::vector<lab::Row>& steps) {
  ordered_json json = lab::object("version", BINOSPLAT_VERSION, "model", o.scene.name, "output", o.output,
                                  "format", word_of(format), "as_it_was", !found.is_smaller, "unseen",
                                  found.unseen, "views_weighed", views.training.size(), "losses", losses);
  if (o.target.max_drop) json["target"]["drop_db"] = *o.target.max_drop;
  if (o.target.quality) json["target"]["quality_db"] = *o.target.quality;
  json["steps"] = steps;
  return json;
}

std::vector<lab::Row> trim_steps(const compact::Trimmed& found, const compact::ViewSplit& views) {
  std::vector<lab::Row> steps;
  for (const compact::TrimStep& s : found.steps) {
    lab::Row& step =
        steps.emplace_back(lab::object("step", s.name, "gaussians", s.gaussians, "degree", s.degree, "bytes",
                                       s.bytes > 0 ? ordered_json(s.bytes) : ordered_json(), "validation",
                                       trimmed_json(s.validation, views.validation)));
    if (!views.test.empty()) step["test"] = trimmed_json(s.test, views.test);
    if (s.validation_own) step["validation_own_size"] = trimmed_json(*s.validation_own, views.validation_own);
    if (s.test_own) step["test_own_size"] = trimmed_json(*s.test_own, views.test_own);
  }
  return steps;
}

/// Writes the trimmed model, or a copy of the input if nothing could be removed.
std::vector<std::string> write_trimmed(const Options& o, const compact::Trimmed& found, ModelFormat format,
                                       const std::optional<fs::path>& original) {
  if (!found.is_smaller && original) {
    write_file(o.output, as_text(MappedFile(*original).bytes()));
    return {};
  }
  return write_model_file(o.output, found.model, format, found.harmonic_bits);
}

ExitCode trim(const Options& o) {
  const ModelFormat format = check_trim(o);
  const SplitScene scene =
      open_split("trim", o, format, [count = o.split.count.value_or(16)](std::size_t, std::size_t cameras) {
        return std::min<std::size_t>(count, cameras / 2);
      });
  const compact::ViewSplit& views = scene.views;
  const std::optional<fs::path> original = same_format(o, scene.model, format);
  compact::TrimSettings settings{o.target.target(), format, trial_writer(o.output, format), {}};
  if (o.refit) settings.refit = photo_finder(scene.photos);
  compact::Trimmed found = compact::trim(*scene.context, scene.model, views, settings);
  if (const fs::path file = model_file(o.scene.name); fs::is_regular_file(file))
    found.steps.front().bytes = fs::file_size(file);
  const compact::TrimStep &first = found.steps.front(), &last = found.steps.back();
  const bool no_smaller = found.is_smaller && original && last.bytes >= first.bytes;
  if (no_smaller) found.is_smaller = false;
  const std::vector<lab::Row> steps = trim_steps(found, views);
  print_trimmed(o, found, views, scene.model.count(), steps);
  if (!found.format_fits && !original) {
    fail("-o {}: the format alone exceeds the bound, {}; choose .ply, which loses nothing, or a wider bound",
         o.output, fmt::format("{:.3f} dB", last.bounded_db()));
  }
  const std::vector<std::string> losses = write_trimmed(o, found, format, original);
  for (const std::string& loss : losses) log_warning("{}", loss);
  if (found.is_smaller) {
    fmt::print("\n{}\n", o.output);
  } else if (no_smaller) {
    fmt::print("\n{}: the unchanged model, {} bytes: the trimmed one would have {}\n", o.output, first.bytes,
               last.bytes);
  } else {
    fmt::print("\n{}: the unchanged model: nothing can be trimmed within the bound\n", o.output);
  }
  if (!o.json.empty()) save_json(o.json, trimmed_json(o, found, views, format, losses, steps));
  return ExitCode::done;
}

}  // namespace

void add_trim(CLI::App& program, Command& command) {
  add_command(program, command,
              {"trim", in::trim, "Write the smallest model that keeps the pictures",
               "Steps: fewer bits a harmonic (spz), lower harmonics, fewer Gaussians; each as far as the "
               "bound holds\n"
               "for what is written. A model from which nothing can be trimmed is written unchanged.\n"
               "Examples:\n"
               "  binosplat trim garden.ply --photos images --max-drop 0.1 -o garden.spz\n"
               "  binosplat trim garden.ply --quality 40 -o small.ply --json small.json"},
              trim);
}

}  // namespace binosplat::app
