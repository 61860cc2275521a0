#pragma once
// A model on the GPU, which a separate thread draws.

#include <atomic>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adagscale/own_calibrations.h"
#include "base/error.h"
#include "python/gl_thread.h"
#include "render/frame.h"
#include "render/linear_blend.h"
#include "render/read_back.h"
#include "stereo/debug_view.h"

namespace binosplat::python {

struct ViewImages {
  Image colour, transmittance, depth;
};

struct Drawn {
  std::vector<ViewImages> views;
  Report report;
};

inline ViewImages images_of(const Picture& picture, const glm::vec3& background) {
  ViewImages images = {composite(picture, background), Image(picture.width, picture.height, 1),
                       depth_map(picture)};
  for (std::size_t k = 0; k < picture.colour.size(); ++k) images.transmittance.data[k] = picture.colour[k].a;
  return images;
}

inline Drawn drawn_of(Report report, const std::vector<Picture>& pictures, const glm::vec3& background) {
  Drawn drawn{{}, std::move(report)};
  for (const Picture& picture : pictures) drawn.views.push_back(images_of(picture, background));
  return drawn;
}

using Views = std::vector<shared::View>;

/// The settings of a frame. If `follow`, the frame uses the previous frame's measurements.
struct Settings {
  render::FrameSettings frame;
  adagscale::CalibratedThreshold calibrated;
  bool follow = false;
};

/// A model and its place in the cameras' world.
struct Placed {
  std::shared_ptr<const Model> model;
  render::InstancePlace place;
};

/// A sequence of frames. The GPU draws the next frame while Python uses the last one.
struct Path {
  Path(gl::Context& context, std::shared_ptr<render::GpuModel> model)
      : frame(std::move(model)), read_back(context) {}

  void submit(const Views& views, bool follow, const render::FrameSettings& settings,
              const std::vector<render::Instance>& instances) {
    frame.place(instances);
    if (!follow) frame.start_over();
    frame.submit(views, settings);
  }

  render::Frame frame;
  render::ReadBack read_back;
};

class Renderer {
 public:
  Renderer(std::shared_ptr<Model> model, gl::Backend backend, int device, int precision)
      : model_(std::move(model)), precision_(precision) {
    thread_.run([&] { on_gpu_ = std::make_unique<OnGpu>(backend, device, *model_, precision_); });
    const gl::Context& context = *on_gpu_->context;
    device_ = fmt::format("{} ({}, OpenGL {})", context.renderer(), context.backend(), context.version());
  }
  /// Only if !is_in_use().
  ~Renderer() { close(); }
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Whether its thread may use it after the last reference is gone, or is gone itself, as in a fork.
  bool is_in_use() {
    return !GlThread::in_its_process() || (ReleasedGil::ends_by_interrupt() && thread_.is_busy());
  }

  void close() {
    thread_.run([this] { on_gpu_.reset(); });
  }

  std::future<void> place(std::vector<Placed> placed) {
    return thread_.start([this, placed = std::move(placed)] { on_gpu().place(placed, *model_, precision_); });
  }

  std::future<Drawn> draw(const Views& views, const Settings& settings) {
    return thread_.start([this, views, settings] {
      render::Frame& frame = on_gpu().frame;
      if (!settings.follow) frame.start_over();
      Report report = frame.draw(views, on_gpu().frame_of(settings, views));
      return drawn_of(std::move(report), frame.read_pictures(),
                      settings.frame.background.value_or(glm::vec3(0.0f)));
    });
  }

  /// A list for each view.
  std::future<std::vector<std::vector<render::GaussianInView>>> measure(const Views& views,
                                                                        const Settings& settings) {
    return thread_.start([this, views, settings] {
      render::LinearBlend blend(on_gpu().own_model("measure"));
      std::vector<std::vector<render::GaussianInView>> found;
      for (const shared::View& view : views)
        found.push_back(blend.measure(view, on_gpu().frame_of(settings, {view})));
      return found;
    });
  }

  /// The map `what` of each view (shared/choices.h), below 0 where a pixel has no number.
  std::future<std::vector<Image>> debug_view(int what, const Views& views, const Settings& settings) {
    return thread_.start([this, what, views, settings] {
      OnGpu& on = on_gpu();
      stereo::DebugView view(on.own_model("debug_view"));
      if (!settings.follow) on.frame.start_over();
      const render::FrameSettings of_frame = on.frame_of(settings, views);
      on.frame.draw(views, of_frame);
      return view.map(what, {on.frame, views, on.frame.read_pictures(), of_frame}, of_frame.background);
    });
  }

