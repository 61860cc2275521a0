// --precision half: Gaussians and splats in fp16, and the error of fp16.

#include "render/halves.h"

#include <bit>
#include <glm/gtc/packing.hpp>

#include "render/faulty_shaders.h"
#include "render/support.h"

namespace binosplat {
namespace {

constexpr render::FrameSettings in_half = {.precision = PRECISION_HALF};

std::vector<shared::View> eyes_for_half() {
  const Camera camera = test::front_camera(97, 81, 90);
  Camera right = camera;
  right.position.x += 0.06;
  return {make_view(camera), make_view(right)};
}

TEST(Half, Reaches60Db) {
  for (const int degree : {0, 1, 3}) {
    const Model model = test::random_model(41, 3000, degree);
    for (const shared::View& view : eyes_for_half()) {
      const double db = test::psnr(test::draw(model, view, in_half), reference::render(model, view));
      EXPECT_GE(db, 60.0) << degree;
      EXPECT_LT(db, 100.0) << degree;
    }
  }
}

// Hundreds of faint splats in each pixel, in front of something bright. A sum in halves over all of them
// would lose the last ones.
TEST(Half, Reaches60DbThroughHaze) {
  Model model = test::random_model(47, 1200, 0);
  for (std::size_t i = 0; i < model.opacity.size(); ++i) {
    model.scale[i] = glm::vec3(0.5f);
    model.opacity[i] = 0.02f;
  }
  const shared::View view = eyes_for_half()[0];
  EXPECT_GE(test::psnr(test::draw(model, view, in_half), reference::render(model, view)), 60.0);
}

// NVIDIA's GPUs blend in halves in batches that depend on the tile test.
TEST(Half, DoesNotDependOnTileTest) {
  const bool in_halves = gl::has_extension(test::gl_context().gl(), "GL_NV_gpu_shader5");
  const Model model = test::random_model(42, 2000, 2);
  const std::vector<Picture> expected = test::draw(model, eyes_for_half(), in_half);
  for (const int tiles : {TILES_SNUG, TILES_ALL}) {
    render::FrameSettings settings = in_half;
    settings.tiles = tiles;
    const std::vector<Picture> drawn = test::draw(model, eyes_for_half(), settings);
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const bool is_same = in_halves ? test::psnr(drawn[eye], expected[eye]) >= 60.0
                                     : test::same_bits(drawn[eye], expected[eye]);
      EXPECT_TRUE(is_same) << tiles;
    }
  }
}

// Lets llvmpipe run blend_halves.glsl, which blends in halves on NVIDIA's GPUs. A float takes the place of
// each half.
std::vector<test::ShaderFault> with_floats() {
  return {{"blend_software.comp", "#define BLOCK_HEIGHT COLUMN\n",
           "#define BLOCK_HEIGHT COLUMN\n#define MAY_PACK 1\n#define f16vec2 vec2\n#define float16_t float\n"
           "#define unpackFloat2x16 unpackHalf2x16\n#define blend(at)\n"},
          {"blend_software.comp", "void list_own(uint block) {",
           "uint own_at(uint i) { return own_lists[gl_LocalInvocationID.y][i]; }\n"
           "#include \"blend_halves.glsl\"\nvoid list_own(uint block) {"},
          {"blend_software.comp", "own_counts[own_block], next = 0u;\n",
           "own_counts[own_block], next = 0u;\n    blend_batch(count);\n"}};
}

TEST(Half, PackedBlendMatchesUsualBlend) {
  if (!test::gl_context().software()) GTEST_SKIP() << "GPUs draw by other programs";
  const Model model = test::random_model(48, 3000, 1);
  const auto away = [&](const render::FrameSettings& settings, std::vector<test::ShaderFault> faults) {
    const Picture usual = test::draw(model, eyes_for_half(), settings)[1];
    for (const test::ShaderFault& f : with_floats()) faults.push_back(f);
    const test::FaultyShaders shaders(faults);
    return test::psnr(test::draw(model, eyes_for_half(), settings)[1], usual);
  };
  const double exact_db = away(in_half, {});
  EXPECT_GE(exact_db, 80.0);
  EXPECT_LT(exact_db, 150.0) << "the usual blend was drawn";
  render::FrameSettings rough = in_half;
  rough.threshold = Threshold::squared;
  rough.tolerance = 0.5f;
  EXPECT_GE(away(rough, {}), 80.0);
  // Injected faults: one where batches are joined, one in the visibility of a splat.
  const char* const file = "blend_halves.glsl";

  EXPECT_LT(away(in_half, {{file, "is_done(p) ? 0.0 : after", "is_done(p) ? 0.0 : before"}}), 70.0);
  EXPECT_LT(away(in_half, {{file, "exp2(exponent) * is_seen", "exp2(exponent)"}}), 70.0);
}

TEST(Half, BoundDetectsEightBitScales) {
  Model model = test::random_model(43, 3000, 0);
  const Picture right = reference::render(model, eyes_for_half()[0]);
  for (glm::vec3& scale : model.scale) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto bits = std::bit_cast<std::uint32_t>(scale[axis]);
      scale[axis] = std::bit_cast<float>(bits & 0xFFF80000u);  // five significant bits; fp16 has eleven
    }
  }
  EXPECT_LT(test::psnr(test::draw(model, eyes_for_half()[0], in_half), right), 60.0);
}

