#include "xr/runtime/script.h"

#include <GL/glcorearb.h>
#include <openxr/openxr_reflection.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <stdexcept>

namespace binosplat::xr_test {
namespace {

const std::map<std::string, std::int64_t> formats = {
    {"GL_SRGB8_ALPHA8", GL_SRGB8_ALPHA8},
    {"GL_RGBA8", GL_RGBA8},
    {"GL_RGBA16F", GL_RGBA16F},
    {"GL_RGB10_A2", GL_RGB10_A2},
    {"GL_RGBA16", GL_RGBA16},
    {"GL_SRGB8", GL_SRGB8},
    {"GL_DEPTH_COMPONENT16", GL_DEPTH_COMPONENT16},
    {"GL_DEPTH_COMPONENT24", GL_DEPTH_COMPONENT24},
    {"GL_DEPTH_COMPONENT32F", GL_DEPTH_COMPONENT32F},
};

const std::map<std::string, XrReferenceSpaceType> spaces = {
    {"view", XR_REFERENCE_SPACE_TYPE_VIEW},
    {"local", XR_REFERENCE_SPACE_TYPE_LOCAL},
    {"stage", XR_REFERENCE_SPACE_TYPE_STAGE},
    {"local_floor", XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST}};
const std::map<std::string, XrVisibilityMaskTypeKHR> mask_types = {
    {"hidden", XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR},
    {"visible", XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR}};
const std::map<std::string, XrViewStateFlags> flags = {
    {"orientation_valid", XR_VIEW_STATE_ORIENTATION_VALID_BIT},
    {"position_valid", XR_VIEW_STATE_POSITION_VALID_BIT},
    {"orientation_tracked", XR_VIEW_STATE_ORIENTATION_TRACKED_BIT},
    {"position_tracked", XR_VIEW_STATE_POSITION_TRACKED_BIT}};

template <typename T>
T one_of(const std::map<std::string, T>& choices, const std::string& name) {
  const auto found = choices.find(name);
  if (found != choices.end()) return found->second;
  std::string text;
  for (const auto& [choice, value] : choices) text += (text.empty() ? "" : ", ") + choice;
  throw std::runtime_error("'" + name + "' is none of " + text);
}

template <typename T>
std::vector<T> all_of(const std::map<std::string, T>& choices, const Json& names) {
  std::vector<T> out;
  for (const Json& name : names) out.push_back(one_of(choices, name.get<std::string>()));
  return out;
}

XrFovf fov_from(const Json& json) {
  const auto v = json.get<std::array<float, 4>>();
  return {v[0], v[1], v[2], v[3]};
}

XrVersion version_from(const Json& json) {
  const auto v = json.get<std::array<int, 2>>();
  return XR_MAKE_VERSION(v[0], v[1], 0);
}

ViewSpec eye(double side) {
  ViewSpec view;
  view.pose.position.x = side * 0.0315;
  if (side > 0.0) view.fov = {-0.646f, 0.855f, 0.7f, -0.7f};
  return view;
}

Script defaults() {
  Script script;
  for (const char* name : {XR_MNDX_EGL_ENABLE_EXTENSION_NAME, XR_KHR_OPENGL_ENABLE_EXTENSION_NAME,
                           XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME,
                           XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, XR_EXT_EYE_GAZE_INTERACTION_EXTENSION_NAME,
                           XR_VARJO_QUAD_VIEWS_EXTENSION_NAME, XR_LOCAL_FLOOR_NAME}) {
    script.extensions.insert(name);
  }
  script.formats = {GL_SRGB8_ALPHA8, GL_RGBA8, GL_RGBA16F, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24};
  script.views[XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO] = {eye(-1), eye(1)};
  return script;
}

using Setter = std::function<void(Script&, const Json&)>;

template <typename T>
Setter plain(T Script::*member) {
  return [member](Script& script, const Json& json) { script.*member = json.get<T>(); };
}

void set_views(Script& script, const Json& json) {
  script.views.clear();
  for (const auto& [name, views] : json.items()) {
    std::vector<ViewSpec>& out = script.views[configuration_from(name)];
    for (const Json& view : views) patch(out.emplace_back(eye(out.size() % 2 == 0 ? -1 : 1)), view);
  }
}

void set_masks(Script& script, const Json& json) {
  for (const auto& [name, masks] : json.items()) {
    for (const Json& mask : masks) script.masks[configuration_from(name)].push_back(mask_from(mask));
  }
}

void set_heads(Script& script, const Json& json) {
  script.heads.clear();
  for (const Json& head : json) script.heads.push_back(pose_from(head));
  if (script.heads.empty()) throw std::runtime_error("no pose of the head");
}

const std::map<std::string, Setter>& setters() {
  static const std::map<std::string, Setter> all = {
      {"folder", [](Script& s, const Json& j) { s.folder = j.get<std::string>(); }},
      {"extensions", plain(&Script::extensions)},
      {"gl_min", [](Script& s, const Json& j) { s.gl_min = version_from(j); }},
      {"gl_max", [](Script& s, const Json& j) { s.gl_max = version_from(j); }},
      {"formats", [](Script& s, const Json& j) { s.formats = all_of(formats, j); }},
      {"system", [](Script& s, const Json& j) { s.system = result_from(j.get<std::string>()); }},
      {"views", set_views},
      {"masks", set_masks},
      {"spaces", [](Script& s, const Json& j) { s.spaces = all_of(spaces, j); }},
      {"heads", set_heads},
      {"period", plain(&Script::period)},
      {"frames", plain(&Script::frames)},
      {"invisible_frames", plain(&Script::invisible_frames)},
      {"not_rendered", plain(&Script::not_rendered)},
      {"late", plain(&Script::late)},
      {"sleep", plain(&Script::sleep)},
      {"immutable", plain(&Script::immutable)},
      {"unordered_srgb", plain(&Script::unordered_srgb)},
      {"pixels", [](Script& s, const Json& j) { s.pixels = j.get<std::set<int>>(); }},
      {"flags", [](Script& s, const Json& j) { s.flags = flags_from(j); }},
      {"profile", plain(&Script::profile)},
      {"hands", plain(&Script::hands)},
      {"gaze", [](Script& s, const Json& j) { s.gaze = pose_from(j); }},
      {"events",
       [](Script& s, const Json& j) {
         s.events = {j.begin(), j.end()};
       }},
  };
  return all;
}

}  // namespace

Pose operator*(const Pose& a, const Pose& b) {
  return {a.position + a.orientation * b.position, a.orientation * b.orientation};
}

Pose inverse(const Pose& pose) {
  const glm::dquat back = glm::conjugate(pose.orientation);
  return {back * -pose.position, back};
}

XrPosef to_xr(const Pose& pose) {
  const glm::vec3 p(pose.position);
  const glm::quat q(pose.orientation);
  return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}

Pose from_xr(const XrPosef& pose) {
  const XrQuaternionf& q = pose.orientation;
  return {glm::dvec3(pose.position.x, pose.position.y, pose.position.z),
          glm::normalize(glm::dquat(q.w, q.x, q.y, q.z))};
}

Json to_json(const XrPosef& pose) {
  const XrQuaternionf& q = pose.orientation;
  return {{"position", {pose.position.x, pose.position.y, pose.position.z}},
          {"orientation", {q.x, q.y, q.z, q.w}}};
}

Json to_json(const XrFovf& fov) { return {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}; }

Pose pose_from(const Json& json) {
  Pose pose;
  if (json.contains("position")) {
    const auto p = json["position"].get<std::array<double, 3>>();
    pose.position = {p[0], p[1], p[2]};
  }
  if (json.contains("orientation")) {
    const auto q = json["orientation"].get<std::array<double, 4>>();
    pose.orientation = glm::normalize(glm::dquat(q[3], q[0], q[1], q[2]));
  }
  return pose;
}

void patch(ViewSpec& view, const Json& json) {
  if (json.contains("width")) view.width = json["width"];
  if (json.contains("height")) view.height = json["height"];
  if (json.contains("fov")) view.fov = fov_from(json["fov"]);
  if (json.contains("position") || json.contains("orientation")) view.pose = pose_from(json);
}

Mask mask_from(const Json& json) {
  Mask mask;
  for (const auto& [name, mesh] : json.items()) {
    Mesh& out = mask[one_of(mask_types, name)];
    for (const auto& v : mesh.at("vertices").get<std::vector<std::array<float, 2>>>()) {
      out.vertices.push_back({v[0], v[1]});
    }
    out.indices = mesh.at("indices").get<std::vector<std::uint32_t>>();
  }
  return mask;
}

XrViewConfigurationType configuration_from(const std::string& name) {
  static const std::map<std::string, XrViewConfigurationType> types = {
      {"stereo", XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO},
      {"quad", XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO}};
  return one_of(types, name);
}

std::string name_of(XrViewConfigurationType type) {
  return type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO ? "quad" : "stereo";
}

XrViewStateFlags flags_from(const Json& json) {
  XrViewStateFlags out = 0;
  for (const XrViewStateFlags flag : all_of(flags, json)) out |= flag;
  return out;
}

#define BINOSPLAT_NAME(name, value) \
  case name:                        \
    return #name;
#define BINOSPLAT_VALUE(name, value) {#name, name},

const char* name_of(XrResult result) {
  switch (result) {
    XR_LIST_ENUM_XrResult(BINOSPLAT_NAME);
    default:
      return "unknown";
  }
}

const char* name_of(XrStructureType type) {
  switch (type) {
    XR_LIST_ENUM_XrStructureType(BINOSPLAT_NAME);
    default:
      return "unknown";
  }
}

const char* name_of(XrSessionState state) {
  switch (state) {
    XR_LIST_ENUM_XrSessionState(BINOSPLAT_NAME);
    default:
      return "unknown";
  }
}

XrResult result_from(const std::string& name) {
  static const std::map<std::string, XrResult> all = {XR_LIST_ENUM_XrResult(BINOSPLAT_VALUE)};
  return one_of(all, name);
}

Script read_script() {
  Script script = defaults();
  const char* path = std::getenv("BINOSPLAT_XR_SCRIPT");
  if (path == nullptr) return script;
  std::ifstream in(path);
  const Json json = Json::parse(in);
  for (const auto& [key, value] : json.items()) {
    try {
      one_of(setters(), key)(script, value);
    } catch (const std::exception& error) {
      throw std::runtime_error(std::string(path) + ": " + key + ": " + error.what());
    }
  }
  return script;
}

}  // namespace binosplat::xr_test
