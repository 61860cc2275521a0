// An OpenXR 1.0 runtime without a headset, which Khronos' loader loads. It plays a script, refuses what the
// specification refuses, and logs its input (tests/xr/README.md). It has one session at a time and one
// thread.

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#include <openxr/openxr_reflection.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "xr/bindings.h"

extern "C" {  // of libGLX
Display* glXGetCurrentDisplay();
GLXContext glXGetCurrentContext();
GLXDrawable glXGetCurrentDrawable();
}

namespace binosplat::xr_test {
namespace {

using Json = nlohmann::ordered_json;
using Strings = std::vector<std::string>;

// Debian's headers lack this.
constexpr auto local_floor = static_cast<XrReferenceSpaceType>(1000426000);
constexpr XrSystemId the_system = 0x5e7;
constexpr XrTime first_time = 1'000'000'000;
constexpr int patience = 100;  // frames after the script's: a program that does not stop must not hang

#define VALUE_OF(name, value) {#name, name},
const std::map<std::string, XrResult> results = {XR_LIST_ENUM_XrResult(VALUE_OF)};
const std::map<std::string, XrSessionState> states = {XR_LIST_ENUM_XrSessionState(VALUE_OF)};
const std::map<std::string, XrObjectType> kinds = {XR_LIST_ENUM_XrObjectType(VALUE_OF)};
const std::map<std::string, std::int64_t> formats = {{"GL_SRGB8_ALPHA8", GL_SRGB8_ALPHA8},
                                                     {"GL_RGBA8", GL_RGBA8},
                                                     {"GL_DEPTH_COMPONENT24", GL_DEPTH_COMPONENT24},
                                                     {"GL_DEPTH_COMPONENT32F", GL_DEPTH_COMPONENT32F}};
const std::map<std::string, XrEnvironmentBlendMode> blend_modes = {
    {"OPAQUE", XR_ENVIRONMENT_BLEND_MODE_OPAQUE},
    {"ADDITIVE", XR_ENVIRONMENT_BLEND_MODE_ADDITIVE},
    {"ALPHA_BLEND", XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND}};
const std::map<std::string, XrReferenceSpaceType> space_types = {{"local", XR_REFERENCE_SPACE_TYPE_LOCAL},
                                                                 {"stage", XR_REFERENCE_SPACE_TYPE_STAGE},
                                                                 {"local_floor", local_floor}};

template <typename Value>
std::string name_of(const std::map<std::string, Value>& values, Value value) {
  for (const auto& [name, one] : values) {
    if (one == value) return name;
  }
  return "unknown";
}

template <typename Handle>
constexpr XrObjectType kind_of = XR_OBJECT_TYPE_UNKNOWN;  // for types that are no handles
template <>
constexpr XrObjectType kind_of<XrInstance> = XR_OBJECT_TYPE_INSTANCE;
template <>
constexpr XrObjectType kind_of<XrSession> = XR_OBJECT_TYPE_SESSION;
template <>
constexpr XrObjectType kind_of<XrSpace> = XR_OBJECT_TYPE_SPACE;
template <>
constexpr XrObjectType kind_of<XrSwapchain> = XR_OBJECT_TYPE_SWAPCHAIN;
template <>
constexpr XrObjectType kind_of<XrActionSet> = XR_OBJECT_TYPE_ACTION_SET;
template <>
constexpr XrObjectType kind_of<XrAction> = XR_OBJECT_TYPE_ACTION;

/// Returns the pose as the matrix from its own space to the space in which it is given.
glm::dmat4 pose_from(const Json& json) {
  const auto p = json.value("position", std::array{0.0, 0.0, 0.0});
  const auto q = json.value("orientation", std::array{0.0, 0.0, 0.0, 1.0});
  return glm::translate(glm::dmat4(1.0), glm::dvec3(p[0], p[1], p[2])) *
         glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
}

XrPosef to_xr(const glm::dmat4& pose) {
  const glm::vec3 p(pose[3]);
  const glm::quat q(glm::quat_cast(glm::dmat3(pose)));
  return {{q.x, q.y, q.z, q.w}, {p.x, p.y, p.z}};
}

Json to_json(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return {{"position", {p.x, p.y, p.z}}, {"orientation", {q.x, q.y, q.z, q.w}}};
}

Json to_json(const XrFovf& fov) { return {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}; }

Json to_json(const XrRect2Di& rect) {
  return {rect.offset.x, rect.offset.y, rect.extent.width, rect.extent.height};
}

/// An action's value at the last sync.
struct Value {
  Json now;
  bool is_active = false, has_changed = false;
};

/// The object of a handle. It uses the members for its kind.
struct Object {
  XrObjectType kind;
  std::uint64_t parent;
  // swapchain
  XrSwapchainCreateInfo info{};
  bool is_depth = false, waited = false;
  std::vector<GLuint> textures;
  std::size_t next = 0;
  std::optional<std::size_t> acquired, released, view;  // `view`: the view whose depths it has
  int released_frame = -1;
  std::vector<std::uint8_t> pixels;  // as released; empty: not kept
  // space
  std::optional<XrReferenceSpaceType> reference;  // none: the space of a user's action
  std::uint64_t action = 0;
  std::string user;
  // action; its set is its parent
  std::string name;
  XrActionType type = XR_ACTION_TYPE_BOOLEAN_INPUT;
  std::map<std::string, Strings> bindings;  // paths by interaction profile
  std::map<std::string, Value> values;      // by user
};

struct Frame {
  int number = 0;
  XrTime time = 0;
  bool begun = false;
  std::uint64_t space = 0;  // in which views were located
  XrViewStateFlags flags = 0;
  std::vector<XrView> located;
};

struct Session {
  std::uint64_t id = 0;  // 0: there is none
  XrSessionState state = XR_SESSION_STATE_IDLE;
  bool running = false, lost = false, attached = false;
  std::string then = "exiting";  // the state after STOPPING, or "ready"
  XrViewConfigurationType views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  std::optional<Frame> frame;  // the frame in progress
};

struct Runtime {
  ~Runtime();

  Json script = Json::object();
  std::filesystem::path folder;
  std::ofstream log_file;
  std::string function;  // the function that is being called
  std::map<std::uint64_t, Object> objects;
  std::uint64_t last_id = 0;
  Strings paths;
  std::deque<XrEventDataBuffer> events;
  std::set<std::string> extensions;  // enabled extensions
  Json input = Json::object();       // the script's last input, by path
  bool instance_lost = false, asked_requirements = false;
  Session session;
  int next_frame = 0, ended_frames = 0, applied = -1;

