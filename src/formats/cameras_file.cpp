#include "formats/cameras_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/json_file.h"

namespace binosplat {

namespace {

using nlohmann::json;

constexpr double most_pixels = 2147483648.0;

/// One object of the list; every error names the file, the object's number and the key.
class CameraReader {
 public:
  CameraReader(const std::filesystem::path& path, std::size_t index, const json& object)
      : path_(path), index_(index), object_(object) {}

  Camera read() const {
    if (!object_.is_object())
      fail("{}, camera {} (counted from 0): expected an object", path_.string(), index_);
    Camera camera;
    if (!need("img_name").is_string()) fail_key("img_name", "expected a name in quotes");
    camera.name = need("img_name").get<std::string>();
    camera.width = size("width");
    camera.height = size("height");
    if (static_cast<double>(camera.width) * camera.height > most_pixels)
      fail_key("width", "the picture is too large");
    camera.fx = number(need("fx"), "fx");
    camera.fy = number(need("fy"), "fy");
    if (!(camera.fx > 0)) fail_key("fx", "expected a focal length above 0");
    if (!(camera.fy > 0)) fail_key("fy", "expected a focal length above 0");
    camera.cx = object_.contains("cx") ? number(object_["cx"], "cx") : camera.width / 2.0;
    camera.cy = object_.contains("cy") ? number(object_["cy"], "cy") : camera.height / 2.0;
    camera.position = vector(need("position"), "position");
    camera.rotation = rotation();
    if (object_.contains("time")) camera.time = number(object_["time"], "time");
    return camera;
  }

 private:
  [[noreturn]] void fail_key(const char* key, const std::string& text) const {
    fail("{}, camera {} (counted from 0), key '{}': {}", path_.string(), index_, key, text);
  }

  const json& need(const char* key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) fail_key(key, "is missing");
    return *found;
  }

  double number(const json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) fail_key(key, "expected a finite number");
    return value.get<double>();
  }

  int size(const char* key) const {
    const double value = number(need(key), key);
    if (!(value >= 1 && value <= std::numeric_limits<int>::max()) || value != std::floor(value)) {
      fail_key(key, fmt::format("{} is no number of pixels", value));
    }
    return static_cast<int>(value);
  }

  glm::dvec3 vector(const json& value, const char* key) const {
    if (!value.is_array() || value.size() != 3)
      fail_key(key, "expected three numbers, or three rows of three");
    return {number(value[0], key), number(value[1], key), number(value[2], key)};
  }

  glm::dmat3 rotation() const {
    const char* key = "rotation";
    const json& rows = need(key);
    if (!rows.is_array() || rows.size() != 3) fail_key(key, "expected three rows of three numbers");
    glm::dmat3 transposed;
    for (int i = 0; i < 3; ++i) transposed[i] = vector(rows[static_cast<std::size_t>(i)], key);
    const glm::dmat3 matrix = glm::transpose(transposed);
    const glm::dmat3 square = transposed * matrix;
    double largest = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(square[i][j] - (i == j ? 1.0 : 0.0)));
    }
    if (!(largest <= 1e-3)) {
      fail_key(key, fmt::format("the columns must be orthogonal and of length 1; they are off by {:.3g}",
                                largest));
    }
    if (glm::determinant(matrix) < 0)
      fail_key(key, "it mirrors (determinant -1); expected x right, y down, z forward");
    return matrix;
  }

  const std::filesystem::path& path_;
  std::size_t index_;
  const json& object_;
};

}  // namespace

std::vector<Camera> load_cameras(const std::filesystem::path& path) {
  const MappedFile file(path);
  const json root = parse_json(path.string(), as_text(file.bytes()));
  if (!root.is_array()) {
    fail("{}: expected a list of cameras as INRIA's cameras.json, but its root is of type {}", path.string(),
         root.type_name());
  }
  if (root.empty()) fail("{} holds no cameras", path.string());
  std::vector<Camera> cameras;
  std::set<std::string> names;
  for (const json& object : root) {
    cameras.push_back(CameraReader(path, cameras.size(), object).read());
    if (!names.insert(cameras.back().name).second) {
      log_warning("{}: the name '{}' occurs twice", path.string(), cameras.back().name);
    }
  }
  return cameras;
}

std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const bool is_folder = fs::is_directory(model, ignored);
  const fs::path folder = fs::absolute(is_folder ? model / "" : model).parent_path();
  std::vector<fs::path> candidates{folder / "cameras.json"};
  if (folder.filename().string().starts_with("iteration_")) {
    candidates.push_back(folder.parent_path().parent_path() / "cameras.json");
  }
  if (folder.filename() == "point_cloud") candidates.push_back(folder.parent_path() / "cameras.json");
  for (const fs::path& candidate : candidates) {
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return std::nullopt;
}

}  // namespace binosplat
