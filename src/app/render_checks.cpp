// Which options of `binosplat render` go together.

#include "app/drawing.h"
#include "app/render_options.h"
#include "base/choices.h"
#include "base/error.h"
#include "demo/city.h"

namespace binosplat::app {

namespace {

void check_threshold(const RenderOptions& o) {
  const render::FrameSettings settings = settings_of(o);
  const bool exact = render::is_exact(settings.th);
  const bool given = o.loss || o.quality, calibrated = !o.calibration.empty();
  if (given && calibrated) {
    fail("{} with --calibration: each chooses the loss: leave one of them out",
         o.loss ? "--loss" : "--quality");
  }
  if (!exact && !given && !calibrated)
    fail("--th {} needs --loss, --quality or --calibration: what it may cost", threshold_name(o));
  if (exact && calibrated)
    fail("--calibration has no effect with --th {}, which is exact", threshold_name(o));
  if (o.decode == "cyclopean" && (o.mono || !o.only.empty()))
    fail("--decode cyclopean is for both eyes together: leave --mono and --only out");
  if (!o.reference_until.empty() && calibrated)
    fail("--reference-until: the reference goes by no calibration: leave --calibration out");
  render::check_choice(settings, "--");
  render::check(workings_of(o), settings, "--");
}

void check_cameras(const RenderOptions& o) {
  if (o.eye.has_value() != o.at.has_value())
    fail("--eye and --at go together: where the camera is, and what it looks at");
  const bool made_up = o.eye || o.orbit;
  if (o.eye && o.orbit) fail("--eye and --orbit: choose one of them");
  if (made_up && (!o.cameras.empty() || !o.views.empty())) {
    fail("{} makes its own camera: leave --cameras and --view out", o.eye ? "--eye" : "--orbit");
  }
  if (o.tour && (made_up || !o.path.empty() || !o.views.empty() || o.frames > 1)) {
    fail(
        "--tour goes through all cameras of the scene or of --cameras, each frame drawn once: leave --view, "
        "--path, --eye, --orbit and --frames out");
  }
  if (o.tour && !o.photos.empty()) fail("--photos with --tour: between the cameras no photos were taken");
  if (o.seconds && !o.tour) fail("--seconds is for --tour: how much of it is drawn");
  if (!o.path.empty() && (made_up || !o.cameras.empty() || !o.views.empty() || o.frames > 1)) {
    fail(
        "--path names its own cameras, each drawn once: leave --cameras, --view, --eye, --orbit and --frames "
        "out");
  }
}

}  // namespace

std::string threshold_name(const RenderOptions& o) {
  if (!o.th.empty()) return o.th;
  return o.loss || o.quality || !o.calibration.empty() ? "squared" : "tau";
}

double units_per_metre(const RenderOptions& o) {
  return o.units_per_metre.value_or(o.saved ? o.saved->units_per_metre : 1.0);
}

bool along_path(const RenderOptions& o) { return o.tour || !o.path.empty(); }

void check(const RenderOptions& o) {
  if (o.scene != demo_city_name && (o.seed || o.count)) {
    fail("{} is for {}, and {} is none", o.seed ? "--seed" : "--count", demo_city_name, o.scene);
  }
  if (o.lod && (o.gpu_memory || o.detail)) {
    fail("--lod and {} both choose the levels of detail: leave one of them out",
         o.gpu_memory ? "--gpu-memory" : "--detail");
  }
  if (o.detail && o.repeat) fail("--detail and --repeat: copies have one level of detail for all");
  if (o.detail_report && !o.detail) fail("--detail-report tells what --detail costs, which is missing");
  if (o.scene.rfind("demo:", 0) == 0 &&
      (o.lod || o.gpu_memory || o.detail || o.appearance || !o.axes.empty())) {
    const char* const option = o.lod          ? "--lod"
                               : o.gpu_memory ? "--gpu-memory"
                               : o.detail     ? "--detail"
                               : o.appearance ? "--appearance"
                                              : "--axes";
    fail("{} is for model files, and {} is none", option, o.scene);
  }
  if (o.repeat.has_value() != o.spacing.has_value())
    fail("--repeat and --spacing go together: how many copies, and how far apart");
  check_cameras(o);
  check_threshold(o);
  if (o.fov && o.preset == "headset")
    fail("--fov with --preset headset: the preset's lens has 100 degrees across");
  if (o.mono && !o.only.empty())
    fail("--mono draws the camera itself and --only an eye beside it: choose one of them");
  if (o.mono && (o.ipd || o.convergence || o.cant)) {
    fail("--mono has no rig: leave --ipd, --convergence and --cant out");
  }
  if (o.show == "disagreement" && (o.mono || !o.only.empty()))
    fail("--show disagreement is between both eyes: leave --mono and --only out");
  if (o.reference_until == "blend" && find_choice("--show", o.show, show_choices) >= SHOW_ALPHAS)
    fail("--show {}: the GPU's blend tells it, which --reference-until blend leaves out", o.show);
  if (!o.photos.empty() && !o.mono)
    fail("--photos needs --mono: a photo shows what the camera sees, not an eye beside it");
  if (o.device >= 0 && (o.backend == "surfaceless" || o.backend == "osmesa"))
    fail("--device is for --backend device or auto: {} has none", o.backend);
}

}  // namespace binosplat::app
