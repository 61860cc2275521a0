// Reference spaces, and where they, the hands and the views are.

#include <algorithm>
#include <cmath>

#include "xr/runtime/api.h"

namespace binosplat::xr_test {

Pose head_at(XrTime time) {
  const auto& heads = runtime().script.heads;
  return heads[std::min<std::size_t>(static_cast<std::size_t>(runtime().frame_of(time)), heads.size() - 1)];
}

void check_pose(const XrPosef& pose) {
  const XrQuaternionf& q = pose.orientation;
  const float length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  require(std::abs(length - 1.0f) < 0.01f, XR_ERROR_POSE_INVALID,
          "a quaternion of length " + std::to_string(length));
}

namespace {

Pose local_at(XrTime time) {
  Pose out;
  for (const auto& [frame, pose] : runtime().locals) {
    if (frame <= runtime().frame_of(time)) out = pose;
  }
  return out;
}

/// What the application is offered: LOCAL_FLOOR only with its extension.
std::vector<XrReferenceSpaceType> offered() {
  std::vector<XrReferenceSpaceType> out = runtime().script.spaces;
  if (runtime().instance()->extensions.count(XR_LOCAL_FLOOR_NAME) == 0) {
    std::erase(out, XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST);
  }
  return out;
}

void check_offered(XrReferenceSpaceType type) {
  const auto spaces = offered();
  require(std::count(spaces.begin(), spaces.end(), type) != 0, XR_ERROR_REFERENCE_SPACE_UNSUPPORTED,
          "reference space " + std::to_string(type) + " is not offered");
}

void check_time(XrTime time) { require(time > 0, XR_ERROR_TIME_INVALID, "time " + std::to_string(time)); }

}  // namespace

std::optional<Pose> pose_of(const Space& space, XrTime time) {
  if (!space.reference) return pose_of_action(space, time);
  const XrReferenceSpaceType type = *space.reference;
  if (type == XR_REFERENCE_SPACE_TYPE_VIEW) return head_at(time) * space.offset;
  if (type == XR_REFERENCE_SPACE_TYPE_STAGE) return runtime().script.stage * space.offset;
  Pose local = local_at(time);
  if (type == XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_TEST) local.position.y = runtime().script.stage.position.y;
  return local * space.offset;
}

namespace api {

XrResult enumerate_reference_spaces(XrSession handle, std::uint32_t capacity, std::uint32_t* count,
                                    XrReferenceSpaceType* spaces) {
  runtime().get<Session>(handle);
  const auto all = offered();
  return fill(all.size(), capacity, count, spaces, [&](std::size_t k) { spaces[k] = all[k]; });
}

XrResult create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  const auto& session = runtime().get<Session>(handle);
  checked(info, XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
  check_offered(info->referenceSpaceType);
  check_pose(info->poseInReferenceSpace);
  auto& space = runtime().add<Space>(session.id);
  space.reference = info->referenceSpaceType;
  space.offset = from_xr(info->poseInReferenceSpace);
  *out = handle_of<XrSpace>(space);
  runtime().log({{"what", "space"}, {"id", space.id}, {"type", info->referenceSpaceType}});
  return XR_SUCCESS;
}

XrResult create_action_space(XrSession handle, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  const auto& session = runtime().get<Session>(handle);
  checked(info, XR_TYPE_ACTION_SPACE_CREATE_INFO);
  const auto& action = runtime().get<Action>(info->action);
  require(action.type == XR_ACTION_TYPE_POSE_INPUT, XR_ERROR_ACTION_TYPE_MISMATCH,
          "a space of an action that is no pose: " + action.name);
  require(info->subactionPath == XR_NULL_PATH || action.users.count(text_of(info->subactionPath)) != 0,
          XR_ERROR_PATH_UNSUPPORTED, "a user path that action " + action.name + " was not made with");
  check_pose(info->poseInActionSpace);
  auto& space = runtime().add<Space>(session.id);
  space.action = action.id;
  space.subaction = info->subactionPath;
  space.offset = from_xr(info->poseInActionSpace);
  *out = handle_of<XrSpace>(space);
  return XR_SUCCESS;
}

XrResult locate_space(XrSpace handle, XrSpace base, XrTime time, XrSpaceLocation* location) {
  Runtime& r = runtime();
  const auto& space = r.get<Space>(handle);
  const auto& from = r.get<Space>(base);
  checked(location, XR_TYPE_SPACE_LOCATION);
  check_time(time);
  const auto pose = pose_of(space, time), base_pose = pose_of(from, time);
  location->locationFlags = 0;
  if (!pose || !base_pose) return XR_SUCCESS;
  const bool of_head = [&] {
    const auto view = [](const Space& s) { return s.reference == XR_REFERENCE_SPACE_TYPE_VIEW; };
    return view(space) != view(from);
  }();
  // The flags of spaces are those of views, bit for bit.
  location->locationFlags = of_head ? r.script.flags : 15;
  location->pose = to_xr(inverse(*base_pose) * *pose);
  return XR_SUCCESS;
}

XrResult destroy_space(XrSpace handle) {
  runtime().destroy(runtime().get<Space>(handle, true));
  return XR_SUCCESS;
}

XrResult locate_views(XrSession handle, const XrViewLocateInfo* info, XrViewState* state,
                      std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  Runtime& r = runtime();
  auto& session = r.get<Session>(handle);
  checked(info, XR_TYPE_VIEW_LOCATE_INFO);
  checked(state, XR_TYPE_VIEW_STATE);
  const auto& specs = views_of(info->viewConfigurationType);
  require(info->viewConfigurationType == session.configuration, XR_ERROR_VALIDATION_FAILURE,
          "views of another configuration than the session's");
  check_time(info->displayTime);
  const auto& space = r.get<Space>(info->space);
  const auto base = pose_of(space, info->displayTime);
  state->viewStateFlags = base ? r.script.flags : 0;
  Located located = {.space = space.id, .flags = state->viewStateFlags};
  const Pose head = head_at(info->displayTime);
  for (const ViewSpec& spec : specs) {
    located.views.push_back({XR_TYPE_VIEW, nullptr, {{0, 0, 0, 1}, {0, 0, 0}}, spec.fov});
    // What is not valid is not to be used: it would be seen at once.
    XrPosef& pose = located.views.back().pose;
    if (base) pose = to_xr(inverse(*base) * head * spec.pose);
    if ((located.flags & XR_VIEW_STATE_ORIENTATION_VALID_BIT) == 0) pose.orientation = {0, 0, 0, 0};
    if ((located.flags & XR_VIEW_STATE_POSITION_VALID_BIT) == 0) pose.position = {NAN, NAN, NAN};
  }
  const XrResult result = fill(specs.size(), capacity, count, views, [&](std::size_t k) {
    checked(&views[k], XR_TYPE_VIEW);
    views[k].pose = located.views[k].pose;
    views[k].fov = located.views[k].fov;
  });
  if (capacity == 0) return result;
  for (auto* frame : {&session.begun, &session.waited}) {
    if (!*frame || (*frame)->time != info->displayTime) continue;
    (*frame)->located.push_back(located);
    return result;
  }
  r.fault("views located for another time than a frame's predicted one: " +
          std::to_string(info->displayTime));
  return result;
}

}  // namespace api
}  // namespace binosplat::xr_test
