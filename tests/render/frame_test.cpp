// Whole frames: the picture does not depend on how it is drawn.

#include "base/choices.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::Stage;
using test::draw;
using test::same_bits;

TEST(Frame, ExactTilesEqualBruteForce) {
  struct Size {
    int width, height;
  };
  for (const Size size :
       {Size{160, 96}, Size{1, 1}, Size{17, 1}, Size{1, 33}, Size{31, 47}, Size{160, 16}, Size{7, 95}}) {
    const Model model = test::random_model(41, 5000, 1, static_cast<double>(size.height) / size.width);
    const shared::View view = make_view(test::front_camera(size.width, size.height, size.width));
    const Picture brute = draw(model, view, {.tiles = TILES_ALL});
    for (const int tiles : test::exact_tiles) {
      EXPECT_TRUE(same_bits(draw(model, view, {.tiles = tiles}), brute))
          << tiles_choices[tiles].name << " " << size.width << " x " << size.height;
    }
  }
}

TEST(Frame, ComparisonDetectsCutTails) {
  const Model model = test::random_model(41, 5000, 1);
  const shared::View view = make_view(test::front_camera(160, 96, 160));
  const Picture brute = draw(model, view, {.tiles = TILES_ALL});
  for (const int tiles : test::clipping_tiles)
    EXPECT_FALSE(same_bits(draw(model, view, {.tiles = tiles}), brute)) << tiles_choices[tiles].name;
}

TEST(Frame, ZeroToleranceIsExact) {
  const Model model = test::random_model(43, 5000, 1);
  const shared::View view = make_view(test::front_camera(160, 96, 160));
  const Picture exact = draw(model, view);
  for (const int tiles : test::exact_tiles) {
    for (const Threshold threshold : test::tolerant_rules) {
      EXPECT_TRUE(same_bits(draw(model, view, {{.tolerance = 0, .threshold = threshold}, tiles}), exact))
          << tiles << " " << name_of(threshold);
      EXPECT_FALSE(same_bits(draw(model, view, {{.tolerance = 1, .threshold = threshold}, tiles}), exact))
          << tiles << " " << name_of(threshold);
    }
  }
}

TEST(Frame, IsDeterministic) {
  const Model model = test::random_model(42, 5000, 2);
  const shared::View view = make_view(test::front_camera(200, 120, 200));
  const Picture first = draw(model, view);
  EXPECT_TRUE(same_bits(first, draw(model, view)));
  render::Frame frame(test::gl_context(), model);  // a second frame in the same buffers is equal, too
  frame.draw(std::vector{view});
  frame.draw(std::vector{make_view(test::front_camera(64, 64, 64))});
  frame.draw(std::vector{view});
  EXPECT_TRUE(same_bits(first, frame.read_pictures().front()));
}

TEST(Frame, AntialiasedModelsEqualReference) {
  Model model = test::random_model(54, 3000, 1);
  for (glm::vec3& scale : model.scale) scale *= 0.2f;  // many are smaller than a pixel
  model.antialiased = true;
  model.kernel_px2 = 0.1;
  const shared::View view = make_view(test::front_camera(150, 110, 140));
  const Picture drawn = draw(model, view);
  EXPECT_GE(test::psnr(drawn, reference::render(model, view)), 80.0);
  // Injected fault: the reference of a model that is not antialiased.
  Model plain = model;
  plain.antialiased = false;
  EXPECT_LT(test::psnr(drawn, reference::render(plain, view)), 40.0);
}

