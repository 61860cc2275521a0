#include "stereo/panorama.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "base/error.h"
#include "stereo/rig.h"

namespace binosplat::stereo {

namespace {

// A face of the cube around the eye. Side faces are cut to the half in front of the eye. `low` and `high` are
// the corners in focal lengths from the middle of the uncut face.
struct Face {
  glm::dmat3 axes;  // columns: right, down, forward, in the eye's axes
  glm::dvec2 low, high;
};

const std::array<Face, panorama_faces> faces = {{
    {glm::dmat3(1.0), {-1, -1}, {1, 1}},
    {{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {-1, -1}, {0, 1}},
    {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0, -1}, {1, 1}},
    {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {-1, 0}, {1, 1}},
    {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {-1, -1}, {1, 0}},
}};

std::size_t face_of(const glm::dvec3& ray) {
  const double x = std::abs(ray.x), y = std::abs(ray.y);
  if (ray.z >= std::max(x, y)) return 0;
  if (x >= y) return ray.x > 0 ? 1 : 2;
  return ray.y < 0 ? 3 : 4;
}

// A pixel at the panorama's horizon covers the same angle as a pixel in the middle of a face.
double focal(int side) { return side / glm::pi<double>(); }

int face_pixels(int side, double low, double high) {
  return static_cast<int>(std::ceil((high - low) * focal(side)));
}

void add(const Report& face, Report& sum) {
  if (sum.stages.empty()) {
    sum = face;
    return;
  }
  sum.visible += face.visible;
  sum.pairs += face.pairs;
  sum.redraws += face.redraws;
  sum.gpu_ms += face.gpu_ms;
  sum.submit_ms += face.submit_ms;
  sum.gpu_bytes = face.gpu_bytes;
  for (std::size_t k = 0; k < sum.stages.size(); ++k) sum.stages[k].ms += face.stages[k].ms;
}

}  // namespace

glm::dvec3 panorama_ray(int side, int i, int j) {
  const double longitude = ((i + 0.5) / side - 0.5) * glm::pi<double>();
  const double latitude = (0.5 - (j + 0.5) / side) * glm::pi<double>();
  return {std::cos(latitude) * std::sin(longitude), -std::sin(latitude),
          std::cos(latitude) * std::cos(longitude)};
}

Camera panorama_face(int side, const Camera& eye, std::size_t nth) {
  const Face& face = faces[nth];
  Camera camera = eye;
  camera.rotation = eye.rotation * face.axes;
  camera.fx = camera.fy = focal(side);
  camera.width = face_pixels(side, face.low.x, face.high.x);
  camera.height = face_pixels(side, face.low.y, face.high.y);
  camera.cx = -face.low.x * camera.fx;
  camera.cy = -face.low.y * camera.fy;
  return camera;
}

Panorama::Panorama(std::shared_ptr<render::GpuModel> model, int side)
    : side_(side), blend_(std::move(model)) {
  if (side < 2 || side > max_panorama_side || side % 2 != 0)
    fail("a panorama of {0} x {0} px: expected an even number from 2 to {1}", side, max_panorama_side);
  std::array<std::vector<shared::PlacedRay>, faces.size()> rays;
  std::array<Camera, faces.size()> cameras;
  for (std::size_t nth = 0; nth < faces.size(); ++nth) cameras[nth] = panorama_face(side, {}, nth);
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const glm::dvec3 ray = panorama_ray(side, i, j);
      const std::size_t nth = face_of(ray);
      const Camera& camera = cameras[nth];
      const glm::dvec3 v = glm::transpose(faces[nth].axes) * ray;
      const glm::dvec2 at(camera.fx * v.x / v.z + camera.cx - 0.5, camera.fy * v.y / v.z + camera.cy - 0.5);
      rays[nth].push_back({glm::vec2(at), static_cast<std::uint32_t>(j * side + i), 0});
    }
  }
  for (const auto& of_face : rays) {
    rays_.push_back(std::make_unique<gl::Buffer>(blend_.context(), "rays of a panorama"));
    rays_.back()->upload(of_face);
    ray_counts_.push_back(static_cast<std::uint32_t>(of_face.size()));
  }
}

Report Panorama::draw(std::span<const Camera> eyes, double near_plane,
                      const render::FrameSettings& settings) {
  render::FrameSettings steady = settings;
  steady.order = Order::distance;
  steady.projection = Projection::tangent;
  eyes_ = eyes.size();
  for (std::size_t k = pixels_.size(); k < eyes_; ++k)
    pixels_.push_back(std::make_unique<Pixels>(blend_.context()));
  const std::int64_t count = std::int64_t{side_} * side_;
  Report report;
  double blend_ms = 0;
  for (std::size_t nth = 0; nth < faces.size(); ++nth) {
    std::vector<Camera> cameras;
    for (const Camera& eye : eyes) cameras.push_back(panorama_face(side_, eye, nth));
    add(blend_.set_views(views_of_head(cameras, near_plane), steady), report);
    for (std::uint32_t v = 0; v < eyes_; ++v) {
      Pixels& pixels = *pixels_[v];
      pixels.colours.reserve(count * 16);
      pixels.z_sums.reserve(count * 4);
      blend_ms += blend_.blend(v, *rays_[nth], ray_counts_[nth], pixels.colours, pixels.z_sums);
    }
  }
  report.stages.push_back({"blend", blend_ms});
  report.gpu_ms += blend_ms;
  return report;
}

std::vector<Picture> Panorama::read_pictures() const {
  std::vector<Picture> pictures;
  for (std::size_t k = 0; k < eyes_; ++k) {
    Picture& picture = pictures.emplace_back(side_, side_);
    picture.colour = pixels_[k]->colours.read<glm::vec4>(picture.colour.size());
    picture.z_sum = pixels_[k]->z_sums.read<float>(picture.z_sum.size());
  }
  return pictures;
}

}  // namespace binosplat::stereo
