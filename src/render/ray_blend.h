#pragma once
// Blends along arbitrary rays, for pictures without a pinhole camera.

#include <memory>
#include <span>

#include "render/frame.h"

namespace binosplat::render {

/// Blends views exactly along rays that need not pass through pixel centres. With Order::distance and
/// Projection::tangent a ray's colour depends only on its origin and direction. So one picture can combine
/// several views.
class RayBlend {
 public:
  /// The model's context must be current in every call.
  explicit RayBlend(std::shared_ptr<GpuModel> model) : frame_(std::move(model)), dispatcher_(context()) {}

  /// Makes the lists of the views. Uses the settings that exact_of() keeps. Throws as Frame::draw() does.
  Report set_views(std::span<const shared::View> views, const FrameSettings& settings = {});

  /// Blends `count` rays (shared::PlacedRay) of view `v`. For each ray, writes at index PlacedRay::place: C
  /// and T to `colours` (vec4), and Z to `z_sums` (float; with Projection::tangent a sum of distances). Each
  /// ray must pass through the view's picture. Returns the GPU time in ms. Throws Error(out_of_memory) for
  /// lists that are too long for the driver.
  double blend(std::uint32_t v, const gl::Buffer& rays, std::uint32_t count, gl::Buffer& colours,
               gl::Buffer& z_sums);

  gl::Context& context() { return frame_.model()->context(); }

 private:
  Frame frame_;
  gl::Dispatcher dispatcher_;
};

}  // namespace binosplat::render