TEST(Frame, AcceptsReferenceUntilAnyStage) {
  const Model model = test::random_model(52, 2000, 1);
  const auto eyes = stereo::make_rig(test::front_camera(90, 70, 80), {.ipd = 0.1});
  const std::vector views(eyes.views.begin(), eyes.views.end());
  for (const FrameSettings& way :
       {FrameSettings{.tiles = TILES_AABB}, FrameSettings{.tiles = TILES_ELLIPSE},
        FrameSettings{.tiles = TILES_ALL}, FrameSettings{.tiles = TILES_OBB},
        FrameSettings{{.tolerance = 1.0f, .threshold = Threshold::adagscale}, TILES_SNUG},
        FrameSettings{{.tolerance = 0.05f, .threshold = Threshold::squared}, TILES_ELLIPSE}}) {
    const Picture expected = reference::render(model, views[1],
                                               {.tiles = way.tiles,
                                                .threshold = render::chosen_threshold(way),
                                                .tolerance = way.tolerance.value_or(0.0f)});
    EXPECT_GE(test::psnr(draw(model, views, way)[1], expected), 80.0) << tiles_choices[way.tiles].name;
    for (const Stage stage : {Stage::project, Stage::bin, Stage::sort, Stage::blend}) {
      EXPECT_GE(test::psnr(draw(model, views, way, test::given(stage))[1], expected), 80.0)
          << name_of(stage) << " " << tiles_choices[way.tiles].name;
    }
  }
}

// Returns fog, red in front and blue behind, in which the transmittance falls slowly.
Model fog(int count) {
  Model model;
  test::Uniform uniform(105);
  for (int i = 0; i < count; ++i) {
    const double z = uniform(1.0, 3.0);
    test::add(model, glm::vec3(uniform(-0.6, 0.6) * z, uniform(-0.5, 0.5) * z, z),
              glm::vec3(uniform(0.02, 0.2)), 0.1f,
              glm::vec3(uniform(0.8, 1.0) * (3.0 - z) / 2.0, uniform(0, 0.3), (z - 1.0) / 2.0));
  }
  return model;
}

// Returns the share of pixels whose colour, coverage or depth differs.
double share_of_differing_pixels(const Picture& a, const Picture& b) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.colour.size(); ++k) {
    const glm::vec4 off = glm::abs(a.colour[k] - b.colour[k]);
    const bool same_colour = glm::all(glm::lessThan(off, glm::vec4(1e-3f)));
    count += !same_colour || std::abs(a.z_sum[k] - b.z_sum[k]) > 2e-3f * (1.0f + b.z_sum[k]);
  }
  return static_cast<double>(count) / static_cast<double>(a.colour.size());
}

// docs/method.md 5.2. Frames that measure have separate programs. Long lists have smaller blocks, which are
// tested less often.
TEST(Frame, LossSkipsBlocksAndHiddenSplats) {
  for (const auto& [width, height, count] : {std::array{90, 70, 3000}, {33, 27, 50000}}) {
    const Model model = fog(count);
    const shared::View view = make_view(test::front_camera(width, height, width));
    constexpr double tolerance = 0.3;
    auto splats = reference::project_all(model, view);
    reference::set_thresholds(splats, Threshold::squared, tolerance);
    reference::TileLists lists =
        reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
    EXPECT_EQ(lists.at_pixel(20, 20).size() > LONG_LIST, width < 40) << lists.at_pixel(20, 20).size();
    FrameSettings settings = test::squared(static_cast<float>(tolerance));
    const Picture drawn = draw(model, view, settings);
    const auto off = [&](const reference::Approximation& approximation) {
      lists.approximation = approximation;
      return share_of_differing_pixels(drawn, reference::blend(splats, lists, view));
    };
    const reference::Approximation approximation =
        reference::approximation_of(TILES_ELLIPSE, Threshold::squared, tolerance);
    EXPECT_LE(off(approximation), 0.002) << width;
    EXPECT_GT(off({true, 0.0}), 0.02) << width;
    EXPECT_GT(off({false, approximation.dark_transmittance}), 0.02) << width;
    EXPECT_GT(off({true, 2.0 * approximation.dark_transmittance}), 0.02) << width;
    settings.transmittance = Transmittance::last;  // nothing is measured yet
    EXPECT_TRUE(same_bits(std::vector{draw(model, view, settings)}, std::vector{drawn}));
    EXPECT_TRUE(same_bits(std::vector{draw(model, view, {{.threshold = Threshold::squared}})},
                          std::vector{draw(model, view)}));
  }
}

