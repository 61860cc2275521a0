#include "formats/cameras/cameras_file.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/path_questions.h"
#include "base/text.h"
#include "formats/cameras/colmap.h"
#include "formats/cameras/distortion.h"
#include "formats/cameras/head_trace.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/lichtfeld.h"
#include "formats/cameras/nerfstudio.h"
#include "formats/cameras/ply_camera.h"
#include "formats/cameras/transforms.h"
#include "formats/cameras/view_files.h"
#include "formats/containers/opened_file.h"
#include "formats/models/gltf.h"
#include "formats/models/gltf_nodes.h"
#include "formats/models/model_file.h"
#include "scene/framing.h"

namespace binosplat {

namespace {

/// Reads one object of a cameras.json; every error names the file, the object's number and the key.
Camera read_camera(const std::string& file, const JsonValue& object) {
  const auto number = [&](const char* key, double otherwise) {
    return object.has(key) ? object.at(key).number() : otherwise;
  };
  Camera camera;
  // Trainers that make models from text, such as GaussianDreamer, count their pictures.
  const JsonValue name = object.at("img_name");
  camera.name = name.value().is_number_integer() ? name.value().dump() : name.text();
  camera.width = object.at("width").pixels();
  camera.height = object.at("height").pixels();
  camera.fx = object.at("fx").above_zero();
  camera.fy = object.at("fy").above_zero();
  camera.cx = number("cx", camera.width / 2.0);
  camera.cy = number("cy", camera.height / 2.0);
  check_lens(object.source(), camera);
  camera.position = object.at("position").vector<3>();
  const JsonValue rows = object.at("rotation").list_of(3);
  for (int i = 0; i < 3; ++i) camera.rotation[i] = rows.at(static_cast<std::size_t>(i)).vector<3>();
  camera.rotation = glm::transpose(camera.rotation);
  const std::string fault = make_rotation(file, camera.rotation);
  if (!fault.empty()) rows.fail_here("{}", fault);
  if (object.has("time")) camera.time = object.at("time").number();
  return camera;
}

std::vector<Camera> load_list(const std::filesystem::path& path, const nlohmann::json& root) {
  if (root.empty()) fail("{} holds no cameras", path);
  std::vector<Camera> cameras;
  LensReport lens_report(path.string());
  for (std::size_t i = 0; i < root.size(); ++i) {
    const std::string where = fmt::format("{}, camera {} (counted from 0)", path, i);
    const JsonValue object(where, root[i]);
    const KeyOf key = [&](const char* name) { return object.find(name); };
    if (const std::string fault = undrawable_lens(key); !fault.empty()) {
      lens_report.add_skipped(fmt::format("{}, {}", where, fault));
      continue;
    }
    cameras.push_back(read_camera(path.string(), object));
    lens_report.add(has_distortion(key));
  }
  lens_report.report();
  return cameras;
}

/// Returns the COLMAP reconstruction with most images of those in a folder: COLMAP numbers them in `sparse`.
std::optional<std::filesystem::path> largest_colmap(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::optional<std::filesystem::path> largest;
  std::uintmax_t most = 0, count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (!is_colmap(entry.path())) continue;
    ++count;
    const bool binary = is_there(entry.path() / "images.bin");
    const auto size =
        std::filesystem::file_size(entry.path() / (binary ? "images.bin" : "images.txt"), ignored);
    if (largest && (size < most || (size == most && entry.path() > *largest))) continue;
    most = size;
    largest = entry.path();
  }
  if (count > 1) log_info("{}: the largest of {} reconstructions (`cameras` for another)", *largest, count);
  return largest;
}

/// Returns the first existing source of cameras in a folder.
std::optional<std::filesystem::path> cameras_in(const std::filesystem::path& folder) {
  for (const char* name : {"cameras.json", "transforms.json", "transforms_train.json"}) {
    if (is_file(folder / name)) return folder / name;
  }
  if (is_colmap(folder)) return folder;
  for (const char* name : {"sparse", "colmap/sparse"}) {
    if (auto largest = largest_colmap(folder / name)) return largest;
    if (is_colmap(folder / name)) return folder / name;
  }
  return std::nullopt;
}

/// Returns whether a model's file has cameras itself. The reader of the model reports its faults.
bool has_own_cameras(const std::filesystem::path& model) {
  try {
    const OpenedFile file(model);
    if (file.content == Content::ply) return has_ply_camera(file.ply());
    return (file.content == Content::glb || lowered_ending(model) == ".gltf") &&
           !nodes_with("camera", GltfDocument(file).root()).empty();
  } catch (const Error&) {
    return false;
  }
}

std::vector<Camera> load_any(const std::filesystem::path& named, const std::optional<double>& fov_degrees) {
  const std::filesystem::path path = resolve_cameras(named);
  if (is_folder(path)) return load_colmap(path);
  const OpenedFile file(path);
  if (file.content == Content::ply) return {load_ply_camera(file)};
  if (file.content == Content::glb) return load_gltf_cameras(file);
  const std::string_view text = as_text(file.bytes());
  if (file.content == Content::text && is_head_trace(text)) return load_head_trace(path, text);
  const nlohmann::json& root = file.json();
  if (is_gltf(root)) return load_gltf_cameras(file);
  if (is_transforms(root)) return load_transforms(path, root);
  if (is_lichtfeld_path(root)) return load_lichtfeld_path(path, root);
  if (is_camera_path(root)) return load_camera_path(path, root);
  if (is_pose_list(root)) return load_pose_list(path, root, fov_degrees.value_or(default_fov_degrees));
  if (root.is_array()) return load_list(path, root);
  fail(
      "{}: expected a list as in INRIA's cameras.json, or an object with 'frames' (transforms.json), "
      "'camera_path' (nerfstudio) or 'keyframes' (LichtFeld Studio), but its root is of type {}",
      path, root.type_name());
}

/// Returns the ending before which a name gets its number, as in NAME_2.png: a picture's ending or an eye's.
std::string_view ending_of(std::string_view name) {
  for (const std::string_view ending : {".png", ".jpg", ".jpeg", "_left", "_right"}) {
    if (lowered(std::string(name)).ends_with(ending)) return name.substr(name.size() - ending.size());
  }
  return "";
}

/// Makes names unique: further cameras with the same name become NAME_2 and so on. INRIA's trainer gives
/// equal names to test and training views of NeRF's synthetic scenes.
void make_names_unique(const std::filesystem::path& path, std::vector<Camera>& cameras) {
  std::set<std::string> names, met;
  for (const Camera& camera : cameras) {
    // Names become file names and are printed on terminals.
    if (std::any_of(camera.name.begin(), camera.name.end(),
                    [](unsigned char c) { return std::iscntrl(c) != 0; }))
      fail("{}: the name {:?} has a control character; take it out", path, camera.name);
    names.insert(camera.name);
  }
  std::map<std::string, int> numbers;
  std::string renamed;
  for (Camera& camera : cameras) {
    if (met.insert(camera.name).second) continue;
    const std::string name = camera.name, ending(ending_of(name));
    const std::string_view stem = std::string_view(name).substr(0, name.size() - ending.size());
    int& number = numbers.try_emplace(name, 1).first->second;
    do {
      camera.name = fmt::format("{}_{}{}", stem, ++number, ending);
    } while (!names.insert(camera.name).second);
    if (renamed.empty()) renamed = fmt::format("the second '{}' is called '{}'", name, camera.name);
  }
  if (!renamed.empty())
    log_warning(
        "{}: {} of {} cameras repeat an earlier name and get numbers: {}. A photo with that name belongs to "
        "the first one",
        path, cameras.size() - met.size(), cameras.size(), renamed);
}

}  // namespace

