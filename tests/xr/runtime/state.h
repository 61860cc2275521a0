#pragma once
// All that the test runtime knows while it runs, and how its functions refuse.

#include <deque>
#include <fstream>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <unordered_map>

#include "xr/runtime/gl.h"
#include "xr/runtime/script.h"

namespace binosplat::xr_test {

/// Ends a call with an error. Of the application's making, unless `fault` is false.
struct Refusal {
  XrResult result;
  std::string text;
  bool fault = true;
};

/// What a handle stands for. Ids are never used again.
struct Object {
  virtual ~Object() = default;
  virtual const char* kind() const = 0;
  std::uint64_t id = 0, parent = 0;
};

struct Instance : Object {
  const char* kind() const override { return "instance"; }
  std::set<std::string> extensions;
  bool asked_requirements = false;
  std::deque<XrEventDataBuffer> events;
};

struct Located {
  std::uint64_t space = 0;
  XrViewStateFlags flags = 0;
  std::vector<XrView> views;
};

/// A frame from xrWaitFrame on.
struct FrameRecord {
  int number = 0;
  XrTime time = 0;
  bool should_render = false;
  std::vector<Located> located;  // by xrLocateViews
  std::vector<std::string> faults;
};

struct Session : Object {
  const char* kind() const override { return "session"; }
  Binding binding;
  XrSessionState state = XR_SESSION_STATE_IDLE;
  bool running = false, lost = false;
  std::string then = "exiting";  // what comes after STOPPING: "exiting" or "ready"
  XrViewConfigurationType configuration = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
  std::optional<FrameRecord> waited, begun;            // not yet begun, not yet ended
  std::map<std::size_t, std::uint64_t> depth_of_view;  // the swapchain
  bool attached = false;
};

struct Swapchain : Object {
  const char* kind() const override { return "swapchain"; }
  XrSwapchainCreateInfo info{};
  bool depth = false;
  std::vector<std::uint32_t> textures;
  std::deque<std::uint32_t> acquired;  // the first one is waited for or may be released
  bool waited = false;
  std::uint32_t next = 0;
  std::optional<std::uint32_t> released;  // the image that a layer shows
  int released_frame = -1;
  std::vector<std::uint8_t> pixels;  // as released; empty: not kept
};

struct Space : Object {
  const char* kind() const override { return "space"; }
  std::optional<XrReferenceSpaceType> reference;  // none: of an action
  std::uint64_t action = 0;
  XrPath subaction = XR_NULL_PATH;
  Pose offset;
};

struct ActionSet : Object {
  const char* kind() const override { return "action set"; }
  std::string name, localized;
  bool attached = false;
};

/// What xrSyncActions saw of one user path.
struct ActionState {
  Json value;
  bool active = false, changed = false;
  XrTime time = 0;
};

struct Action : Object {
  const char* kind() const override { return "action"; }
  std::string name, localized;
  XrActionType type = XR_ACTION_TYPE_BOOLEAN_INPUT;
  std::set<std::string> users;                               // subaction paths
  std::map<std::string, std::vector<std::string>> bindings;  // by interaction profile
  std::map<std::string, ActionState> states;                 // by user path
};

class Runtime {
 public:
  Runtime();
  ~Runtime();

  Script script;
  std::recursive_mutex mutex;
  const char* function = "";  // that is being called
  std::unordered_map<std::uint64_t, std::unique_ptr<Object>> objects;
  std::vector<std::pair<int, Pose>> locals;  // where LOCAL lies from a frame on
  std::map<std::string, Json> input;         // by path, as scripted last
  std::map<XrPath, std::string> paths;
  std::set<std::string> suggested;  // interaction profiles that have bindings
  int applied = -1;                 // events of frames up to this one have happened
  // Counted on from session to session.
  int next_frame = 0;  // that xrWaitFrame gives out
  int ended_frames = 0;

  Instance* instance();
  Session* session();

  template <typename T>
  T& add(std::uint64_t parent) {
    auto object = std::make_unique<T>();
    object->id = ++last_id_;
    object->parent = parent;
    T& out = *object;
    objects[out.id] = std::move(object);
    return out;
  }

  /// What a handle stands for. Throws Refusal for one that is not there, and for what is lost unless
  /// `even_lost`.
  template <typename T, typename Handle>
  T& get(Handle handle, bool even_lost = false) {
    const auto found = objects.find(reinterpret_cast<std::uint64_t>(handle));
    T* out = found == objects.end() ? nullptr : dynamic_cast<T*>(found->second.get());
    if (out == nullptr) {
      throw Refusal{XR_ERROR_HANDLE_INVALID, T().kind() + std::string(" ") +
                                                 std::to_string(reinterpret_cast<std::uint64_t>(handle)) +
                                                 " is not there, or was destroyed"};
    }
    if (!even_lost) check_lost(*out);
    return *out;
  }

