#pragma once
// The images that xr/client.cpp paints, and what it asks about lenses.

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include <array>
#include <cstdio>
#include <vector>

#include "xr/client_calls.h"

namespace binosplat::xr_test {

/// A swapchain and what is held of it.
struct Chain {
  XrSwapchain handle = XR_NULL_HANDLE;
  std::vector<XrSwapchainImageOpenGLKHR> images;
  std::uint32_t index = 0;
  int width = 0, height = 0;
};

inline GLenum depth_format() { return has("depth24") ? GL_DEPTH_COMPONENT24 : GL_DEPTH_COMPONENT32F; }

/// The upper half in one colour, the lower half in another: both tell eye and frame.
inline void paint(const Chain& chain, std::size_t view, bool depth, int frame) {
  const bool turned = has("upside_down");
  for (int half = 0; half < 2; ++half) {
    const bool upper = (half == 1) != turned;
    const GLuint image = chain.images[chain.index].image;
    const int y = half * chain.height / 2, rows = chain.height - chain.height / 2;
    if (depth) {
      const float value = (upper ? 0.5f : 0.25f) + static_cast<float>(view) / 16;
      glClearTexSubImage(image, 0, 0, y, 0, chain.width, rows, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &value);
    } else {
      const std::array<GLubyte, 4> value = {static_cast<GLubyte>(upper ? 200 : 100),
                                            static_cast<GLubyte>(10 * view), static_cast<GLubyte>(frame),
                                            255};
      glClearTexSubImage(image, 0, 0, y, 0, chain.width, rows, 1, GL_RGBA, GL_UNSIGNED_BYTE, value.data());
    }
  }
}

/// How much of a view the lens hides.
inline void say_mask(XrSession session, XrViewConfigurationType type, std::uint32_t view, int frame) {
  PFN_xrGetVisibilityMaskKHR get_mask = nullptr;
  XR(xrGetInstanceProcAddr, instance, "xrGetVisibilityMaskKHR",
     reinterpret_cast<PFN_xrVoidFunction*>(&get_mask));
  if (get_mask == nullptr) return;
  const auto hidden = XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR;
  XrVisibilityMaskKHR mask = {XR_TYPE_VISIBILITY_MASK_KHR};
  say("mask", get_mask(session, type, view, hidden, &mask));
  std::vector<XrVector2f> vertices(mask.vertexCountOutput);
  std::vector<std::uint32_t> indices(mask.indexCountOutput);
  mask.vertexCapacityInput = mask.vertexCountOutput;
  mask.indexCapacityInput = has("small_mask") ? 1 : mask.indexCountOutput;
  mask.vertices = vertices.data();
  mask.indices = indices.data();
  say("mask", get_mask(session, type, view, hidden, &mask));
  std::printf("%d mask %u: %zu triangles", frame, view, indices.size() / 3);
  for (const XrVector2f& v : vertices) std::printf(" %g,%g", v.x, v.y);
  std::printf("\n");
}

}  // namespace binosplat::xr_test
