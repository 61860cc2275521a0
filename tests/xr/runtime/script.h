#pragma once
// What the test runtime is to play: the JSON file that $BINOSPLAT_XR_SCRIPT names (tests/xr/README.md).

#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "xr/runtime/openxr.h"

namespace binosplat::xr_test {

using Json = nlohmann::ordered_json;

struct Pose {
  glm::dvec3 position{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
};

/// b, which is given in a's space, in the space that a is given in.
Pose operator*(const Pose& a, const Pose& b);
Pose inverse(const Pose& pose);
XrPosef to_xr(const Pose& pose);
Pose from_xr(const XrPosef& pose);

Json to_json(const XrPosef& pose);
Json to_json(const XrFovf& fov);
Pose pose_from(const Json& json);

struct ViewSpec {
  std::uint32_t width = 96, height = 80, max_width = 4096, max_height = 4096;
  XrFovf fov = {-0.855f, 0.646f, 0.7f, -0.7f};
  Pose pose;  // of the eye in the head
};

struct Mesh {
  std::vector<XrVector2f> vertices;
  std::vector<std::uint32_t> indices;
};
using Mask = std::map<XrVisibilityMaskTypeKHR, Mesh>;

struct Script {
  std::filesystem::path folder;  // empty: nothing is written
  std::set<std::string> extensions;
  XrVersion gl_min = XR_MAKE_VERSION(4, 3, 0), gl_max = XR_MAKE_VERSION(4, 6, 0);
  std::vector<std::int64_t> formats;
  XrResult system = XR_SUCCESS;  // of xrGetSystem
  std::map<XrViewConfigurationType, std::vector<ViewSpec>> views;
  std::map<XrViewConfigurationType, std::vector<Mask>> masks;
  std::vector<XrReferenceSpaceType> spaces = {XR_REFERENCE_SPACE_TYPE_VIEW, XR_REFERENCE_SPACE_TYPE_LOCAL,
                                              XR_REFERENCE_SPACE_TYPE_STAGE,
                                              XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST};
  // Poses are given in a world of the script's own.
  Pose stage, local = {.position = {0.0, 1.6, 0.0}};
  std::vector<Pose> heads = {{.position = {0.0, 1.6, 0.0}}};  // by frame; the last one stays
  XrTime first_time = 1'000'000'000;
  XrDuration period = 11'111'111;       // ns
  int frames = 3;                       // that are ended before the runtime asks to stop
  int invisible_frames = 0;             // at the beginning
  std::set<int> not_rendered;           // frames whose shouldRender is false
  std::set<int> late;                   // frames that are shown a period later, as are all after them
  bool sleep = false;                   // for a period in each xrWaitFrame
  bool immutable = true;                // textures made by glTextureStorage*
  bool unordered_srgb = true;           // unordered access to sRGB
  std::optional<std::set<int>> pixels;  // frames whose pixels are kept; none: all
  XrViewStateFlags flags = 15;
  std::string profile = "/interaction_profiles/khr/simple_controller";
  std::set<std::string> hands = {"left", "right"};
  std::optional<Pose> gaze;  // in the head
  std::vector<Json> events;  // each with "frame"

  bool keeps_pixels(int frame) const { return !folder.empty() && (!pixels || pixels->count(frame)); }
};

/// The script of $BINOSPLAT_XR_SCRIPT, or the defaults without it. Throws std::exception for one that is
/// none.
Script read_script();

/// Overwrites what `json` names of a view.
void patch(ViewSpec& view, const Json& json);
Mask mask_from(const Json& json);
XrViewConfigurationType configuration_from(const std::string& name);
std::string name_of(XrViewConfigurationType type);
XrViewStateFlags flags_from(const Json& json);
XrResult result_from(const std::string& name);
const char* name_of(XrResult result);
const char* name_of(XrStructureType type);
const char* name_of(XrSessionState state);

}  // namespace binosplat::xr_test
