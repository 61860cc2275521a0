#pragma once
// Runs programs that use OpenXR on the test runtime: the script that it plays, and its log
// (tests/xr/README.md).

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.h"

namespace binosplat::test {

using Json = nlohmann::ordered_json;

inline Json xr_pose(const std::array<double, 3>& position,
                    const std::array<double, 4>& orientation = {0, 0, 0, 1}) {
  return {{"position", position}, {"orientation", orientation}};
}

/// The runtime's log of a run.
struct XrLog {
  std::filesystem::path folder;
  std::vector<Json> lines;

  /// Returns the lines with this "what".
  std::vector<Json> all(const std::string& what) const {
    std::vector<Json> out;
    for (const Json& line : lines) {
      if (line["what"] == what) out.push_back(line);
    }
    return out;
  }

  std::vector<Json> frames() const { return all("frame"); }

  /// Returns "x" for each frame that showed something, and "-" for each other frame.
  std::string shown() const {
    std::string out;
    for (const Json& frame : frames()) out += frame["layers"].empty() ? '-' : 'x';
    return out;
  }

  /// Returns "FUNCTION: TEXT (RESULT)" for each fault; a correct program has none.
  std::vector<std::string> faults() const {
    std::vector<std::string> out;
    for (const Json& line : all("fault")) {
      out.push_back(line["function"].get<std::string>() + ": " + line["text"].get<std::string>() + " (" +
                    line["result"].get<std::string>() + ")");
    }
    return out;
  }

  /// Returns a view in the first layer of a frame's line.
  static const Json& view(const Json& frame, std::size_t index) {
    return frame.at("layers").at(0).at("views").at(index);
  }

  /// Returns the submitted pixels of a view: RGBA8, top row first.
  std::string colours(const Json& frame, std::size_t index) const {
    return read_text(folder / view(frame, index).at("colour").get<std::string>());
  }

  /// Returns the submitted depths of a view, from the texture, in 0..1.
  std::vector<float> depths(const Json& frame, std::size_t index) const {
    const std::string bytes =
        read_text(folder / view(frame, index).at("depth").at("file").get<std::string>());
    std::vector<float> out(bytes.size() / sizeof(float));
    std::memcpy(out.data(), bytes.data(), out.size() * sizeof(float));
    return out;
  }
};

/// A script, and the folder in which its runs write their logs.
class XrStage {
 public:
  Json script = Json::object();

  /// Returns the environment variables for a program's run (Surroundings::variables).
  std::map<std::string, std::string> variables() {
    script["folder"] = folder_.path().string();
    std::filesystem::remove(folder_ / "log.jsonl");  // the previous run's log
    const auto path = folder_ / "script.json";
    write_text(path, script.dump(1));
    return {{"XR_RUNTIME_JSON", BINOSPLAT_XR_RUNTIME}, {"BINOSPLAT_XR_SCRIPT", path.string()}};
  }

  /// The same under Khronos' validation, which writes its findings for validation().
  std::map<std::string, std::string> validated_variables() {
    auto out = variables();
    out["XR_API_LAYER_PATH"] = BINOSPLAT_XR_LAYERS ":/usr/share/openxr/1/api_layers/explicit.d";
    out["XR_ENABLE_API_LAYERS"] = "XR_APILAYER_binosplat_egl:XR_APILAYER_LUNARG_core_validation";
    out["XR_CORE_VALIDATION_EXPORT_TYPE"] = "text";
    out["XR_CORE_VALIDATION_FILE_NAME"] = (folder_ / "validation.txt").string();
    return out;
  }

  /// Returns the findings of the validation in a run, or "" if there are none. The layer creates its file at
  /// the first finding, but prints its presence at once. Newer layers also log their begin and end
  /// (VALID_DEBUG), which is left out.
  std::string validation(const Outcome& outcome) const {
    const bool there =
        (outcome.out + outcome.err).find("Core Validation output type: text") != std::string::npos;
    if (!there) return "the validation layer was not there";
    std::string found;
    std::istringstream said(read_text(folder_ / "validation.txt"));
    for (std::string line; std::getline(said, line);)
      if (line.find("VALID_DEBUG") == std::string::npos) found += line + "\n";
    return found;
  }

  void add_event(Json event) { script["events"].push_back(std::move(event)); }

  XrLog log() const {
    XrLog out = {folder_.path(), {}};
    std::ifstream in(folder_ / "log.jsonl");
    for (std::string line; std::getline(in, line);) out.lines.push_back(Json::parse(line));
    return out;
  }

  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

/// Returns a view for the script: its size in px, its angles (left, right, up, down) in radians, and its pose
/// relative to the head.
inline Json xr_view(int width, int height, const std::array<double, 4>& fov, const Json& pose) {
  Json view = pose;
  view["width"] = width;
  view["height"] = height;
  view["fov"] = fov;
  return view;
}

}  // namespace binosplat::test
