#include "formats/cameras/lichtfeld.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

#include "base/log.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/nerfstudio.h"
#include "formats/cameras/transforms.h"
#include "formats/containers/json_file.h"

namespace binosplat {

namespace {

constexpr double sensor_height_mm = 24.0;

Camera key_of(const std::filesystem::path& path, const JsonValue& key) {
  Camera camera;
  camera.width = pose_width;
  camera.height = pose_height;
  camera.fx = camera.fy = camera.height * key.at("focal_length_mm").above_zero() / sensor_height_mm;
  camera.cx = 0.5 * camera.width;
  camera.cy = 0.5 * camera.height;
  check_lens(path.string(), camera);
  camera.time = key.at("time").number();
  const glm::dvec4 q = key.at("rotation").vector<4>();  // w x y z
  if (!(glm::length(q) > 0.0)) key.at("rotation").fail_here("a rotation is a quaternion of length 0");
  const glm::dmat3 to_world(1, 0, 0, 0, -1, 0, 0, 0, -1);
  const glm::dvec4 unit = glm::normalize(q);
  place_as_opengl(camera, {to_world * glm::mat3_cast(glm::dquat(unit.x, unit.y, unit.z, unit.w)),
                           to_world * key.at("position").vector<3>()});
  return camera;
}

}  // namespace

bool is_lichtfeld_path(const nlohmann::json& root) {
  if (!root.is_object() || !root.contains("keyframes")) return false;
  const nlohmann::json& keys = root["keyframes"];
  return keys.is_array() && !keys.empty() && keys[0].is_object() && keys[0].contains("focal_length_mm");
}

std::vector<Camera> load_lichtfeld_path(const std::filesystem::path& path, const nlohmann::json& json) {
  const JsonValue root(path.string(), json);
  constexpr std::uint64_t newest = 4;
  if (root.has("version") && root.at("version").whole(1000) > newest)
    root.at("version").fail_here("paths of LichtFeld Studio up to version {} are known", newest);
  std::vector<Camera> cameras;
  bool eases = false;
  for (const JsonValue& key : root.at("keyframes").items()) {
    cameras.push_back(key_of(path, key));
    eases = eases || (key.has("easing") && key.at("easing").number() != 0.0);
  }
  std::ranges::stable_sort(cameras, {}, [](const Camera& camera) { return *camera.time; });
  const double start = *cameras[0].time;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    cameras[i].name = fmt::format("key_{:03}", i);
    *cameras[i].time -= start;
  }
  if (eases) log_info("{}: easing of its keys is ignored: the path is as smooth as from other files", path);
  if (root.has("animation_clip"))
    log_warning("{}: its animation_clip is ignored: only its keys move the camera", path);
  return cameras;
}

}  // namespace binosplat
