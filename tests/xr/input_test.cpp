// What the test runtime has for hands, eyes and lenses.

#include <gtest/gtest.h>

#include "xr/xr_script.h"

namespace binosplat::test {
namespace {

using Strings = std::vector<std::string>;

std::string run_pressing(XrStage& stage, const Strings& words) {
  const Outcome outcome =
      run_program(words, {.variables = stage.variables(), .program = BINOSPLAT_XR_CLIENT});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return outcome.out;
}

TEST(XrInput, HandsHaveWhatTheScriptSays) {
  XrStage stage;
  stage.script = {{"frames", 4}};
  stage.add_event({{"frame", 1},
                   {"input",
                    {{"/user/hand/left/input/select/click", true},
                     {"/user/hand/left/input/aim/pose", xr_pose({-0.25, 1.6, -0.5})}}}});
  stage.add_event({{"frame", 3}, {"hands", {"right"}}});
  EXPECT_EQ(run_pressing(stage, {"actions"}),
            "0 left: select 0 nowhere\n"
            "0 right: select 0 nowhere\n"
            "1 left: select 1! at -0.25,0,-0.5\n"
            "1 right: select 0 nowhere\n"
            "2 left: select 1 at -0.25,0,-0.5\n"
            "2 right: select 0 nowhere\n"
            "3 left: nowhere\n"
            "3 right: select 0 nowhere\n");
  EXPECT_EQ(stage.log().faults(), Strings());
  EXPECT_TRUE(stage.log().clean()) << stage.log().text();
}

TEST(XrInput, OtherControllersHaveOtherInputs) {
  XrStage stage;
  stage.script = {{"frames", 1}, {"profile", "/interaction_profiles/oculus/touch_controller"}};
  stage.add_event({{"input",
                    {{"/user/hand/right/input/thumbstick", {0.5, -1.0}},
                     {"/user/hand/right/input/thumbstick/click", true},
                     {"/user/hand/right/input/select/click", true}}}});
  EXPECT_EQ(run_pressing(stage, {"actions"}),
            "0 left: select 0 stick 0,0 nowhere\n"
            "0 right: select 1! stick 0.5,-1 nowhere\n");
}

TEST(XrInput, OnlyTheFocusedHaveInput) {
  XrStage stage;
  stage.script = {{"frames", 3}};
  stage.add_event({{"frame", 1}, {"state", "visible"}});
  stage.add_event({{"frame", 2}, {"state", "focused"}});
  const std::string said = run_pressing(stage, {"actions"});
  EXPECT_NE(said.find("xrSyncActions: XR_SESSION_NOT_FOCUSED\n2 left"), std::string::npos) << said;
  EXPECT_EQ(stage.log().faults(), Strings());
}

TEST(XrInput, EyesLookWhereTheScriptSays) {
  XrStage stage;
  stage.script = {{"frames", 3}, {"heads", {xr_pose({0, 1.6, 0}), xr_pose({0.5, 1.6, 0})}}};
  stage.script["gaze"] = xr_pose({0, 0, -1});
  stage.add_event({{"frame", 2}, {"gaze", nullptr}});
  const std::string said = run_pressing(stage, {"actions", "gaze"});
  EXPECT_NE(said.find("0 gaze: at 0,0,-1\n"), std::string::npos) << said;
  EXPECT_NE(said.find("1 gaze: at 0.5,0,-1\n"), std::string::npos) << said;
  EXPECT_NE(said.find("2 gaze: nowhere\n"), std::string::npos) << said;
  EXPECT_EQ(stage.log().faults(), Strings());
}

TEST(XrInput, LensesHideWhatTheScriptSays) {
  const Json corner = {
      {"hidden", {{"vertices", {{-1, -1}, {-0.5, -1}, {-1, -0.5}}}, {"indices", {0, 1, 2}}}}};
  XrStage stage;
  stage.script = {{"frames", 2}, {"masks", {{"stereo", {corner}}}}};
  stage.add_event({{"frame", 1}, {"view", {{"index", 1}, {"mask", corner}}}});
  EXPECT_EQ(run_pressing(stage, {"mask"}),
            "0 mask 0: 1 triangles -1,-1 -0.5,-1 -1,-0.5\n"
            "1 mask 1: 1 triangles -1,-1 -0.5,-1 -1,-0.5\n");
  EXPECT_EQ(stage.log().faults(), Strings());
}

TEST(XrInput, FaultsAreSeen) {
  const std::vector<std::array<std::string, 3>> faults = {
      {"bad_action_name", "xrCreateActionSet", "XR_ERROR_PATH_FORMAT_INVALID"},
      {"second_action_set", "xrCreateActionSet", "XR_ERROR_NAME_DUPLICATED"},
      {"second_action", "xrCreateAction", "XR_ERROR_NAME_DUPLICATED"},
      {"unknown_hand", "xrCreateAction", "XR_ERROR_PATH_UNSUPPORTED"},
      {"action_too_late", "xrCreateAction", "XR_ERROR_ACTIONSETS_ALREADY_ATTACHED"},
      {"bad_binding", "xrSuggestInteractionProfileBindings", "XR_ERROR_PATH_UNSUPPORTED"},
      {"bad_profile", "xrSuggestInteractionProfileBindings", "XR_ERROR_PATH_UNSUPPORTED"},
      {"binding_of_another_type", "xrSuggestInteractionProfileBindings", "XR_ERROR_PATH_UNSUPPORTED"},
      {"binding_too_late", "xrSuggestInteractionProfileBindings", "XR_ERROR_ACTIONSETS_ALREADY_ATTACHED"},
      {"attached_twice", "xrAttachSessionActionSets", "XR_ERROR_ACTIONSETS_ALREADY_ATTACHED"},
      {"not_attached", "xrSyncActions", "XR_ERROR_ACTIONSET_NOT_ATTACHED"},
      {"space_of_button", "xrCreateActionSpace", "XR_ERROR_ACTION_TYPE_MISMATCH"},
      {"wrong_action_type", "xrGetActionStateVector2f", "XR_ERROR_ACTION_TYPE_MISMATCH"},
      {"unknown_user", "xrGetActionStateBoolean", "XR_ERROR_PATH_UNSUPPORTED"}};
  for (const auto& fault : faults) {
    XrStage stage;
    run_pressing(stage, {"actions", fault[0]});
    const auto lines = stage.log().all("fault");
    const bool seen = std::any_of(lines.begin(), lines.end(), [&](const Json& line) {
      return line["function"] == fault[1] && line["result"] == fault[2];
    });
    EXPECT_TRUE(seen) << fault[0] << "\n" << stage.log().text();
  }
  XrStage stage;
  stage.script["masks"]["stereo"] = {
      {{"hidden", {{"vertices", {{0, 0}, {1, 0}, {0, 1}}}, {"indices", {0, 1, 2}}}}}};
  run_pressing(stage, {"mask", "small_mask"});
  EXPECT_EQ(stage.log().faults().size(), 1u) << stage.log().text();
}

TEST(XrInput, KhronosValidationAgrees) {
  XrStage stage;
  stage.script["gaze"] = xr_pose({0, 0, -1});
  const Outcome outcome = run_program({"actions", "gaze", "mask"}, {.variables = stage.validated_variables(),
                                                                    .program = BINOSPLAT_XR_CLIENT});
  EXPECT_EQ(stage.validation(outcome), "");
  EXPECT_EQ(stage.log().faults(), Strings());
}

}  // namespace
}  // namespace binosplat::test
