// binosplat refit: fits colours to pictures, for a given order and projection.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "app/bench/photos.h"
#include "app/bench/report.h"
#include "app/command.h"
#include "app/models/model_files.h"
#include "app/models/split.h"
#include "app/options/checks.h"
#include "app/options/options.h"
#include "app/options/parse.h"
#include "base/choices.h"
#include "base/log.h"
#include "compact/refit.h"
#include "lab/fields.h"

namespace binosplat::app {

namespace {

std::string name_of(const Perspective& seen) {
  return fmt::format("{}, {}", name_of(seen.order), name_of(seen.projection));
}

using adagscale::Calibrator;
using nlohmann::ordered_json;
using TargetKind = adagscale::CalibrationTarget::Kind;

ModelFormat check_refit(const Options& o) {
  check(o.scene);
  if (o.photos.empty() != o.against_exact)
    fail("refit needs pictures to fit to: --photos DIR, or --against exact for the model's own");
  if (o.camera.lens.size && !o.photos.empty())
    fail("--size with --photos: photos are fitted in their own size");
  const ModelFormat format = output_format(o.output);
  check_harmonic_bits(o.harmonic_bits, format);
  return format;
}

/// Measures a model's pictures in views that the fit does not use: the mean PSNR in dB, against photos or the
/// original model's pictures.
class ModelMeasurer {
 public:
  ModelMeasurer(gl::Context& context, const Model& original, const compact::ViewSplit& views, TargetKind kind)
      : kind_(kind) {
    for (const auto& [name, of] : {std::pair{"validation_db", &views.validation},
                                   {"test_db", &views.test},
                                   {"validation_own_size_db", &views.validation_own},
                                   {"test_own_size_db", &views.test_own}}) {
      if (!of->empty())
        calibrators_.emplace_back(
            name, std::make_unique<Calibrator>(std::make_shared<render::GpuModel>(context, original), *of,
                                               views.near_plane, kind));
    }
  }

  double validation(const Model& model) { return psnr(*calibrators_.front().second, model); }

  /// Views in their cameras' own size count if --size is smaller.
  lab::Row step(const std::string& name, const Model& model) {
    lab::Row step = lab::object("step", name);
    for (const auto& [views, calibrator] : calibrators_) step[views] = psnr(*calibrator, model);
    return step;
  }

 private:
  /// Against photos, the calibrator measures the loss relative to the original model.
  double psnr(Calibrator& views, const Model& model) const {
    const double db = views.cost(model).mean_db;
    return kind_ == TargetKind::drop ? views.exact_photo_db() - db : db;
  }

  TargetKind kind_;
  std::vector<std::pair<const char*, std::unique_ptr<Calibrator>>> calibrators_;
};

void print_refit(const std::vector<lab::Row>& steps, const Options& o, const compact::ViewSplit& views,
                 std::size_t photos) {
  fmt::print("{} views fitted, {} of them to photos; {} to validate, {} to test. PSNR in dB against {}\n\n",
             views.training.size(), photos, views.validation.size(), views.test.size(),
             o.photos.empty() ? "the model's own pictures" : "the photos");
  print_table(steps, {"step", "validation_db", "test_db", "validation_own_size_db", "test_own_size_db"});
}

ordered_json refit_json(const std::vector<lab::Row>& steps, const Options& o, const compact::ViewSplit& views,
                        std::size_t photos, int best_round, bool written) {
  ordered_json json =
      lab::object("version", BINOSPLAT_VERSION, "model", o.scene.name, "output", o.output, "against",
                  o.photos.empty() ? "exact" : "photos", "views_fitted", views.training.size(), "photos",
                  photos, "best_round", best_round, "written", written);
  for (const adagscale::CalibrationView& view : views.validation)
    json["validation"].push_back(view.camera.name);
  json["steps"] = steps;
  return json;
}

ExitCode refit(const Options& o) {
  const ModelFormat format = check_refit(o);
  const SplitScene scene = open_split(
      "refit", o, format, [count = o.split.count.value_or(4)](std::size_t candidates, std::size_t) {
        return std::min<std::size_t>(count, candidates / 4);
      });
  const Model& model = scene.model;
  const compact::ViewSplit& views = scene.views;
  const compact::RefitTargets targets{model, views.training, photo_finder(scene.photos), views.near_plane};
  const auto photos = static_cast<std::size_t>(std::count_if(
      views.training.begin(), views.training.end(),
      [&](const Camera& camera) { return !o.photos.empty() && find_view_photo(o.photos, camera); }));
  if (!o.photos.empty() && photos == 0)
    fail(
        "--photos {}: only validation or test views have photos, so none is left to fit; add photos, or use "
        "--against exact",
        o.photos);
  Model fitted = model;
  fitted.perspective = {o.drawing.order.value_or(model.perspective.order),
                        o.drawing.projection.value_or(model.perspective.projection)};

  ModelMeasurer measurer(*scene.context, model, views,
                         o.photos.empty() ? TargetKind::quality : TargetKind::drop);
  std::vector<lab::Row> steps;
  if (fitted.perspective != model.perspective)
    steps.push_back(measurer.step("original: " + name_of(model.perspective), model));
  steps.push_back(measurer.step("before: " + name_of(fitted.perspective), fitted));
  const lab::Row before = steps.back();

  compact::RefitSettings settings;
  settings.rounds = o.rounds.value_or(settings.rounds);
  compact::Refitted found = compact::refit(*scene.context, fitted, targets, settings,
                                           [&](const Model& m) { return -measurer.validation(m); });
  fitted.sh = std::move(found.sh);
  steps.push_back(measurer.step(fmt::format("after {} rounds", found.best_round), fitted));
  const compact::WrittenModel written = trial_writer(o.output, format)(fitted, o.harmonic_bits.value_or(8));
  steps.push_back(
      measurer.step(fmt::format("as {}, {} bytes", row_of(format).name, written.bytes), written.model));
  print_refit(steps, o, views, photos);
  const auto worse = [&](const char* views) {
    return lab::number(steps.back(), views) < lab::number(before, views);
  };
  const bool nearer = found.best_round > 0 && !worse("validation_db") && !worse("validation_own_size_db");
  if (!o.json.empty()) save_json(o.json, refit_json(steps, o, views, photos, found.best_round, nearer));
  if (!nearer) {
    log_warning(
        "{} is not written: the validation views would not improve on {:.3f} dB{}; other validation "
        "views (--views, --validation) or more cameras may help",
        o.output, lab::number(before, "validation_db"),
        views.validation_own.empty() ? ""
                                     : fmt::format(" and {:.3f} in the cameras' own size",
                                                   lab::number(before, "validation_own_size_db")));
    return ExitCode::fell_short;
  }
  for (const std::string& loss : write_model_file(o.output, fitted, format, o.harmonic_bits.value_or(8)))
    log_warning("{}", loss);
  fmt::print("\n{}\n", o.output);
  return ExitCode::done;
}

}  // namespace

void add_refit(CLI::App& program, Command& command) {
  add_command(
      program, command,
      {"refit", in::refit, "Fit a model's colours to photos, or to its own pictures",
       "Shapes and opacities stay. Nothing is written if the validation views would get worse.\n"
       "Takes about seven times the memory of the model's harmonics, whatever the number of views.\n"
       "Examples:\n"
       "  binosplat refit garden.ply --photos images --order distance --projection tangent -o steady.ply\n"
       "  binosplat refit small.spz --against exact -o better.spz"},
      refit);
}

}  // namespace binosplat::app