  /// Forgets an object and its children, and says which were alive.
  void destroy(Object& object);

  /// The frame under way, or the one that xrWaitFrame would give out.
  int frame();
  /// The frame of a time.
  int frame_of(XrTime time) const;
  XrTime time_of(int frame) const { return script.first_time + frame * script.period; }
  /// What a script's event lets a function return instead of doing its work.
  std::optional<XrResult> scripted_result();

  void log(const Json& line);
  void fault(const std::string& text, XrResult result = XR_SUCCESS);

  template <typename Event>
  void queue(const Event& event) {
    static_assert(sizeof(Event) <= sizeof(XrEventDataBuffer));
    XrEventDataBuffer buffer = {XR_TYPE_EVENT_DATA_BUFFER};
    std::memcpy(&buffer, &event, sizeof(event));
    if (instance() != nullptr) instance()->events.push_back(buffer);
  }

 private:
  void check_lost(const Object& object);

  std::uint64_t last_id_ = 0;
  std::ofstream log_;
  bool instance_lost_ = false;
};

Runtime& runtime();

/// By the states in between, as OpenXR has them follow each other.
void walk_to(Session& session, XrSessionState state);
void set_state(Session& session, XrSessionState state);
/// Lets happen what the script has for the frames up to this one.
void apply_events(Session& session, int frame);
/// The pose of a space in the script's world; none where it is not tracked.
std::optional<Pose> pose_of(const Space& space, XrTime time);

/// Runs a function of the API, with what a script or an error makes of it.
template <typename Function>
XrResult guarded(const char* name, const Function& function) {
  Runtime& r = runtime();
  const std::lock_guard lock(r.mutex);
  r.function = name;
  try {
    if (const auto result = r.scripted_result()) return *result;
    return function();
  } catch (const Refusal& refusal) {
    if (refusal.fault) r.fault(refusal.text, refusal.result);
    return refusal.result;
  } catch (const std::exception& error) {
    r.fault(error.what(), XR_ERROR_RUNTIME_FAILURE);
    return XR_ERROR_RUNTIME_FAILURE;
  }
}

[[noreturn]] inline void refuse(XrResult result, const std::string& text) { throw Refusal{result, text}; }
inline void require(bool good, XrResult result, const std::string& text) {
  if (!good) refuse(result, text);
}

/// A structure of the application's that must be there and say what it is.
template <typename T>
const T& checked(const T* structure, XrStructureType type) {
  const std::string name = name_of(type);
  require(structure != nullptr, XR_ERROR_VALIDATION_FAILURE, "no structure where " + name + " is expected");
  require(structure->type == type, XR_ERROR_VALIDATION_FAILURE,
          std::string("a structure of type ") + name_of(structure->type) + " where " + name + " is expected");
  return *structure;
}

/// The same where it may be left out.
template <typename T>
void check_if_any(const T* structure, XrStructureType type) {
  if (structure != nullptr) checked(structure, type);
}

/// The structure of a type in a chain, or nullptr.
template <typename T>
T* chained(const void* next, XrStructureType type) {
  auto* at = static_cast<const XrBaseInStructure*>(next);
  while (at != nullptr && at->type != type) at = at->next;
  return reinterpret_cast<T*>(const_cast<XrBaseInStructure*>(at));
}

/// The two calls by which OpenXR gives arrays: how many, then what. `put(k)` writes element k.
template <typename Put>
XrResult fill(std::size_t count, std::uint32_t capacity, std::uint32_t* count_out, const void* array,
              const Put& put) {
  require(count_out != nullptr, XR_ERROR_VALIDATION_FAILURE, "nowhere to put a count");
  *count_out = static_cast<std::uint32_t>(count);
  if (capacity == 0) return XR_SUCCESS;
  require(capacity >= count, XR_ERROR_SIZE_INSUFFICIENT,
          "room for " + std::to_string(capacity) + " of " + std::to_string(count));
  require(array != nullptr, XR_ERROR_VALIDATION_FAILURE, "nowhere to put an array");
  for (std::size_t k = 0; k < count; ++k) put(k);
  return XR_SUCCESS;
}

template <typename Handle>
Handle handle_of(const Object& object) {
  return reinterpret_cast<Handle>(object.id);
}

}  // namespace binosplat::xr_test
