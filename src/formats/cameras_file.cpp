#include "formats/cameras_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "formats/colmap.h"
#include "formats/content.h"
#include "formats/distortion.h"
#include "formats/json_file.h"
#include "formats/lens.h"
#include "formats/lichtfeld.h"
#include "formats/model_file.h"
#include "formats/nerfstudio.h"
#include "formats/ply_camera.h"
#include "formats/transforms.h"
#include "scene/framing.h"

namespace binosplat {

namespace {

constexpr double most_pixels = 2147483648.0;

/// One object of the list; every error names the file, the object's number and the key.
class CameraReader {
 public:
  CameraReader(const std::filesystem::path& path, std::size_t index, const nlohmann::json& object)
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

  const nlohmann::json& need(const char* key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) fail_key(key, "is missing");
    return *found;
  }

  double number(const nlohmann::json& value, const char* key) const {
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

  glm::dvec3 vector(const nlohmann::json& value, const char* key) const {
    if (!value.is_array() || value.size() != 3)
      fail_key(key, "expected three numbers, or three rows of three");
    return {number(value[0], key), number(value[1], key), number(value[2], key)};
  }

  glm::dmat3 rotation() const {
    const char* key = "rotation";
    const nlohmann::json& rows = need(key);
    if (!rows.is_array() || rows.size() != 3) fail_key(key, "expected three rows of three numbers");
    glm::dmat3 transposed;
    for (int i = 0; i < 3; ++i) transposed[i] = vector(rows[static_cast<std::size_t>(i)], key);
    const glm::dmat3 matrix = glm::transpose(transposed);
    if (const std::string fault = rotation_fault(matrix); !fault.empty()) fail_key(key, fault);
    return matrix;
  }

  const std::filesystem::path& path_;
  std::size_t index_;
  const nlohmann::json& object_;
};

/// INRIA's cameras.json.
std::vector<Camera> load_list(const std::filesystem::path& path, const nlohmann::json& root) {
  if (root.empty()) fail("{} holds no cameras", path.string());
  std::vector<Camera> cameras;
  DrawnLenses drawn(path.string());
  for (std::size_t i = 0; i < root.size(); ++i) {
    const std::string where = fmt::format("{}, camera {} (counted from 0)", path.string(), i);
    const JsonValue object(where, root[i]);
    const KeyOf key = [&](const char* name) {
      return object.has(name) ? std::optional(object.at(name)) : std::nullopt;
    };
    if (const std::string fault = undrawable_lens(key); !fault.empty()) {
      drawn.leave_out(fmt::format("{}, {}", where, fault));
      continue;
    }
    cameras.push_back(CameraReader(path, i, root[i]).read());
    drawn.add(cameras.back(), read_distortion(key));
  }
  drawn.finish();
  return cameras;
}

/// Where cameras may lie in a folder; the first that is there is taken.
std::optional<std::filesystem::path> cameras_in(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {"cameras.json", "transforms.json", "transforms_train.json"}) {
    if (std::filesystem::is_regular_file(folder / name, ignored)) return folder / name;
  }
  for (const char* name : {"", "sparse/0", "sparse", "colmap/sparse/0"}) {
    if (is_colmap(folder / name)) return *name == '\0' ? folder : folder / name;
  }
  return std::nullopt;
}

std::vector<Camera> load_any(const std::filesystem::path& named, const std::optional<double>& fov_degrees) {
  std::error_code ignored;
  const std::filesystem::path path = resolve_cameras(named);
  if (std::filesystem::is_directory(path, ignored)) return load_colmap(path);
  const MappedFile file(path);
  if (content_of(file.bytes()) == Content::ply) return {load_ply_camera(path, file.bytes())};
  const nlohmann::json root = parse_json(path.string(), as_text(file.bytes()));
  if (is_transforms(root)) return load_transforms(path, root);
  if (is_lichtfeld_path(root)) return load_lichtfeld_path(path, root);
  if (is_camera_path(root)) return load_camera_path(path, root);
  if (is_pose_list(root)) return load_pose_list(path, root, fov_degrees.value_or(default_fov_degrees));
  if (root.is_array()) return load_list(path, root);
  fail(
      "{}: expected a list of cameras as INRIA's cameras.json, or an object with 'frames' as transforms.json "
      "or 'camera_path' as nerfstudio's paths or 'keyframes' as LichtFeld Studio's, but its root is of type "
      "{}",
      path.string(), root.type_name());
}

void check_names(const std::filesystem::path& path, const std::vector<Camera>& cameras) {
  std::set<std::string> names;
  for (const Camera& camera : cameras) {
    // They become names of files, and stand on terminals.
    if (std::any_of(camera.name.begin(), camera.name.end(),
                    [](unsigned char c) { return std::iscntrl(c) != 0; }))
      fail("{}: the name {:?} has a control character; take it out", path.string(), camera.name);
    if (!names.insert(camera.name).second)
      fail(
          "{}: two cameras are called '{}': photos and pictures are told apart by names, so give each its "
          "own",
          path.string(), camera.name);
  }
}

}  // namespace

