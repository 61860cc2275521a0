// Each refusal of the test runtime, provoked; and what a client does wrong without an error of OpenXR's.

#include <gtest/gtest.h>

#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

struct Fault {
  const char* words;  // of xr/client.cpp
  const char* function;
  const char* result;
  const char* text;  // a part of it
};

const Fault faults[] = {
    {"wrong_type", "xrGetSystem", "XR_ERROR_VALIDATION_FAILURE", "XR_TYPE_SYSTEM_GET_INFO is expected"},
    {"form_factor", "xrGetSystem", "XR_ERROR_FORM_FACTOR_UNSUPPORTED", "head-mounted"},
    {"bad_path", "xrStringToPath", "XR_ERROR_PATH_FORMAT_INVALID", "no/slash"},
    {"bad_system", "xrEnumerateViewConfigurationViews", "XR_ERROR_SYSTEM_INVALID", "system 1"},
    {"bad_configuration", "xrEnumerateViewConfigurationViews", "XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED",
     "not offered"},
    {"quad", "xrEnumerateViewConfigurationViews", "XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED",
     "1000037000"},
    {"view_type", "xrEnumerateViewConfigurationViews", "XR_ERROR_VALIDATION_FAILURE", "XR_TYPE_VIEW where"},
    {"small_array", "xrEnumerateViewConfigurationViews", "XR_ERROR_SIZE_INSUFFICIENT", "room for 1 of 2"},
    {"no_requirements", "xrCreateSession", "XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING", "is expected"},
    {"no_binding", "xrCreateSession", "XR_ERROR_GRAPHICS_DEVICE_INVALID", "no graphics binding"},
    {"binding_unasked", "xrCreateSession", "XR_ERROR_GRAPHICS_DEVICE_INVALID", "XR_MNDX_egl_enable"},
    {"second_session", "xrCreateSession", "XR_ERROR_LIMIT_REACHED", "second"},
    {"request_exit_early", "xrRequestExitSession", "XR_ERROR_SESSION_NOT_RUNNING", "does not run"},
    {"frame_before_begin", "xrWaitFrame", "XR_ERROR_SESSION_NOT_RUNNING", "does not run"},
    {"unknown_space", "xrCreateReferenceSpace", "XR_ERROR_REFERENCE_SPACE_UNSUPPORTED", "not offered"},
    {"floor floor_unasked", "xrCreateReferenceSpace", "XR_ERROR_REFERENCE_SPACE_UNSUPPORTED", "1000426000"},
    {"bad_space", "xrCreateReferenceSpace", "XR_ERROR_POSE_INVALID", "length 2"},
    {"unknown_format", "xrCreateSwapchain", "XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED", "format"},
    {"big_swapchain", "xrCreateSwapchain", "XR_ERROR_SWAPCHAIN_RECT_INVALID", "5000 x 80"},
    {"wrong_usage", "xrCreateSwapchain", "XR_ERROR_VALIDATION_FAILURE", "usage"},
    {"samples", "xrCreateSwapchain", "XR_ERROR_FEATURE_UNSUPPORTED", "samples"},
    {"begin_session_twice", "xrBeginSession", "XR_ERROR_SESSION_RUNNING", "already"},
    {"begin_stopped", "xrBeginSession", "XR_ERROR_SESSION_NOT_READY", "EXITING"},
    {"end_session_early", "xrEndSession", "XR_ERROR_SESSION_NOT_STOPPING", "FOCUSED"},
    {"does_not_stop", "xrWaitFrame", "XR_ERROR_SESSION_LOST", "does not stop"},
    {"begin_without_wait", "xrBeginFrame", "XR_ERROR_CALL_ORDER_INVALID", "xrWaitFrame is expected"},
    {"wait_twice", "xrWaitFrame", "XR_ERROR_CALL_ORDER_INVALID", "not begun"},
    {"frame_not_ended", "xrBeginFrame", "XR_FRAME_DISCARDED", "not ended"},
    {"end_twice", "xrEndFrame", "XR_ERROR_CALL_ORDER_INVALID", "xrBeginFrame is expected"},
    {"wrong_time", "xrEndFrame", "XR_ERROR_TIME_INVALID", "was predicted"},
    {"no_time", "xrEndFrame", "XR_ERROR_TIME_INVALID", "no display time"},
    {"blend_mode", "xrEndFrame", "XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED", "blend mode 2"},
    {"locate_other_time", "xrLocateViews", "XR_SUCCESS", "another time"},
    {"locate_no_time", "xrLocateViews", "XR_ERROR_TIME_INVALID", "time 0"},
    {"locate_other_configuration", "xrLocateViews", "XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED", ""},
    {"locate_small_array", "xrLocateViews", "XR_ERROR_SIZE_INSUFFICIENT", "room for 1 of 2"},
    {"wait_without_acquire", "xrWaitSwapchainImage", "XR_ERROR_CALL_ORDER_INVALID", "no image is acquired"},
    {"release_without_acquire", "xrReleaseSwapchainImage", "XR_ERROR_CALL_ORDER_INVALID",
     "no image is acquired"},
    {"acquire_too_many", "xrAcquireSwapchainImage", "XR_ERROR_CALL_ORDER_INVALID", "acquired already"},
    {"release_without_wait", "xrReleaseSwapchainImage", "XR_ERROR_CALL_ORDER_INVALID", "not waited for"},
    {"wait_image_twice", "xrWaitSwapchainImage", "XR_ERROR_CALL_ORDER_INVALID", "not yet released"},
    {"not_released", "xrEndFrame", "XR_SUCCESS", "was not released"},
    {"not_released", "xrDestroySwapchain", "XR_SUCCESS", "was not released"},
    {"drawn_after_release", "xrEndFrame", "XR_SUCCESS", "written to after its release"},
    {"stale_image", "xrEndFrame", "XR_SUCCESS", "released in frame 0"},
    {"never_draws", "xrEndFrame", "XR_ERROR_LAYER_INVALID", "ever released"},
    {"eyes_swapped", "xrEndFrame", "XR_SUCCESS", "view 1 has another pose"},
    {"stale_pose", "xrEndFrame", "XR_SUCCESS", "view 0 has another pose"},
    {"stale_fov", "xrEndFrame", "XR_SUCCESS", "view 0 has another fov"},
    {"rectangle_outside", "xrEndFrame", "XR_ERROR_SWAPCHAIN_RECT_INVALID", "[1,0,96,80]"},
    {"array_index", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "array index 1 of 1"},
    {"bad_pose", "xrEndFrame", "XR_ERROR_POSE_INVALID", "length 0"},
    {"view_layer_type", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "PROJECTION_VIEW is expected"},
    {"one_view", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "1 views where 2"},
    {"layer_type", "xrEndFrame", "XR_ERROR_LAYER_INVALID", "XR_TYPE_VIEW"},
    {"other_space", "xrEndFrame", "XR_SUCCESS", "none that views were located in"},
    {"destroyed_space", "xrEndFrame", "XR_ERROR_HANDLE_INVALID", "space 4 is not there"},
    {"destroyed_swapchain", "xrEndFrame", "XR_ERROR_HANDLE_INVALID", "swapchain 5 is not there"},
    {"too_many_layers", "xrEndFrame", "XR_ERROR_LAYER_LIMIT_EXCEEDED", "17 layers"},
    {"no_layer", "xrEndFrame", "XR_ERROR_LAYER_INVALID", "layer 0"},
    {"used_after", "xrEndSession", "XR_ERROR_HANDLE_INVALID", "was destroyed"},
    {"depth stale_depth", "xrEndFrame", "XR_SUCCESS", "released in frame 0"},
    {"depth depth_unasked", "xrEndFrame", "XR_SUCCESS", "depth without"},
    {"depth depth_of_other_eye", "xrEndFrame", "XR_SUCCESS", "view 0 has the depth of view 1"},
    {"depth depth_twice", "xrEndFrame", "XR_SUCCESS", "view 1 has the depth of view 0"},
    {"depth depth_size", "xrEndFrame", "XR_SUCCESS", "96 x 40"},
    {"depth depth_range", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "1.5"},
    {"depth depth_planes", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "two different ones"},
    {"depth depth_of_colours", "xrEndFrame", "XR_ERROR_VALIDATION_FAILURE", "swapchain of colours"},
};

