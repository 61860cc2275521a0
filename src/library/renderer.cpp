#include <binosplat/renderer.h>

#include "base/error.h"
#include "base/log.h"
#include "gl/state.h"
#include "library/mesh_depth.h"
#include "library/numbers.h"
#include "library/settings.h"
#include "library/stream.h"
#include "library/targets.h"
#include "library/views.h"
#include "stereo/foveate.h"
#include "stereo/present.h"

namespace binosplat {

namespace {

/// Throws Error if the object was moved from, or its context is not current.
template <typename Impl>
Impl& usable(const std::unique_ptr<Impl>& impl) {
  if (impl == nullptr) fail("this Renderer was moved from: expected one that holds a model");
  impl->context->check_current();
  return *impl;
}

}  // namespace

struct Renderer::Impl {
  Impl(GetProcAddress get_proc_address, std::shared_ptr<const Model> drawn, Precision kept_in)
      : model(std::move(drawn)), precision(library::precision_of(kept_in)) {
    if (model == nullptr) fail("model: it was moved from: expected a SplatModel that holds one");
    context = gl::Context::adopt(get_proc_address);
    const gl::KeptState kept(*context);
    draw_with(std::make_shared<render::GpuModel>(*context, *model, precision));
  }
  Impl(GetProcAddress get_proc_address, std::shared_ptr<SplatStream::Impl> drawn, Precision kept_in)
      : stream(std::move(drawn)), precision(library::precision_of(kept_in)) {
    if (stream == nullptr) fail("stream: it was moved from: expected a SplatStream that holds one");
    if (stream->context != nullptr) fail("a stream has one renderer at a time: destroy the other one first");
    context = gl::Context::adopt(get_proc_address);
    const gl::KeptState kept(*context);
    draw_with(stream->stream->gpu_model(*context, precision));
    stream->context = context.get();
    stream->precision = precision;
  }
  void draw_with(std::shared_ptr<render::GpuModel> drawn) {
    frame = std::make_unique<stereo::FoveatedFrame>(std::move(drawn));
    presenter = std::make_unique<stereo::Presenter>(*context);
    checked = std::make_unique<library::Targets>(*context);
  }
  ~Impl() {
    if (!stream || stream->context != context.get()) return;
    frame.reset();
    stream->stream->release_gpu_model();
    stream->context = nullptr;
    stream->is_drawn = false;
  }

  /// Logs and returns the errors that OpenGL has recorded since the last call. They are the caller's.
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
    bool is_foveated = false;
    std::vector<std::uint32_t> callers_errors;

    bool has_meshes() const { return !mesh_depths.list.empty(); }
  };

  std::shared_ptr<const Model> model;  // null with a stream
  std::shared_ptr<SplatStream::Impl> stream;
  int precision;  // PRECISION_
  std::unique_ptr<gl::Context> context;
  std::optional<Submitted> submitted;
  std::unique_ptr<stereo::FoveatedFrame> frame;
  std::unique_ptr<stereo::Presenter> presenter;
  std::unique_ptr<library::Targets> checked;
};

Renderer::Renderer(GetProcAddress get_proc_address, const SplatModel& model, Precision precision)
    : impl_(std::make_unique<Impl>(get_proc_address, model.model_, precision)) {}
Renderer::Renderer(GetProcAddress get_proc_address, SplatStream& stream, Precision precision)
    : impl_(std::make_unique<Impl>(get_proc_address, stream.impl_, precision)) {}
Renderer::~Renderer() {
  // In another context the same names may be other objects, which the renderer must not delete.
  if (impl_ == nullptr || !impl_->context->another_is_current()) return;
  log_warning(
      "a renderer ends where another OpenGL context than its own is current: its memory is not freed");
  static_cast<void>(impl_.release());
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&& other) noexcept {
  if (this == &other) return *this;
  const Renderer old(std::move(*this));
  impl_ = std::move(other.impl_);
  return *this;
}

void Renderer::submit(std::span<const View> views, const Placement& placement, const Settings& settings) {
  hand_over(views, placement, settings, false);
}

void Renderer::prepare(std::span<const View> views, const Placement& placement, const Settings& settings) {
  hand_over(views, placement, settings, true);
}

