#include <binosplat/renderer.h>

#include <algorithm>
#include <map>

#include "adagscale/own_calibrations.h"
#include "base/error.h"
#include "base/log.h"
#include "gl/state.h"
#include "library/conversions.h"
#include "library/mesh_depth.h"
#include "library/numbers.h"
#include "library/stream.h"
#include "library/targets.h"
#include "library/views.h"
#include "scene/axes.h"
#include "stereo/drawing.h"
#include "stereo/present.h"

namespace binosplat {

namespace {

/// Throws Error if the object was moved from, or its context is not current.
template <typename Impl>
Impl& usable(const std::unique_ptr<Impl>& impl) {
  if (impl == nullptr) fail("this Renderer was moved from: expected a valid one");
  impl->context->check_current();
  return *impl;
}

}  // namespace

struct Renderer::Impl {
  struct HeldModel {
    std::shared_ptr<const Model> model;  // null with a stream
    std::shared_ptr<SplatStream::Impl> stream;
    std::shared_ptr<render::GpuModel> on_gpu;
  };

  struct Scene {
    std::vector<render::Instance> instances;
    std::vector<SplatStream::Impl*> streams;  // the instances' streams
    glm::dvec3 origin{0.0};                   // world units; the frame's positions are relative to this point
    bool is_own = false;                      // own_scene() of a model whose Gaussians stay
  };

  Impl(GetProcAddress get_proc_address, Precision kept_in) : precision(library::precision_of(kept_in)) {
    context = gl::Context::adopt(get_proc_address);
  }
  ~Impl() {
    frame.reset();
    while (!held.empty()) drop(held.begin()->first);
  }

  ModelId add(std::shared_ptr<const Model> model) {
    if (model == nullptr) fail("model was moved from: expected a valid SplatModel");
    const gl::SavedState saved(*context);
    auto on_gpu = std::make_shared<render::GpuModel>(*context, *model, precision);
    return hold({.model = std::move(model), .on_gpu = std::move(on_gpu)});
  }
  ModelId add(std::shared_ptr<SplatStream::Impl> stream) {
    if (stream == nullptr) fail("stream was moved from: expected a valid SplatStream");
    if (stream->context != nullptr) fail("a stream has one renderer at a time: destroy the other one first");
    const gl::SavedState saved(*context);
    auto on_gpu = stream->stream->gpu_model(*context, precision);
    stream->context = context.get();
    stream->precision = precision;
    return hold({.stream = std::move(stream), .on_gpu = std::move(on_gpu)});
  }
  ModelId hold(HeldModel model) {
    const ModelId id{next_id++};
    held.emplace(id, std::move(model));
    return id;
  }
  void drop(ModelId id) {
    HeldModel model = std::move(held.extract(id).mapped());
    model.on_gpu.reset();
    if (!model.stream || model.stream->context != context.get()) return;
    model.stream->stream->release_gpu_model();
    model.stream->context = nullptr;
    model.stream->is_drawn = false;
  }
  /// Creates `frame` and `presenter`. A Frame needs a model, even if a World later replaces it.
  void draw_with(std::shared_ptr<render::GpuModel> drawn) {
    frame = std::make_unique<stereo::Drawing>(std::move(drawn));
    presenter = std::make_unique<stereo::Presenter>(*context);
    checked = std::make_unique<library::Targets>(*context);
  }

  const HeldModel& model_of(ModelId id, const std::string& name) const {
    const auto found = held.find(id);
    if (found == held.end())
      fail("{}: this renderer holds no such model: expected one that add() returned", name);
    return found->second;
  }

  /// The model with which the renderer was created, in its own world.
  Scene own_scene() const {
    if (held.empty() || held.begin()->first != ModelId{})
      fail("this renderer was made without a model: draw a World of instances");
    const HeldModel& own = held.begin()->second;
    Scene scene{.instances = {{.model = own.on_gpu, .place = {}}}, .origin = own.on_gpu->model().axes.origin};
    if (own.stream) scene.streams.push_back(own.stream.get());
    scene.is_own = !own.stream;
    return scene;
  }

  Scene scene_of(const World& world) const {
    Scene scene;
    for (std::size_t k = 0; k < world.instances.size(); ++k) {
      const Instance& instance = world.instances[k];
      const std::string name = fmt::format("instances[{}]", k);
      const HeldModel& model = model_of(instance.model, name + ".model");
      library::check_numbers(instance, name);
      if (!instance.is_shown || instance.opacity == 0.0f) continue;
      const ModelAxes& axes = model.on_gpu->model().axes;
      render::InstancePlace place = render::in_axes_of({.rotation = instance.rotation,
                                                        .translation = instance.translation,
                                                        .scale = instance.scale,
                                                        .opacity = instance.opacity,
                                                        .depth_table = instance.depth_table},
                                                       axes, ModelAxes{});
      if (scene.origin == glm::dvec3(0.0) && axes.origin != glm::dvec3(0.0)) scene.origin = place.translation;
      scene.instances.push_back({model.on_gpu, std::move(place)});
      if (model.stream) scene.streams.push_back(model.stream.get());
    }
    for (render::Instance& instance : scene.instances) instance.place.translation -= scene.origin;
    return scene;
  }

