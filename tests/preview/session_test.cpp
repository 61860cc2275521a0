// The preview's session without a window: how it draws, shows and saves pictures.

#include "preview/session.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "formats/cameras/pose_file.h"
#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "stereo/layout.h"
#include "stereo/rig.h"
#include "support/broken.h"
#include "support/calibration.h"
#include "support/fixtures.h"
#include "support/gl.h"
#include "support/level_errors.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::preview {
namespace {

struct SessionTest : testing::Test {
  test::TempFolder folder;
  Choices coarse = [] {
    Choices choices;
    choices.settings = {{.tolerance = 3.0f, .threshold = Threshold::squared}};
    return choices;
  }();
  Session session{test::gl_context(),
                  {.whole = test::random_model(9, 400, 0, 0.6)},
                  {{test::front_camera(64, 40, 55.0)}, glm::dvec3(0, -1, 0)},
                  coarse,
                  folder.path()};

  SessionTest() { session.resize({128, 40}); }

  Image picture() {
    session.draw();
    return load_image(session.save_picture(false));
  }
};

double apart(const Image& a, const Image& b) { return measure::largest_difference(a, b).max; }

TEST_F(SessionTest, SplitFollowsSlider) {
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

TEST(Session, NewLevelsReplaceOldOnes) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const Camera camera = look_at({0, -1, -20}, {0, -1, 0}, {0, -1, 0}, 60, 64, 40);
  const auto session_of = [&](OpenedModel<Stream> opened) {
    auto session = std::make_unique<Session>(test::gl_context(), std::move(opened),
                                             Start{{camera}, glm::dvec3(0, -1, 0)}, Choices{}, folder.path());
    session->resize({128, 40});
    return session;
  };
  const auto picture = [](Session& session) {
    session.draw();
    return load_image(session.save_picture(false));
  };
  const Image of_finest = picture(*session_of({.whole = load_model(fixtures / "sog/st-lod", {.lod = 0})}));
  const auto session = session_of({std::make_unique<Stream>(fixtures / "sog/st-lod", StreamSettings{})});
  const Image before = picture(*session);
  EXPECT_GT(apart(before, of_finest), 0.1);
  session->choices.show = SHOW_SPLIT;  // the session then has a frame of the exact picture, too
  session->choices.split = 0.0;
  session->change_show();
  EXPECT_EQ(apart(picture(*session), before), 0.0);
  do session->follow_levels();
  while (!session->stream()->settled());
  EXPECT_EQ(apart(picture(*session), of_finest), 0.0);
  session->choices.show = SHOW_PICTURE;
  session->change_show();
  EXPECT_EQ(apart(picture(*session), of_finest), 0.0);
}

TEST(Session, LevelsReachRequestedQuality) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  const test::Copy scene(fixtures / "sog/st-lod");
  test::add_level_errors(scene);
  const auto gaussians_for = [&](double db) {
    Session session(test::gl_context(),
                    {std::make_unique<Stream>(scene.path(), StreamSettings{.detail = {.db = db}})},
                    Start{{look_at({0, -1, -20}, {0, -1, 0}, {0, -1, 0}, 60, 64, 40)}, glm::dvec3(0, -1, 0)},
                    {}, folder.path());
    session.resize({128, 40});
    do session.follow_levels();
    while (!session.stream()->settled());
    EXPECT_GT(session.stream()->reported_db(), db);
    return session.stream()->gaussians();
  };
  EXPECT_EQ(gaussians_for(60.0), 1000u);
  EXPECT_LT(gaussians_for(5.0), 1000u);
}

TEST(Session, LateFramesReduceResolution) {
  EXPECT_EQ(next_divisor(1, moving_ms), 1);
  EXPECT_EQ(next_divisor(1, 1.01 * moving_ms), 2);
  EXPECT_EQ(next_divisor(4, 100.0 * moving_ms), 4);
  // A divisor smaller by one takes at most four times as long, so the larger picture is never late.
  EXPECT_EQ(next_divisor(2, 0.26 * moving_ms), 2);
  EXPECT_EQ(next_divisor(2, 0.24 * moving_ms), 1);
  EXPECT_EQ(next_divisor(1, 0.0), 1);
}