TEST(Half, FrameSwitchesPrecision) {
  const Model model = test::random_model(44, 1000, 1);
  render::Frame frame(test::gl_context(), model);
  frame.draw(eyes_for_half());
  const std::vector<Picture> full = frame.read_pictures();
  frame.draw(eyes_for_half(), in_half);
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[0], test::draw(model, eyes_for_half(), in_half)[0]));
  EXPECT_FALSE(test::same_bits(frame.read_pictures()[0], full[0]));
  frame.draw(eyes_for_half());
  EXPECT_TRUE(test::same_bits(frame.read_pictures()[1], full[1]));
}

TEST(Half, AcceptsReferenceStages) {
  const Model model = test::random_model(45, 500, 1);
  const shared::View view = eyes_for_half()[0];
  const Picture right = reference::render(model, view);
  for (const render::Stage until : {render::Stage::project, render::Stage::bin, render::Stage::sort}) {
    EXPECT_GE(test::psnr(test::draw(model, view, in_half, test::given(until)), right), 60.0);
  }
}

TEST(Half, NeedsLessMemory) {
  const Model model = test::random_model(46, 1000, 3);
  const auto needs = [&](int precision) {
    return render::memory_needs(render::make_plan(eyes_for_half(), {.precision = precision}, model));
  };
  EXPECT_EQ(needs(PRECISION_FULL).model, 1000 * (48 + 192));
  EXPECT_EQ(needs(PRECISION_HALF).model, 1000 * (32 + 96));
  EXPECT_LT(needs(PRECISION_HALF).frame, needs(PRECISION_FULL).frame);
}

TEST(Half, ClampsToLargestHalf) {
  std::array<std::uint32_t, 2> words{};
  render::pack(std::vector{1e9f, -1e9f, 0.5f}, words);
  EXPECT_EQ(glm::unpackHalf2x16(words[0]), glm::vec2(65504.0f, -65504.0f));
  EXPECT_EQ(glm::unpackHalf2x16(words[1]), glm::vec2(0.5f, 0.0f));
  // A splat wider than any picture still has a Cholesky factor above 0.
  const render::Halves wide =
      render::pack(shared::Splat{.opacity = 1.0f, .conic = {1e-20f, 0.0f, 1e-20f, 1e20f}});
  EXPECT_GT(glm::unpackHalf2x16(wide[4]).x, 0.0f);
  EXPECT_GT(glm::unpackHalf2x16(wide[5]).x, 0.0f);
}

}  // namespace
}  // namespace binosplat