// Splats that an approximate frame skips in a block, or that lie behind a dark block, get their measurement
// all the same.
TEST(Frame, LossKeepsTransmittanceMeasurement) {
  const Model model = fog(3000);
  const shared::View view = make_view(test::front_camera(90, 70, 90));
  auto splats = reference::project_all(model, view);
  reference::set_thresholds(splats, Threshold::squared, 0.3);
  const std::vector<double> light = reference::measure_transmittance(
      splats, reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE), view);
  const auto darkened = [&] {
    render::Frame frame(test::gl_context(), model);
    FrameSettings settings = test::squared(0.3f, Transmittance::last);
    settings.measure_every = 1;
    frame.draw(std::vector{view}, settings);
    int count = 0;
    for (const render::MeasuredGaussian& m : frame.read_measured(0))
      count += light[m.index] > 0.02 && m.transmittance < 0.9 * light[m.index] ? 1 : 0;
    return count;
  };
  EXPECT_EQ(darkened(), 0);
  const test::FaultyShaders faulty("measure/transmittance.glsl",
                                   "is_marked[p][k] = alpha >= float(ALPHA_MIN)",
                                   "is_marked[p][k] = weights[p][k] > 0.0");
  EXPECT_GT(darkened(), 3);
}

// A block that no splat reaches has T = 1 while its list continues: to divide by 1 - T would give infinity.
TEST(Frame, EveryToleranceGivesFinitePicture) {
  Model model;
  test::Uniform uniform(106);
  for (int i = 0; i < 200; ++i) {  // around the pixel (-4, -4), ten px wide
    const double z = uniform(1.0, 1.1);
    test::add(model, glm::vec3(-20.0 / 32 * z, -20.0 / 32 * z, z), glm::vec3(10.0 / 32 * z), 0.98f);
  }
  const shared::View view = make_view(test::front_camera(32, 32, 32));
  const auto is_finite = [&](const FrameSettings& settings) {
    const Picture drawn = draw(model, view, settings);
    return std::all_of(drawn.colour.begin(), drawn.colour.end(),
                       [](const glm::vec4& c) { return std::isfinite(c.r + c.g + c.b + c.a); });
  };
  const FrameSettings settings = test::squared(100.0f);
  EXPECT_TRUE(is_finite(settings));
  const test::FaultyShaders faulty(
      "blend_dark_blocks.glsl",
      "min(float(DARK_TRANSMITTANCE_MAX), float(DARK_TRANSMITTANCE) * sqrt(tolerance))",
      "float(DARK_TRANSMITTANCE) * sqrt(tolerance)");
  EXPECT_FALSE(is_finite(settings));
}

TEST(Frame, DisabledDepthKeepsColours) {
  const Model model = test::random_model(54, 2000, 1);
  const shared::View view = make_view(test::front_camera(90, 70, 80));
  const Picture with = draw(model, view), without = draw(model, view, {.has_depths = false});
  EXPECT_EQ(without.colour, with.colour);
  EXPECT_NE(without.z_sum, with.z_sum);
  EXPECT_EQ(without.z_sum, std::vector<float>(with.z_sum.size()));
}

// After a frame has found how large and how many its splats are, the next may blend by another program.
TEST(Frame, LaterFramesEqualFirst) {
  const shared::View view = make_view(test::front_camera(150, 110, 140));
  constexpr std::uint32_t tiles = 80;  // in whole supertiles
  const auto drawn_twice = [&](int count, bool are_large, bool are_many) {
    Model model = test::random_model(56, count, 1);
    for (glm::vec3& scale : model.scale) scale *= are_large ? 3.0f : 1.0f;
    render::Frame frame(test::gl_context(), model);
    std::vector<Picture> drawn;
    for (int n = 0; n < 2; ++n) {
      const Report report = frame.draw({{view}}, {.has_depths = false});
      EXPECT_EQ(report.pairs > 8 * report.visible, are_large);
      EXPECT_EQ(report.pairs > 80 * tiles, are_many);
      drawn.push_back(frame.read_pictures()[0]);
    }
    return same_bits(drawn[0], drawn[1]);
  };
  const auto few_large = [&] { return drawn_twice(200, true, false); };
  const auto many_large = [&] { return drawn_twice(800, true, true); };
  const auto many_small = [&] { return drawn_twice(6000, false, true); };
  EXPECT_TRUE(few_large());
  EXPECT_TRUE(many_large());
  EXPECT_TRUE(many_small());
  if (!test::gl_context().limits().subgroups_of_32) GTEST_SKIP() << "all are drawn by one program";
  {
    const test::FaultyShaders faulty("blend_lists_by_ballots.glsl", "bit_of(gl_SubgroupID)",
                                     "bit_of(COLUMN == 4 ? 0u : gl_SubgroupID)");
    EXPECT_FALSE(few_large());
  }
  {
    const test::FaultyShaders faulty("blend_whole_tile.glsl", "{ return 1u; }",
                                     "{ return splat.mean.x > 70.0 ? 1u : 0u; }");
    EXPECT_FALSE(many_large());
  }
  const test::FaultyShaders faulty("blend_subgroups.comp", "if (TAIL > 0u && ", "if (false && ");
  EXPECT_FALSE(many_small());
}

