// What the preview draws, shows and saves, without a window.

#include "preview/session.h"

#include <gtest/gtest.h>

#include "formats/image_file.h"
#include "formats/pose_file.h"
#include "measure/metrics.h"
#include "support/gl.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::preview {
namespace {

struct SessionTest : testing::Test {
  test::TempFolder folder;
  Choices coarse = [] {
    Choices choices;
    choices.settings = {.th = TH_SQUARED, .tolerance = 3.0f};
    return choices;
  }();
  Session session{test::gl_context(),
                  test::random_model(9, 400, 0, 0.6),
                  {test::front_camera(64, 40, 55.0)},
                  glm::dvec3(0, -1, 0),
                  coarse,
                  folder.path()};

  SessionTest() { session.resize({128, 40}); }

  Image picture() {
    session.draw();
    return load_image(session.save_picture(false));
  }
};

double apart(const Image& a, const Image& b) { return measure::largest_difference(a, b).max; }

TEST_F(SessionTest, TheSplitIsWhereTheSliderStands) {
  const Image drawn = picture();
  EXPECT_FALSE(session.draw()) << "nothing changed, and it drew";
  const auto split_at = [&](double share) {
    session.choices.show = SHOW_SPLIT;
    session.choices.split = share;
    session.change_show();
    return picture();
  };
  EXPECT_EQ(apart(split_at(1.0), drawn), 0.0);
  const Image exact = split_at(0.0);
  EXPECT_GT(apart(exact, drawn), 0.05) << "this tolerance changes nothing";
  EXPECT_GT(apart(split_at(0.5), drawn), 0.0);
  EXPECT_GT(apart(split_at(0.5), exact), 0.0);
  session.choices.show = SHOW_PICTURE;
  session.choices.settings = {};
  session.change();
  EXPECT_EQ(apart(picture(), exact), 0.0);
}

TEST_F(SessionTest, OtherLevelsTakeThePlaceOfTheModel) {
  session.choices.settings = {};
  const Image before = picture();
  session.choices.show = SHOW_SPLIT;  // has a frame of the exact picture, too
  session.choices.split = 0.0;
  session.change_show();
  EXPECT_EQ(apart(picture(), before), 0.0);
  session.replace(test::random_model(10, 900, 0, 0.6));
  const Image after = picture();
  EXPECT_GT(apart(after, before), 0.1);
  session.choices.show = SHOW_PICTURE;
  session.change_show();
  EXPECT_EQ(apart(picture(), after), 0.0);
  session.replace(test::random_model(9, 400, 0, 0.6));
  EXPECT_EQ(apart(picture(), before), 0.0);
}

TEST_F(SessionTest, MapsHaveARangeAndGoAgain) {
  const Image drawn = picture();
  EXPECT_FALSE(session.most_shown());
  session.choices.show = SHOW_PAIRS;
  session.change_show();
  EXPECT_GT(apart(picture(), drawn), 0.1);
  EXPECT_GT(session.most_shown().value_or(0.0), 0.0);
  session.choices.show = SHOW_PICTURE;
  session.change_show();
  EXPECT_EQ(apart(picture(), drawn), 0.0);
  EXPECT_FALSE(session.most_shown());
}

TEST_F(SessionTest, PsnrLeavesWhatIsSeen) {
  session.choices.settings.transmittance = TRANSMITTANCE_LAST;
  session.change();
  while (session.draw()) {
  }
  const Image before = picture();
  EXPECT_LT(session.psnr_against_exact(), 60.0);
  EXPECT_FALSE(session.draw());
  EXPECT_EQ(apart(picture(), before), 0.0);
  session.choices.settings = {};
  session.change();
  picture();
  EXPECT_TRUE(std::isinf(session.psnr_against_exact()));
}

TEST_F(SessionTest, ThePoseHasWhatIsUpAndHowLargeTheWorldIs) {
  picture();
  session.head.look(0.3, 0.4);
  session.choices.rig.units_per_metre = 3.0;
  session.choices.rig.ipd = 0.07;
  session.set_up();
  session.save_pose(pose_path(folder / "model.ply"));
  const auto saved = find_pose(folder / "model.ply");
  ASSERT_TRUE(saved);
  EXPECT_LT(glm::distance(saved->up, -session.head.camera().rotation[1]), 1e-12);
  EXPECT_GT(glm::distance(saved->up, glm::dvec3(0, -1, 0)), 0.1);
  EXPECT_EQ(saved->units_per_metre, 3.0);
  EXPECT_EQ(saved->ipd, 0.07);
  EXPECT_EQ(saved->camera.width, 64);
  EXPECT_EQ(saved->camera.rotation[2], session.head.camera().rotation[2]);
}

}  // namespace
}  // namespace binosplat::preview
