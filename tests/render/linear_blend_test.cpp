// The blend as a linear map of colours, and its transpose, against the reference.

#include "render/linear_blend.h"

#include <gtest/gtest.h>

#include "base/choices.h"
#include "render/faulty_shaders.h"
#include "render/support.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::LinearBlend;

constexpr int blend_width = 96, blend_height = 80;
constexpr std::size_t pixels = std::size_t{blend_width} * blend_height;

shared::View blend_view() { return make_view(test::front_camera(blend_width, blend_height, 90)); }

// Applies the transpose to a picture of one value. Returns each Gaussian's sum, or 0 if it is not drawn.
std::vector<double> shown_values(const Model& model, float value, const FrameSettings& settings = {},
                                 const render::DebugOptions& debug = {}) {
  LinearBlend blend(test::gl_context(), model);
  blend.set_view(blend_view(), settings, debug);
  blend.set_picture(std::vector<glm::vec4>(pixels, {0, 0, value, 0}));
  const std::vector<glm::dvec4> sums = blend.transposed(1.0f);
  std::vector<double> found(model.count());
  for (std::size_t k = 0; k < sums.size(); ++k) {
    EXPECT_EQ(glm::dvec3(sums[k].x, sums[k].y, sums[k].w), glm::dvec3(0.0));
    found[blend.drawn()[k].index] = sums[k].z;
  }
  return found;
}

// Returns the number of weights whose difference from the reference's exceeds fixed-point steps and fp32
// rounding.
std::size_t differing_weights(const std::vector<double>& weights, const Model& model) {
  const shared::View view = blend_view();
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const std::vector<double> expected = reference::measure_weights(splats, lists, view);
  std::size_t count = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    count += std::abs(weights[i] - expected[i]) > 2e-4 + 1e-4 * expected[i] ? 1 : 0;
  return count;
}

TEST(LinearBlends, WeightsMatchReference) {
  const Model model = test::random_model(91, 4000, 0);
  Model fainter = model;  // injected: weights that are slightly off
  for (float& opacity : fainter.opacity) opacity *= 0.995f;
  const std::vector<double> weights = shown_values(model, 1.0f);
  // With fp32, a few Gaussians may be blended in one pixel more or less.
  const std::size_t few = model.count() / 500;
  EXPECT_LE(differing_weights(weights, model), few);
  EXPECT_GT(differing_weights(weights, fainter), 10 * few);
  // All weights and the remaining transmittances together sum to the number of pixels.
  const Picture picture = test::draw(model, blend_view());
  double left = 0.0, sum = 0.0;
  for (const glm::vec4& colour : picture.colour) left += colour.a;
  for (const double weight : weights) sum += weight;
  EXPECT_NEAR(sum + left, static_cast<double>(pixels), 0.1);
  EXPECT_EQ(weights, shown_values(model, 1.0f)) << "not the same bits twice";
  EXPECT_EQ(weights, shown_values(model, 1.0f, {}, {.slots = 10, .pairs = 10})) << "drawn again";
}

// Sums of both signs that need two words each. Some Gaussians hide others.
TEST(LinearBlends, LargeSumsCarry) {
  Model model;
  test::add(model, {0, 0, 2}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.99f);
  test::add(model, {0, 0, 3}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.9f);
  test::add(model, {0, 0, 4}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.99f);
  test::add(model, {0, 0, -4}, glm::vec3(0.1f), 0.99f);
  const auto right = [&] {
    for (const float sign : {1.0f, -1.0f}) {
      const std::vector<double> sums = shown_values(model, sign);
      if (std::abs(sign * sums[0] - 0.99 * pixels) > 0.1 ||
          std::abs(sign * sums[1] - 0.01 * 0.9 * pixels) > 0.02)
        return false;
      EXPECT_GT(sign * sums[0] * TRANSPOSED_SCALE, 0x1p33) << "one word would do";
      EXPECT_EQ(sums[2], 0.0) << "it would leave less than the blend goes on with";
      EXPECT_EQ(sums[3], 0.0) << "behind the camera";
    }
    return true;
  };
  EXPECT_TRUE(right());
  const test::FaultyShaders faulty("measure/sums.glsl", "sum < 0 ? 0xffffffffu", "false ? 0xffffffffu");
  EXPECT_FALSE(right());
}