TEST(Frame, ZeroEyeDistanceGivesEqualEyes) {
  const Model model = test::random_model(62, 3000, 1);
  const auto rig = stereo::make_rig(test::front_camera(120, 90, 110), {.ipd = 0.0});
  const std::vector<Picture> eyes = draw(model, std::vector(rig.views.begin(), rig.views.end()));
  EXPECT_TRUE(same_bits(eyes[0], eyes[1]));
}

TEST(Frame, SmallBuffersGiveSamePicture) {
  const Model model = test::random_model(71, 4000, 0);
  const auto rig = stereo::make_rig(test::front_camera(150, 90, 140), {.ipd = 0.1, .cant_degrees = 3});
  const std::vector views(rig.views.begin(), rig.views.end());
  const std::vector<Picture> ample = draw(model, views);
  for (const render::DebugOptions& little :
       {render::DebugOptions{.slots = 10}, render::DebugOptions{.pairs = 10},
        render::DebugOptions{.slots = 10, .pairs = 10}}) {
    render::Frame frame(test::gl_context(), model);
    testing::internal::CaptureStderr();
    const Report report = frame.draw(views, {}, little);
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_NE(log.find("drawn again"), std::string::npos);
    EXPECT_EQ(log.find("drawn again"), log.rfind("drawn again")) << "one line a run";
    EXPECT_GT(report.redraws, 0);
    const std::vector<Picture> tight = frame.read_pictures();
    EXPECT_TRUE(same_bits(ample[0], tight[0]));
    EXPECT_TRUE(same_bits(ample[1], tight[1]));
  }
}

TEST(Frame, PagedModelGivesSamePicture) {
  const Model model = test::random_model(75, 3000, 2);
  const auto rig = stereo::make_rig(test::front_camera(150, 90, 140), {.ipd = 0.1, .cant_degrees = 3});
  const std::vector<Picture> whole = draw(model, std::vector(rig.views.begin(), rig.views.end()));
  for (const std::uint32_t page_gaussians : {1000u, 1024u, 2999u}) {
    render::Frame frame(
        std::make_shared<render::GpuModel>(test::gl_context(), model, PRECISION_FULL, page_gaussians));
    frame.draw(rig.views);
    const std::vector<Picture> paged = frame.read_pictures();
    EXPECT_TRUE(same_bits(whole[0], paged[0])) << page_gaussians;
    EXPECT_TRUE(same_bits(whole[1], paged[1])) << page_gaussians;
  }
}

// A page is uploaded in steps of 32,768 Gaussians.
TEST(Frame, ChunkedUploadGivesSamePicture) {
  const shared::View view = make_view(test::front_camera(64, 40, 60));
  for (const int degree : {0, 1, 2}) {  // with and without padding between Gaussians
    Model model = test::random_model(76, 70000, degree);
    for (std::size_t i = 0; i < 65600; ++i) model.opacity[i] = 0.0f;  // only the last step is visible
    render::Frame frame(std::make_shared<render::GpuModel>(test::gl_context(), model, PRECISION_FULL, 20000));
    frame.draw(std::vector{view});
    const Picture paged = frame.read_pictures().front();
    EXPECT_TRUE(same_bits(draw(model, view), paged)) << degree;
    std::rotate(model.position.begin(), model.position.begin() + 32768, model.position.end());
    EXPECT_FALSE(same_bits(draw(model, view), paged)) << "injected: one piece for another";
  }
}

