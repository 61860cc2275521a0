#pragma once
// What lenses show of a view (XR_KHR_visibility_mask): other tiles are not drawn.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "xr/session.h"

namespace binosplat::xr {

/// Triangles at a distance of 1 ahead, x right and y up, that hold all that can be seen. Empty: all of the
/// view.
struct Visible {
  std::vector<XrVector2f> vertices;
  std::vector<std::uint32_t> indices;  // three a triangle
};

/// What can be seen of a view of the session; empty where the runtime tells nothing.
Visible visible_of(const Session& session, std::uint32_t view);

/// For each row of tiles of `tile` x `tile` px of a picture, top first, the columns [x, y) of tiles that can
/// be seen, with a margin of a pixel; (0, 0): none. Empty: all can be seen.
std::vector<glm::uvec2> visible_columns(const Visible& visible, const XrFovf& fov, const glm::ivec2& size,
                                        int tile);

}  // namespace binosplat::xr
