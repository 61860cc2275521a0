#include "preview/camera_key_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "base/inputs.h"
#include "base/log.h"
#include "base/output_file.h"
#include "formats/cameras/cameras_file.h"

namespace binosplat::preview {

namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The names distinguish keys from the cameras of a data set.
std::string name_of_key(std::size_t k) { return fmt::format("key_{:03}", k); }

bool are_ours(const std::vector<Camera>& cameras) {
  return std::all_of(cameras.begin(), cameras.end(),
                     [](const Camera& c) { return c.name.starts_with("key_") && c.time; });
}

std::string text_of(const std::vector<Camera>& keys) {
  nlohmann::ordered_json list = nlohmann::json::array();
  for (const Camera& key : keys) list.push_back(camera_json(key));
  return list.dump(2) + "\n";
}

}  // namespace

KeyList::KeyList(const fs::path& folder) : file_(folder / "cameras.json") {
  if (!fs::exists(file_)) return;
  try {
    check_no_input(file_);
    std::vector<Camera> found = load_cameras(file_);
    if (!are_ours(found)) return;
    keys_ = std::move(found);
    written_ = contents(file_);
    log_info("{}: {} key{} of a path", file_.string(), keys_.size(), keys_.size() == 1 ? "" : "s");
  } catch (const Error&) {
    // The file holds no keys; set() chooses another name.
  }
}

void KeyList::add(Camera camera) {
  std::vector<Camera> keys = keys_;
  camera.time = keys.empty() ? 0.0 : *keys.back().time + key_seconds;
  keys.push_back(std::move(camera));
  set(std::move(keys));
}

void KeyList::replace(std::size_t k, Camera camera) {
  std::vector<Camera> keys = keys_;
  camera.time = keys.at(k).time;
  keys[k] = std::move(camera);
  set(std::move(keys));
}

void KeyList::remove(std::size_t k) {
  std::vector<Camera> keys = keys_;
  keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(k));
  set(std::move(keys));
}

void KeyList::set(std::vector<Camera> keys) {
  const double began = keys.empty() ? 0.0 : *keys[0].time;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    keys[k].name = name_of_key(k);
    *keys[k].time -= began;
  }
  const bool changed_by_others = fs::exists(file_) && contents(file_) != written_;
  const fs::path to = changed_by_others ? free_name(file_.parent_path(), "cameras", ".json") : file_;
  const std::string text = keys.empty() ? "" : text_of(keys);
  if (keys.empty()) {
    std::error_code gone;
    if (!changed_by_others) fs::remove(to, gone);
  } else {
    write_file(to, text);
  }
  file_ = to;
  written_ = text;
  keys_ = std::move(keys);
}

fs::path free_name(const fs::path& folder, const std::string& name, const std::string& ending) {
  for (int n = 1;; ++n) {
    auto path = folder / fmt::format("{}_{:03}{}", name, n, ending);
    if (!fs::exists(path)) return path;
  }
}

}  // namespace binosplat::preview
