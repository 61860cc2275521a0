#pragma once
// An eye's VR180 picture: the hemisphere in front of the eye as an equirectangular picture, in which each
// pixel has its own ray.

#include <memory>
#include <span>
#include <vector>

#include "base/image.h"
#include "gl/buffer.h"
#include "render/ray_blend.h"
#include "scene/camera.h"

namespace binosplat::stereo {

/// Maximum side of a panorama, px: more than any player shows.
constexpr int max_panorama_side = 8192;

/// The direction of pixel (i, j) of a panorama, `side` px wide and high, in the eye's axes (x right, y down,
/// z forward): longitude grows with i from -90 to 90 degrees, and latitude falls with j from 90 to -90.
glm::dvec3 panorama_ray(int side, int i, int j);

/// The pinhole views that together contain all rays of an eye: ahead, right, left, up, down.
constexpr std::size_t panorama_faces = 5;
Camera panorama_face(int side, const Camera& eye, std::size_t nth);

class Panorama {
 public:
  /// The model's context must be current in every call. Throws Error for a side that is odd, below 2 or above
  /// max_panorama_side.
  Panorama(std::shared_ptr<render::GpuModel> model, int side);

  /// Draws the panoramas of one or two eyes. Uses the positions and rotations of their cameras, and ignores
  /// the lenses. Uses the settings that exact_of() keeps, but always the tangent projection and the order by
  /// distance from the point between the eyes. `near_plane` is a distance in world units. The report sums the
  /// five pinhole views. Throws as render::RayBlend does.
  Report draw(std::span<const Camera> eyes, double near_plane, const render::FrameSettings& settings = {});

  /// The panoramas of the last draw(), by eye; z_sum holds distances instead of depths.
  std::vector<Picture> read_pictures() const;

 private:
  struct Pixels {
    explicit Pixels(gl::Context& context) : colours(context, "panorama"), z_sums(context, "its distances") {}
    gl::Buffer colours;  // vec4
    gl::Buffer z_sums;   // float
  };

  int side_;
  render::RayBlend blend_;
  std::vector<std::unique_ptr<gl::Buffer>> rays_;  // PlacedRay, by face
  std::vector<std::uint32_t> ray_counts_;
  std::vector<std::unique_ptr<Pixels>> pixels_;  // by eye
  std::size_t eyes_ = 0;                         // number of eyes in the last draw()
};

}  // namespace binosplat::stereo