// Pictures of colours of either sign equal the reference's, and the transpose fulfils <W c, p> = <c, W^T p>.
TEST(LinearBlends, AreLinearWithExactTranspose) {
  const Model model = test::random_model(93, 3000, 1);
  test::Uniform uniform(5);
  const auto either_sign = [&] {
    return glm::vec3(static_cast<float>(uniform(-1, 1)), static_cast<float>(uniform(-1, 1)),
                     static_cast<float>(uniform(-1, 1)));
  };
  std::vector<glm::vec4> picture;
  for (std::size_t p = 0; p < pixels; ++p) picture.emplace_back(either_sign(), 0.0f);
  const std::vector<glm::vec3> of_all = [&] {
    std::vector<glm::vec3> colours(model.count());
    for (glm::vec3& colour : colours) colour = either_sign();
    return colours;
  }();
  struct Found {
    double psnr, there, back;
  };
  const auto find = [&](const Perspective& seen) {
    LinearBlend blend(test::gl_context(), model);
    blend.set_view(blend_view(), {{.order = seen.order, .projection = seen.projection}});
    std::vector<glm::vec3> colours;
    for (const auto& drawn : blend.drawn()) colours.push_back(of_all[drawn.index]);
    blend.set_colours(colours);
    const std::vector<glm::vec4> drawn = blend.read_picture();

    Model as_seen = model;
    as_seen.perspective = seen;
    const shared::View view = blend_view();
    auto splats = reference::project_all(as_seen, view);
    for (std::size_t i = 0; i < splats.size(); ++i) splats[i].colour = of_all[i];
    const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
    const Picture expected = reference::blend(splats, lists, view);
    double squares = 0.0;
    for (std::size_t p = 0; p < pixels; ++p) {
      const glm::dvec3 off = glm::dvec3(drawn[p]) - glm::dvec3(expected.colour[p]);
      squares += glm::dot(off, off) / (3.0 * pixels);
    }
    Found found{-10.0 * std::log10(squares), 0.0, 0.0};

    blend.set_picture(picture);
    const std::vector<glm::dvec4> sums = blend.transposed(1.0f);
    for (std::size_t p = 0; p < pixels; ++p)
      found.there += glm::dot(glm::dvec3(drawn[p]), glm::dvec3(picture[p]));
    for (std::size_t k = 0; k < sums.size(); ++k)
      found.back += glm::dot(glm::dvec3(colours[k]), glm::dvec3(sums[k]));
    return found;
  };
  for (const Perspective& seen : {Perspective{}, Perspective{Order::distance, Projection::tangent}}) {
    const Found found = find(seen);
    EXPECT_GT(found.psnr, 90.0) << name_of(seen.projection);
    EXPECT_GT(std::abs(found.there), 1.0) << "nothing to compare";
    EXPECT_NEAR(found.there, found.back, 2e-3) << name_of(seen.projection);
  }
  const test::FaultyShaders faulty("measure/sums.glsl", "colours[place_of(view, p)] : vec4",
                                   "colours[place_of(view, 0u)] : vec4");
  const Found found = find({});
  EXPECT_TRUE(found.psnr < 50.0 || std::abs(found.there - found.back) > 5e-3);
}

