#include "study/seen_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace binosplat::study {

std::vector<SeenPart> seen_parts(render::LinearBlend& blend, const Model& model, const ModelParts& parts,
                                 const shared::View& view, const render::FrameSettings& settings) {
  blend.set_view(view, settings);
  const std::vector<double> seen = blend.seen();
  const glm::dvec3 eye = glm::dvec3(view.anchor) + glm::dvec3(view.eye);
  std::vector<SeenPart> result(parts.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k] == 0.0) continue;
    const std::uint32_t i = blend.drawn()[k].index;
    SeenPart& part = result[parts.part_of(i)];
    part.area += seen[k];
    part.distance += seen[k] * std::log(glm::distance(glm::dvec3(model.position[i]), eye));
  }
  for (SeenPart& part : result) {
    if (part.area > 0.0) part.distance = std::exp(part.distance / part.area);
  }
  return result;
}

}  // namespace binosplat::study