std::filesystem::path resolve_cameras(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    if (const auto found = cameras_in(path)) return *found;
    fail(
        "{} is a folder without cameras.json, transforms.json or a COLMAP reconstruction (cameras.bin and "
        "images.bin, or .txt)",
        path.string());
  }
  const std::string stem = path.stem().string();
  const bool of_colmap =
      (stem == "images" || stem == "cameras") && path.extension() != ".json" && is_colmap(path.parent_path());
  return of_colmap ? path.parent_path() : path;
}

std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const std::optional<double>& fov_degrees) {
  std::vector<Camera> cameras = load_any(path, fov_degrees);
  check_names(path, cameras);
  return cameras;
}

bool lacks_lenses(const std::filesystem::path& path) {
  const std::filesystem::path file = resolve_cameras(path);
  if (lowered_ending(file) != ".json") return false;
  const MappedFile mapped(file);
  return is_pose_list(parse_json(file.string(), as_text(mapped.bytes())));
}

void fail_no_camera(const std::string& asked, const std::string& source, std::span<const Camera> cameras) {
  constexpr std::size_t shown = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(shown, cameras.size()); ++i) names += "\n  " + cameras[i].name;
  if (cameras.size() > shown) names += fmt::format("\n  and {} more", cameras.size() - shown);
  fail("{}: {} has no camera of this name. It has:{}", asked, source, names);
}

nlohmann::ordered_json camera_json(const Camera& camera) {
  nlohmann::ordered_json rotation = nlohmann::json::array();
  for (int row = 0; row < 3; ++row)
    rotation.push_back({camera.rotation[0][row], camera.rotation[1][row], camera.rotation[2][row]});
  return {{"img_name", camera.name}, {"width", camera.width},
          {"height", camera.height}, {"position", {camera.position.x, camera.position.y, camera.position.z}},
          {"rotation", rotation},    {"fx", camera.fx},
          {"fy", camera.fy},         {"cx", camera.cx},
          {"cy", camera.cy},         {"time", camera.time.value_or(0.0)}};
}

std::optional<std::filesystem::path> find_cameras(const std::filesystem::path& model) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path path = fs::absolute(model);
  const bool is_folder = fs::is_directory(path, ignored);
  const std::vector<fs::path> models = is_folder ? models_in(path) : std::vector{path};
  if (models.size() == 1 && has_ply_camera(models[0])) return models[0];
  const fs::path folder = is_folder ? path : path.parent_path();
  if (auto found = cameras_in(folder)) return found;
  if (folder.filename() == "point_cloud") return cameras_in(folder.parent_path());
  if (!folder.filename().string().starts_with("iteration_")) return std::nullopt;
  return cameras_in(folder.parent_path().parent_path());
}

std::optional<std::filesystem::path> find_photos(const std::filesystem::path& cameras) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path path = fs::absolute(cameras).lexically_normal();
  fs::path folder = fs::is_directory(path, ignored) ? path : path.parent_path();
  // The names in such files are relative to their own folder.
  if (path.filename().string().starts_with("transforms")) return folder;
  // A reconstruction's folder lies in the scene's, up to three levels deep.
  const int levels = is_colmap(folder) ? 4 : 1;
  for (int up = 0; up < levels; ++up, folder = folder.parent_path()) {
    for (const char* name : {"images", "photos"}) {
      if (fs::is_directory(folder / name, ignored)) return folder / name;
    }
  }
  return std::nullopt;
}

}  // namespace binosplat
