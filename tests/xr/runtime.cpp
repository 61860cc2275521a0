// An OpenXR 1.0 runtime without a headset, which Khronos' loader loads: it plays a script, refuses what the
// specification refuses, and logs what it was given (tests/xr/README.md). One session at a time, one thread.

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

#include "xr/egl_as_xlib.h"

namespace binosplat::xr_test {
namespace {

using Json = nlohmann::ordered_json;
using Strings = std::vector<std::string>;

// Newer than Debian's headers.
constexpr auto local_floor = static_cast<XrReferenceSpaceType>(1000426000);
constexpr XrSystemId the_system = 0x5e7;
constexpr XrTime first_time = 1'000'000'000;
constexpr int patience = 100;  // frames after the script's: a program that does not stop must not hang
constexpr const char* gaze_user = "/user/eyes_ext";

#define NAME_OF(name, value) \
  case name:                 \
    return #name;
#define VALUE_OF(name, value) {#name, name},
std::string name_of(XrResult result) {
  switch (result) {
    XR_LIST_ENUM_XrResult(NAME_OF);
    default:
      return "unknown";
  }
}
std::string name_of(XrSessionState state) {
  switch (state) {
    XR_LIST_ENUM_XrSessionState(NAME_OF);
    default:
      return "unknown";
  }
}
const std::map<std::string, XrResult> results = {XR_LIST_ENUM_XrResult(VALUE_OF)};
const std::map<std::string, std::int64_t> formats = {{"GL_SRGB8_ALPHA8", GL_SRGB8_ALPHA8},
                                                     {"GL_RGBA8", GL_RGBA8},
                                                     {"GL_DEPTH_COMPONENT24", GL_DEPTH_COMPONENT24},
                                                     {"GL_DEPTH_COMPONENT32F", GL_DEPTH_COMPONENT32F}};
const std::map<std::string, XrReferenceSpaceType> space_types = {{"view", XR_REFERENCE_SPACE_TYPE_VIEW},
                                                                 {"local", XR_REFERENCE_SPACE_TYPE_LOCAL},
                                                                 {"stage", XR_REFERENCE_SPACE_TYPE_STAGE},
                                                                 {"local_floor", local_floor}};
const std::map<std::string, XrSessionState> states = {{"synchronized", XR_SESSION_STATE_SYNCHRONIZED},
                                                      {"visible", XR_SESSION_STATE_VISIBLE},
                                                      {"focused", XR_SESSION_STATE_FOCUSED},
                                                      {"stopping", XR_SESSION_STATE_STOPPING},
                                                      {"loss_pending", XR_SESSION_STATE_LOSS_PENDING}};

struct Pose {
  glm::dvec3 position{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
};

/// b, which is given in a's space, in the space that a is given in.
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
  const auto& [q, p] = pose;
  return {{p.x, p.y, p.z}, glm::normalize(glm::dquat(q.w, q.x, q.y, q.z))};
}

Pose pose_from(const Json& json) {
  const auto p = json.value("position", std::array{0.0, 0.0, 0.0});
  const auto q = json.value("orientation", std::array{0.0, 0.0, 0.0, 1.0});
  return {{p[0], p[1], p[2]}, glm::normalize(glm::dquat(q[3], q[0], q[1], q[2]))};
}

Json to_json(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return {{"position", {p.x, p.y, p.z}}, {"orientation", {q.x, q.y, q.z, q.w}}};
}

Json to_json(const XrFovf& fov) { return {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}; }

/// What a handle stands for: of these members those of its kind are used.
struct Object {
  std::string kind;
  std::uint64_t parent = 0;
  // swapchain
  XrSwapchainCreateInfo info{};
  bool is_depth = false, waited = false;
  std::vector<GLuint> textures;
  std::size_t next = 0;
  std::optional<std::size_t> acquired, released;
  int released_frame = -1;
  std::vector<std::uint8_t> pixels;  // as released; empty: not kept
  // space
  std::optional<XrReferenceSpaceType> reference;  // none: of an action
  std::uint64_t action = 0;
  std::string user;
  Pose offset;
  // action; its set is its parent
  std::string name;
  XrActionType type = XR_ACTION_TYPE_BOOLEAN_INPUT;
  std::map<std::string, Strings> bindings;              // by interaction profile
  std::map<std::string, std::pair<Json, bool>> values;  // by user: at the last sync, and whether it changed
  std::set<std::string> active;                         // users
};

struct Frame {
  int number = 0;
  XrTime time = 0;
  bool shown = false, begun = false;
  std::uint64_t space = 0;  // that views were located in
  XrViewStateFlags flags = 0;
  std::vector<XrView> located;
};

struct Runtime {
  Runtime();
  ~Runtime();

  Json script = Json::object();
  std::filesystem::path folder;
  std::ofstream log_file;
  std::string function;  // that is called
  std::map<std::uint64_t, Object> objects;
  std::uint64_t last_id = 0;
  Strings paths;
  std::deque<XrEventDataBuffer> events;
  std::set<std::string> extensions, suggested;  // those that are enabled; profiles that have bindings
  Json input = Json::object();                  // by path, as scripted last
  std::map<std::size_t, std::uint64_t> depth_of_view;
  bool instance_lost = false, asked_requirements = false;
  // Of the session:
  std::uint64_t session = 0;
  void* context = nullptr;
  XrSessionState state = XR_SESSION_STATE_IDLE;
  bool running = false, lost = false, attached = false;
  std::string then = "exiting";  // what comes after STOPPING, or "ready"
  XrViewConfigurationType views = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  std::optional<Frame> frame;  // under way
  int next_frame = 0, ended_frames = 0, applied = -1;

