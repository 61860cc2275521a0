#include <binosplat/renderer.h>

#include "base/error.h"
#include "base/log.h"
#include "gl/state.h"
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

  std::shared_ptr<const Model> model;
  std::unique_ptr<gl::Context> context;
  std::unique_ptr<render::Frame> frame;
  std::unique_ptr<stereo::Presenter> presenter;
};

Renderer::Renderer(GetProcAddress get_proc_address, const SplatModel& model)
    : impl_(std::make_unique<Impl>(get_proc_address, model.model_)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Report Renderer::draw(std::span<const View> views, const Placement& placement, const Settings& settings) {
  std::vector<Eye> eyes;
  std::vector<glm::ivec2> sizes;
  std::vector<Target> targets;
  std::vector<DepthTarget> depths;
  for (const View& view : views) {
    eyes.push_back(view.eye);
    sizes.push_back(view.size);
    targets.push_back(view.target);
    if (view.depth) depths.push_back(*view.depth);
  }
  const int layout = library::layout_of(settings.layout);
  if (layout != LAYOUT_SEPARATE) {
    if (views.size() != 2)
      fail("{} views in layout {}: expected two", views.size(), layout_choices[layout].name);
    targets.resize(1);
  }
  if (!depths.empty() && depths.size() != views.size())
    fail("{} of {} views have a depth target: expected all or none", depths.size(), views.size());
  const render::FrameSettings over = library::frame_settings(settings, views);
  const auto head = stereo::views_from_xr(eyes, placement, sizes, settings.near_plane);

  const std::vector<std::uint32_t> callers_errors = impl_->callers_errors();
  const gl::Context& context = *impl_->context;
  const gl::KeptState kept(context);
  stereo::Presenter& presenter = *impl_->presenter;
  stereo::Canvases canvases;
  if (layout == LAYOUT_SEPARATE) canvases = presenter.canvases(targets, settings.background);
  Report report = library::report_of(impl_->frame->draw(head.views, over, {}, canvases.list,
                                                        stereo::depth_rows(context, head.views, depths)));
  report.callers_errors = callers_errors;
  for (std::size_t k = 0; k < targets.size() && !report.in_place; ++k)
    presenter.draw(*impl_->frame, k, layout, targets[k], settings.background);
  for (std::size_t k = 0; k < depths.size(); ++k) presenter.draw_depth(*impl_->frame, k, depths[k]);
  return report;
}

}  // namespace binosplat
