#include <binosplat/renderer.h>

#include "base/error.h"
#include "base/log.h"
#include "gl/state.h"
#include "library/mesh_depth.h"
#include "library/settings.h"
#include "stereo/eyes.h"
#include "stereo/present.h"

namespace binosplat {

struct Renderer::Impl {
  Impl(GetProcAddress get_proc_address, std::shared_ptr<const Model> drawn)
      : model(std::move(drawn)), context(gl::Context::adopt(get_proc_address)) {
    const gl::KeptState kept(*context);
    frame = std::make_unique<render::Frame>(*context, *model);
    presenter = std::make_unique<stereo::Presenter>(*context);
  }

  /// Logs the errors that OpenGL has recorded since the last call: the caller's.
  std::vector<std::uint32_t> callers_errors() const {
    std::vector<std::uint32_t> errors;
    for (const GLenum error : context->take_errors()) {
      log_warning("OpenGL error 0x{:04x} was recorded before binosplat drew: it is the caller's", error);
      errors.push_back(error);
    }
    return errors;
  }

  /// What finish() needs of the frame that was submitted.
  struct Submitted {
    int layout = LAYOUT_SEPARATE;
    std::optional<glm::vec3> background;
    std::vector<Target> targets;
    std::vector<DepthTarget> depths;
    library::MeshDepths mesh_depths;
    stereo::Canvases canvases;

    bool has_meshes() const { return !mesh_depths.list.empty(); }
    std::vector<std::uint32_t> callers_errors;
  };

  std::shared_ptr<const Model> model;
  std::unique_ptr<gl::Context> context;
  std::optional<Submitted> submitted;
  std::unique_ptr<render::Frame> frame;
  std::unique_ptr<stereo::Presenter> presenter;
};

Renderer::Renderer(GetProcAddress get_proc_address, const SplatModel& model)
    : impl_(std::make_unique<Impl>(get_proc_address, model.model_)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::submit(std::span<const View> views, const Placement& placement, const Settings& settings) {
  if (impl_->submitted) fail("a frame is under way: call finish() before the next submit()");
  Impl::Submitted to{.layout = library::layout_of(settings.layout), .background = settings.background};
  to.callers_errors = impl_->callers_errors();
  std::vector<Eye> eyes;
  std::vector<glm::ivec2> sizes;
  for (const View& view : views) {
    eyes.push_back(view.eye);
    sizes.push_back(view.size);
    to.targets.push_back(view.target);
    if (view.depth) to.depths.push_back(*view.depth);
    if (view.mesh_depth) library::add_mesh_depth(*impl_->context, view, to.mesh_depths);
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
  const render::FrameSettings over = library::frame_settings(settings, views);
  const auto head = stereo::views_from_xr(eyes, placement, sizes, settings.near_plane);

  const gl::KeptState kept(*impl_->context);
  std::optional<gl::KeptTextures> textures;
  if (to.has_meshes()) textures.emplace(*impl_->context);
  if (to.layout == LAYOUT_SEPARATE)
    to.canvases = impl_->presenter->canvases(to.targets, to.background, to.has_meshes());
  impl_->frame->submit(head.views, over, {},
                       {.canvases = to.canvases.list,
                        .depth_rows = stereo::depth_rows(*impl_->context, head.views, to.depths),
                        .mesh_depths = to.mesh_depths.list});
  impl_->submitted = std::move(to);
}

bool Renderer::is_done() { return !impl_->submitted || impl_->frame->is_done(); }

Report Renderer::finish() {
  if (!impl_->submitted) fail("no frame is under way: call submit() before finish()");
  const Impl::Submitted frame = std::move(*impl_->submitted);
  impl_->submitted.reset();
  const gl::KeptState kept(*impl_->context);
  std::optional<gl::KeptTextures> textures;
  if (frame.has_meshes()) textures.emplace(*impl_->context);
  stereo::Presenter& presenter = *impl_->presenter;
  Report report = library::report_of(impl_->frame->finish());
  report.callers_errors = frame.callers_errors;
  for (std::size_t k = 0; k < frame.targets.size() && !report.in_place; ++k)
    presenter.draw(*impl_->frame, k, frame.layout, frame.targets[k], frame.background);
  for (std::size_t k = 0; k < frame.depths.size(); ++k)
    presenter.draw_depth(*impl_->frame, k, frame.depths[k]);
  return report;
}

}  // namespace binosplat