  void submit_or_prepare(std::span<const View> views, const Placement& placement, Scene scene,
                         const Settings& settings, bool prepares);

  /// Logs and returns the OpenGL errors of the caller's commands since the last call.
  std::vector<std::uint32_t> callers_errors() const {
    std::vector<std::uint32_t> errors;
    for (const GLenum error : context->take_errors()) {
      log_warning("OpenGL error 0x{:04x} was recorded before binosplat drew: it is the caller's", error);
      errors.push_back(error);
    }
    return errors;
  }

  /// The data of the submitted frame that finish() needs.
  struct Submitted {
    int layout = LAYOUT_SEPARATE;
    std::optional<glm::vec3> background;
    std::vector<Target> targets;
    std::vector<DepthTarget> depths;
    library::MeshDepths mesh_depths;
    stereo::Canvases canvases;
    std::vector<SplatStream::Impl*> streams;
    std::vector<std::uint32_t> callers_errors;

    bool has_meshes() const { return !mesh_depths.list.empty(); }
  };

  int precision;  // PRECISION_
  std::unique_ptr<gl::Context> context;
  const Model no_model;  // for renderers that are created without a model
  std::map<ModelId, HeldModel> held;
  std::uint32_t next_id = 0;
  std::optional<Submitted> submitted;
  std::unique_ptr<stereo::Drawing> frame;
  adagscale::OwnCalibrations calibrations;  // of the own model
  std::unique_ptr<stereo::Presenter> presenter;
  std::unique_ptr<library::Targets> checked;
};

Renderer::Renderer(GetProcAddress get_proc_address, const SplatModel& model, Precision precision)
    : impl_(std::make_unique<Impl>(get_proc_address, precision)) {
  impl_->draw_with(impl_->held.at(impl_->add(model.model_)).on_gpu);
}
Renderer::Renderer(GetProcAddress get_proc_address, SplatStream& stream, Precision precision)
    : impl_(std::make_unique<Impl>(get_proc_address, precision)) {
  impl_->draw_with(impl_->held.at(impl_->add(stream.impl_)).on_gpu);
}
Renderer::Renderer(GetProcAddress get_proc_address, Precision precision)
    : impl_(std::make_unique<Impl>(get_proc_address, precision)) {
  const gl::SavedState saved(*impl_->context);
  impl_->next_id = 1;  // 0 is the model with which other renderers are created
  impl_->draw_with(std::make_shared<render::GpuModel>(*impl_->context, impl_->no_model, impl_->precision));
}
Renderer::~Renderer() {
  // In another context the same names may be other objects, which the renderer must not delete.
  if (impl_ == nullptr || !impl_->context->another_is_current()) return;
  log_warning("a renderer is destroyed while its OpenGL context is not current: its memory is not freed");
  static_cast<void>(impl_.release());
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&& other) noexcept {
  if (this == &other) return *this;
  const Renderer old(std::move(*this));
  impl_ = std::move(other.impl_);
  return *this;
}

ModelId Renderer::add(const SplatModel& model) { return usable(impl_).add(model.model_); }
ModelId Renderer::add(SplatStream& stream) { return usable(impl_).add(stream.impl_); }

void Renderer::remove(ModelId model) {
  Impl& impl = usable(impl_);
  if (impl.submitted) fail("a frame is under way: call finish() before remove()");
  impl.model_of(model, "model");
  const gl::SavedState saved(*impl.context);
  impl.frame->frame().place({});
  impl.drop(model);
}

Placement Renderer::in_model(const Placement& placement, const Instance& instance) const {
  const Impl& impl = usable(impl_);
  const ModelAxes& axes = impl.model_of(instance.model, "instance.model").on_gpu->model().axes;
  library::check_numbers(instance, "instance");
  const glm::dmat3 into_model = glm::transpose(instance.rotation * world_from_axes(axes.letters));
  return {.origin = into_model * (placement.origin - instance.translation) / instance.scale,
          .axes = into_model * placement.axes,
          .units_per_metre = placement.units_per_metre / instance.scale};
}

void Renderer::submit(std::span<const View> views, const Placement& placement, const Settings& settings) {
  Impl& impl = usable(impl_);
  impl.submit_or_prepare(views, placement, impl.own_scene(), settings, false);
}
void Renderer::submit(std::span<const View> views, const World& world, const Settings& settings) {
  Impl& impl = usable(impl_);
  impl.submit_or_prepare(views, world.placement, impl.scene_of(world), settings, false);
}
void Renderer::prepare(std::span<const View> views, const Placement& placement, const Settings& settings) {
  Impl& impl = usable(impl_);
  impl.submit_or_prepare(views, placement, impl.own_scene(), settings, true);
}
void Renderer::prepare(std::span<const View> views, const World& world, const Settings& settings) {
  Impl& impl = usable(impl_);
  impl.submit_or_prepare(views, world.placement, impl.scene_of(world), settings, true);
}

// Passes the views to `frame`, which draws them or, if `prepares`, compiles the programs for them.
void Renderer::Impl::submit_or_prepare(std::span<const View> views, const Placement& placement, Scene scene,
                                       const Settings& settings, bool prepares) {
  if (submitted) fail("a frame is under way: call finish() before the next submit()");
  Submitted to{.layout = library::layout_of(settings.layout), .background = settings.background};
  to.callers_errors = callers_errors();
  library::check_numbers(views, placement);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const View& view = views[k];
    to.targets.push_back(view.target);
    if (view.depth) to.depths.push_back(*view.depth);
    if (view.mesh_depth) library::add_mesh_depth(*context, view, {k, "mesh_depth"}, to.mesh_depths);
  }
  if (to.layout != LAYOUT_SEPARATE) {
    if (views.size() != 2)
      fail("{} views in layout {}: expected two", views.size(), layout_choices[to.layout].name);
    to.targets.resize(1);
  }
  if (!to.depths.empty() && to.depths.size() != views.size())
    fail("{} of {} views have a depth target: expected all or none", to.depths.size(), views.size());
  const std::size_t with_meshes = to.mesh_depths.list.size();
  if (to.has_meshes() && (with_meshes != views.size() || with_meshes > MAX_CANVASES)) {
    fail("{} of {} views have a mesh depth: expected all or none, at most {}", with_meshes, views.size(),
         MAX_CANVASES);
  }
  if (to.has_meshes() && (settings.background || to.layout != LAYOUT_SEPARATE)) {
    fail("mesh depths with a {}: splats are blended over the colours that are in each view's target",
         settings.background ? "background" : "layout other than separate");
  }
  checked->check(views, settings);
  const bool finds_k = scene.is_own && adagscale::lacks_k(settings) && !settings.quality;
  render::FrameSettings over = library::frame_settings(settings, views, precision, finds_k);
  const std::size_t gazes = settings.foveation ? settings.foveation->gaze.size() : 0;
  if (gazes > 1 && gazes != views.size())
    fail("settings.foveation.gaze: {} for {} views: expected none, one, or one for each view", gazes,
         views.size());
  if (settings.foveation && !to.depths.empty())
    fail("foveation with depth targets: composed pictures have no depths");
  const Training unknown;
  const Training& training = scene.instances.empty()
                                 ? unknown
                                 : static_cast<const Training&>(scene.instances.front().model->model());
  const auto drawn = library::views_of(views, placement, scene.origin, settings, training);