// Compares with pictures that the reference blends without one of the Gaussians.
TEST(LinearBlends, ChangesMatchRemovalOfGaussian) {
  const Model model = test::random_model(94, 250, 1);
  const shared::View view = blend_view();
  const auto splats = reference::project_all(model, view);
  const auto order = reference::depth_order(splats);
  const auto picture_of = [&](const std::vector<reference::Splat>& some) {
    return reference::blend(some, reference::make_lists(some, order, view, TILES_ELLIPSE), view);
  };
  const Picture whole = picture_of(splats);
  std::vector<double> expected(model.count());
  for (std::size_t i = 0; i < model.count(); ++i) {
    auto without = splats;
    without[i].opacity = 0.0;
    const Picture rest = picture_of(without);
    for (std::size_t p = 0; p < pixels; ++p) {
      const glm::dvec3 change = glm::dvec3(whole.colour[p]) - glm::dvec3(rest.colour[p]);
      expected[i] += std::min(glm::dot(change, change), CHANGE_MAX);
    }
  }
  const auto differing = [&] {
    LinearBlend blend(test::gl_context(), model);
    blend.set_view(view);
    const std::vector<double> found = blend.changes();
    std::size_t count = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double should = expected[blend.drawn()[k].index];
      count += std::abs(found[k] - should) > 1e-4 + 0.01 * should ? 1 : 0;
    }
    return count;
  };
  EXPECT_LE(differing(), 1u);
  EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1.0);
  const test::FaultyShaders faulty("measure/changes.glsl", "weight * (behind - own)", "weight * own");
  EXPECT_GT(differing(), 10u);
}

// A separate dispatch draws tiles with long lists, whichever result is requested first and however often.
TEST(LinearBlends, LongListsAreComplete) {
  const Model model = test::long_lists_model();
  const auto right = [&] {
    LinearBlend blend(test::gl_context(), model);
    blend.set_view(blend_view());
    blend.set_picture(std::vector<glm::vec4>(pixels, {1, 0, 0, 0}));
    std::vector<double> weights(model.count());
    const std::vector<glm::dvec4> sums = blend.transposed(1.0f);
    for (std::size_t k = 0; k < sums.size(); ++k) weights[blend.drawn()[k].index] = sums[k].x;
    const std::vector<double> changes = blend.changes();
    return differing_weights(weights, model) <= model.count() / 500 && blend.changes() == changes;
  };
  EXPECT_TRUE(right());
  const test::FaultyShaders faulty("tile_ranges.glsl", "atomicAdd(counters.long_lists, 1u)",
                                   "(counters.long_lists & 0u)");
  EXPECT_FALSE(right());
}

// The change of a pixel is limited to CHANGE_MAX, and the changes of all pixels of a tile add up.
TEST(LinearBlends, ChangesAreLimitedPerPixel) {
  Model model;
  test::add(model, {0, 0, 2}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.99f, glm::vec3(1.0f));
  test::add(model, {0, 0, 3}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.9f, glm::vec3(0.0f));
  LinearBlend blend(test::gl_context(), model);
  blend.set_view(blend_view());
  EXPECT_EQ(blend.changes()[0], CHANGE_MAX * pixels);
}

/// What the reference gives for a Gaussian of a view; `tiles` 0 if no tile's list has it.
struct ExpectedGaussian {
  double radius = 0.0, tiles = 0.0, transmittance = 0.0, contribution = 0.0;
};

std::vector<ExpectedGaussian> expected_measures(const Model& model, const FrameSettings& settings) {
  Model as_seen = model;
  as_seen.perspective = render::perspective_of(settings, model);
  const shared::View view = blend_view();
  auto splats = reference::project_all(as_seen, view);
  reference::set_thresholds(splats, render::chosen_threshold(settings), settings.tolerance.value_or(0.0f));
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, settings.tiles);
  const auto transmittance = reference::measure_transmittance(splats, lists, view);
  const auto weights = reference::measure_weights(splats, lists, view);
  std::vector<ExpectedGaussian> expected(model.count());
  for (const std::uint32_t i : lists.gaussians) ++expected[i].tiles;
  for (std::size_t i = 0; i < model.count(); ++i) {
    ExpectedGaussian& one = expected[i];
    one.transmittance = std::max(transmittance[i], 0.0);
    one.contribution = weights[i];
    if (one.tiles == 0.0) continue;
    glm::dvec3 c = splats[i].covariance;
    if (const auto& cone = splats[i].cone) {  // the inverse of q's second derivatives in the splat's middle
      const glm::dvec3 p(splats[i].mean, 1.0);
      const glm::dmat2 around = glm::inverse(glm::dmat2(cone->form) / glm::dot(p, cone->ray * p));
      c = {around[0][0], around[0][1], around[1][1]};
      if (reference::is_wide(*cone)) c = glm::dvec3(INFINITY, 0.0, INFINITY);
    }
    const double half = 0.5 * (c.x + c.z);
    one.radius = 3.0 * std::sqrt(std::isinf(half) ? half : half + std::hypot(0.5 * (c.x - c.z), c.y));
  }
  return expected;
}

