#include "reference/render.h"

namespace binosplat::reference {

Picture render(const Model& model, const shared::View& view, const Settings& settings) {
  std::vector<Splat> splats =
      project_all(model, view, settings.anchor_cull, settings.perspective.value_or(model.perspective));
  set_thresholds(splats, settings.threshold, settings.tolerance, settings.bounds);
  const std::vector<std::uint32_t> order = depth_order(splats);
  TileLists lists = make_lists(splats, order, view, settings.tiles);
  lists.approximation = approximation_of(settings.tiles, settings.threshold, settings.tolerance);
  lists.mesh_depths = settings.mesh_depths;
  Picture picture = blend(splats, lists, view);
  if (model.linear) display(picture, glm::vec3(0.0f));
  return picture;
}

}  // namespace binosplat::reference