/// Frames that differ in pose and fov, so that an old one is told from a new one.
void move(XrStage& stage) {
  stage.script["heads"] = {xr_pose({0, 1.6, 0}), xr_pose({0.01, 1.6, 0}), xr_pose({0.02, 1.6, 0})};
  stage.add_event({{"frame", 1}, {"view", {{"index", 0}, {"fov", {-0.85, 0.646, 0.7, -0.7}}}}});
}

XrLog log_of(XrStage& stage, const std::string& words) {
  std::istringstream in(words);
  std::vector<std::string> arguments;
  for (std::string word; in >> word;) arguments.push_back(word);
  const Outcome outcome =
      run_program(arguments, {.variables = stage.variables(), .program = BINOSPLAT_XR_CLIENT});
  EXPECT_EQ(outcome.code, 0) << words << outcome.err;
  return stage.log();
}

TEST(XrFaults, AreSeen) {
  for (const Fault& fault : faults) {
    XrStage stage;
    move(stage);
    const XrLog log = log_of(stage, fault.words);
    const auto lines = log.all("fault");
    const bool seen = std::any_of(lines.begin(), lines.end(), [&](const Json& line) {
      return line["function"] == fault.function && line["result"] == fault.result &&
             line["text"].get<std::string>().find(fault.text) != std::string::npos;
    });
    EXPECT_TRUE(seen) << fault.words << " " << fault.function << "\n" << log.text();
  }
}

TEST(XrFaults, TheSameScriptWithoutThemHasNone) {
  XrStage stage;
  move(stage);
  const XrLog log = log_of(stage, "depth");
  EXPECT_EQ(log.faults(), std::vector<std::string>()) << log.text();
}

TEST(XrFaults, WhatIsNotDestroyedIsTold) {
  XrStage all;
  EXPECT_FALSE(log_of(all, "leaves_all").all("left").empty());
  EXPECT_FALSE(all.log().clean());
  XrStage children;
  EXPECT_FALSE(log_of(children, "leaves_children").clean());
}

TEST(XrFaults, PosesThatAreNotValidAreNotToBeShown) {
  XrStage stage;
  stage.add_event({{"frame", 1}, {"flags", {"position_valid"}}});
  const XrLog log = log_of(stage, "");
  ASSERT_FALSE(log.faults().empty());
  EXPECT_NE(log.faults()[0].find("not valid"), std::string::npos) << log.text();
}

}  // namespace
}  // namespace binosplat::test