TEST_F(SessionTest, DrawsFullResolutionAtRest) {
  session.resize({1000, 800});
  const Image before = picture();
  const int expected = next_divisor(1, session.frames().back().report.gpu_ms);  // 1 on a fast GPU
  session.move();
  ASSERT_TRUE(session.draw());
  EXPECT_EQ(session.divisor(), expected);
  EXPECT_TRUE(session.moving());
  EXPECT_EQ(apart(picture(), before), 0.0) << "what is saved is not whole";
  EXPECT_EQ(session.divisor(), 1);
  EXPECT_FALSE(session.moving());
  session.keeps_size = true;  // as for recorded frames
  session.move();
  ASSERT_TRUE(session.draw());
  EXPECT_EQ(session.divisor(), 1);
  session.keeps_size = false;
  // Interlaced pictures are never scaled.
  session.choices.layout = LAYOUT_ROWS;
  session.move();
  ASSERT_TRUE(session.draw());
  EXPECT_EQ(session.divisor(), 1);
}

TEST_F(SessionTest, ScreenDistanceFitsFirstPicture) {
  picture();
  EXPECT_FALSE(session.screen_found()) << "nobody asked for one";
  EXPECT_FALSE(session.choices.rig.convergence);
  Choices seeking = coarse;
  seeking.seeks_screen = true;
  seeking.layout = LAYOUT_SEPARATE;
  Session other(test::gl_context(), {.whole = test::random_model(9, 400, 0, 0.6)},
                {{test::front_camera(64, 40, 55.0)}, glm::dvec3(0, -1, 0)}, seeking, folder.path());
  other.resize({128, 40});
  other.draw();
  EXPECT_FALSE(other.screen_found()) << "one eye has no screen";
  other.choices.layout = LAYOUT_PARALLEL;
  other.change();
  other.draw();
  ASSERT_TRUE(other.screen_found());
  EXPECT_EQ(other.choices.rig.convergence, other.screen_found());
  EXPECT_TRUE(other.draw()) << "it is not shown";
  // The screen keeps its distance when the head moves and when choices change.
  other.head.dolly(0.5);
  other.choices.rig.convergence.reset();
  other.change();
  other.draw();
  EXPECT_FALSE(other.choices.rig.convergence);
}

TEST_F(SessionTest, ChangesAndResetsFieldOfView) {
  const Image before = picture();
  const double fov = session.head.fov();
  EXPECT_NEAR(std::tan(0.5 * fov), 20.0 / 55.0, 1e-12);
  session.head.set_fov(1.4 * fov);
  EXPECT_NEAR(session.head.fov(), 1.4 * fov, 1e-12);
  session.change();
  EXPECT_GT(apart(picture(), before), 0.1);
  session.reset_view();
  EXPECT_EQ(apart(picture(), before), 0.0);
}

TEST_F(SessionTest, QualityExcludesTolerance) {
  render::FrameSettings& s = session.choices.settings;
  choose_quality(s, 40.0f);
  session.change();
  EXPECT_EQ(s.threshold, Threshold::squared);
  EXPECT_FALSE(s.tolerance);
  for (int n = 0; n < 16; ++n) session.draw();
  EXPECT_TRUE(session.trouble().empty()) << session.trouble();
  ASSERT_TRUE(session.threshold_effect());
  EXPECT_GT(session.threshold_effect()->psnr, 100.0) << "so small pictures are exact";
  choose_threshold(s, Threshold::adagscale);
  EXPECT_FALSE(s.quality);
  choose_quality(s, 30.0f);
  EXPECT_EQ(s.threshold, Threshold::adagscale) << "a rule that was chosen goes";
  choose_quality(s, {});
  session.change();
  picture();
  EXPECT_FALSE(session.threshold_effect()) << "of an exact picture";
}