  /// A new path's number. begin() creates the path; end() or close() destroys it.
  static std::uint64_t new_path() {
    static std::atomic<std::uint64_t> last = 0;
    return ++last;
  }

  std::future<void> begin(std::uint64_t number, const Views& views, const Settings& settings) {
    return thread_.start([this, number, views, settings] {
      OnGpu& on = on_gpu();
      Path& path = on.paths.try_emplace(number, *on.context, on.frame.model()).first->second;
      path.submit(views, settings.follow, on.frame_of(settings, views), on.instances);
    });
  }

  /// Submits `following`, if given, and returns the frame that was submitted before.
  std::future<Drawn> next(std::uint64_t number, const std::optional<Views>& following,
                          const Settings& settings) {
    return thread_.start([this, number, following, settings] {
      const auto found = on_gpu().paths.find(number);
      if (found == on_gpu().paths.end()) fail(closed);
      Path& path = found->second;
      Report report = path.frame.finish();
      const auto pictures = path.read_back.start(path.frame);
      OnGpu& on = on_gpu();
      if (following)
        path.submit(*following, settings.follow, on.frame_of(settings, *following), on.instances);
      pictures->wait();
      return drawn_of(std::move(report), pictures->take(),
                      settings.frame.background.value_or(glm::vec3(0.0f)));
    });
  }

  /// Destroys the path later, on the thread, without waiting.
  void end(std::uint64_t number) {
    thread_.start([this, number] {
      if (on_gpu_) on_gpu_->paths.erase(number);
    });
  }

  const Model& model() const { return *model_; }
  const std::string& device() const { return device_; }
  int precision() const { return precision_; }

 private:
  static constexpr const char* closed = "this Renderer is closed";

  struct OnGpu {
    OnGpu(gl::Backend backend, int number, const Model& model, int precision)
        : context(gl::Context::open(backend, number)),
          frame(*context, model, precision),
          instances{{frame.model(), {}}} {}

    /// Uploads each model once, and drops models that are not in `placed`.
    void place(const std::vector<Placed>& placed, const Model& own, int precision) {
      struct Owner {
        Owner(std::shared_ptr<const Model> owned, gl::Context& context, int precision)
            : model(std::move(owned)), on_gpu(context, *model, precision) {}
        std::shared_ptr<const Model> model;
        render::GpuModel on_gpu;
      };
      std::map<const Model*, std::shared_ptr<render::GpuModel>> held = {{&own, frame.model()}};
      std::vector<render::Instance> next;
      for (const auto& [model, place] : placed) {
        std::shared_ptr<render::GpuModel>& on_gpu = held[model.get()];
        if (const auto before = models.find(model.get()); !on_gpu && before != models.end())
          on_gpu = before->second;
        if (!on_gpu) {
          const auto owner = std::make_shared<Owner>(model, *context, precision);
          on_gpu = {owner, &owner->on_gpu};
        }
        next.push_back({on_gpu, render::in_axes_of(place, model->axes, own.axes)});
      }
      frame.place(next);
      instances = std::move(next);
      models = std::move(held);
    }

    /// The only model, for `what`, which draws no instances.
    std::shared_ptr<render::GpuModel> own_model(const char* what) const {
      if (instances.size() != 1 || instances[0].model != frame.model() || !instances[0].place.is_plain())
        fail("{}: this Renderer draws instances: expected one model at its own place", what);
      return frame.model();
    }

    /// A calibration may complete the settings: the user's, or one that AdaGScale makes here.
    render::FrameSettings frame_of(const Settings& settings, const Views& views) {
      if (settings.calibrated.is_calibrated())
        return settings.calibrated.settings(settings.frame, views.front(), frame.model()->model().axes);
      if (!adagscale::lacks_k(settings.frame)) return settings.frame;
      return calibrations.settings(settings.frame, own_model("threshold adagscale without tolerance"),
                                   views.front());
    }

    std::unique_ptr<gl::Context> context;
    adagscale::OwnCalibrations calibrations;
    std::map<const Model*, std::shared_ptr<render::GpuModel>> models;  // the instances' models
    render::Frame frame;
    std::vector<render::Instance> instances;
    std::map<std::uint64_t, Path> paths;
  };

  OnGpu& on_gpu() {
    if (!on_gpu_) fail(closed);
    return *on_gpu_;
  }

  std::shared_ptr<const Model> model_;
  int precision_;
  std::string device_;
  GlThread thread_;
  std::unique_ptr<OnGpu> on_gpu_;  // created, used and destroyed on the thread
};

}  // namespace binosplat::python
