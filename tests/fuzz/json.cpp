// Cameras: load_cameras.

#include <cmath>

#include "formats/cameras_file.h"
#include "fuzz/input.h"

namespace binosplat::fuzz {

namespace {

/// What formats/cameras_file.h promises.
void check(const Camera& camera) {
  demand(camera.width >= 1 && camera.height >= 1, "a picture without pixels");
  demand(camera.fx > 0 && camera.fy > 0, "a focal length of 0");
  const glm::dvec3& p = camera.position;
  for (const double v : {camera.fx, camera.fy, camera.cx, camera.cy, p.x, p.y, p.z})
    demand(std::isfinite(v), "a value that is not finite");
  demand(!camera.time || std::isfinite(*camera.time), "a time that is not finite");
  demand(std::abs(glm::determinant(camera.rotation) - 1.0) < 2e-3, "a rotation that is none");
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  feed(bytes, [](const std::filesystem::path& path) {
    const std::vector<Camera> cameras = load_cameras(path);
    demand(!cameras.empty(), "no cameras");
    for (const Camera& camera : cameras) check(camera);
  });
}

}  // namespace binosplat::fuzz
