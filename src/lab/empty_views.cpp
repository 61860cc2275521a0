#include "lab/empty_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "base/progress.h"
#include "render/frame.h"
#include "scene/axes.h"

namespace binosplat::lab {

namespace {

Camera small(const Camera& camera) {
  constexpr int most = 160;  // px along the longer side
  const std::int64_t longer = std::max(camera.width, camera.height);
  if (longer <= most) return camera;
  const auto scaled = [&](int size) {
    return std::max(1, static_cast<int>(std::int64_t{size} * most / longer));
  };
  return resized(camera, scaled(camera.width), scaled(camera.height));
}

// Whether the middle of a visible Gaussian lies well within the picture; the pixel there then shows it,
// whatever its shape. Most views pass this test, which draws nothing. `camera` is in the model's axes.
bool has_middle(const Model& model, const Camera& camera, double near_plane) {
  // The nearest pixel centre is at most 0.5 px away along each axis. The splat's variance is at least
  // kernel_px2, so alpha at this centre is at least 2 / 255.
  const double not_faint = 2.0 / 255.0 * std::exp(0.25 / model.kernel_px2);
  if (model.antialiased || model.scaffold) return false;
  for (std::size_t i = 0; i < model.count(); ++i) {
    if (double{model.opacity[i]} < not_faint) continue;
    const ProjectedPoint middle = project_point(camera, model.position[i]);
    if (middle.depth > 1.01 * near_plane && middle.is_within(1.0)) return true;
  }
  return false;
}

}  // namespace

std::vector<bool> which_see_model(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                                  double near_plane) {
  std::optional<render::Frame> frame;
  const auto shows_model = [&](const Camera& camera) {
    if (!frame) frame.emplace(context, model);
    const shared::View view = make_view(into_axes(camera, model.axes), near_plane);
    frame->draw(std::span(&view, 1));
    const Picture picture = frame->read_pictures()[0];
    return std::any_of(picture.colour.begin(), picture.colour.end(),
                       [](const glm::vec4& c) { return c.a < 1.0f; });
  };
  Progress progress("looking through every view", cameras.size());
  std::vector<bool> sees;
  for (const Camera& camera : cameras) {
    sees.push_back(has_middle(model, into_axes(camera, model.axes), near_plane) ||
                   shows_model(small(camera)) || shows_model(camera));
    progress.update(sees.size());
  }
  return sees;
}

}  // namespace binosplat::lab