TEST_F(SessionTest, FlipShowsExactPicture) {
  const Image drawn = picture();
  const auto effect = session.threshold_effect();
  ASSERT_TRUE(effect);
  EXPECT_LT(effect->drawn.pairs, effect->exact.pairs);
  session.choices.flipped = true;
  session.change();
  EXPECT_FALSE(session.threshold_effect()) << "there is another picture to draw";
  const Image exact = picture();
  EXPECT_FALSE(session.threshold_effect()) << "of the exact picture";
  EXPECT_EQ(session.frames().back().report.pairs, effect->exact.pairs);
  // Both pictures have 8 bits, like those whose PSNR is reported.
  EXPECT_NEAR(effect->psnr, measure::psnr(drawn, exact), 0.01);
  session.choices.flipped = false;
  session.change();
  EXPECT_EQ(apart(picture(), drawn), 0.0);
  session.choices.flipped = true;
  session.choices.settings = {};
  session.change();
  EXPECT_FALSE(session.choices.flipped) << "there is nothing to flip to";
  EXPECT_EQ(apart(picture(), exact), 0.0);
}

/// Returns the pictures of both eyes as a frame draws them, over black, side by side.
Image expected(Session& session, const render::FrameSettings& settings) {
  render::Frame frame(test::gl_context(), session.model());
  frame.draw(session.views(), settings);
  const std::vector<Picture> eyes = frame.read_pictures();
  return quantised(
      composite(stereo::lay_out(LAYOUT_PARALLEL, eyes[0], eyes[1], glm::vec3(0.0f)), glm::vec3(0.0f)));
}

TEST_F(SessionTest, UsesCalibration) {
  adagscale::ThresholdCalibration calibration = test::sample_calibration();
  calibration.gaussians = session.model().count();
  calibration.hash = adagscale::model_hash(session.model());
  calibration.perspective = {};
  calibration.focal = 55.0;
  calibration.depth_table = {6.0f, {1.0f, 0.5f, 0.25f, 0.125f}};
  calibration.views = {{"a", {}}};
  calibration.entries = {{Threshold::adagscale, Transmittance::depth, 3.0}};
  session.choices.settings = {{.threshold = Threshold::adagscale, .transmittance = Transmittance::depth}};
  session.choices.calibrated = {"c.json", calibration};
  session.change();
  render::FrameSettings by_it = session.choices.settings;
  by_it.tolerance = 3.0f;
  by_it.depth_table = calibration.depth_table;
  const Image drawn = picture();
  EXPECT_EQ(apart(drawn, expected(session, by_it)), 0.0);
  by_it.depth_table.bounds = {1.0f, 1.0f, 1.0f, 1.0f};  // injected
  EXPECT_GT(apart(drawn, expected(session, by_it)), 0.0);
  // A rule without an entry in the calibration gets its starting_tolerance.
  session.choices.settings = {{.threshold = Threshold::squared}};
  session.change();
  EXPECT_GT(session.choices.settings.tolerance, 0.0f);
}

TEST_F(SessionTest, OtherViewKeepsShownPicture) {
  const Image before = picture();
  EXPECT_EQ(session.picture_of(session.views()[1]).width, 64);
  EXPECT_FALSE(session.draw()) << "what is shown was drawn over";
  EXPECT_EQ(apart(picture(), before), 0.0);
}

TEST_F(SessionTest, NextTileTestStaysExact) {
  render::FrameSettings settings;
  ASSERT_TRUE(is_exact(settings));
  std::set<int> met;
  for (int k = 0; k < 6; ++k) {
    next_tiles(settings, k < 3 ? 1 : -1);
    EXPECT_TRUE(is_exact(settings)) << tiles_choices[settings.tiles].name;
    met.insert(settings.tiles);
  }
  std::set<int> exact, any;
  for (int tiles = 0; tiles < std::ssize(tiles_choices); ++tiles) {
    if (tiles != TILES_ALL) any.insert(tiles);
    if (tiles != TILES_ALL && render::has_every_pair(tiles)) exact.insert(tiles);
  }
  EXPECT_EQ(met, exact);
  choose_threshold(settings, Threshold::squared);
  met.clear();
  for (std::size_t k = 0; k < any.size(); ++k) {
    next_tiles(settings, 1);
    met.insert(settings.tiles);
  }
  EXPECT_EQ(met, any);
  choose_threshold(settings, Threshold::exact);
  settings.tiles = TILES_OBB;
  EXPECT_FALSE(is_exact(settings)) << "tails that tiles clip count as exact";
}