/// How many Gaussians differ from the reference in each number.
std::array<std::size_t, 4> differing_measures(const Model& model, const FrameSettings& settings,
                                              const std::vector<ExpectedGaussian>& expected) {
  LinearBlend blend(test::gl_context(), model);
  std::vector<ExpectedGaussian> found(model.count());
  for (const render::GaussianInView& one : blend.measure(blend_view(), settings))
    found[one.index] = {one.radius, static_cast<double>(one.tiles), one.transmittance, one.contribution};
  std::array<std::size_t, 4> count{};
  const auto differ = [](double a, double b, double absolute, double relative) {
    return std::size_t{a != b && !(std::abs(a - b) <= absolute + relative * b)};
  };
  for (std::size_t i = 0; i < found.size(); ++i) {
    count[0] += found[i].tiles > 0.0 && expected[i].tiles > 0.0
                    ? differ(found[i].radius, expected[i].radius, 0.0, 1e-3)
                    : 0;
    count[1] += differ(found[i].tiles, expected[i].tiles, 0.0, 0.0);
    count[2] += differ(found[i].transmittance, expected[i].transmittance, 1e-4, 1e-4);
    count[3] += differ(found[i].contribution, expected[i].contribution, 2e-4, 1e-4);
  }
  return count;
}

TEST(LinearBlends, MeasuresOfGaussiansMatchReference) {
  const Model model = test::random_model(91, 4000, 0);
  const std::size_t few = model.count() / 200;
  const FrameSettings exact, tangent{{.order = Order::distance, .projection = Projection::tangent}},
      paper{{.tolerance = 2.0f, .threshold = Threshold::adagscale}}, squared = test::squared(0.5f);
  const auto with_tiles = [](int tiles) {
    FrameSettings settings;
    settings.tiles = tiles;
    return settings;
  };
  const FrameSettings boxes = with_tiles(TILES_AABB), whole = with_tiles(TILES_ALL);
  for (const FrameSettings* settings : {&exact, &tangent, &boxes, &paper, &squared, &whole}) {
    const auto expected = expected_measures(model, *settings);
    const auto differing = differing_measures(model, *settings, expected);
    EXPECT_LE(*std::ranges::max_element(differing), few) << testing::PrintToString(differing);
    const FrameSettings& other = settings == &exact ? boxes : exact;  // an injected fault
    EXPECT_GT(differing_measures(model, other, expected)[1], 5 * few);
  }
  const auto expected = expected_measures(model, exact);
  EXPECT_GT(differing_measures(model, tangent, expected)[0], 10 * few);
  const test::FaultyShaders faulty(
      {{"measure/transmittance.glsl", "atomicMax(measured[splat], most)",
        "atomicMax(measured[splat], floatBitsToUint(0.98 * uintBitsToFloat(most)))"},
       {"measure/transposed.glsl", "weight * picture[p]", "0.99 * weight * picture[p]"}});
  const auto wrong = differing_measures(model, exact, expected);
  EXPECT_GT(wrong[2], 5 * few);
  EXPECT_GT(wrong[3], 5 * few);
}

TEST(LinearBlends, EmptyModelGivesNothing) {
  Model model;
  test::add(model, {0, 0, -4}, glm::vec3(0.1f), 0.99f);
  LinearBlend blend(test::gl_context(), model);
  blend.set_view(blend_view());
  EXPECT_TRUE(blend.drawn().empty());
  blend.set_colours({});
  EXPECT_EQ(blend.read_picture()[7], glm::vec4(0, 0, 0, 1));
  EXPECT_TRUE(blend.transposed(1.0f).empty());
}

}  // namespace
}  // namespace binosplat