  void log(const Json& line) {
    if (log_file.is_open()) log_file << line.dump() << std::endl;
  }
  int now() const { return session.frame ? session.frame->number : next_frame; }
  XrDuration period() const { return script.value("period", XrDuration{11'111'111}); }
  int frames() const { return script.value("frames", 3); }
};

Runtime runtime;

/// Ends a call with an error. An error with a text is a fault of the application.
struct Refusal {
  XrResult result;
  std::string text;
};

void require(bool good, XrResult result, const std::string& text) {
  if (!good) throw Refusal{result, text};
}

void fault(const std::string& text, XrResult result = XR_SUCCESS) {
  runtime.log({{"what", "fault"},
               {"function", runtime.function},
               {"frame", runtime.now()},
               {"result", name_of(results, result)},
               {"text", text}});
}

Runtime::~Runtime() {
  for (const auto& [id, object] : objects) fault(name_of(kinds, object.kind) + " was never destroyed");
}

/// Returns whether the script injects this fault of the application.
bool is_injected(const char* name) { return runtime.script.value("inject", "") == name; }

template <typename Handle>
std::uint64_t id_of(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}

template <typename Handle>
Object& get(Handle handle) {
  constexpr XrObjectType kind = kind_of<Handle>;
  const auto found = runtime.objects.find(id_of(handle));
  require(found != runtime.objects.end() && found->second.kind == kind, XR_ERROR_HANDLE_INVALID,
          name_of(kinds, kind) + " is not there, or was destroyed");
  const bool is_destroyed = runtime.function.starts_with("xrDestroy");  // lost objects can be destroyed, too
  require(is_destroyed || !runtime.instance_lost, XR_ERROR_INSTANCE_LOST, "");
  require(is_destroyed || !runtime.session.lost || kind == XR_OBJECT_TYPE_INSTANCE, XR_ERROR_SESSION_LOST,
          "");
  return found->second;
}

template <typename Parent, typename Handle>
Object& add(Parent parent, Handle* out) {
  *out = reinterpret_cast<Handle>(++runtime.last_id);
  return runtime.objects.insert({runtime.last_id, {kind_of<Handle>, id_of(parent)}}).first->second;
}

template <typename Handle>
void destroy(Handle handle) {
  const Object& destroyed = get(handle);
  if (destroyed.kind == XR_OBJECT_TYPE_SPACE && is_injected("space")) return;
  if (destroyed.kind == XR_OBJECT_TYPE_INSTANCE && is_injected("instance")) return;
  if (destroyed.acquired) fault("an image was not released");
  if (!destroyed.textures.empty()) glDeleteTextures(3, destroyed.textures.data());
  // Actions are destroyed with their set: applications rely on that.
  for (const auto& [id, object] : runtime.objects) {
    if (object.parent == id_of(handle) && object.kind != XR_OBJECT_TYPE_ACTION)
      fault(name_of(kinds, object.kind) + " was not destroyed before its parent");
  }
  std::erase_if(runtime.objects, [&](const auto& one) {
    return one.first == id_of(handle) || one.second.parent == id_of(handle);
  });
  if (id_of(handle) == runtime.session.id) runtime.session = {};
}

/// Returns arrays as OpenXR does, in two calls: first their number, then their elements.
template <typename T>
void give(const std::vector<T>& all, std::uint32_t capacity, std::uint32_t* count, T* out) {
  *count = static_cast<std::uint32_t>(all.size());
  if (capacity == 0) return;
  require(capacity >= all.size(), XR_ERROR_SIZE_INSUFFICIENT,
          "room for " + std::to_string(capacity) + " of " + std::to_string(all.size()));
  std::ranges::copy(all, out);
}

// Views, spaces and the session's states.

std::vector<XrViewConfigurationType> view_configurations() {
  if (runtime.script.value("views", Json::object()).contains("quad") &&
      runtime.extensions.contains("XR_VARJO_quad_views"))
    return {XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
  return {XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
}

/// Returns the script's views.
std::vector<Json> views_of(XrViewConfigurationType type) {
  const auto offered = view_configurations();
  require(std::count(offered.begin(), offered.end(), type) != 0, XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED,
          "a view configuration that is not offered");
  const bool quad = type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO;
  const Json scripted =
      runtime.script.value("views", Json::object()).value(quad ? "quad" : "stereo", Json::array());
  std::vector<Json> views;
  for (std::size_t k = 0; k < (quad ? 4 : 2); ++k) {
    Json& view = views.emplace_back(Json{{"width", 96}, {"height", 80}});
    view["fov"] = k % 2 == 0 ? Json{-0.855, 0.646, 0.7, -0.7} : Json{-0.646, 0.855, 0.7, -0.7};
    view["position"] = {k % 2 == 0 ? -0.0315 : 0.0315, 0.0, 0.0};
    if (!scripted.empty()) view.update(scripted.at(k));
  }
  return views;
}

glm::dmat4 head_in_script(XrTime time) {
  const Json heads = runtime.script.value("heads", Json{{{"position", {0, 1.6, 0}}}});
  const auto frame = static_cast<std::size_t>((time - first_time + runtime.period() / 2) / runtime.period());
  return pose_from(heads.at(std::min(frame, heads.size() - 1)));
}

/// Returns the pose in the script's world, or nothing if it is not tracked.
std::optional<glm::dmat4> pose_of(const Object& space) {
  if (!space.reference) {
    const Value& value = runtime.objects.at(space.action).values[space.user];
    return value.is_active && value.now.is_object() ? std::optional(pose_from(value.now)) : std::nullopt;
  }
  if (*space.reference == XR_REFERENCE_SPACE_TYPE_STAGE) return glm::dmat4(1.0);
  glm::dmat4 local = pose_from(runtime.script.value("recentre", Json{{"position", {0, 1.6, 0}}}));
  if (*space.reference == local_floor) local[3].y = 0.0;
  return local;
}

template <typename Event>
void queue(const Event& event) {
  XrEventDataBuffer buffer{XR_TYPE_EVENT_DATA_BUFFER};
  std::memcpy(&buffer, &event, sizeof(event));
  runtime.events.push_back(buffer);
}

void set_state(XrSessionState state) {
  runtime.session.state = state;
  runtime.log({{"what", "state"}, {"state", name_of(states, state)}, {"frame", runtime.now()}});
  queue(XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr,
                                       reinterpret_cast<XrSession>(runtime.session.id), state, first_time});
}

bool is_synchronized(XrSessionState state) {
  return state >= XR_SESSION_STATE_SYNCHRONIZED && state <= XR_SESSION_STATE_FOCUSED;
}

/// Changes to a state through the intermediate states that OpenXR prescribes.
void walk_to(XrSessionState state) {
  const XrSessionState& now = runtime.session.state;
  if (state == XR_SESSION_STATE_STOPPING && is_synchronized(now)) walk_to(XR_SESSION_STATE_SYNCHRONIZED);
  if (!is_synchronized(state)) return set_state(state);
  while (now < state) set_state(static_cast<XrSessionState>(now + 1));
  while (now > state) set_state(static_cast<XrSessionState>(now - 1));
}

// Keys of the script, and the additional keys of an event.
const std::set<std::string> script_words = {
    "folder",    "frames",         "heads",  "recentre",     "spaces",     "views",
    "masks",     "extensions",     "period", "formats",      "sleep",      "late",
    "pixels",    "profile",        "hands",  "events",       "flags",      "not_rendered",
    "immutable", "unordered_srgb", "inject", "leaves_error", "blend_modes"};
const std::set<std::string> event_words = {"frame",         "state", "then",   "input",
                                           "instance_loss", "fail",  "result", "times"};

void check_words(const Json& json, bool is_event) {
  for (const auto& [word, value] : json.items()) {
    if (!script_words.contains(word) && !(is_event && event_words.contains(word)))
      throw std::runtime_error("there is no word " + word);
  }
}

void read_script(const std::string& path) {
  std::ifstream in(path);
  runtime.script = Json::parse(in);
  check_words(runtime.script, false);
  for (const Json& event : runtime.script.value("events", Json::array())) check_words(event, true);
  runtime.folder = runtime.script.value("folder", "");
  if (!runtime.folder.empty()) runtime.log_file.open(runtime.folder / "log.jsonl", std::ios::app);
}

/// Applies the script's events for the frames up to this one.
void apply_events(int frame) {
  while (runtime.applied < frame) {
    ++runtime.applied;
    for (const Json& event : runtime.script.value("events", Json::array())) {
      if (event.value("frame", 0) != runtime.applied) continue;
      for (const auto& [word, value] : event.items()) {
        if (word == "state") {
          runtime.session.then = event.value("then", "exiting");
          walk_to(states.at("XR_SESSION_STATE_" + value.get<std::string>()));
        } else if (word == "instance_loss") {
          queue(
              XrEventDataInstanceLossPending{XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING, nullptr, first_time});
        } else if (word == "input") {
          runtime.input.update(value);
        } else if (script_words.contains(word)) {
          runtime.script[word] = value;
        }
        if (word == "masks")
          queue(XrEventDataVisibilityMaskChangedKHR{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR, nullptr,
                                                    reinterpret_cast<XrSession>(runtime.session.id),
                                                    runtime.session.views, 0});
      }
    }
  }
}

/// Returns the error that an event of the script prescribes for the current function, if there is one.
std::optional<XrResult> scripted_result() {
  if (!runtime.script.contains("events")) return std::nullopt;
  for (Json& event : runtime.script["events"]) {
    if (event.value("fail", "") != runtime.function || event.value("frame", 0) > runtime.now()) continue;
    const int times = event.value("times", 1'000'000);
    if (times == 0) continue;
    event["times"] = times - 1;
    const XrResult result = results.at(event.at("result"));
    runtime.session.lost = runtime.session.lost || result == XR_ERROR_SESSION_LOST;
    runtime.instance_lost = runtime.instance_lost || result == XR_ERROR_INSTANCE_LOST;
    return result;
  }
  return std::nullopt;
}

// Layers.

std::vector<std::uint8_t> read_texture(const Object& of, GLuint texture) {
  std::vector<std::uint8_t> bytes(std::size_t{4} * of.info.width * of.info.height);
  GLint buffer = 0;
  glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &buffer);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  glGetTextureImage(texture, 0, of.is_depth ? GL_DEPTH_COMPONENT : GL_RGBA,
                    of.is_depth ? GL_FLOAT : GL_UNSIGNED_BYTE, static_cast<GLsizei>(bytes.size()),
                    bytes.data());
  glBindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(buffer));
  return bytes;
}

/// Checks a layer's image and writes its pixels, top row first. Returns the name of their file, or null.
Json check_image(const XrSwapchainSubImage& image, bool is_depth, std::size_t index) {
  const Object& of = get(image.swapchain);
  const std::string view = "view " + std::to_string(index) + (is_depth ? "'s depth" : "");
  require(of.is_depth == is_depth, XR_ERROR_VALIDATION_FAILURE, view + " is of the other kind of swapchain");
  require(of.released.has_value(), XR_ERROR_LAYER_INVALID, view + " was never released");
  const auto& [offset, extent] = image.imageRect;
  const bool inside = offset.x >= 0 && offset.y >= 0 && extent.width > 0 && extent.height > 0 &&
                      offset.x + std::int64_t{extent.width} <= of.info.width &&
                      offset.y + std::int64_t{extent.height} <= of.info.height;
  require(inside, XR_ERROR_SWAPCHAIN_RECT_INVALID, view + " has a rectangle beyond its swapchain");
  if (of.released_frame != runtime.now()) fault(view + " is an image of another frame");
  if (of.pixels.empty()) return nullptr;
  if (read_texture(of, of.textures[*of.released]) != of.pixels)
    fault(view + " was written to after its release");
  char file[64];
  std::snprintf(file, sizeof(file), "frame%04d_view%zu.%s", runtime.now(), index,
                is_depth ? "depth" : "rgba");
  std::ofstream out(runtime.folder / file, std::ios::binary);
  for (int row = offset.y + extent.height - 1; row >= offset.y; --row) {
    const std::size_t at =
        std::size_t{4} * (static_cast<std::size_t>(row) * of.info.width + static_cast<std::size_t>(offset.x));
    out.write(reinterpret_cast<const char*>(&of.pixels[at]), std::streamsize{4} * extent.width);
  }
  return file;
}

Json check_depth(const XrCompositionLayerProjectionView& view, std::size_t index) {
  if (view.next == nullptr) return nullptr;
  XrCompositionLayerDepthInfoKHR depth = *static_cast<const XrCompositionLayerDepthInfoKHR*>(view.next);
  if (is_injected("planes")) depth.farZ = depth.nearZ;
  if (!runtime.extensions.contains(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME))
    fault("depth without its extension");
  const bool planes = depth.nearZ >= 0 && depth.farZ >= 0 && depth.nearZ != depth.farZ;
  const bool range = depth.minDepth >= 0 && depth.minDepth < depth.maxDepth && depth.maxDepth <= 1;
  require(planes && range, XR_ERROR_VALIDATION_FAILURE, "depths between planes that bound nothing");
  // Depths must have the aspect of the colours. Rounding of smaller sizes may add a pixel.
  const XrExtent2Di size = depth.subImage.imageRect.extent, colours = view.subImage.imageRect.extent;
  const std::int64_t apart =
      std::int64_t{size.width} * colours.height - std::int64_t{size.height} * colours.width;
  if (std::abs(apart) > std::max(colours.width, colours.height))
    fault("depths of another shape than the colours");
  // A depth swapchain belongs to one view.
  std::optional<std::size_t>& shown = get(depth.subImage.swapchain).view;
  if (shown.value_or(index) != index) fault("a view has the depths of another one");
  shown = index;
  return {{"near", depth.nearZ}, {"far", depth.farZ}, {"file", check_image(depth.subImage, true, index)}};
}

template <typename T>
bool same(const T& a, const T& b) {  // bit for bit, NaN included
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Checks a projection layer: its views must be those of this frame, for the right eyes, with released
/// images.
Json check_layer(const XrCompositionLayerBaseHeader* header) {
  require(header != nullptr && header->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION, XR_ERROR_LAYER_INVALID,
          "a layer that is no projection");
  const auto& layer = *reinterpret_cast<const XrCompositionLayerProjection*>(header);
  get(layer.space);
  const Frame& frame = *runtime.session.frame;
  require(layer.viewCount == frame.located.size(), XR_ERROR_VALIDATION_FAILURE,
          "a layer of other views than were located");
  if (id_of(layer.space) != frame.space) fault("a layer in another space than views were located in");
  if ((frame.flags & 3) != 3) fault("a layer of poses that are not valid");
  std::vector<XrCompositionLayerProjectionView> views(layer.views, layer.views + layer.viewCount);
  if (is_injected("pose")) views[0].pose.position.x += 0.01f;
  if (is_injected("fov")) views[1].fov.angleUp += 0.01f;
  if (is_injected("eyes")) std::swap(views[0].pose, views[1].pose);
  if (is_injected("rectangle")) ++views[0].subImage.imageRect.extent.width;
  if (is_injected("depths") && frame.number > 0) std::swap(views[0].next, views[1].next);
  Json list = Json::array();
  for (std::size_t k = 0; k < views.size(); ++k) {
    const std::string name = "view " + std::to_string(k);
    if (!same(views[k].pose, frame.located[k].pose)) fault(name + " has another pose than was located");
    if (!same(views[k].fov, frame.located[k].fov)) fault(name + " has another fov than was located");
    list.push_back({{"rect", to_json(views[k].subImage.imageRect)},
                    {"colour", check_image(views[k].subImage, false, k)},
                    {"depth", check_depth(views[k], k)}});
  }
  return {{"flags", layer.layerFlags}, {"views", list}};
}

// Actions.

// The users with inputs.
const Strings users = {"/user/hand/left", "/user/hand/right", "/user/eyes_ext"};

std::string last_of(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// The inputs of interaction profiles, below their users; "left:" is only for that one.
const std::map<std::string, Strings> profiles = {
    {"/interaction_profiles/khr/simple_controller", {"grip/pose", "select/click", "menu/click"}},
    {"/interaction_profiles/oculus/touch_controller",
     {"grip/pose", "left:x/click", "left:y/click", "left:menu/click", "right:a/click", "right:b/click",
      "squeeze/value", "trigger/value", "thumbstick", "thumbstick/click"}},
    {"/interaction_profiles/valve/index_controller",
     {"grip/pose", "a/click", "b/click", "squeeze/value", "squeeze/force", "trigger/click", "trigger/value",
      "thumbstick", "thumbstick/click", "trackpad"}},
    {"/interaction_profiles/microsoft/motion_controller",
     {"grip/pose", "menu/click", "squeeze/click", "trigger/value", "thumbstick", "thumbstick/click",
      "trackpad", "trackpad/click"}},
    {"/interaction_profiles/htc/vive_controller",
     {"grip/pose", "squeeze/click", "menu/click", "trigger/click", "trigger/value", "trackpad",
      "trackpad/click"}},
    {"/interaction_profiles/ext/eye_gaze_interaction", {"eyes_ext:gaze_ext/pose"}}};

bool has_path(const std::string& profile, const std::string& path) {
  for (const std::string& user : users) {
    for (const std::string& input : profiles.at(profile)) {
      const std::size_t colon = input.find(':');
      const bool is_the_users = colon == std::string::npos || input.substr(0, colon) == last_of(user);
      if (is_the_users && path == user + "/input/" + input.substr(colon + 1)) return true;
    }
  }
  return false;
}

XrActionType type_of(const std::string& path) {
  const std::string last = last_of(path);
  if (last == "pose") return XR_ACTION_TYPE_POSE_INPUT;
  return last == "thumbstick" || last == "trackpad" ? XR_ACTION_TYPE_VECTOR2F_INPUT
                                                    : XR_ACTION_TYPE_BOOLEAN_INPUT;
}

/// Returns the current interaction profile of a user, or "" if the user is absent.
std::string profile_of(const std::string& user) {
  if (user == users[2]) return "/interaction_profiles/ext/eye_gaze_interaction";
  const Strings hands = runtime.script.value("hands", Strings{"left", "right"});
  if (std::count(hands.begin(), hands.end(), last_of(user)) == 0) return "";
  return runtime.script.value("profile", "/interaction_profiles/khr/simple_controller");
}

void sync(Object& action, bool focused) {
  for (const std::string& user : users) {
    Json value;
    bool is_active = false;
    for (const std::string& path : action.bindings[profile_of(user)]) {
      if (!focused || !path.starts_with(user)) continue;
      is_active = true;
      if (runtime.input.contains(path)) value = runtime.input[path];
    }
    action.values[user] = {value, is_active, value != action.values[user].now};
  }
}

/// Returns an action's value at the last sync. Sets the members that the states of all types have.
template <typename State>
Json read_action(const XrActionStateGetInfo* info, XrActionType type, State& out) {
  Object& action = get(info->action);
  require(runtime.session.attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "an action whose set is not attached");
  require(action.type == type, XR_ERROR_ACTION_TYPE_MISMATCH, action.name + " is of another type");
  const Value& value = action.values[runtime.paths.at(info->subactionPath - 1)];
  out.isActive = value.is_active ? XR_TRUE : XR_FALSE;
  out.changedSinceLastSync = value.has_changed ? XR_TRUE : XR_FALSE;
  return value.now;
}

// OpenXR's functions. If they return nothing, they succeed. Their first handle has been checked already.

void enumerate_extensions(const char*, std::uint32_t capacity, std::uint32_t* count,
                          XrExtensionProperties* properties) {
  static const Strings all = {
      "XR_MNDX_egl_enable",     "XR_KHR_opengl_enable",        "XR_KHR_composition_layer_depth",
      "XR_KHR_visibility_mask", "XR_EXT_eye_gaze_interaction", "XR_VARJO_quad_views",
      "XR_EXT_local_floor"};
  std::vector<XrExtensionProperties> offered;
  for (const std::string& name : runtime.script.value("extensions", all)) {
    XrExtensionProperties& extension = offered.emplace_back();
    extension = {XR_TYPE_EXTENSION_PROPERTIES, nullptr, {}, 1};
    std::strncpy(extension.extensionName, name.c_str(), XR_MAX_EXTENSION_NAME_SIZE - 1);
  }
  give(offered, capacity, count, properties);
}

void create_instance(const XrInstanceCreateInfo* info, XrInstance* out) {
  runtime.extensions = {info->enabledExtensionNames,
                        info->enabledExtensionNames + info->enabledExtensionCount};
  add(XrInstance{}, out);
}

void get_instance_properties(XrInstance, XrInstanceProperties* properties) {
  properties->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  std::strcpy(properties->runtimeName, "binosplat's test runtime");
}

XrResult poll_event(XrInstance, XrEventDataBuffer* event) {
  if (runtime.events.empty()) return XR_EVENT_UNAVAILABLE;
  *event = runtime.events.front();
  runtime.events.pop_front();
  return XR_SUCCESS;
}

void result_to_string(XrInstance, XrResult value, char* buffer) {
  std::strncpy(buffer, name_of(results, value).c_str(), XR_MAX_RESULT_STRING_SIZE - 1);
}

void string_to_path(XrInstance, const char* text, XrPath* path) {
  const std::string name = text;
  require(name.size() > 1 && name[0] == '/' && name.back() != '/' && name.find("//") == std::string::npos,
          XR_ERROR_PATH_FORMAT_INVALID, "'" + name + "' is no path");
  Strings& paths = runtime.paths;
  auto at = std::find(paths.begin(), paths.end(), name);
  if (at == paths.end()) at = paths.insert(at, name);
  *path = static_cast<XrPath>(at - paths.begin()) + 1;
}

void get_system(XrInstance, const XrSystemGetInfo*, XrSystemId* system) { *system = the_system; }

void get_system_properties(XrInstance, XrSystemId, XrSystemProperties* properties) {
  std::strcpy(properties->systemName, "binosplat's test headset");
}

void enumerate_view_configurations(XrInstance, XrSystemId, std::uint32_t capacity, std::uint32_t* count,
                                   XrViewConfigurationType* types) {
  give(view_configurations(), capacity, count, types);
}

void enumerate_view_configuration_views(XrInstance, XrSystemId, XrViewConfigurationType type,
                                        std::uint32_t capacity, std::uint32_t* count,
                                        XrViewConfigurationView* views) {
  std::vector<XrViewConfigurationView> all;
  for (const Json& view : views_of(type))
    all.push_back(
        {XR_TYPE_VIEW_CONFIGURATION_VIEW, nullptr, view["width"], 4096, view["height"], 4096, 1, 1});
  give(all, capacity, count, views);
}

Strings offered_modes() { return runtime.script.value("blend_modes", Strings{"OPAQUE"}); }

void enumerate_blend_modes(XrInstance, XrSystemId, XrViewConfigurationType, std::uint32_t capacity,
                           std::uint32_t* count, XrEnvironmentBlendMode* modes) {
  std::vector<XrEnvironmentBlendMode> all;
  for (const std::string& name : offered_modes()) all.push_back(blend_modes.at(name));
  give(all, capacity, count, modes);
}

void get_requirements(XrInstance, XrSystemId, XrGraphicsRequirementsOpenGLKHR* requirements) {
  requirements->minApiVersionSupported = XR_MAKE_VERSION(4, 3, 0);
  requirements->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  runtime.asked_requirements = true;
}

void create_session(XrInstance instance, const XrSessionCreateInfo* info, XrSession* out) {
  require(runtime.session.id == 0, XR_ERROR_LIMIT_REACHED, "a second session");
  require(runtime.asked_requirements, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING,
          "before the requirements' call");
  // The binding of the context that is current. xr/egl_layer.cpp passes EGL's in Xlib's form.
  const bool has_egl = runtime.extensions.contains("XR_MNDX_egl_enable");
  const auto* egl = static_cast<const XrGraphicsBindingEGLMNDX*>(info->next);
  const auto* xlib = static_cast<const XrGraphicsBindingOpenGLXlibKHR*>(info->next);
  bool is_current = false;
  if (egl != nullptr && egl->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX)
    is_current = has_egl && egl->context == eglGetCurrentContext();
  if (xlib != nullptr && xlib->type == XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR && has_egl)
    is_current = xlib->glxContext == eglGetCurrentContext();
  if (xlib != nullptr && xlib->type == XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR && !has_egl)
    is_current = xlib->glxContext != nullptr && xlib->glxContext == glXGetCurrentContext() &&
                 xlib->xDisplay == glXGetCurrentDisplay() && xlib->glxDrawable == glXGetCurrentDrawable();
  require(is_current, XR_ERROR_GRAPHICS_DEVICE_INVALID,
          std::string("no binding of the context of ") + (has_egl ? "EGL" : "GLX") + " that is current");
  add(instance, out);
  runtime.session.id = id_of(*out);
  runtime.log({{"what", "session"}, {"binding", has_egl ? "EGL" : "GLX"}});
  set_state(XR_SESSION_STATE_IDLE);
  set_state(XR_SESSION_STATE_READY);
}

void begin_session(XrSession, const XrSessionBeginInfo* info) {
  Session& session = runtime.session;
  require(!session.running && session.state == XR_SESSION_STATE_READY, XR_ERROR_SESSION_NOT_READY,
          name_of(states, session.state));
  session.views = info->primaryViewConfigurationType;
  session.running = true;
  runtime.log({{"what", "begin"}});
  walk_to(XR_SESSION_STATE_FOCUSED);
  apply_events(runtime.next_frame);
}

void end_session(XrSession) {
  Session& session = runtime.session;
  require(session.running && session.state == XR_SESSION_STATE_STOPPING, XR_ERROR_SESSION_NOT_STOPPING,
          name_of(states, session.state));
  if (session.frame) fault("a frame was not ended");
  session.running = false;
  session.frame.reset();
  set_state(XR_SESSION_STATE_IDLE);
  set_state(session.then == "ready" ? XR_SESSION_STATE_READY : XR_SESSION_STATE_EXITING);
}

void request_exit_session(XrSession) {
  require(runtime.session.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  runtime.session.then = "exiting";
  if (runtime.session.state != XR_SESSION_STATE_STOPPING) walk_to(XR_SESSION_STATE_STOPPING);
}

/// Returns the known values that the script lists under `word`, or all of them without that key.
template <typename Value>
std::vector<Value> offered(const char* word, const std::map<std::string, Value>& known) {
  std::vector<Value> values;
  for (const auto& [name, value] : known) {
    const Json names = runtime.script.value(word, Json::array({name}));
    if (std::count(names.begin(), names.end(), name) != 0) values.push_back(value);
  }
  return values;
}

std::vector<XrReferenceSpaceType> offered_spaces() {
  std::vector<XrReferenceSpaceType> spaces = offered("spaces", space_types);
  if (!runtime.extensions.contains("XR_EXT_local_floor")) std::erase(spaces, local_floor);
  return spaces;
}

void enumerate_reference_spaces(XrSession, std::uint32_t capacity, std::uint32_t* count,
                                XrReferenceSpaceType* spaces) {
  give(offered_spaces(), capacity, count, spaces);
}

void require_no_offset(const XrPosef& pose) {
  constexpr XrPosef none = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
  require(same(pose, none), XR_ERROR_RUNTIME_FAILURE, "this runtime knows no spaces that are moved");
}

void create_reference_space(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  const auto all = offered_spaces();
  require(std::count(all.begin(), all.end(), info->referenceSpaceType) != 0,
          XR_ERROR_REFERENCE_SPACE_UNSUPPORTED, "a reference space that is not offered");
  require_no_offset(info->poseInReferenceSpace);
  add(session, out).reference = info->referenceSpaceType;
}

void create_action_space(XrSession session, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  require(get(info->action).type == XR_ACTION_TYPE_POSE_INPUT, XR_ERROR_ACTION_TYPE_MISMATCH,
          "a space of an action that is no pose");
  require_no_offset(info->poseInActionSpace);
  Object& space = add(session, out);
  space.action = id_of(info->action);
  space.user = info->subactionPath == XR_NULL_PATH ? users[2] : runtime.paths.at(info->subactionPath - 1);
}

void locate_space(XrSpace space, XrSpace base, XrTime time, XrSpaceLocation* location) {
  require(time > 0, XR_ERROR_TIME_INVALID, "a space at no time");
  const auto pose = pose_of(get(space)), from = pose_of(get(base));
  location->locationFlags = pose && from ? 15 : 0;
  if (pose && from) location->pose = to_xr(glm::inverse(*from) * *pose);
}

void locate_views(XrSession, const XrViewLocateInfo* info, XrViewState* state, std::uint32_t capacity,
                  std::uint32_t* count, XrView* views) {
  Session& session = runtime.session;
  require(info->viewConfigurationType == session.views, XR_ERROR_VALIDATION_FAILURE,
          "another view configuration");
  if (!session.frame || info->displayTime != session.frame->time)
    fault("views located for another time than the frame's");
  state->viewStateFlags = 0;
  for (const std::string& flag :
       runtime.script.value("flags", Strings{"orientation_valid", "position_valid"}))
    state->viewStateFlags |=
        flag == "orientation_valid" ? XR_VIEW_STATE_ORIENTATION_VALID_BIT : XR_VIEW_STATE_POSITION_VALID_BIT;
  const auto base = pose_of(get(info->space));
  std::vector<XrView> located;
  for (const Json& spec : views_of(session.views)) {
    const auto fov = spec["fov"].get<std::array<float, 4>>();
    XrView& view = located.emplace_back(XrView{XR_TYPE_VIEW, nullptr, {}, {fov[0], fov[1], fov[2], fov[3]}});
    view.pose = to_xr(glm::inverse(*base) * head_in_script(info->displayTime) * pose_from(spec));
    // Invalid poses must not be used: these values make any use visible.
    if ((state->viewStateFlags & XR_VIEW_STATE_ORIENTATION_VALID_BIT) == 0) view.pose.orientation = {};
    if ((state->viewStateFlags & XR_VIEW_STATE_POSITION_VALID_BIT) == 0) view.pose.position.x = NAN;
  }
  give(located, capacity, count, views);
  if (capacity == 0 || !session.frame) return;
  session.frame->space = id_of(info->space);
  session.frame->flags = state->viewStateFlags;
  session.frame->located = std::move(located);
}

void enumerate_swapchain_formats(XrSession, std::uint32_t capacity, std::uint32_t* count, std::int64_t* out) {
  give(offered("formats", formats), capacity, count, out);
}

void create_swapchain(XrSession session, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
  const auto all = offered("formats", formats);
  require(std::count(all.begin(), all.end(), info->format) != 0, XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED,
          "format " + std::to_string(info->format));
  require(info->width - 1 < 4096 && info->height - 1 < 4096, XR_ERROR_SWAPCHAIN_RECT_INVALID, "a wrong size");
  require(info->sampleCount == 1 && info->faceCount == 1 && info->arraySize == 1 && info->mipCount == 1,
          XR_ERROR_FEATURE_UNSUPPORTED, "several samples, faces, layers or levels");
  // The program may try this format, so the error is not a fault of the program.
  require(info->format != GL_SRGB8_ALPHA8 || runtime.script.value("unordered_srgb", true) ||
              (info->usageFlags & XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT) == 0,
          XR_ERROR_FEATURE_UNSUPPORTED, "");
  Object& swapchain = add(session, out);
  swapchain.info = *info;
  swapchain.is_depth = info->format != GL_SRGB8_ALPHA8 && info->format != GL_RGBA8;
  const auto width = static_cast<GLsizei>(info->width), height = static_cast<GLsizei>(info->height);
  const auto format = static_cast<GLenum>(info->format);
  for (GLuint& texture : swapchain.textures = std::vector<GLuint>(3)) {
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    if (runtime.script.value("immutable", true)) {
      glTextureStorage2D(texture, 1, format, width, height);
      continue;
    }
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0,
                 swapchain.is_depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
    glTextureParameteri(texture, GL_TEXTURE_MAX_LEVEL, 0);
    glBindTexture(GL_TEXTURE_2D, 0);
  }
  runtime.log({{"what", "swapchain"}, {"width", info->width}, {"height", info->height}});
}

void enumerate_swapchain_images(XrSwapchain handle, std::uint32_t capacity, std::uint32_t* count,
                                XrSwapchainImageBaseHeader* images) {
  std::vector<XrSwapchainImageOpenGLKHR> all;
  for (const GLuint texture : get(handle).textures)
    all.push_back({XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR, nullptr, texture});
  give(all, capacity, count, reinterpret_cast<XrSwapchainImageOpenGLKHR*>(images));
}

void acquire_swapchain_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo*, std::uint32_t* index) {
  Object& swapchain = get(handle);
  require(!swapchain.acquired, XR_ERROR_CALL_ORDER_INVALID, "an image is acquired already");
  swapchain.acquired = swapchain.next;
  swapchain.next = (swapchain.next + 1) % swapchain.textures.size();
  *index = static_cast<std::uint32_t>(*swapchain.acquired);
}

void wait_swapchain_image(XrSwapchain handle, const XrSwapchainImageWaitInfo*) {
  Object& swapchain = get(handle);
  require(swapchain.acquired && !swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "no image to wait for");
  swapchain.waited = !is_injected("wait");
}

void release_swapchain_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo*) {
  Object& swapchain = get(handle);
  require(swapchain.acquired.has_value(), XR_ERROR_CALL_ORDER_INVALID, "no image is acquired");
  require(swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "the image was not waited for");
  if (is_injected("release")) return;
  swapchain.waited = false;
  swapchain.released = std::exchange(swapchain.acquired, std::nullopt);
  swapchain.released_frame = is_injected("stale") ? 0 : runtime.now();
  swapchain.pixels.clear();
  const Json kept = runtime.script.value("pixels", Json());
  if (runtime.folder.empty() ||
      (!kept.is_null() && std::find(kept.begin(), kept.end(), runtime.now()) == kept.end()))
    return;
  swapchain.pixels = read_texture(swapchain, swapchain.textures[*swapchain.released]);
  if (is_injected("written")) swapchain.pixels[0] ^= 1;
}

void wait_frame(XrSession, const XrFrameWaitInfo*, XrFrameState* state) {
  Session& session = runtime.session;
  require(session.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  require(!session.frame, XR_ERROR_CALL_ORDER_INVALID, "the frame before was not ended");
  session.lost = session.lost || runtime.next_frame >= runtime.frames() + patience;
  require(!session.lost, XR_ERROR_SESSION_LOST, "the program does not stop");
  apply_events(runtime.next_frame);
  const int number = runtime.next_frame++;
  const auto late = runtime.script.value("late", std::set<int>()),
             hidden = runtime.script.value("not_rendered", std::set<int>());
  const XrTime time =
      first_time + runtime.period() * (number + std::distance(late.begin(), late.upper_bound(number)));
  const bool is_shown = session.state >= XR_SESSION_STATE_VISIBLE &&
                        session.state <= XR_SESSION_STATE_FOCUSED && !hidden.contains(number);
  state->predictedDisplayTime = time;
  state->predictedDisplayPeriod = runtime.period();
  state->shouldRender = is_shown ? XR_TRUE : XR_FALSE;
  session.frame = {.number = number, .time = time};
  if (runtime.script.value("sleep", false))
    std::this_thread::sleep_for(std::chrono::nanoseconds(runtime.period()));
}

void begin_frame(XrSession, const XrFrameBeginInfo*) {
  std::optional<Frame>& frame = runtime.session.frame;
  require(frame.has_value(), XR_ERROR_CALL_ORDER_INVALID, "xrWaitFrame is expected before");
  frame->begun = !is_injected("begin");
}

void end_frame(XrSession, const XrFrameEndInfo* info) {
  std::optional<Frame>& frame = runtime.session.frame;
  require(frame && frame->begun, XR_ERROR_CALL_ORDER_INVALID, "xrBeginFrame is expected before");
  if (info->displayTime != frame->time + (is_injected("time") ? 1 : 0))
    fault("another display time than was predicted", XR_ERROR_TIME_INVALID);
  const std::string mode = name_of(blend_modes, info->environmentBlendMode);
  const Strings modes = offered_modes();
  if (std::count(modes.begin(), modes.end(), mode) == 0)
    fault("a blend mode that is not offered", XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED);
  for (const auto& [id, object] : runtime.objects) {
    if (object.acquired) fault("an image was not released");
  }
  Json located = Json::array(), layers = Json::array();
  for (const XrView& view : frame->located)
    located.push_back({{"pose", to_json(view.pose)}, {"fov", to_json(view.fov)}});
  for (std::uint32_t k = 0; k < info->layerCount; ++k) layers.push_back(check_layer(info->layers[k]));
  runtime.log({{"what", "frame"},
               {"frame", frame->number},
               {"blend_mode", mode},
               {"located", located},
               {"layers", layers}});
  if (runtime.script.value("leaves_error", false)) glEnable(0);
  frame.reset();
  ++runtime.ended_frames;
  apply_events(runtime.next_frame);
  if (runtime.ended_frames >= runtime.frames() && runtime.session.state < XR_SESSION_STATE_STOPPING) {
    runtime.session.then = "exiting";
    walk_to(XR_SESSION_STATE_STOPPING);
  }
}

void create_action_set(XrInstance instance, const XrActionSetCreateInfo*, XrActionSet* out) {
  add(instance, out);
}

void create_action(XrActionSet set, const XrActionCreateInfo* info, XrAction* out) {
  require(!runtime.session.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "the set is attached already");
  for (const auto& [id, other] : runtime.objects)
    require(other.name != info->actionName, XR_ERROR_NAME_DUPLICATED, other.name);
  Object& action = add(set, out);
  action.name = info->actionName;
  action.type = info->actionType;
}

void suggest_bindings(XrInstance, const XrInteractionProfileSuggestedBinding* info) {
  require(!runtime.session.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "actions are attached already");
  const std::string profile = runtime.paths.at(info->interactionProfile - 1);
  require(profiles.contains(profile), XR_ERROR_PATH_UNSUPPORTED, "no profile " + profile);
  for (std::uint32_t k = 0; k < info->countSuggestedBindings; ++k) {
    Object& action = get(info->suggestedBindings[k].action);
    std::string path = runtime.paths.at(info->suggestedBindings[k].binding - 1);
    if (is_injected("binding")) path += "s";
    require(has_path(profile, path), XR_ERROR_PATH_UNSUPPORTED, profile + " has no " + path);
    require(action.type == type_of(path), XR_ERROR_PATH_UNSUPPORTED,
            action.name + " is of another type than " + path);
    action.bindings[profile].push_back(path);
  }
}

void attach_action_sets(XrSession, const XrSessionActionSetsAttachInfo* info) {
  require(!runtime.session.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "a set is attached already");
  for (std::uint32_t k = 0; k < info->countActionSets; ++k) get(info->actionSets[k]);
  runtime.session.attached = true;
}

XrResult sync_actions(XrSession, const XrActionsSyncInfo* info) {
  require(runtime.session.attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "no set is attached");
  for (std::uint32_t k = 0; k < info->countActiveActionSets; ++k) get(info->activeActionSets[k].actionSet);
  const bool focused = runtime.session.state == XR_SESSION_STATE_FOCUSED;
  for (auto& [id, object] : runtime.objects) {
    if (object.kind == XR_OBJECT_TYPE_ACTION) sync(object, focused);
  }
  return focused ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

void get_boolean(XrSession, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
  const Json value = read_action(info, XR_ACTION_TYPE_BOOLEAN_INPUT, *out);
  out->currentState = value.is_boolean() && value.get<bool>() ? XR_TRUE : XR_FALSE;
}

void get_vector(XrSession, const XrActionStateGetInfo* info, XrActionStateVector2f* out) {
  const Json value = read_action(info, XR_ACTION_TYPE_VECTOR2F_INPUT, *out);
  if (value.is_array()) out->currentState = {value[0], value[1]};
}

void get_visibility_mask(XrSession, XrViewConfigurationType, std::uint32_t view, XrVisibilityMaskTypeKHR type,
                         XrVisibilityMaskKHR* mask) {
  require(type == XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR, XR_ERROR_VALIDATION_FAILURE,
          "another mask");
  const Json masks = runtime.script.value("masks", Json::array());
  const Json mesh = view < masks.size() ? masks[view] : Json::object();
  std::vector<XrVector2f> vertices;
  for (const Json& vertex : mesh.value("vertices", Json::array())) vertices.push_back({vertex[0], vertex[1]});
  give(vertices, mask->vertexCapacityInput, &mask->vertexCountOutput, mask->vertices);
  give(mesh.value("indices", std::vector<std::uint32_t>()), mask->indexCapacityInput, &mask->indexCountOutput,
       mask->indices);
}

// The functions that the loader finds.

template <typename First, typename... Others>
void check_first(First first, Others...) {
  if constexpr (kind_of<First> != XR_OBJECT_TYPE_UNKNOWN) get(first);
}

/// A function as the loader calls it, with scripted results and error handling. GetName is a lambda.
template <typename GetName, auto function>
struct Entry;
template <typename GetName, typename Result, typename... Arguments, Result (*function)(Arguments...)>
struct Entry<GetName, function> {
  static XrResult XRAPI_CALL call(Arguments... arguments) {
    runtime.function = GetName()();
    try {
      if (const auto result = scripted_result()) return *result;
      check_first(arguments...);
      if constexpr (std::is_same_v<Result, XrResult>) return function(arguments...);
      function(arguments...);
      return XR_SUCCESS;
    } catch (const Refusal& refusal) {
      if (!refusal.text.empty()) fault(refusal.text, refusal.result);
      return refusal.result;
    } catch (const std::exception& error) {
      fault(error.what(), XR_ERROR_RUNTIME_FAILURE);
      return XR_ERROR_RUNTIME_FAILURE;
    }
  }
};

#define ENTRY(name, function)                                                                                \
  {                                                                                                          \
    "xr" #name,                                                                                              \
        reinterpret_cast<PFN_xrVoidFunction>(&Entry<decltype([] { return "xr" #name; }), &(function)>::call) \
  }
const std::map<std::string, PFN_xrVoidFunction> entries = {
    ENTRY(EnumerateInstanceExtensionProperties, enumerate_extensions),
    ENTRY(CreateInstance, create_instance),
    ENTRY(DestroyInstance, destroy<XrInstance>),
    ENTRY(GetInstanceProperties, get_instance_properties),
    ENTRY(PollEvent, poll_event),
    ENTRY(ResultToString, result_to_string),
    ENTRY(StringToPath, string_to_path),
    ENTRY(GetSystem, get_system),
    ENTRY(GetSystemProperties, get_system_properties),
    ENTRY(EnumerateViewConfigurations, enumerate_view_configurations),
    ENTRY(EnumerateViewConfigurationViews, enumerate_view_configuration_views),
    ENTRY(EnumerateEnvironmentBlendModes, enumerate_blend_modes),
    ENTRY(GetOpenGLGraphicsRequirementsKHR, get_requirements),
    ENTRY(CreateSession, create_session),
    ENTRY(DestroySession, destroy<XrSession>),
    ENTRY(BeginSession, begin_session),
    ENTRY(EndSession, end_session),
    ENTRY(RequestExitSession, request_exit_session),
    ENTRY(EnumerateReferenceSpaces, enumerate_reference_spaces),
    ENTRY(CreateReferenceSpace, create_reference_space),
    ENTRY(CreateActionSpace, create_action_space),
    ENTRY(LocateSpace, locate_space),
    ENTRY(DestroySpace, destroy<XrSpace>),
    ENTRY(LocateViews, locate_views),
    ENTRY(EnumerateSwapchainFormats, enumerate_swapchain_formats),
    ENTRY(CreateSwapchain, create_swapchain),
    ENTRY(DestroySwapchain, destroy<XrSwapchain>),
    ENTRY(EnumerateSwapchainImages, enumerate_swapchain_images),
    ENTRY(AcquireSwapchainImage, acquire_swapchain_image),
    ENTRY(WaitSwapchainImage, wait_swapchain_image),
    ENTRY(ReleaseSwapchainImage, release_swapchain_image),
    ENTRY(WaitFrame, wait_frame),
    ENTRY(BeginFrame, begin_frame),
    ENTRY(EndFrame, end_frame),
    ENTRY(CreateActionSet, create_action_set),
    ENTRY(DestroyActionSet, destroy<XrActionSet>),
    ENTRY(CreateAction, create_action),
    ENTRY(DestroyAction, destroy<XrAction>),
    ENTRY(SuggestInteractionProfileBindings, suggest_bindings),
    ENTRY(AttachSessionActionSets, attach_action_sets),
    ENTRY(SyncActions, sync_actions),
    ENTRY(GetActionStateBoolean, get_boolean),
    ENTRY(GetActionStateVector2f, get_vector),
    ENTRY(GetVisibilityMaskKHR, get_visibility_mask)};

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance, const char* name, PFN_xrVoidFunction* function) {
  const auto found = entries.find(name);
  *function = found == entries.end() ? nullptr : found->second;
  if (std::strcmp(name, "xrGetInstanceProcAddr") == 0)
    *function = reinterpret_cast<PFN_xrVoidFunction>(&get_instance_proc_addr);
  return *function == nullptr ? XR_ERROR_FUNCTION_UNSUPPORTED : XR_SUCCESS;
}

// From the loader's specification, since no package has its header.
struct RuntimeRequest {
  std::uint32_t type, version;
  std::size_t size;
  std::uint32_t interface_version;
  XrVersion api_version;
  PFN_xrGetInstanceProcAddr get;
};

}  // namespace
}  // namespace binosplat::xr_test

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(  // NOLINT(readability-identifier-naming): the loader's own name
    const void*, binosplat::xr_test::RuntimeRequest* request) {
  try {
    if (const char* const path = std::getenv("BINOSPLAT_XR_SCRIPT")) binosplat::xr_test::read_script(path);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xr_test_runtime: %s\n", error.what());
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 0);
  request->get = &binosplat::xr_test::get_instance_proc_addr;
  return XR_SUCCESS;
}