TEST_F(SessionTest, ShowsCameraNameAtCamera) {
  Camera camera = test::front_camera(64, 40, 55.0);
  camera.name = "DSC07956";
  Session named{test::gl_context(),
                {.whole = test::random_model(9, 40, 0, 0.6)},
                {{camera}, glm::dvec3(0, -1, 0)},
                {},
                folder.path()};
  EXPECT_EQ(named.place_name(), "DSC07956");
  named.head.orbit(0.1, 0.0);
  EXPECT_EQ(named.place_name(), "away from DSC07956 (R: back)");
  named.reset_view();
  EXPECT_EQ(named.place_name(), "DSC07956");
  named.head.move(0.0, 0.0, 0.1, false);
  EXPECT_NE(named.place_name(), "DSC07956");
}

TEST_F(SessionTest, SavesAtAnyWidth) {
  const Image small = picture();
  session.choices.saved_width = 384;
  const Image large = picture();
  EXPECT_EQ(glm::ivec2(large.width, large.height), glm::ivec2(384, 120));
  session.choices.saved_width = 0;
  EXPECT_EQ(apart(picture(), small), 0.0) << "the window keeps the other size";
  session.resize({384, 120});
  EXPECT_EQ(apart(picture(), large), 0.0) << "it is not drawn at that size, but enlarged";
  session.choices.saved_width = 1000000000;
  EXPECT_THROW(session.save_picture(false), Error);
  session.choices.saved_width = 0;
  EXPECT_EQ(apart(picture(), large), 0.0);
}

TEST_F(SessionTest, DebugMapsHaveRange) {
  const Image drawn = picture();
  EXPECT_FALSE(session.max_shown());
  session.choices.show = SHOW_PAIRS;
  session.change_show();
  EXPECT_GT(apart(picture(), drawn), 0.1);
  EXPECT_GT(session.max_shown().value_or(0.0), 0.0);
  session.choices.show = SHOW_LEFT_OUT;
  session.change_show();
  picture();
  EXPECT_GT(session.max_shown().value_or(0.0), 0.0);
  session.choices.show = SHOW_PICTURE;
  session.change_show();
  EXPECT_EQ(apart(picture(), drawn), 0.0);
  EXPECT_FALSE(session.max_shown());
  session.choices.show = SHOW_LEFT_OUT;
  session.choices.settings = {};
  session.change();
  picture();
  EXPECT_EQ(session.max_shown(), 0.0) << "an exact picture leaves nothing out";
}

TEST_F(SessionTest, ThresholdEffectKeepsPicture) {
  session.choices.settings.transmittance = Transmittance::last;
  session.change();
  while (session.draw()) {
  }
  const Image before = picture();
  ASSERT_TRUE(session.threshold_effect());
  EXPECT_LT(session.threshold_effect()->psnr, 60.0);
  EXPECT_FALSE(session.draw());
  EXPECT_EQ(apart(picture(), before), 0.0);
}

