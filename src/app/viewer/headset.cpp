#include "app/viewer/headset.h"

#include <binosplat/stream.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <utility>

#include "app/bench/profile.h"
#include "app/command_line.h"
#include "app/models/load_scene.h"
#include "app/open_context.h"
#include "app/render/shot_settings.h"
#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "preview/camera_key_list.h"
#include "preview/mirror.h"
#include "render/recorder.h"
#include "scene/axes.h"
#include "xr/headset.h"

namespace binosplat::app {

namespace {

constexpr double seconds_by_key = 10.0;

volatile std::sig_atomic_t signalled = 0;

// The first signal ends the runtime's session in order; the next one ends the program.
void tell_first_signal() {
  struct sigaction once = {};
  once.sa_handler = [](int) {
    signalled = 1;
    for (const int signal : {SIGHUP, SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  };
  once.sa_flags = SA_RESTART;
  for (const int signal : {SIGHUP, SIGINT, SIGTERM}) {
    struct sigaction before = {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
      sigaction(signal, &once, nullptr);
  }
}

Settings drawing_of(const Options& o, const preview::Choices& choices) {
  Settings settings = static_cast<const Settings&>(choices.settings);
  // A frame budget may choose a quality for exact frames, too.
  if (settings.threshold == Threshold::exact) settings.threshold.reset();
  settings.background = o.headset.passthrough ? std::nullopt : std::optional(choices.background);
  settings.near_plane = choices.rig.near_plane;
  return settings;
}

// Unless an option or the model's file chooses, splats must not turn with the head. A calibration is for an
// order and a projection, so it keeps the model's.
void keep_splats_still(Settings& drawing, const Model& model, bool is_calibrated) {
  if (drawing.order || drawing.projection || !model.perspective_by.empty() || is_calibrated) return;
  drawing.order = Settings::headset().order;
  drawing.projection = Settings::headset().projection;
  log_info(
      "splats do not turn with the head, which costs time and may cost accuracy (as trained: --order depth "
      "--projection affine)");
}

render::FrameRecord record_of(xr::Drawn drawn, std::size_t gaussians, std::size_t uploaded) {
  render::FrameRecord record{.due = drawn.begin, .begin = drawn.begin, .end = drawn.end};
  record.report = std::move(drawn.report);
  for (const View& view : drawn.views) {
    shared::View& picture = record.views.emplace_back();
    picture.width = static_cast<std::uint32_t>(view.size.x);
    picture.height = static_cast<std::uint32_t>(view.size.y);
  }
  record.gaussians = gaussians;
  record.levels = {drawn.levels_ms, uploaded};
  record.display = {drawn.display_ms, drawn.missed};
  return record;
}

/// Records a headset's frames on request, and writes them afterwards.
class HeadsetRecording {
 public:
  HeadsetRecording(const gl::Context& context, const preview::Opened& scene, const std::string& headset)
      : context_(context), scene_(scene), headset_(headset) {}
  ~HeadsetRecording() { save(); }
  HeadsetRecording(const HeadsetRecording&) = delete;
  HeadsetRecording& operator=(const HeadsetRecording&) = delete;

  void begin(double seconds) { seconds_ = seconds; }
  void add(render::FrameRecord frame, double period_ms) {
    if (seconds_ == 0.0) return;
    if (recorder_) {
      recorder_->add(std::move(frame));
      if (ms_since(since_) > 1000.0 * seconds_) save();
      return;
    }
    // Recording starts with the next frame, because this one began without it.
    recorder_.emplace(context_, period_ms > 0.0 ? 1000.0 / period_ms : 0.0,
                      std::make_shared<gl::GpuClock>(context_));
    since_ = Clock::now();
    log_info("recording {:g} s", seconds_);
  }

 private:
  // A failed write must not end the session.
  void save() {
    seconds_ = 0.0;
    if (!recorder_) return;
    render::Recording recording = recorder_->finish();
    recorder_.reset();
    if (recording.frames.empty()) return log_warning("no frame was recorded");
    try {
      if (scene_.claim) scene_.claim();
      const std::filesystem::path folder = preview::free_name(scene_.folder, "profile", "");
      save_recording(folder,
                     {scene_.name, "in " + headset_, "as the headset asks", lab::device_text(context_),
                      context_.software()},
                     std::move(recording));
      log_info("saved {}", folder.string());
    } catch (const Error& error) {
      log_warning("{}", error.what());
    }
  }

  const gl::Context& context_;
  const preview::Opened& scene_;
  std::string headset_;
  double seconds_ = 0.0;  // requested duration; 0: none
  std::optional<render::Recorder> recorder_;
  Clock::time_point since_ = {};
};

}  // namespace

void view_in_headset(const Options& o, const preview::Opened& scene, preview::Choices choices) {
  std::error_code ignored;
  if (!is_built_in(scene.name) && !std::filesystem::exists(scene.name, ignored))
    fail_to_read(scene.name, ENOENT);
  xr::Instance instance(o.headset.passthrough);  // reports a missing headset before a model is read
  log_info("{} on {}", instance.headset, instance.runtime);
  if (o.drawing.foveation && instance.has_insets())
    log_warning("--foveate: {} has insets of its own, which are used instead", instance.headset);
  std::unique_ptr<preview::Mirror> mirror;
  std::unique_ptr<gl::Context> own;
  const bool is_hidden = !o.headset.mirror || !has_display(), needs_glx = !instance.takes_egl();
  if (needs_glx || !is_hidden) {
    if (o.context.device >= 0 || o.context.backend != gl::Backend::automatic)
      fail("--device and --backend with {}, which uses the display's GPU: {}",
           needs_glx ? "a runtime that takes contexts of GLX only" : "the mirror window",
           needs_glx ? "remove them" : "add --no-mirror");
    try {
      mirror = std::make_unique<preview::Mirror>(!needs_glx, is_hidden);
    } catch (const Error& error) {
      if (needs_glx) {
        throw Error(
            ExitCode::no_gl,
            fmt::format("{} takes OpenGL contexts of GLX only, which need an X display (DISPLAY): start "
                        "it in a desktop session, or use Monado ({})",
                        instance.runtime, error.what()));
      }
      log_warning("no window can be opened on this display: only the headset shows the model");
    }
  }
  if (!mirror) own = open_context(o.context);
  gl::Context& context = mirror ? mirror->context() : *own;

  const auto opened = std::make_shared<OpenedModel<Stream>>(scene.load());
  const std::shared_ptr<Stream> levels(opened, opened->stream.get());
  const std::shared_ptr<const Model> model(opened, &opened->whole);
  const Model& shown = opened->model();
  keep_splats_still(choices.settings, shown, o.drawing.has_calibration());
  const preview::Start start = scene.start(context, *opened, choices, {1, 1});  // square
  log_info("{}: {} Gaussians", scene.name, opened->gaussians());
  const Camera eyes = into_axes(start.cameras.front(), {shown.axes.letters, glm::dvec3(0.0)});
  xr::HeadsetSettings settings{
      .scale = o.headset.scale,
      .drawing = drawing_of(o, choices),
      .budget_ms = o.headset.budget_ms,
      .start = xr::upright_at(eyes.position, eyes.rotation,
                              glm::transpose(world_from_axes(shown.axes.letters)) * start.up,
                              choices.rig.units_per_metre)};
  const auto precision = static_cast<Precision>(o.drawing.precision);
  if (choices.calibrated.is_calibrated())
    settings.calibration.emplace(o.drawing.calibration, SplatModel(model));
  tell_first_signal();
  HeadsetRecording recording(context, scene, instance.headset);
  if (o.headset.record_s) recording.begin(*o.headset.record_s);
  xr::Callbacks callbacks;
  callbacks.step = [&] {
    context.take_errors();  // SteamVR leaves OpenGL errors behind in every frame
    if (mirror && mirror->take_record_key()) recording.begin(seconds_by_key);
    return (!mirror || mirror->step()) && signalled == 0;
  };
  callbacks.drawn = [&](xr::Drawn frame) {
    const double period_ms = frame.period_ms;
    const std::size_t uploaded = levels ? levels->take_times().put : 0;
    recording.add(record_of(std::move(frame), opened->gaussians(), uploaded), period_ms);
  };
  if (!is_hidden && mirror)
    callbacks.show = [&](const Target& left, const glm::ivec2& size) { mirror->show(left, size); };
  std::optional<SplatStream> stream;
  if (levels) {
    stream.emplace(levels);
    callbacks.levels = [&](std::span<const View> views, const Placement& placement, Settings& drawing,
                           double period_ms, double drawn_ms) {
      Settings asked = drawing;  // a frame budget does not change the levels' quality
      asked.quality = settings.drawing.quality;
      stream->begin_frame(views, placement, asked, time_for_levels(period_ms, drawn_ms));
      if (asked.quality) drawing.quality = levels->frame_quality(asked.quality);
    };
  }
  Renderer renderer = stream ? Renderer(xr::get_proc_address(), *stream, precision)
                             : Renderer(xr::get_proc_address(), SplatModel(model), precision);
  xr::run(instance, renderer, settings, callbacks);
}

}  // namespace binosplat::app