// Many workgroups that look back at one another's sums, in several frames.
TEST(Frame, DoesNotDependOnSubgroups) {
  gl::Context& context = test::gl_context();
  if (!context.limits().subgroups_of_32) GTEST_SKIP() << "there are no subgroups to be without";
  const Model model = test::random_model(49, 90000, 0);
  const auto rig = stereo::make_rig(test::front_camera(96, 64, 96), {.ipd = 0.1, .cant_degrees = 4.0});
  const std::vector<shared::View> both(rig.views.begin(), rig.views.end());
  render::Frame with(context, model);
  for (int n = 0; n < 3; ++n) with.draw(both);
  const std::vector<Picture> drawn = with.read_pictures();
  with.draw(std::span(both).first(1));  // one eye, with another plan
  with.draw(both);
  EXPECT_TRUE(test::same_bits(with.read_pictures()[1], drawn[1]));
  context.use_subgroups(false);
  const std::vector<Picture> without = draw(model, both);
  context.use_subgroups(true);
  for (std::size_t eye = 0; eye < 2; ++eye) EXPECT_TRUE(same_bits(drawn[eye], without[eye]));
  EXPECT_FALSE(same_bits(drawn[0], without[1])) << "the other eye's goes unnoticed";
}

TEST(Frame, WorksWithFewGroups) {
  const Model model = test::random_model(72, 3000, 0);
  const shared::View view = make_view(test::front_camera(150, 90, 140));
  const Picture expected = draw(model, view);
  const std::uint32_t before = test::gl_context().limits().groups;
  test::gl_context().limit_groups(5);
  EXPECT_TRUE(same_bits(expected, draw(model, view)));
  test::gl_context().limit_groups(before);
}

TEST(Frame, PredictsMemory) {
  const Model model = test::random_model(76, 20000, 2);
  const auto rig = stereo::make_rig(test::front_camera(300, 200, 300), {.ipd = 0.1});
  const std::int64_t before = test::gl_context().allocated_bytes();
  for (const Transmittance transmittance : {Transmittance::one, Transmittance::last}) {
    const FrameSettings settings{{.transmittance = transmittance}};
    const auto needs = render::memory_needs(render::make_plan(rig.views, settings, model));
    render::Frame frame(test::gl_context(), model);
    EXPECT_EQ(test::gl_context().allocated_bytes() - before, needs.model);
    const double taken = static_cast<double>(frame.draw(rig.views, settings).gpu_bytes - before);
    const double said = static_cast<double>(needs.model + needs.frame);
    EXPECT_NEAR(said / taken, 1.0, 0.03);
  }
}

TEST(Frame, RejectsInvalidSizes) {
  const Model model = test::random_model(74, 10, 0);
  EXPECT_ERROR(draw(model, std::vector<shared::View>{}), "1 to 8 views");
  shared::View empty = make_view(test::front_camera(16, 16, 16));
  empty.width = 0;
  EXPECT_ERROR(draw(model, empty), "0 x 16");
}

TEST(Frame, TimeExcludesCompilation) {
  gl::Context& context = test::gl_context();
  const Model model = test::random_model(0, 100, 1);
  const shared::View view = make_view(test::front_camera(32, 24, 30));
  context.set_shader_folder({});  // discards all programs
  const double before = context.compile_ms();
  render::Frame frame(context, model);
  const Report first = frame.draw(std::span(&view, 1));
  const double making = context.compile_ms() - before;
  EXPECT_GT(first.new_programs, 5);
  EXPECT_LT(first.gpu_ms, 0.5 * making) << "of so few Gaussians";
  EXPECT_LT(making, first.submit_ms + 1.0) << "it is told as the CPU's time";
  frame.draw(std::span(&view, 1));
  EXPECT_EQ(context.compile_ms() - before, making) << "nothing is made twice";
}

}  // namespace
}  // namespace binosplat
