// JSON files other than models: cameras, the pose next to a model, a calibration, the axes of a measurement.

#include <cmath>
#include <nlohmann/json.hpp>

#include "adagscale/calibration_file.h"
#include "formats/cameras/cameras_file.h"
#include "formats/cameras/pose_file.h"
#include "formats/containers/content.h"
#include "fuzz/input.h"
#include "lab/suite.h"

namespace binosplat::fuzz {

namespace {

namespace fs = std::filesystem;

/// The guarantees of formats/cameras/cameras_file.h.
void check(const Camera& camera) {
  demand(camera.width >= 1 && camera.height >= 1, "a picture without pixels");
  demand(camera.fx > 0 && camera.fy > 0, "a focal length of 0");
  const glm::dvec3& p = camera.position;
  for (const double v : {camera.fx, camera.fy, camera.cx, camera.cy, p.x, p.y, p.z})
    demand(std::isfinite(v), "a value that is not finite");
  demand(!camera.time || std::isfinite(*camera.time), "a time that is not finite");
  demand(std::abs(glm::determinant(camera.rotation) - 1.0) < 2e-3, "a rotation that is none");
}

void check(const SavedPose& pose) {
  check(pose.camera);
  demand(glm::length(glm::normalize(pose.up)) > 0.0, "no way up");
  demand(pose.units_per_metre > 0.0 && pose.near_plane > 0.0 && pose.ipd >= 0.0, "a length below zero");
}

void check(const adagscale::ThresholdCalibration& calibration) {
  demand(calibration.width >= 1 && calibration.height >= 1 && calibration.focal > 0.0, "a view of nothing");
  demand(!calibration.depth_table.bounds.empty() && calibration.depth_table.far > 0.0f, "no table of depths");
  for (const adagscale::CalibrationEntry& entry : calibration.entries)
    demand(entry.tolerance >= 0.0 && std::isfinite(static_cast<float>(entry.tolerance)),
           "a tolerance that is none");
}

}  // namespace

void target(std::span<const std::byte> bytes) {
  feed(bytes, [](const fs::path& path) {
    const std::vector<Camera> cameras = load_cameras(path);
    demand(!cameras.empty(), "no cameras");
    for (const Camera& camera : cameras) check(camera);
  });
  // All readers refuse invalid JSON at the same place in the code, so the others need not see it.
  const std::string_view text = as_text(bytes);
  const nlohmann::json root = nlohmann::json::parse(text.begin(), text.end(), nullptr, false);
  if (root.is_array()) feed(bytes, [](const fs::path& path) { check(load_pose(path)); });
  if (!root.is_object()) return;
  feed(bytes, [](const fs::path& path) { check(adagscale::load_calibration(path)); });
  feed(bytes,
       [](const fs::path& path) { demand(!lab::load_suite(path.string()).settings.empty(), "no suite"); });
}

}  // namespace binosplat::fuzz
