// What the lenses hide.

#include "xr/runtime/api.h"

namespace binosplat::xr_test::api {

XrResult GetVisibilityMaskKHR(XrSession handle, XrViewConfigurationType type, std::uint32_t view,
                              XrVisibilityMaskTypeKHR mask_type, XrVisibilityMaskKHR* mask) {
  Runtime& r = runtime();
  r.get<Session>(handle);
  checked(mask, XR_TYPE_VISIBILITY_MASK_KHR);
  require(view < views_of(type).size(), XR_ERROR_VALIDATION_FAILURE, "view " + std::to_string(view));
  static const Mesh none;
  const auto& masks = r.script.masks[type];
  const bool there = view < masks.size() && masks[view].count(mask_type) != 0;
  const Mesh& mesh = there ? masks[view].at(mask_type) : none;
  // One call asks for both counts, so neither is filled in unless both have room.
  const bool asks = mask->vertexCapacityInput == 0 && mask->indexCapacityInput == 0;
  mask->vertexCountOutput = static_cast<std::uint32_t>(mesh.vertices.size());
  mask->indexCountOutput = static_cast<std::uint32_t>(mesh.indices.size());
  if (asks) return XR_SUCCESS;
  require(
      mask->vertexCapacityInput >= mesh.vertices.size() && mask->indexCapacityInput >= mesh.indices.size(),
      XR_ERROR_SIZE_INSUFFICIENT, "no room for the mask");
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), mask->vertices);
  std::copy(mesh.indices.begin(), mesh.indices.end(), mask->indices);
  return XR_SUCCESS;
}

}  // namespace binosplat::xr_test::api
