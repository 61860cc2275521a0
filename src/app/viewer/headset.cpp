#include "app/viewer/headset.h"

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/command_line.h"
#include "app/context_options.h"
#include "app/load_scene.h"
#include "app/profile.h"
#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "preview/key_list.h"
#include "preview/mirror.h"
#include "render/recorder.h"
#include "scene/axes.h"
#include "xr/binding.h"
#include "xr/headset.h"

namespace binosplat::app {

namespace {

constexpr double seconds_by_key = 10.0;

volatile std::sig_atomic_t signalled = 0;

// The first signal is told, so that the runtime's session can be ended in order; the next one ends the
// program.
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

/// Frames of a headset that are recorded when somebody asks, and written once that is over.
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
    // What this frame did was not written down from its beginning on.
    recorder_.emplace(context_, period_ms > 0.0 ? 1000.0 / period_ms : 0.0,
                      std::make_shared<gl::GpuClock>(context_));
    since_ = Clock::now();
    log_info("recording {:g} s", seconds_);
  }

 private:
  // A recording that cannot be written ends no session.
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
  double seconds_ = 0.0;  // that are asked for; 0: nothing is
  std::optional<render::Recorder> recorder_;
  Clock::time_point since_ = {};
};

}  // namespace

void view_in_headset(const RenderOptions& o, const preview::Opened& scene, preview::Choices choices) {
  std::error_code ignored;
  if (!is_built_in(scene.name) && !std::filesystem::exists(scene.name, ignored))
    fail_to_read(scene.name, ENOENT);
  // A headset that is not there is said before a model is read.
  const std::unique_ptr<xr::Instance> opened = [] {
    try {
      return std::make_unique<xr::Instance>();
    } catch (const xr::Lost&) {
      throw Error(ExitCode::no_gl,
                  "the OpenXR runtime ended while it was asked: start it, and then this again");
    }
  }();
  xr::Instance& instance = *opened;
  log_info("{} on {}", instance.headset(), instance.runtime());
  std::unique_ptr<preview::Mirror> mirror;
  std::unique_ptr<gl::Context> own;
  const bool four = instance.view_configuration() != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  if (o.foveate && four)
    log_warning("--foveate: {} has insets of its own, and takes these", instance.headset());
  if (o.headset.mirror && has_display()) {
    if (o.context.device >= 0 || o.context.backend != gl::Backend::automatic)
      fail("--device and --backend with a window, which its display draws: add --no-mirror");
    try {
      mirror = std::make_unique<preview::Mirror>(instance.has(xr::egl_extension));
    } catch (const Error&) {
      log_warning("no window can be opened on this display: only the headset shows the model");
    }
  }
  if (!mirror) own = open_context(o.context);
  gl::Context& context = mirror ? mirror->context() : *own;
  if (!o.context.shader_dir.empty()) context.set_shader_folder(o.context.shader_dir);

  preview::Loaded loaded = scene.load();
  const Model& model = loaded.shown();
  const preview::Start start = scene.start(model, choices);
  log_info("{}: {} Gaussians", scene.name, loaded.gaussians());
  xr::HeadsetSettings settings;
  settings.projection = {o.headset.scale, choices.rig.near_plane, choices.rig.units_per_metre,
                         choices.background, o.foveate};
  settings.frame = choices.settings;
  settings.budget_ms = o.headset.budget_ms;
  settings.start = into_axes(start.cameras.front(), model.axes);
  settings.up = glm::transpose(world_from_axes(model.axes.letters)) * start.up;
  settings.units_per_metre = choices.rig.units_per_metre;
  tell_first_signal();
  HeadsetRecording recording(context, scene, instance.headset());
  if (o.headset.record_s) recording.begin(*o.headset.record_s);
  std::size_t uploaded = 0;
  xr::Beside beside = {.step =
                           [&] {
                             if (mirror && mirror->take_record_key()) recording.begin(seconds_by_key);
                             return (!mirror || mirror->step()) && signalled == 0;
                           },
                       .show = {},
                       .levels = {}};
  beside.drawn = [&](render::FrameRecord frame, double period_ms) {
    frame.levels.uploaded = std::exchange(uploaded, 0);
    recording.add(std::move(frame), period_ms);
  };
  const int precision = settings.frame.precision;
  const auto gpu_model = loaded.stream ? loaded.stream->gpu_model(context, precision)
                                       : std::make_shared<render::GpuModel>(context, model, precision);
  if (loaded.stream) {
    beside.levels = [&](std::span<const shared::View> views, double frame_ms, double drawn_ms) {
      loaded.stream->begin_frame(views, settings.frame, time_for_levels(frame_ms, drawn_ms));
      uploaded += loaded.stream->take_times().put;
      return static_cast<float>(loaded.stream->quality_left(settings.frame.quality));
    };
  }
  if (mirror) beside.show = [&](const Target& left, const glm::ivec2& size) { mirror->show(left, size); };
  xr::run(instance, gpu_model, settings, beside);
}

}  // namespace binosplat::app