TEST_F(SessionTest, PoseHasUpAndScale) {
  picture();
  session.head.look(0.3, 0.4);
  session.choices.rig.units_per_metre = 3.0;
  session.choices.rig.ipd = 0.07;
  session.set_up_direction();
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

TEST_F(SessionTest, DoubleClickSetsOrbitTarget) {
  Model model;
  test::add(model, {0.3f, 0.2f, 2.0f}, glm::vec3(0.05f), 0.99f);
  Session one(test::gl_context(), {.whole = std::move(model)},
              {{test::front_camera(64, 40, 55.0)}, glm::dvec3(0, -1, 0)}, {}, folder.path());
  one.resize({128, 40});
  one.draw();
  const Navigator before = one.head;
  one.focus({5, 5});
  EXPECT_EQ(one.head.target(), before.target()) << "of the background";
  EXPECT_EQ(one.head.camera().rotation, before.camera().rotation);
  EXPECT_FALSE(one.draw()) << "nothing changed, and it drew";
  const stereo::EyePair eyes = stereo::make_rig(before.camera(), one.choices.rig);
  for (const std::size_t side : {0u, 1u}) {
    one.head = before;
    one.change();
    const glm::dvec2 at = project_point(eyes.cameras[side], {0.3f, 0.2f, 2.0f}).at;
    one.focus(glm::ivec2(at) + glm::ivec2(64 * static_cast<int>(side), 0));
    EXPECT_LT(glm::distance(one.head.target(), glm::dvec3(0.3, 0.2, 2.0)), 0.06) << side;
    EXPECT_TRUE(one.draw());
  }
}

TEST_F(SessionTest, RulerSetsUnitsPerMetre) {
  const glm::vec3 ends[] = {{-0.6f, 0.2f, 2.0f}, {0.9f, -0.3f, 4.0f}};
  Model model;
  for (const glm::vec3& end : ends) test::add(model, end, glm::vec3(0.02f), 0.99f);
  Session one(test::gl_context(), {.whole = std::move(model)},
              {{test::front_camera(320, 200, 55.0)}, glm::dvec3(0, -1, 0)}, {}, folder.path());
  one.resize({640, 200});
  one.draw();
  const stereo::EyePair eyes = stereo::make_rig(one.head.camera(), one.choices.rig);
  const auto pixel_of = [&](const glm::vec3& point, std::size_t side) {
    return glm::ivec2(project_point(eyes.cameras[side], point).at) +
           glm::ivec2(320 * static_cast<int>(side), 0);
  };
  const double apart = glm::distance(ends[0], ends[1]);
  for (const std::size_t side : {0u, 1u}) {
    one.choices.rig.units_per_metre = 1.0;
    one.change();
    one.ruler.emplace();
    EXPECT_FALSE(one.add_to_ruler({5, 5})) << "the background";
    EXPECT_TRUE(one.add_to_ruler(pixel_of(ends[0], 0)));
    EXPECT_FALSE(one.ruler_length());
    EXPECT_FALSE(one.add_to_ruler(pixel_of(ends[0], 0))) << "the first point again";
    EXPECT_TRUE(one.add_to_ruler(pixel_of(ends[1], side)));
    ASSERT_TRUE(one.ruler_length());
    EXPECT_NEAR(*one.ruler_length(), apart, 0.03) << side;
    one.set_ruler_length(0.5);
    EXPECT_NEAR(one.choices.rig.units_per_metre, 2.0 * apart, 0.06) << side;
    EXPECT_FALSE(one.ruler);
  }
  // The distance on the plane of the first point, as if depths were not read.
  EXPECT_GT(std::abs(glm::distance(ends[0], 0.5f * ends[1]) - apart), 0.3) << "depths go unnoticed";
  one.save_pose(pose_path(folder / "model.ply"));
  EXPECT_EQ(find_pose(folder / "model.ply")->units_per_metre, one.choices.rig.units_per_metre);
  const glm::dvec3 before = find_pose(folder / "model.ply")->camera.position;
  one.head.look(0.1, 0.0);
  one.head.orbit(0.2, 0.0);
  one.choices.rig.units_per_metre = 7.0;
  one.save_pose(pose_path(folder / "model.ply"), true);
  EXPECT_EQ(find_pose(folder / "model.ply")->units_per_metre, 7.0);
  EXPECT_EQ(find_pose(folder / "model.ply")->camera.position, before) << "the saved pose is kept";
  one.save_pose(pose_path(folder / "model.ply"));
  EXPECT_NE(find_pose(folder / "model.ply")->camera.position, before);
}

TEST(EyeSize, FillsEveryLayout) {
  for (int layout = 0; layout < std::ssize(layout_choices); ++layout) {
    const glm::ivec2 all(601, 401), eye = eye_size_in(layout, all);
    const glm::ivec2 both = stereo::layout_size(layout, eye);
    EXPECT_TRUE(all.x - both.x >= 0 && all.x - both.x <= 1) << layout_choices[layout].name;
    EXPECT_TRUE(all.y - both.y >= 0 && all.y - both.y <= 1) << layout_choices[layout].name;
  }
}

/// A session with an object of which the start shows only the middle.
struct ShowAll : testing::Test {
  test::TempFolder folder;
  const glm::vec3 middle{3.0f, -2.0f, 5.0f};
  const Camera near_it = look_at({3, -2, 3.5}, {3, -2, 5}, {0, -1, 0}, 50, 64, 40);
  Session session{
      test::gl_context(), {.whole = object()}, {{near_it}, glm::dvec3(0, -1, 0)}, {}, folder.path()};

  /// A bar that is longer than high.
  Model object() const {
    test::Uniform uniform(4);
    Model model;
    for (int k = 0; k < 2000; ++k) {
      const glm::vec3 at(uniform(-1.2, 1.2), uniform(-0.4, 0.4), uniform(-0.5, 0.5));
      test::add(model, middle + at, glm::vec3(0.02f), 0.9f);
    }
    return model;
  }

  /// Returns how many Gaussians lie outside of an eye's picture of this size.
  int cut(const glm::ivec2& size) const {
    int count = 0;
    const Camera head = resized(session.head.camera(), size.x, size.y);
    for (const Camera& eye : stereo::make_rig(head, session.choices.rig).cameras) {
      for (const glm::vec3& position : session.model().position) {
        const ProjectedPoint point = project_point(eye, position);
        count += point.depth < session.choices.rig.near_plane || !point.is_within(0.0);
      }
    }
    return count;
  }
};

TEST_F(ShowAll, FitsModelInTallEye) {
  session.resize({400, 300});
  EXPECT_GT(cut({200, 300}), 400) << "this start cuts nothing";
  session.show_all();
  EXPECT_EQ(cut({200, 300}), 0);
  EXPECT_LT(glm::distance(session.head.target(), glm::dvec3(middle)), 0.1);
  const glm::dmat3 axes = session.head.camera().rotation;
  EXPECT_NEAR(axes[0].y, 0.0, 1e-9) << "the horizon tilts";
  EXPECT_LT(glm::dot(axes[1], glm::dvec3(0, -1, 0)), 0.0) << "it is upside down";
  const glm::dvec3 towards = glm::normalize(session.head.target() - session.head.camera().position);
  EXPECT_LT(glm::distance(towards, axes[2]), 1e-9) << "it looks past the target";
  EXPECT_TRUE(session.draw());
  EXPECT_TRUE(session.trouble().empty()) << session.trouble();
  const double distance = session.head.distance();
  session.reset_view();
  EXPECT_EQ(session.head.camera().position, near_it.position);
  // Injected: the view that suits the whole window cuts the object in half of it.
  session.choices.layout = LAYOUT_SEPARATE;
  session.show_all();
  EXPECT_EQ(cut({400, 300}), 0);
  EXPECT_LT(session.head.distance(), 0.8 * distance) << "a wide picture is used no better";
  EXPECT_GT(cut({200, 300}), 0);
}

TEST_F(ShowAll, FitsModelInSeparateEyes) {
  session.resize({400, 300});
  session.show_all();
  const double distance = session.head.distance();
  stereo::RigSettings& rig = session.choices.rig;
  rig.ipd = 0.5;
  EXPECT_GT(cut({200, 300}), 0) << "these eyes change nothing";
  for (const std::optional<double> convergence : {std::optional<double>(), {4.0}, {2.0}}) {
    rig.convergence = convergence;
    session.show_all();
    EXPECT_EQ(cut({200, 300}), 0) << convergence.value_or(0.0);
    EXPECT_GT(session.head.distance(), distance);
  }
  rig = {.cant_degrees = 5.0};
  session.show_all();
  EXPECT_EQ(cut({200, 300}), 0);
  rig.cant_degrees = 15.0;  // injected
  EXPECT_GT(cut({200, 300}), 0);
}

TEST_F(ShowAll, KeepsFieldOfViewAndUp) {
  session.show_all();  // before the window has a size
  EXPECT_EQ(session.head.camera().position, near_it.position);
  session.resize({400, 300});
  session.head.set_fov(glm::radians(80.0));
  session.show_all();
  EXPECT_NEAR(session.head.fov(), glm::radians(80.0), 1e-9);
  EXPECT_EQ(cut({200, 300}), 0);
  session.go_to(look_at({3, -2, 1}, {3, -2, 5}, {1, -1, 0}, 50, 64, 40));
  session.set_up_direction();
  session.show_all();
  EXPECT_NEAR(glm::dot(session.head.camera().rotation[0], glm::dvec3(1, -1, 0)), 0.0, 1e-9);
  EXPECT_EQ(cut({200, 300}), 0);
}

}  // namespace
}  // namespace binosplat::preview