std::filesystem::path resolve_cameras(const std::filesystem::path& path) {
  if (is_folder(path)) {
    if (const auto found = cameras_in(path)) return *found;
    if (const auto found = largest_colmap(path)) return *found;
    fail(
        "{} is a folder without cameras.json, transforms.json or a COLMAP reconstruction (cameras.bin and "
        "images.bin, or .txt)",
        path);
  }
  const std::string stem = path.stem().string();
  const bool of_colmap =
      (stem == "images" || stem == "cameras") && path.extension() != ".json" && is_colmap(path.parent_path());
  return of_colmap ? path.parent_path() : path;
}

std::vector<Camera> load_cameras(const std::filesystem::path& path,
                                 const std::optional<double>& fov_degrees) {
  const WarningsOnce once;
  std::vector<Camera> cameras = load_any(path, fov_degrees);
  make_names_unique(path, cameras);
  set_short_names(cameras);
  return cameras;
}

bool lacks_lenses(const std::filesystem::path& path) {
  const std::filesystem::path file = resolve_cameras(path);
  if (lowered_ending(file) != ".json") return false;
  const OpenedFile opened(file);
  return opened.content != Content::text && is_pose_list(opened.json());
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
  const fs::path path = fs::absolute(model);
  const std::vector<fs::path> models = is_folder(path) ? models_in(path) : std::vector{path};
  if (models.size() == 1 && has_own_cameras(models[0])) return models[0];
  const fs::path folder = is_folder(path) ? path : path.parent_path();
  if (auto found = cameras_in(folder)) return found;
  if (folder.filename() == "point_cloud") return cameras_in(folder.parent_path());
  if (!folder.filename().string().starts_with("iteration_")) return std::nullopt;
  return cameras_in(folder.parent_path().parent_path());
}

std::optional<std::filesystem::path> find_photos(const std::filesystem::path& cameras) {
  namespace fs = std::filesystem;
  const fs::path path = fs::absolute(cameras).lexically_normal();
  fs::path folder = is_folder(path) ? path : path.parent_path();
  // The names in a transforms.json are relative to its folder.
  if (path.filename().string().starts_with("transforms")) return folder;
  // A reconstruction's folder is up to three levels below the scene's.
  const int levels = is_colmap(folder) ? 4 : 1;
  for (int up = 0; up < levels; ++up, folder = folder.parent_path()) {
    for (const char* name : {"images", "photos"}) {
      if (is_folder(folder / name)) return folder / name;
    }
  }
  return std::nullopt;
}

TestSplit test_split(const std::string& source, std::span<const Camera> cameras,
                     const std::optional<int>& every) {
  std::vector<std::string> names;
  for (const Camera& camera : cameras) names.push_back(camera.name);
  const auto others = std::is_sorted_until(names.begin(), names.end());
  if (!every && source.ends_with(".json") && others != names.end() && std::is_sorted(others, names.end()) &&
      2 * (others - names.begin()) <= names.end() - others) {
    return {{names.begin(), others},
            {others, names.end()},
            fmt::format("the {} that {} lists first", others - names.begin(), source)};
  }
  std::sort(names.begin(), names.end());
  const auto step = static_cast<std::size_t>(every.value_or(8));
  TestSplit split{{}, {}, fmt::format("one in {} of {} views, by the order of names", step, names.size())};
  for (std::size_t k = 0; k < names.size(); ++k)
    (k % step == 0 ? split.test : split.training).push_back(names[k]);
  return split;
}

}  // namespace binosplat