// Draws the views, or compiles the shaders that drawing them needs.
void Renderer::hand_over(std::span<const View> views, const Placement& placement, const Settings& settings,
                         bool prepares) {
  if (usable(impl_).submitted) fail("a frame is under way: call finish() before the next submit()");
  Impl::Submitted to{.layout = library::layout_of(settings.layout), .background = settings.background};
  to.callers_errors = impl_->callers_errors();
  library::check_numbers(views, placement);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const View& view = views[k];
    to.targets.push_back(view.target);
    if (view.depth) to.depths.push_back(*view.depth);
    if (view.mesh_depth) library::add_mesh_depth(*impl_->context, view, {k, "mesh_depth"}, to.mesh_depths);
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
  impl_->checked->check(views, settings);
  const render::FrameSettings over = library::frame_settings(settings, views, impl_->precision);
  if (settings.cyclopean && !(impl_->model && impl_->model->scaffold))
    fail("settings.cyclopean has no effect on this model, which is no Scaffold-GS model: leave it out");
  to.is_foveated = settings.foveation.has_value();
  const std::size_t gazes = to.is_foveated ? settings.foveation->gaze.size() : 0;
  if (gazes > 1 && gazes != views.size())
    fail("settings.foveation.gaze: {} for {} views: expected none, one or one a view", gazes, views.size());
  if (to.is_foveated && !to.depths.empty())
    fail("foveation with depth targets: composed pictures have no depths");
  const auto head = library::views_of(views, placement, impl_->frame->frame().model()->model(), settings);

  const gl::KeptState kept(*impl_->context);
  std::optional<gl::KeptTextures> textures;
  if (to.has_meshes()) textures.emplace(*impl_->context);
  if (to.layout == LAYOUT_SEPARATE)
    to.canvases = impl_->presenter->canvases(to.targets, to.background, to.has_meshes());
  const render::CallersTextures of_caller{
      .canvases = to.canvases.list,
      .depth_rows = stereo::depth_rows(*impl_->context, head.views, to.depths),
      .mesh_depths = to.mesh_depths.list};
  stereo::FoveatedFrame& frame = *impl_->frame;
  if (prepares) {
    if (to.is_foveated) {
      frame.prepare(head.views, *settings.foveation, over, of_caller);
    } else {
      frame.frame().prepare(head.views, over, {}, of_caller);
    }
    if (impl_->stream) impl_->stream->stream->prepare(head.views, over);
    return impl_->presenter->prepare(frame.frame(), !to.depths.empty());
  }
  if (to.is_foveated) {
    frame.submit(head.views, *settings.foveation, over, {}, of_caller);
  } else {
    frame.frame().submit(head.views, over, {}, of_caller);
  }
  impl_->submitted = std::move(to);
  if (impl_->stream) impl_->stream->is_drawn = true;
}

bool Renderer::is_done() { return !usable(impl_).submitted || impl_->frame->frame().is_done(); }

Report Renderer::finish() {
  if (!usable(impl_).submitted) fail("no frame is under way: call submit() before finish()");
  const Impl::Submitted frame = std::move(*impl_->submitted);
  impl_->submitted.reset();
  if (impl_->stream) impl_->stream->is_drawn = false;
  const gl::KeptState kept(*impl_->context);
  std::optional<gl::KeptTextures> textures;
  if (frame.has_meshes()) textures.emplace(*impl_->context);
  stereo::Presenter& presenter = *impl_->presenter;
  stereo::FoveatedFrame& drawn = *impl_->frame;
  Report report = library::report_of(frame.is_foveated ? drawn.finish() : drawn.frame().finish());
  report.callers_errors = frame.callers_errors;
  for (std::size_t k = 0; k < frame.targets.size() && !report.in_place; ++k) {
    if (frame.is_foveated) {
      presenter.draw(drawn.colours(), drawn.views(), k, frame.layout, frame.targets[k], frame.background);
    } else {
      presenter.draw(drawn.frame(), k, frame.layout, frame.targets[k], frame.background);
    }
  }
  for (std::size_t k = 0; k < frame.depths.size(); ++k)
    presenter.draw_depth(drawn.frame(), k, frame.depths[k]);
  return report;
}

}  // namespace binosplat
