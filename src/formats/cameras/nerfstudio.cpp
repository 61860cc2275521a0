#include "formats/cameras/nerfstudio.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "formats/cameras/distortion.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/transforms.h"
#include "formats/cameras/view_files.h"
#include "formats/pictures/image_file.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

/// Parses a list of 16 numbers, or a text that contains such a list.
std::vector<double> sixteen_numbers(const JsonValue& value) {
  if (!value.value().is_string()) return value.numbers(16);
  const nlohmann::json list = nlohmann::json::parse(value.text(), nullptr, false);
  const bool good = list.is_array() && list.size() == 16 &&
                    std::all_of(list.begin(), list.end(), [](const auto& one) { return one.is_number(); });
  if (!good) value.fail_here("expected a list of 16 numbers");
  return list.get<std::vector<double>>();
}

/// Sets a camera's pose from a camera-to-world matrix with OpenGL's axes: y up and z backwards. The matrix's
/// last row must be 0 0 0 1. For a keyframe, the position of these four numbers shows whether the numbers are
/// row-major or column-major. If both orders or neither fit, numbers in quotes are column-major.
void place(Camera& camera, const JsonValue& value, bool is_keyframe) {
  const std::vector<double> n = sixteen_numbers(value);
  const auto is_last = [&](std::size_t first, std::size_t step) {
    bool good = true;
    for (std::size_t k = 0; k < 4; ++k)
      good = good && std::abs(n[first + k * step] - (k == 3 ? 1.0 : 0.0)) < 1e-6;
    return good;
  };
  const bool rows = is_last(12, 1), columns = is_last(3, 4);
  const bool by_rows = is_keyframe && rows != columns ? rows : !value.value().is_string();
  if (!(by_rows ? rows : columns))
    value.fail_here("expected a camera-to-world matrix, row by row, the last of which is 0 0 0 1");
  const glm::dmat4 stored = glm::make_mat4(n.data()), matrix = by_rows ? glm::transpose(stored) : stored;
  glm::dmat3 axes(matrix);
  if (const std::string fault = make_rotation(value.source(), axes); !fault.empty())
    value.fail_here("{}", fault);
  place_as_opengl(camera, {axes, matrix[3]});
}

/// Returns the seconds between frames, if the path has them.
std::optional<double> seconds_a_frame(const JsonValue& root, std::size_t frames) {
  if (root.has("seconds")) return root.at("seconds").above_zero() / static_cast<double>(frames);
  if (root.has("fps")) return 1.0 / root.at("fps").above_zero();
  return std::nullopt;
}

/// Returns the seconds since the previous keyframe, if the path has them.
std::optional<double> transition(const JsonValue& root, const JsonValue& keyframe) {
  const bool overrides = keyframe.has("override_transition_enabled") &&
                         keyframe.at("override_transition_enabled").value() == true;
  if (overrides) return keyframe.at("override_transition_sec").above_zero();
  if (root.has("default_transition_sec")) return root.at("default_transition_sec").above_zero();
  return std::nullopt;
}

Camera frame_of(const fs::path& path, const JsonValue& root, const JsonValue& frame, bool is_keyframe) {
  Camera camera;
  camera.width = root.at("render_width").pixels();
  camera.height = root.at("render_height").pixels();
  const JsonValue fov = frame.at("fov");
  if (!(fov.number() > 0.0 && fov.number() < 180.0)) fov.fail_here("expected degrees between 0 and 180");
  set_vertical_fov(camera, fov.number());
  check_lens(path.string(), camera);
  place(camera, frame.at(is_keyframe ? "matrix" : "camera_to_world"), is_keyframe);
  return camera;
}

}  // namespace

bool is_camera_path(const nlohmann::json& root) {
  return root.is_object() && (root.contains("camera_path") || root.contains("keyframes"));
}

std::vector<Camera> load_camera_path(const fs::path& path, const nlohmann::json& json) {
  const JsonValue root(path.string(), json);
  const std::string fault = undrawable_lens([&](const char* key) { return root.find(key); });
  if (!fault.empty()) fail("{}, {}", path, fault);
  const bool by_keys =
      !root.has("camera_path") || (root.at("camera_path").size() == 0 && root.has("keyframes"));
  const JsonValue frames = root.at(by_keys ? "keyframes" : "camera_path");
  if (frames.size() == 0) frames.fail_here("no cameras: the list is empty");
  const std::optional<double> pace = by_keys ? std::nullopt : seconds_a_frame(root, frames.size());
  std::vector<Camera> cameras;
  std::optional<double> time = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JsonValue frame = frames.at(i);
    const std::optional<double> step = by_keys ? transition(root, frame) : pace;
    if (!step) time.reset();
    if (time) *time = by_keys ? *time + (i > 0 ? *step : 0.0) : static_cast<double>(i) * *step;
    Camera& camera = cameras.emplace_back(frame_of(path, root, frame, by_keys));
    camera.name = by_keys ? fmt::format("key_{:03}", i) : fmt::format("{:05}", i);
    camera.time = time;
  }
  return cameras;
}

bool is_pose_list(const nlohmann::json& root) {
  return root.is_array() && !root.empty() && root[0].is_object() && root[0].contains("transform");
}

std::vector<Camera> load_pose_list(const fs::path& path, const nlohmann::json& json, double fov_degrees) {
  const JsonValue root(path.string(), json);
  log_info(
      "{} has poses but no lenses: the vertical field of view is {:.4g} degrees (`fov`), and the size is "
      "that of the photos, or {} x {} px (`size`)",
      path, fov_degrees, pose_width, pose_height);
  std::vector<Camera> cameras(root.size());
  for (std::size_t i = 0; i < root.size(); ++i) cameras[i].name = root.at(i).at("file_path").text();
  set_short_names(cameras);
  for (std::size_t i = 0; i < root.size(); ++i) {
    const JsonValue value = root.at(i);
    Camera& camera = cameras[i];
    const auto photo = find_view_photo(path.parent_path(), camera);
    const glm::ivec2 size = photo ? picture_size(*photo) : glm::ivec2(pose_width, pose_height);
    camera.width = size.x;
    camera.height = size.y;
    set_vertical_fov(camera, fov_degrees);
    check_lens(fmt::format("{}: '{}'", path, camera.name), camera);
    place_as_opengl(camera, read_rows(value.at("transform"), true));
  }
  return cameras;
}

}  // namespace binosplat