  void log(const Json& line) {
    if (log_file.is_open()) log_file << line.dump() << std::endl;
  }
  int now() const { return frame ? frame->number : next_frame; }
  XrDuration period() const { return script.value("period", XrDuration{11'111'111}); }
};

Runtime& runtime() {
  static Runtime the_runtime;
  return the_runtime;
}

/// Ends a call with an error: the application's fault, if a text says which.
struct Refusal {
  XrResult result;
  std::string text;
};

void require(bool good, XrResult result, const std::string& text) {
  if (!good) throw Refusal{result, text};
}

void fault(const std::string& text, XrResult result = XR_SUCCESS) {
  Runtime& r = runtime();
  r.log({{"what", "fault"},
         {"function", r.function},
         {"frame", r.now()},
         {"result", name_of(result)},
         {"text", text}});
}

/// Whether the runtime is to pretend that the application made this fault in the frame under way.
bool is_planted(const char* name) {
  return runtime().script.value("plant", "") == name && runtime().now() >= 1;
}

template <typename Handle>
std::uint64_t id_of(Handle handle) {
  return reinterpret_cast<std::uint64_t>(handle);
}

template <typename Handle>
Object& get(const char* kind, Handle handle, bool even_lost = false) {
  Runtime& r = runtime();
  const auto found = r.objects.find(id_of(handle));
  require(found != r.objects.end() && found->second.kind == kind, XR_ERROR_HANDLE_INVALID,
          std::string(kind) + " " + std::to_string(id_of(handle)) + " is not there, or was destroyed");
  require(even_lost || !r.instance_lost, XR_ERROR_INSTANCE_LOST, "");
  require(even_lost || !r.lost || found->second.kind == "instance", XR_ERROR_SESSION_LOST, "");
  return found->second;
}

template <typename Handle>
Object& add(const char* kind, std::uint64_t parent, Handle* out) {
  Runtime& r = runtime();
  *out = reinterpret_cast<Handle>(++r.last_id);
  Object& object = r.objects[r.last_id];
  object.kind = kind;
  object.parent = parent;
  return object;
}

void erase(std::uint64_t id, Json* alive) {
  Runtime& r = runtime();
  const auto is_child = [&](const auto& one) { return one.second.parent == id; };
  for (auto at = r.objects.begin(); (at = std::find_if(at, r.objects.end(), is_child)) != r.objects.end();) {
    const std::uint64_t child = at->first;
    if (alive != nullptr) alive->push_back(r.objects.at(child).kind);
    erase(child, alive);
    at = r.objects.begin();
  }
  const std::vector<GLuint>& textures = r.objects.at(id).textures;
  if (!textures.empty()) glDeleteTextures(static_cast<GLsizei>(textures.size()), textures.data());
  if (id == r.session) {
    r.session = 0;
    r.running = r.lost = r.attached = false;
    r.frame.reset();
    r.depth_of_view.clear();
  }
  r.objects.erase(id);
}

template <typename Handle>
XrResult destroy(const char* kind, Handle handle) {
  const Object& object = get(kind, handle, true);
  if (object.acquired) fault("an image was not released");
  Json alive = Json::array();
  const bool is_set = object.kind == "action set";  // whose actions go with it, as everybody lets them
  erase(id_of(handle), is_set ? nullptr : &alive);
  runtime().log({{"what", "destroyed"}, {"kind", kind}, {"id", id_of(handle)}, {"alive", alive}});
  return XR_SUCCESS;
}

/// The two calls by which OpenXR gives arrays: how many, then what. `put(k)` writes element k.
template <typename Put>
XrResult fill(std::size_t count, std::uint32_t capacity, std::uint32_t* count_out, const Put& put) {
  *count_out = static_cast<std::uint32_t>(count);
  if (capacity == 0) return XR_SUCCESS;
  require(capacity >= count, XR_ERROR_SIZE_INSUFFICIENT,
          "room for " + std::to_string(capacity) + " of " + std::to_string(count));
  for (std::size_t k = 0; k < count; ++k) put(k);
  return XR_SUCCESS;
}

// Views, spaces and the session's states.

XrViewStateFlags script_flags() {
  XrViewStateFlags flags = 15;
  if (!runtime().script.contains("flags")) return flags;
  flags = 0;
  for (const Json& name : runtime().script["flags"])
    flags |=
        name == "orientation_valid" ? XR_VIEW_STATE_ORIENTATION_VALID_BIT : XR_VIEW_STATE_POSITION_VALID_BIT;
  return flags;
}

struct ViewSpec {
  std::uint32_t width = 96, height = 80;
  XrFovf fov = {-0.855f, 0.646f, 0.7f, -0.7f};
  Pose pose;  // of the eye in the head
};

std::vector<ViewSpec> views_of(XrViewConfigurationType type) {
  const bool quad = type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO;
  const Json all = runtime().script.value("views", Json::object());
  const char* const name = quad ? "quad" : "stereo";
  const bool has_quad = all.contains("quad") && runtime().extensions.contains("XR_VARJO_quad_views");
  require(!quad || has_quad, XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "four views are not offered");
  std::vector<ViewSpec> specs(quad ? 4 : 2);
  for (std::size_t k = 0; k < specs.size(); ++k) {
    ViewSpec& spec = specs[k];
    spec.pose.position.x = k % 2 == 0 ? -0.0315 : 0.0315;
    if (k % 2 == 1) spec.fov = {-0.646f, 0.855f, 0.7f, -0.7f};
    if (!all.contains(name)) continue;
    const Json& view = all[name].at(k);
    spec.width = view.value("width", spec.width);
    spec.height = view.value("height", spec.height);
    if (view.contains("position")) spec.pose = pose_from(view);
    if (!view.contains("fov")) continue;
    const auto f = view["fov"].get<std::array<float, 4>>();
    spec.fov = {f[0], f[1], f[2], f[3]};
  }
  return specs;
}

Pose head_in_script(XrTime time) {
  const Json heads = runtime().script.value("heads", Json{{{"position", {0, 1.6, 0}}}});
  const auto frame =
      static_cast<std::size_t>((time - first_time + runtime().period() / 2) / runtime().period());
  return pose_from(heads.at(std::min(frame, heads.size() - 1)));
}

std::string user_of(const std::string& path) {
  for (const char* user : {"/user/hand/left", "/user/hand/right", gaze_user}) {
    if (path.rfind(user, 0) == 0) return user;
  }
  return "";
}

/// In the script's world; none where it is not tracked.
std::optional<Pose> pose_of(const Object& space, XrTime time) {
  const Json& script = runtime().script;
  if (!space.reference) {
    const auto action = runtime().objects.find(space.action);
    if (action == runtime().objects.end()) return std::nullopt;
    const std::string user = space.user.empty() ? gaze_user : space.user;
    if (!action->second.active.contains(user)) return std::nullopt;
    if (user == gaze_user) return head_in_script(time) * pose_from(script["gaze"]) * space.offset;
    const Json& value = action->second.values.at(user).first;
    return value.is_object() ? std::optional(pose_from(value) * space.offset) : std::nullopt;
  }
  if (*space.reference == XR_REFERENCE_SPACE_TYPE_VIEW) return head_in_script(time) * space.offset;
  if (*space.reference == XR_REFERENCE_SPACE_TYPE_STAGE) return space.offset;
  Pose local = pose_from(script.value("recentre", Json{{"position", {0, 1.6, 0}}}));
  if (*space.reference == local_floor) local.position.y = 0.0;
  return local * space.offset;
}

template <typename Event>
void queue(const Event& event) {
  XrEventDataBuffer buffer{XR_TYPE_EVENT_DATA_BUFFER};
  std::memcpy(&buffer, &event, sizeof(event));
  runtime().events.push_back(buffer);
}

void set_state(XrSessionState state) {
  Runtime& r = runtime();
  r.state = state;
  r.log({{"what", "state"}, {"state", name_of(state)}, {"frame", r.now()}});
  queue(XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr,
                                       reinterpret_cast<XrSession>(r.session), state, first_time});
}

bool is_synchronized(XrSessionState state) {
  return state >= XR_SESSION_STATE_SYNCHRONIZED && state <= XR_SESSION_STATE_FOCUSED;
}

/// By the states in between, as OpenXR has them follow each other.
void walk_to(XrSessionState state) {
  Runtime& r = runtime();
  if (state == XR_SESSION_STATE_STOPPING && is_synchronized(r.state)) walk_to(XR_SESSION_STATE_SYNCHRONIZED);
  if (!is_synchronized(state)) return set_state(state);
  while (r.state < state) set_state(static_cast<XrSessionState>(r.state + 1));
  while (r.state > state) set_state(static_cast<XrSessionState>(r.state - 1));
}

/// Lets happen what the script has for the frames up to this one.
void apply_events(int frame) {
  static const std::set<std::string> of_script = {"flags", "gaze", "hands", "profile", "recentre", "masks"};
  static const std::set<std::string> of_event = {"frame", "then", "fail", "result", "times"};
  Runtime& r = runtime();
  while (r.applied < frame) {
    ++r.applied;
    for (const Json& event : r.script.value("events", Json::array())) {
      if (event.value("frame", 0) != r.applied) continue;
      for (const auto& [key, value] : event.items()) {
        if (key == "state") {
          r.then = event.value("then", "exiting");
          walk_to(states.at(value));
        } else if (key == "instance_loss") {
          queue(
              XrEventDataInstanceLossPending{XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING, nullptr, first_time});
        } else if (key == "input") {
          r.input.update(value);
        } else if (of_script.contains(key)) {
          r.script[key] = value;
        } else if (!of_event.contains(key)) {
          throw std::runtime_error("an event of the script has an unknown word: " + key);
        }
        if (key == "masks")
          queue(XrEventDataVisibilityMaskChangedKHR{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR, nullptr,
                                                    reinterpret_cast<XrSession>(r.session), r.views, 0});
      }
    }
  }
}

/// What an event of the script lets a function return instead of doing its work.
std::optional<XrResult> scripted_result() {
  Runtime& r = runtime();
  if (!r.script.contains("events")) return std::nullopt;
  for (Json& event : r.script["events"]) {
    if (event.value("fail", "") != r.function || event.value("frame", 0) > r.now()) continue;
    const int times = event.value("times", 1'000'000);
    if (times == 0) continue;
    event["times"] = times - 1;
    const XrResult result = results.at(event.at("result"));
    r.lost = r.lost || result == XR_ERROR_SESSION_LOST;
    r.instance_lost = r.instance_lost || result == XR_ERROR_INSTANCE_LOST;
    return result;
  }
  return std::nullopt;
}

Runtime::Runtime() {
  static const std::set<std::string> words = {
      "folder", "frames",   "heads",   "spaces", "views",  "masks",          "extensions", "formats",
      "system", "period",   "sleep",   "late",   "pixels", "not_rendered",   "immutable",  "flags",
      "gaze",   "recentre", "profile", "hands",  "events", "unordered_srgb", "plant"};
  const char* const path = std::getenv("BINOSPLAT_XR_SCRIPT");
  if (path == nullptr) return;
  std::ifstream in(path);
  script = Json::parse(in);
  for (const auto& [word, value] : script.items()) {
    if (!words.contains(word)) throw std::runtime_error(std::string(path) + ": there is no word " + word);
  }
  folder = script.value("folder", "");
  if (!folder.empty()) log_file.open(folder / "log.jsonl", std::ios::app);
}

Runtime::~Runtime() {
  Json left = Json::array();
  for (const auto& [id, object] : objects) left.push_back(object.kind);
  if (!left.empty()) log({{"what", "left"}, {"objects", left}});
}

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

// Layers.

Json to_json(const XrRect2Di& rect) {
  return {rect.offset.x, rect.offset.y, rect.extent.width, rect.extent.height};
}

/// What a layer shows: checked, its pixels written, the top row first. The name of their file, or nothing.
Json check_image(const XrSwapchainSubImage& image, bool is_depth, std::size_t view) {
  const Runtime& r = runtime();
  Object& of = get("swapchain", image.swapchain);
  const std::string name = "view " + std::to_string(view) + (is_depth ? "'s depth" : "");
  require(of.is_depth == is_depth, XR_ERROR_VALIDATION_FAILURE, name + " is of the other kind of swapchain");
  require(of.released.has_value(), XR_ERROR_LAYER_INVALID, name + " was never released");
  const auto& [offset, extent] = image.imageRect;
  const bool inside = offset.x >= 0 && offset.y >= 0 && extent.width > 0 && extent.height > 0 &&
                      offset.x + std::int64_t{extent.width} <= of.info.width &&
                      offset.y + std::int64_t{extent.height} <= of.info.height;
  require(inside, XR_ERROR_SWAPCHAIN_RECT_INVALID, name + " has a rectangle beyond its swapchain");
  if (of.released_frame != r.now()) fault(name + " is an image of another frame");
  if (of.pixels.empty()) return nullptr;
  if (read_texture(of, of.textures[*of.released]) != of.pixels)
    fault(name + " was written to after its release");
  char file[64];
  std::snprintf(file, sizeof(file), "frame%04d_view%zu.%s", r.now(), view, is_depth ? "depth" : "rgba");
  std::ofstream out(r.folder / file, std::ios::binary);
  for (int row = offset.y + extent.height - 1; row >= offset.y; --row) {
    const std::size_t at =
        std::size_t{4} * (static_cast<std::size_t>(row) * of.info.width + static_cast<std::size_t>(offset.x));
    out.write(reinterpret_cast<const char*>(&of.pixels[at]), std::streamsize{4} * extent.width);
  }
  return file;
}

Json check_depth(const XrCompositionLayerProjectionView& view, std::size_t index) {
  Runtime& r = runtime();
  if (view.next == nullptr) return nullptr;
  XrCompositionLayerDepthInfoKHR depth = *static_cast<const XrCompositionLayerDepthInfoKHR*>(view.next);
  if (is_planted("planes")) depth.farZ = depth.nearZ;
  if (!r.extensions.contains(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME))
    fault("depth without its extension");
  const bool planes = depth.nearZ >= 0 && depth.farZ >= 0 && depth.nearZ != depth.farZ;
  const bool range = depth.minDepth >= 0 && depth.minDepth < depth.maxDepth && depth.maxDepth <= 1;
  require(planes && range, XR_ERROR_VALIDATION_FAILURE, "depths between planes that bound nothing");
  // Of the shape of the colours, but for a pixel, by which rounding makes smaller ones longer.
  const XrExtent2Di size = depth.subImage.imageRect.extent, colours = view.subImage.imageRect.extent;
  const std::int64_t apart =
      std::int64_t{size.width} * colours.height - std::int64_t{size.height} * colours.width;
  if (std::abs(apart) > std::max(colours.width, colours.height))
    fault("depths of another shape than the colours");
  // A view's depths stay that view's.
  const auto [had, is_new] = r.depth_of_view.try_emplace(index, id_of(depth.subImage.swapchain));
  if (had->second != id_of(depth.subImage.swapchain)) fault("a view has the depths of another one");
  return {{"rect", to_json(depth.subImage.imageRect)},
          {"near", depth.nearZ},
          {"far", depth.farZ},
          {"file", check_image(depth.subImage, true, index)}};
}

template <typename T>
bool same(const T& a, const T& b) {  // bit for bit, NaN included
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// A projection layer: of this frame, of the right eyes, and there?
Json check_layer(const XrCompositionLayerBaseHeader* header) {
  const Runtime& r = runtime();
  require(header != nullptr && header->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION, XR_ERROR_LAYER_INVALID,
          "a layer that is no projection");
  const auto& layer = *reinterpret_cast<const XrCompositionLayerProjection*>(header);
  get("space", layer.space);
  require(layer.viewCount == views_of(r.views).size(), XR_ERROR_VALIDATION_FAILURE, "a layer of other views");
  const Frame& frame = *r.frame;
  if (id_of(layer.space) != frame.space) fault("a layer in another space than views were located in");
  if ((frame.flags & 3) != 3) fault("a layer of poses that are not valid");
  std::vector<XrCompositionLayerProjectionView> views(layer.views, layer.views + layer.viewCount);
  if (is_planted("pose")) views[0].pose.position.x += 0.01f;
  if (is_planted("fov")) views[1].fov.angleUp += 0.01f;
  if (is_planted("eyes")) std::swap(views[0].pose, views[1].pose);
  if (is_planted("rectangle")) ++views[0].subImage.imageRect.extent.width;
  if (is_planted("depths")) std::swap(views[0].next, views[1].next);
  Json list = Json::array();
  for (std::size_t k = 0; k < views.size(); ++k) {
    const std::string name = "view " + std::to_string(k);
    const bool has = k < frame.located.size();
    if (!has || !same(views[k].pose, frame.located[k].pose))
      fault(name + " has another pose than was located");
    if (!has || !same(views[k].fov, frame.located[k].fov)) fault(name + " has another fov than was located");
    list.push_back({{"rect", to_json(views[k].subImage.imageRect)},
                    {"colour", check_image(views[k].subImage, false, k)},
                    {"depth", check_depth(views[k], k)}});
  }
  return {{"views", list}};
}

// Actions.

/// What controllers have, below their hands; "left:" and "right:": of one hand only.
const std::map<std::string, Strings> profiles = {
    {"khr/simple_controller", {"select/click", "menu/click"}},
    {"oculus/touch_controller",
     {"left:x/click", "left:y/click", "left:menu/click", "right:a/click", "right:b/click", "squeeze/value",
      "trigger/value", "thumbstick", "thumbstick/click"}},
    {"valve/index_controller",
     {"a/click", "b/click", "squeeze/value", "squeeze/force", "trigger/click", "trigger/value", "thumbstick",
      "thumbstick/click", "trackpad"}},
    {"microsoft/motion_controller",
     {"menu/click", "squeeze/click", "trigger/value", "thumbstick", "thumbstick/click", "trackpad",
      "trackpad/click"}},
    {"htc/vive_controller",
     {"squeeze/click", "menu/click", "trigger/click", "trigger/value", "trackpad", "trackpad/click"}}};
constexpr const char* gaze_profile = "ext/eye_gaze_interaction";

bool has_path(const std::string& profile, const std::string& path) {
  if (profile == gaze_profile) return path == "/user/eyes_ext/input/gaze_ext/pose";
  for (const std::string hand : {"left", "right"}) {
    const std::string start = "/user/hand/" + hand + "/input/";
    if (path.rfind(start, 0) != 0) continue;
    const std::string below = path.substr(start.size());
    if (below == "grip/pose" || below == "aim/pose") return true;
    for (const std::string& one : profiles.at(profile)) {
      if (one == below || one == hand + ":" + below) return true;
    }
  }
  return false;
}

bool fits(XrActionType type, const std::string& path) {
  const std::string last = path.substr(path.rfind('/') + 1);
  const bool vector = last == "thumbstick" || last == "trackpad";
  if (type == XR_ACTION_TYPE_POSE_INPUT) return last == "pose";
  return (type == XR_ACTION_TYPE_VECTOR2F_INPUT) == vector && last != "pose";
}

/// The interaction profile of a user now; empty: nobody is there, or nothing was bound.
std::string profile_of(const std::string& user) {
  const Runtime& r = runtime();
  const Strings hands = r.script.value("hands", Strings{"left", "right"});
  std::string profile;
  if (user == gaze_user) {
    if (r.script.contains("gaze") && !r.script["gaze"].is_null()) profile = gaze_profile;
  } else if (std::count(hands.begin(), hands.end(), user.substr(user.rfind('/') + 1)) != 0) {
    const std::string whole = r.script.value("profile", "/interaction_profiles/khr/simple_controller");
    profile = whole.substr(std::string("/interaction_profiles/").size());
  }
  return r.suggested.contains(profile) ? profile : "";
}

void sync(Object& action, bool focused) {
  const Runtime& r = runtime();
  action.active.clear();
  for (const std::string user : {"/user/hand/left", "/user/hand/right", gaze_user}) {
    Json value;
    for (const std::string& path : action.bindings[profile_of(user)]) {
      if (!focused || user_of(path) != user) continue;
      action.active.insert(user);
      if (r.input.contains(path)) value = r.input[path];
    }
    auto& [kept, changed] = action.values[user];
    changed = value != kept;
    kept = value;
  }
}

/// What an action read at the last sync. Fills in what the states of all types have.
template <typename State>
Json read_action(const XrActionStateGetInfo* info, XrActionType type, State& out) {
  Object& action = get("action", info->action);
  require(runtime().attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "an action whose set is not attached");
  require(action.type == type, XR_ERROR_ACTION_TYPE_MISMATCH, action.name + " is of another type");
  const std::string user = runtime().paths.at(info->subactionPath - 1);
  const auto& [value, changed] = action.values[user];
  out.isActive = action.active.contains(user) ? XR_TRUE : XR_FALSE;
  out.changedSinceLastSync = changed ? XR_TRUE : XR_FALSE;
  return value;
}

// OpenXR's functions.

XrResult enumerate_extensions(const char*, std::uint32_t capacity, std::uint32_t* count,
                              XrExtensionProperties* properties) {
  static const Strings all = {
      "XR_MNDX_egl_enable",     "XR_KHR_opengl_enable",        "XR_KHR_composition_layer_depth",
      "XR_KHR_visibility_mask", "XR_EXT_eye_gaze_interaction", "XR_VARJO_quad_views",
      "XR_EXT_local_floor"};
  const Strings names = runtime().script.value("extensions", all);
  return fill(names.size(), capacity, count, [&](std::size_t k) {
    std::strncpy(properties[k].extensionName, names[k].c_str(), XR_MAX_EXTENSION_NAME_SIZE - 1);
    properties[k].extensionVersion = 1;
  });
}

XrResult create_instance(const XrInstanceCreateInfo* info, XrInstance* out) {
  Runtime& r = runtime();
  r.extensions = {info->enabledExtensionNames, info->enabledExtensionNames + info->enabledExtensionCount};
  add("instance", 0, out);
  r.log({{"what", "instance"}, {"extensions", r.extensions}});
  return XR_SUCCESS;
}

XrResult destroy_instance(XrInstance handle) { return destroy("instance", handle); }

XrResult get_instance_properties(XrInstance handle, XrInstanceProperties* properties) {
  get("instance", handle);
  properties->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  std::strcpy(properties->runtimeName, "binosplat's test runtime");
  return XR_SUCCESS;
}

XrResult poll_event(XrInstance handle, XrEventDataBuffer* event) {
  get("instance", handle);
  Runtime& r = runtime();
  if (r.events.empty()) return XR_EVENT_UNAVAILABLE;
  *event = r.events.front();
  r.events.pop_front();
  return XR_SUCCESS;
}

XrResult result_to_string(XrInstance, XrResult value, char* buffer) {
  std::strncpy(buffer, name_of(value).c_str(), XR_MAX_RESULT_STRING_SIZE - 1);
  return XR_SUCCESS;
}

XrResult string_to_path(XrInstance handle, const char* text, XrPath* path) {
  get("instance", handle);
  const std::string name = text;
  require(name.size() > 1 && name[0] == '/' && name.back() != '/' && name.find("//") == std::string::npos,
          XR_ERROR_PATH_FORMAT_INVALID, "'" + name + "' is no path");
  Strings& paths = runtime().paths;
  auto at = std::find(paths.begin(), paths.end(), name);
  if (at == paths.end()) at = paths.insert(at, name);
  *path = static_cast<XrPath>(at - paths.begin()) + 1;
  return XR_SUCCESS;
}

XrResult get_system(XrInstance handle, const XrSystemGetInfo*, XrSystemId* system) {
  get("instance", handle);
  *system = the_system;
  return results.at(runtime().script.value("system", "XR_SUCCESS"));
}

XrResult get_system_properties(XrInstance handle, XrSystemId, XrSystemProperties* properties) {
  get("instance", handle);
  std::strcpy(properties->systemName, "binosplat's test headset");
  return XR_SUCCESS;
}

XrResult enumerate_view_configurations(XrInstance handle, XrSystemId, std::uint32_t capacity,
                                       std::uint32_t* count, XrViewConfigurationType* types) {
  get("instance", handle);
  const Json views = runtime().script.value("views", Json::object());
  const bool quad = views.contains("quad") && runtime().extensions.contains("XR_VARJO_quad_views");
  return fill(quad ? 2 : 1, capacity, count, [&](std::size_t k) {
    types[k] = quad && k == 0 ? XR_VIEW_CONFIGURATION_TYPE_PRIMARY_QUAD_VARJO
                              : XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  });
}

XrResult enumerate_view_configuration_views(XrInstance handle, XrSystemId, XrViewConfigurationType type,
                                            std::uint32_t capacity, std::uint32_t* count,
                                            XrViewConfigurationView* views) {
  get("instance", handle);
  const std::vector<ViewSpec> all = views_of(type);
  return fill(all.size(), capacity, count, [&](std::size_t k) {
    views[k] = {XR_TYPE_VIEW_CONFIGURATION_VIEW, nullptr, all[k].width, 4096, all[k].height, 4096, 1, 1};
  });
}

XrResult get_requirements(XrInstance handle, XrSystemId, XrGraphicsRequirementsOpenGLKHR* requirements) {
  get("instance", handle);
  requirements->minApiVersionSupported = XR_MAKE_VERSION(4, 3, 0);
  requirements->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
  runtime().asked_requirements = true;
  return XR_SUCCESS;
}

XrResult create_session(XrInstance handle, const XrSessionCreateInfo* info, XrSession* out) {
  Runtime& r = runtime();
  get("instance", handle);
  require(r.session == 0, XR_ERROR_LIMIT_REACHED, "a second session");
  require(r.asked_requirements, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING, "before the requirements' call");
  const auto* egl = static_cast<const XrGraphicsBindingEGLMNDX*>(info->next);
  if (const auto* xlib = static_cast<const XlibBinding*>(info->next);
      xlib != nullptr && xlib->visual == egl_visual)
    egl = reinterpret_cast<const XrGraphicsBindingEGLMNDX*>(xlib->drawable);
  const bool is_egl = egl != nullptr && egl->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX;
  require(is_egl && egl->context == eglGetCurrentContext() && egl->context != nullptr,
          XR_ERROR_GRAPHICS_DEVICE_INVALID, "no binding of the context of EGL that is current");
  r.session = id_of((add("session", id_of(handle), out), *out));
  r.log({{"what", "session"}});
  set_state(XR_SESSION_STATE_IDLE);
  set_state(XR_SESSION_STATE_READY);
  return XR_SUCCESS;
}

XrResult destroy_session(XrSession handle) { return destroy("session", handle); }

XrResult begin_session(XrSession handle, const XrSessionBeginInfo* info) {
  Runtime& r = runtime();
  get("session", handle);
  require(!r.running && r.state == XR_SESSION_STATE_READY, XR_ERROR_SESSION_NOT_READY, name_of(r.state));
  r.views = info->primaryViewConfigurationType;
  r.running = true;
  r.log({{"what", "begin"}});
  walk_to(XR_SESSION_STATE_FOCUSED);
  apply_events(r.next_frame);
  return XR_SUCCESS;
}

XrResult end_session(XrSession handle) {
  Runtime& r = runtime();
  get("session", handle);
  require(r.running && r.state == XR_SESSION_STATE_STOPPING, XR_ERROR_SESSION_NOT_STOPPING, name_of(r.state));
  if (r.frame) fault("a frame was not ended");
  r.running = false;
  r.frame.reset();
  set_state(XR_SESSION_STATE_IDLE);
  set_state(r.then == "ready" ? XR_SESSION_STATE_READY : XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

XrResult request_exit_session(XrSession handle) {
  get("session", handle);
  require(runtime().running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  runtime().then = "exiting";
  if (runtime().state != XR_SESSION_STATE_STOPPING) walk_to(XR_SESSION_STATE_STOPPING);
  return XR_SUCCESS;
}

std::vector<XrReferenceSpaceType> offered_spaces() {
  std::vector<XrReferenceSpaceType> offered;
  for (const std::string& name :
       runtime().script.value("spaces", Strings{"view", "local", "stage", "local_floor"})) {
    if (name != "local_floor" || runtime().extensions.contains("XR_EXT_local_floor"))
      offered.push_back(space_types.at(name));
  }
  return offered;
}

XrResult enumerate_reference_spaces(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrReferenceSpaceType* spaces) {
  get("session", handle);
  const auto all = offered_spaces();
  return fill(all.size(), capacity, count, [&](std::size_t k) { spaces[k] = all[k]; });
}

XrResult create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  get("session", handle);
  const auto all = offered_spaces();
  require(std::count(all.begin(), all.end(), info->referenceSpaceType) != 0,
          XR_ERROR_REFERENCE_SPACE_UNSUPPORTED, "a reference space that is not offered");
  Object& space = add("space", id_of(handle), out);
  space.reference = info->referenceSpaceType;
  space.offset = from_xr(info->poseInReferenceSpace);
  return XR_SUCCESS;
}

XrResult create_action_space(XrSession handle, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  get("session", handle);
  require(get("action", info->action).type == XR_ACTION_TYPE_POSE_INPUT, XR_ERROR_ACTION_TYPE_MISMATCH,
          "a space of an action that is no pose");
  Object& space = add("space", id_of(handle), out);
  space.action = id_of(info->action);
  if (info->subactionPath != XR_NULL_PATH) space.user = runtime().paths.at(info->subactionPath - 1);
  space.offset = from_xr(info->poseInActionSpace);
  return XR_SUCCESS;
}

XrResult locate_space(XrSpace handle, XrSpace base, XrTime time, XrSpaceLocation* location) {
  const auto pose = pose_of(get("space", handle), time), from = pose_of(get("space", base), time);
  require(time > 0, XR_ERROR_TIME_INVALID, "a space at no time");
  location->locationFlags = pose && from ? 15 : 0;
  if (pose && from) location->pose = to_xr(inverse(*from) * *pose);
  return XR_SUCCESS;
}

XrResult destroy_space(XrSpace handle) { return destroy("space", handle); }

XrResult locate_views(XrSession handle, const XrViewLocateInfo* info, XrViewState* state,
                      std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  Runtime& r = runtime();
  get("session", handle);
  require(info->viewConfigurationType == r.views, XR_ERROR_VALIDATION_FAILURE, "another view configuration");
  if (!r.frame || info->displayTime != r.frame->time)
    fault("views located for another time than the frame's");
  const auto base = pose_of(get("space", info->space), info->displayTime);
  state->viewStateFlags = script_flags();
  std::vector<XrView> located;
  for (const ViewSpec& spec : views_of(r.views)) {
    XrView& view = located.emplace_back(XrView{XR_TYPE_VIEW, nullptr, {}, spec.fov});
    view.pose = to_xr(inverse(*base) * head_in_script(info->displayTime) * spec.pose);
    // What is not valid is not to be used: it would be seen at once.
    if ((state->viewStateFlags & XR_VIEW_STATE_ORIENTATION_VALID_BIT) == 0) view.pose.orientation = {};
    if ((state->viewStateFlags & XR_VIEW_STATE_POSITION_VALID_BIT) == 0) view.pose.position.x = NAN;
  }
  if (capacity > 0 && r.frame) {
    r.frame->space = id_of(info->space);
    r.frame->flags = state->viewStateFlags;
    r.frame->located = located;
  }
  return fill(located.size(), capacity, count, [&](std::size_t k) { views[k] = located[k]; });
}

XrResult enumerate_swapchain_formats(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                     std::int64_t* out) {
  get("session", handle);
  const Strings names = runtime().script.value(
      "formats", Strings{"GL_SRGB8_ALPHA8", "GL_RGBA8", "GL_DEPTH_COMPONENT32F", "GL_DEPTH_COMPONENT24"});
  return fill(names.size(), capacity, count, [&](std::size_t k) { out[k] = formats.at(names[k]); });
}

XrResult create_swapchain(XrSession handle, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
  Runtime& r = runtime();
  get("session", handle);
  std::uint32_t count = 0;
  std::array<std::int64_t, 8> offered{};
  enumerate_swapchain_formats(handle, offered.size(), &count, offered.data());
  require(std::count(offered.begin(), offered.begin() + count, info->format) != 0,
          XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "format " + std::to_string(info->format));
  require(info->width - 1 < 4096 && info->height - 1 < 4096, XR_ERROR_SWAPCHAIN_RECT_INVALID, "a wrong size");
  require(info->sampleCount == 1 && info->faceCount == 1 && info->arraySize == 1 && info->mipCount == 1,
          XR_ERROR_FEATURE_UNSUPPORTED, "several samples, faces, layers or levels");
  // No fault of the program's: it may ask.
  if (info->format == GL_SRGB8_ALPHA8 && !r.script.value("unordered_srgb", true) &&
      (info->usageFlags & XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT) != 0)
    return XR_ERROR_FEATURE_UNSUPPORTED;
  Object& swapchain = add("swapchain", id_of(handle), out);
  swapchain.info = *info;
  swapchain.is_depth = info->format != GL_SRGB8_ALPHA8 && info->format != GL_RGBA8;
  const auto width = static_cast<GLsizei>(info->width), height = static_cast<GLsizei>(info->height);
  const auto format = static_cast<GLenum>(info->format);
  for (GLuint& texture : swapchain.textures = std::vector<GLuint>(3)) {
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    if (r.script.value("immutable", true)) {
      glTextureStorage2D(texture, 1, format, width, height);
      continue;
    }
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0,
                 swapchain.is_depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
    glTextureParameteri(texture, GL_TEXTURE_MAX_LEVEL, 0);
    glBindTexture(GL_TEXTURE_2D, 0);
  }
  r.log({{"what", "swapchain"}, {"width", info->width}, {"height", info->height}});
  return XR_SUCCESS;
}

XrResult destroy_swapchain(XrSwapchain handle) { return destroy("swapchain", handle); }

XrResult enumerate_swapchain_images(XrSwapchain handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrSwapchainImageBaseHeader* images) {
  const Object& swapchain = get("swapchain", handle);
  auto* out = reinterpret_cast<XrSwapchainImageOpenGLKHR*>(images);
  return fill(swapchain.textures.size(), capacity, count,
              [&](std::size_t k) { out[k].image = swapchain.textures[k]; });
}

XrResult acquire_swapchain_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo*,
                                 std::uint32_t* index) {
  Object& swapchain = get("swapchain", handle);
  require(!swapchain.acquired, XR_ERROR_CALL_ORDER_INVALID, "an image is acquired already");
  swapchain.acquired = swapchain.next;
  swapchain.next = (swapchain.next + 1) % swapchain.textures.size();
  *index = static_cast<std::uint32_t>(*swapchain.acquired);
  return XR_SUCCESS;
}

XrResult wait_swapchain_image(XrSwapchain handle, const XrSwapchainImageWaitInfo*) {
  Object& swapchain = get("swapchain", handle);
  require(swapchain.acquired && !swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "no image to wait for");
  swapchain.waited = !is_planted("wait");
  return XR_SUCCESS;
}

XrResult release_swapchain_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo*) {
  Runtime& r = runtime();
  Object& swapchain = get("swapchain", handle);
  require(swapchain.acquired.has_value(), XR_ERROR_CALL_ORDER_INVALID, "no image is acquired");
  require(swapchain.waited, XR_ERROR_CALL_ORDER_INVALID, "the image was not waited for");
  if (is_planted("release")) return XR_SUCCESS;
  swapchain.waited = false;
  swapchain.released = std::exchange(swapchain.acquired, std::nullopt);
  swapchain.released_frame = is_planted("stale") ? 0 : r.now();
  swapchain.pixels.clear();
  const Json kept = r.script.value("pixels", Json());
  if (r.folder.empty() || (!kept.is_null() && std::find(kept.begin(), kept.end(), r.now()) == kept.end()))
    return XR_SUCCESS;
  swapchain.pixels = read_texture(swapchain, swapchain.textures[*swapchain.released]);
  if (is_planted("written")) swapchain.pixels[0] ^= 1;
  return XR_SUCCESS;
}

XrResult wait_frame(XrSession handle, const XrFrameWaitInfo*, XrFrameState* state) {
  Runtime& r = runtime();
  get("session", handle);
  require(r.running, XR_ERROR_SESSION_NOT_RUNNING, "the session does not run");
  require(!r.frame, XR_ERROR_CALL_ORDER_INVALID, "the frame before was not ended");
  r.lost = r.lost || r.next_frame >= r.script.value("frames", 3) + patience;
  require(!r.lost, XR_ERROR_SESSION_LOST, "the program does not stop");
  apply_events(r.next_frame);
  Frame frame{.number = r.next_frame++};
  const auto late = r.script.value("late", std::set<int>()),
             hidden = r.script.value("not_rendered", std::set<int>());
  frame.time =
      first_time + r.period() * (frame.number + std::distance(late.begin(), late.upper_bound(frame.number)));
  frame.shown = r.state >= XR_SESSION_STATE_VISIBLE && r.state <= XR_SESSION_STATE_FOCUSED &&
                !hidden.contains(frame.number);
  state->predictedDisplayTime = frame.time;
  state->predictedDisplayPeriod = r.period();
  state->shouldRender = frame.shown ? XR_TRUE : XR_FALSE;
  r.frame = frame;
  if (r.script.value("sleep", false)) std::this_thread::sleep_for(std::chrono::nanoseconds(r.period()));
  return XR_SUCCESS;
}

XrResult begin_frame(XrSession handle, const XrFrameBeginInfo*) {
  get("session", handle);
  require(runtime().frame.has_value(), XR_ERROR_CALL_ORDER_INVALID, "xrWaitFrame is expected before");
  runtime().frame->begun = !is_planted("begin");
  return XR_SUCCESS;
}

XrResult end_frame(XrSession handle, const XrFrameEndInfo* info) {
  Runtime& r = runtime();
  get("session", handle);
  require(r.frame && r.frame->begun, XR_ERROR_CALL_ORDER_INVALID, "xrBeginFrame is expected before");
  const Frame frame = *r.frame;
  if (info->displayTime != frame.time + (is_planted("time") ? 1 : 0))
    fault("another display time than was predicted", XR_ERROR_TIME_INVALID);
  if (info->environmentBlendMode != XR_ENVIRONMENT_BLEND_MODE_OPAQUE)
    fault("another blend mode", XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED);
  for (const auto& [id, object] : r.objects) {
    if (object.acquired) fault("an image was not released");
  }
  Json located = Json::array(), layers = Json::array();
  for (const XrView& view : frame.located)
    located.push_back({{"pose", to_json(view.pose)}, {"fov", to_json(view.fov)}});
  for (std::uint32_t k = 0; k < info->layerCount; ++k) layers.push_back(check_layer(info->layers[k]));
  r.log({{"what", "frame"}, {"frame", frame.number}, {"located", located}, {"layers", layers}});
  r.frame.reset();
  ++r.ended_frames;
  apply_events(frame.number + 1);
  if (r.ended_frames >= r.script.value("frames", 3) && r.state < XR_SESSION_STATE_STOPPING) {
    r.then = "exiting";
    walk_to(XR_SESSION_STATE_STOPPING);
  }
  return XR_SUCCESS;
}

XrResult create_action_set(XrInstance handle, const XrActionSetCreateInfo*, XrActionSet* out) {
  get("instance", handle);
  add("action set", id_of(handle), out);
  return XR_SUCCESS;
}

XrResult destroy_action_set(XrActionSet handle) { return destroy("action set", handle); }

XrResult create_action(XrActionSet handle, const XrActionCreateInfo* info, XrAction* out) {
  get("action set", handle);
  require(!runtime().attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "the set is attached already");
  for (const auto& [id, other] : runtime().objects)
    require(other.kind != "action" || other.name != info->actionName, XR_ERROR_NAME_DUPLICATED, other.name);
  Object& action = add("action", id_of(handle), out);
  action.name = info->actionName;
  action.type = info->actionType;
  return XR_SUCCESS;
}

XrResult destroy_action(XrAction handle) { return destroy("action", handle); }

XrResult suggest_bindings(XrInstance handle, const XrInteractionProfileSuggestedBinding* info) {
  Runtime& r = runtime();
  get("instance", handle);
  require(!r.attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "actions are attached already");
  const std::string whole = r.paths.at(info->interactionProfile - 1), start = "/interaction_profiles/";
  const std::string profile = whole.substr(std::min(whole.size(), start.size()));
  require(profiles.contains(profile) || profile == gaze_profile, XR_ERROR_PATH_UNSUPPORTED,
          "no profile " + whole);
  for (std::uint32_t k = 0; k < info->countSuggestedBindings; ++k) {
    Object& action = get("action", info->suggestedBindings[k].action);
    std::string path = r.paths.at(info->suggestedBindings[k].binding - 1);
    if (r.script.value("plant", "") == "binding") path += "s";
    require(has_path(profile, path), XR_ERROR_PATH_UNSUPPORTED, profile + " has no " + path);
    require(fits(action.type, path), XR_ERROR_PATH_UNSUPPORTED,
            action.name + " is of another type than " + path);
    action.bindings[profile].push_back(path);
  }
  r.suggested.insert(profile);
  return XR_SUCCESS;
}

XrResult attach_action_sets(XrSession handle, const XrSessionActionSetsAttachInfo* info) {
  get("session", handle);
  require(!runtime().attached, XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "a set is attached already");
  for (std::uint32_t k = 0; k < info->countActionSets; ++k) get("action set", info->actionSets[k]);
  runtime().attached = true;
  return XR_SUCCESS;
}

XrResult sync_actions(XrSession handle, const XrActionsSyncInfo* info) {
  Runtime& r = runtime();
  get("session", handle);
  require(r.attached, XR_ERROR_ACTIONSET_NOT_ATTACHED, "no set is attached");
  for (std::uint32_t k = 0; k < info->countActiveActionSets; ++k)
    get("action set", info->activeActionSets[k].actionSet);
  const bool focused = r.state == XR_SESSION_STATE_FOCUSED;
  for (auto& [id, object] : r.objects) {
    if (object.kind == "action") sync(object, focused);
  }
  return focused ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

XrResult get_boolean(XrSession handle, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
  get("session", handle);
  const Json value = read_action(info, XR_ACTION_TYPE_BOOLEAN_INPUT, *out);
  const bool is_pushed =
      value.is_boolean() ? value.get<bool>() : value.is_number() && value.get<double>() > 0.5;
  out->currentState = is_pushed ? XR_TRUE : XR_FALSE;
  return XR_SUCCESS;
}

XrResult get_vector(XrSession handle, const XrActionStateGetInfo* info, XrActionStateVector2f* out) {
  get("session", handle);
  const Json value = read_action(info, XR_ACTION_TYPE_VECTOR2F_INPUT, *out);
  if (value.is_array()) out->currentState = {value[0], value[1]};
  return XR_SUCCESS;
}

XrResult get_visibility_mask(XrSession handle, XrViewConfigurationType, std::uint32_t view,
                             XrVisibilityMaskTypeKHR type, XrVisibilityMaskKHR* mask) {
  get("session", handle);
  require(type == XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR, XR_ERROR_VALIDATION_FAILURE,
          "another mask");
  const Json masks = runtime().script.value("masks", Json::array());
  const Json mesh = view < masks.size() ? masks[view] : Json::object();
  const auto vertices = mesh.value("vertices", std::vector<std::array<float, 2>>());
  const auto indices = mesh.value("indices", std::vector<std::uint32_t>());
  mask->vertexCountOutput = static_cast<std::uint32_t>(vertices.size());
  mask->indexCountOutput = static_cast<std::uint32_t>(indices.size());
  if (mask->vertexCapacityInput == 0 && mask->indexCapacityInput == 0) return XR_SUCCESS;
  require(mask->vertexCapacityInput >= vertices.size() && mask->indexCapacityInput >= indices.size(),
          XR_ERROR_SIZE_INSUFFICIENT, "no room for the mask");
  for (std::size_t k = 0; k < vertices.size(); ++k) mask->vertices[k] = {vertices[k][0], vertices[k][1]};
  std::copy(indices.begin(), indices.end(), mask->indices);
  return XR_SUCCESS;
}

// What the loader finds.

template <std::size_t N>
struct Name {
  constexpr Name(const char (&from)[N]) {  // NOLINT(google-explicit-constructor): a literal names a function
    std::copy(from, from + N, text);
  }
  char text[N]{};
};

/// A function as the loader calls it, with what a script or an error makes of it.
template <Name name, auto function>
struct Entry;
template <Name name, typename... Arguments, XrResult (*function)(Arguments...)>
struct Entry<name, function> {
  static XrResult XRAPI_CALL call(Arguments... arguments) {
    runtime().function = name.text;
    try {
      if (const auto result = scripted_result()) return *result;
      return function(arguments...);
    } catch (const Refusal& refusal) {
      if (!refusal.text.empty()) fault(refusal.text, refusal.result);
      return refusal.result;
    } catch (const std::exception& error) {
      fault(error.what(), XR_ERROR_RUNTIME_FAILURE);
      return XR_ERROR_RUNTIME_FAILURE;
    }
  }
};

#define ENTRY(name, function) \
  { "xr" #name, reinterpret_cast<PFN_xrVoidFunction>(&Entry<Name("xr" #name), &(function)>::call) }
const std::map<std::string, PFN_xrVoidFunction> entries = {
    ENTRY(EnumerateInstanceExtensionProperties, enumerate_extensions),
    ENTRY(CreateInstance, create_instance),
    ENTRY(DestroyInstance, destroy_instance),
    ENTRY(GetInstanceProperties, get_instance_properties),
    ENTRY(PollEvent, poll_event),
    ENTRY(ResultToString, result_to_string),
    ENTRY(StringToPath, string_to_path),
    ENTRY(GetSystem, get_system),
    ENTRY(GetSystemProperties, get_system_properties),
    ENTRY(EnumerateViewConfigurations, enumerate_view_configurations),
    ENTRY(EnumerateViewConfigurationViews, enumerate_view_configuration_views),
    ENTRY(GetOpenGLGraphicsRequirementsKHR, get_requirements),
    ENTRY(CreateSession, create_session),
    ENTRY(DestroySession, destroy_session),
    ENTRY(BeginSession, begin_session),
    ENTRY(EndSession, end_session),
    ENTRY(RequestExitSession, request_exit_session),
    ENTRY(EnumerateReferenceSpaces, enumerate_reference_spaces),
    ENTRY(CreateReferenceSpace, create_reference_space),
    ENTRY(CreateActionSpace, create_action_space),
    ENTRY(LocateSpace, locate_space),
    ENTRY(DestroySpace, destroy_space),
    ENTRY(LocateViews, locate_views),
    ENTRY(EnumerateSwapchainFormats, enumerate_swapchain_formats),
    ENTRY(CreateSwapchain, create_swapchain),
    ENTRY(DestroySwapchain, destroy_swapchain),
    ENTRY(EnumerateSwapchainImages, enumerate_swapchain_images),
    ENTRY(AcquireSwapchainImage, acquire_swapchain_image),
    ENTRY(WaitSwapchainImage, wait_swapchain_image),
    ENTRY(ReleaseSwapchainImage, release_swapchain_image),
    ENTRY(WaitFrame, wait_frame),
    ENTRY(BeginFrame, begin_frame),
    ENTRY(EndFrame, end_frame),
    ENTRY(CreateActionSet, create_action_set),
    ENTRY(DestroyActionSet, destroy_action_set),
    ENTRY(CreateAction, create_action),
    ENTRY(DestroyAction, destroy_action),
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

// As the loader's specification has it; no package has its header.
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
    const binosplat::xr_test::LoaderInfo*, binosplat::xr_test::RuntimeRequest* request) {
  try {
    binosplat::xr_test::runtime();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "xr_test_runtime: %s\n", error.what());
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 0);
  request->get = &binosplat::xr_test::get_instance_proc_addr;
  return XR_SUCCESS;
}
