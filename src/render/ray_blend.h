#pragma once
// Colours along any rays, for pictures that no pinhole takes.

#include <memory>
#include <span>

#include "render/frame.h"

namespace binosplat::render {

/// Exact blends of views along rays that need not meet centres of their pixels. With ORDER_DISTANCE and
/// PROJECTION_TANGENT a ray's colour depends on place and direction only, so that one picture may be put
/// together of several views.
class RayBlend {
 public:
  /// The model's context must be current in every call.
  explicit RayBlend(std::shared_ptr<GpuModel> model) : frame_(std::move(model)), dispatcher_(context()) {}

  /// Makes the lists of views. Uses the settings that exact_of() keeps. Throws as Frame::draw() does.
  FrameReport set_views(std::span<const shared::View> views, const FrameSettings& settings = {});

  /// Blends `count` rays (shared::PlacedRay) of view `v`, which must meet its picture: C and T as vec4, and
  /// the sum of depths as float (with PROJECTION_TANGENT of distances), to their places. Returns the GPU's
  /// time, ms. Throws Error(out_of_memory) for lists that are too long for the driver.
  double blend(std::uint32_t v, const gl::Buffer& rays, std::uint32_t count, gl::Buffer& colours,
               gl::Buffer& z_sums);

  gl::Context& context() { return frame_.model()->context(); }

 private:
  Frame frame_;
  gl::Dispatcher dispatcher_;
};

}  // namespace binosplat::render