  const gl::SavedState saved(*context);
  std::optional<gl::SavedTextures> textures;
  if (to.has_meshes()) textures.emplace(*context);
  if (finds_k) over = calibrations.settings(over, scene.instances.front().model, drawn.front());
  if (to.layout == LAYOUT_SEPARATE)
    to.canvases = presenter->canvases(to.targets, to.background, to.has_meshes());
  const render::CallersTextures of_caller{.canvases = to.canvases.list,
                                          .depth_rows = stereo::depth_rows(*context, drawn, to.depths),
                                          .mesh_depths = to.mesh_depths.list};
  frame->frame().place(std::move(scene.instances));
  if (prepares) {
    frame->prepare(drawn, over, of_caller);
    for (SplatStream::Impl* stream : scene.streams) stream->stream->prepare(drawn, over);
    return presenter->prepare(frame->frame(), !to.depths.empty());
  }
  frame->submit(drawn, over, {}, of_caller);
  for (SplatStream::Impl* stream : scene.streams) stream->is_drawn = true;
  to.streams = std::move(scene.streams);
  submitted = std::move(to);
}

bool Renderer::is_done() { return !usable(impl_).submitted || impl_->frame->frame().is_done(); }

Report Renderer::finish() {
  if (!usable(impl_).submitted) fail("no frame is under way: call submit() before finish()");
  const Impl::Submitted frame = std::move(*impl_->submitted);
  impl_->submitted.reset();
  for (SplatStream::Impl* stream : frame.streams) stream->is_drawn = false;
  const gl::SavedState saved(*impl_->context);
  std::optional<gl::SavedTextures> textures;
  if (frame.has_meshes()) textures.emplace(*impl_->context);
  stereo::Presenter& presenter = *impl_->presenter;
  stereo::Drawing& drawn = *impl_->frame;
  Report report = drawn.finish();
  report.callers_errors = frame.callers_errors;
  for (std::size_t k = 0; k < frame.targets.size() && !report.in_place; ++k) {
    presenter.draw(drawn.colours(), drawn.views(), k, frame.layout, frame.targets[k],
                   {frame.background, frame.has_meshes()});
  }
  for (std::size_t k = 0; k < frame.depths.size(); ++k)
    presenter.draw_depth(drawn.frame(), k, frame.depths[k]);
  return report;
}

}  // namespace binosplat
