// Recorded heads of EyeNavGS.

#include <gtest/gtest.h>

#include <cmath>

#include "formats/cameras/lens.h"
#include "scene/key_path.h"
#include "support/damage.h"
#include "support/load.h"

namespace binosplat {
namespace {

/// The first line of the data set of Rutgers.
const std::string rutgers =
    "ViewIndex,FOV1,FOV2,FOV3,FOV4,PositionX,PositionY,PositionZ,QuaternionX,QuaternionY,QuaternionZ,"
    "QuaternionW,GazePosX,GazePosY,GazePosZ,GazeQX,GazeQY,GazeQZ,GazeQW,Timestamp\n";

/// A quarter turn to the left around the vertical, and a turn around no axis of the world.
const glm::dquat left_turn(std::sqrt(0.5), 0, std::sqrt(0.5), 0), oblique(0.5, 0.1, -0.7, 0.5);

/// Returns the lines of a frame, whose eyes are 0.06 apart.
std::string frame(const glm::dvec3& head, const glm::dquat& turn, double ms) {
  const auto eye = [&](int k, const char* sides, double after) {
    const glm::dvec3 at = head + turn * glm::dvec3(k == 0 ? -0.03 : 0.03, 0, 0);
    return fmt::format("{},{},-0.942,0.733,{},{},{},{},{},{},{},0,0,0,0,0,0,1,{}\n", k, sides, at.x, at.y,
                       at.z, turn.x, turn.y, turn.z, turn.w, ms + after);
  };
  return eye(0, "-0.942,0.698", 0.0) + eye(1, "-0.698,0.942", 4.0);
}

const std::string frames =
    frame({1, 2, 3}, {1, 0, 0, 0}, 7) + frame({1, 2, 2.5}, left_turn, 21) + frame({0, 0, 0}, oblique, 35.5);

std::vector<Camera> heads_in(const std::string& text) { return test::load_cameras_of(text, "heads.json"); }

bool is_at(const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-9; }

TEST(HeadTrace, HeadIsBetweenEyes) {
  testing::internal::CaptureStderr();
  const std::vector<Camera> heads = heads_in(rutgers + frames);
  const std::string said = "3 heads with eyes 0.06 units apart (63 mm at `units_per_metre` 0.952)";
  EXPECT_NE(testing::internal::GetCapturedStderr().find(said), std::string::npos);
  ASSERT_EQ(heads.size(), 3u);
  // The file's world has y up and z backwards, the scene's y down and z forwards.
  EXPECT_TRUE(is_at(heads[0].position, {1, -2, -3}));
  EXPECT_EQ(heads[0].rotation, glm::dmat3(1.0));
  EXPECT_TRUE(is_at(heads[1].position, {1, -2, -2.5}));
  EXPECT_TRUE(is_at(heads[1].rotation[1], {0, 1, 0}));   // down
  EXPECT_TRUE(is_at(heads[1].rotation[2], {-1, 0, 0}));  // forward
  const glm::dvec3 right = oblique * glm::dvec3(1, 0, 0);
  EXPECT_TRUE(is_at(heads[2].rotation[0], {right.x, -right.y, -right.z}));
  for (const Camera& head : heads) EXPECT_EQ(rotation_fault(head.rotation), "");
  EXPECT_EQ(heads[2].name, "00002");
  EXPECT_EQ(*heads[0].time, 0.0);
  EXPECT_DOUBLE_EQ(*heads[2].time, 0.0285);
  EXPECT_FALSE(are_keys(heads)) << "they are frames";
}

TEST(HeadTrace, PicturesHaveEyesFieldOfViewCentred) {
  const Camera head = heads_in(rutgers + frames)[0];
  const double wide = std::tan(0.942) + std::tan(0.698), high = std::tan(0.942) + std::tan(0.733);
  EXPECT_EQ(head.height, 720);
  EXPECT_NEAR(head.width, 720 * wide / high, 1.0);
  EXPECT_EQ(head.fx, head.fy);
  EXPECT_NEAR(head.height / head.fy, high, 1e-9);
  EXPECT_EQ(glm::dvec2(head.cx, head.cy), glm::dvec2(0.5 * head.width, 360.0));
}

TEST(HeadTrace, FirstLineIdentifiesFormat) {
  const Camera last = heads_in(rutgers + frames)[2];
  const std::string all = rutgers + frames, eye = frames.substr(0, frames.find('\n') + 1);
  std::string windows = all;
  for (std::size_t at = 0; (at = windows.find('\n', at)) < windows.size(); at += 2) windows.insert(at, "\r");
  for (const std::string& text :
       {test::replaced(all, "Timestamp", "timestep"),  // the data set of NTHU
        test::replaced(test::replaced(all, "Timestamp", "elapsed_ms"), "GazeQW", "timestamp"), windows,
        "\xef\xbb\xbf" + all + "\n", all + eye}) {
    const std::vector<Camera> heads = heads_in(text);
    ASSERT_EQ(heads.size(), 3u) << text;
    EXPECT_TRUE(heads[2].rotation == last.rotation && heads[2].time == last.time);
  }
  const test::TempFolder folder;
  test::write_text(folder / "heads.json", all);
  EXPECT_FALSE(lacks_lenses(folder / "heads.json"));
}

TEST(HeadTrace, ErrorsNameLine) {
  const std::string all = rutgers + frames, first = frames.substr(0, frames.find('\n') + 1);
  const auto with = [&](const std::string& from, const std::string& to) {
    return test::replaced(all, from, to);
  };
  const std::vector<test::BrokenFile> refusals = {
      {with("FOV3", "FOV5"), {"line 2: the first line has no column FOV3"}},
      {with("Timestamp", "timestamp"), {"no column Timestamp, timestep or elapsed_ms"}},
      {with(",7\n", ",nan\n"), {"line 2: Timestamp is 'nan'; expected a finite number"}},
      {with(",7\n", ",7ms\n"), {"line 2: Timestamp is '7ms'"}},
      {with(",7\n", "\n"), {"line 2: 19 values for 20 columns"}},
      {with("-0.942", "-54"), {"line 2: FOV1 and FOV2 are -54 and 0.698; expected radians that rise"}},
      {with(",21\n", ",7\n"), {"line 4: its time is 7 ms; expected more than the last frame's 7 ms"}},
      {with(first, ""), {"line 2: ViewIndex is 1; expected 0"}},
      {with("\n1,", "\n0,"), {"line 3: ViewIndex is 0; expected 1"}},
      {rutgers + first, {"no frame of two eyes"}},
      {rutgers, {"no frame of two eyes"}},
      {rutgers + frame({0, 0, 0}, {1, 0, 0, 0}, 0) + frame({0, 0, 0}, {0, 0, 0, 0}, 1),
       {"its quaternion has length 0; expected 1"}},
      // injected: the quaternions w x y z
      {with("QuaternionX,QuaternionY,QuaternionZ,QuaternionW",
            "QuaternionW,QuaternionX,QuaternionY,QuaternionZ"),
       {"line 3: by their quaternions (x, y, z, w) the right eye is not to the right of the left one"}},
  };
  test::expect_no_cameras("user1.csv", refusals);
}

TEST(HeadTrace, DamageNeverCrashes) {
  test::Uniform uniform(1);
  int refused = 0;
  testing::internal::CaptureStderr();
  for (int i = 0; i < 500; ++i) {
    try {
      for (const Camera& head : heads_in(test::damaged(rutgers + frames, uniform)))
        EXPECT_EQ(rotation_fault(head.rotation), "");
    } catch (const Error&) {
      ++refused;
    }
  }
  testing::internal::GetCapturedStderr();
  EXPECT_TRUE(refused > 100 && refused < 500) << refused;
}

}  // namespace
}  // namespace binosplat
