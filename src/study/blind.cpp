#include "study/blind.h"

#include <algorithm>
#include <cstdint>

#include "base/progress.h"
#include "render/frame.h"
#include "scene/axes.h"

namespace binosplat::study {

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

}  // namespace

std::vector<bool> seeing(gl::Context& context, const Model& model, std::span<const Camera> cameras,
                         double near_plane) {
  render::Frame frame(context, model);
  const auto shows_something = [&](const Camera& camera) {
    const shared::View view = make_view(into_axes(camera, model.axes), near_plane);
    frame.draw(std::span(&view, 1));
    const Picture picture = frame.read_pictures()[0];
    return std::any_of(picture.colour.begin(), picture.colour.end(),
                       [](const glm::vec4& c) { return c.a < 1.0f; });
  };
  Progress progress("looking through every view", cameras.size());
  std::vector<bool> sees;
  for (const Camera& camera : cameras) {
    sees.push_back(shows_something(small(camera)) || shows_something(camera));
    progress.update(sees.size());
  }
  return sees;
}

}  // namespace binosplat::study
