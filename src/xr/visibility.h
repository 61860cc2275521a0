#pragma once
// What lenses show of a view: tiles that they do not are not drawn (XR_KHR_visibility_mask).

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

/// Of a view of the session; empty where the runtime tells nothing.
Visible visible_of(const Session& session, std::uint32_t view);

/// Of each row of `tile` x `tile` px of a picture, top first, the columns [x, y) that can be seen of it, and
/// a pixel more; none, (0, 0), of some. Empty: all.
std::vector<glm::uvec2> visible_columns(const Visible& visible, const XrFovf& fov, const glm::ivec2& size,
                                        int tile);

}  // namespace binosplat::xr
