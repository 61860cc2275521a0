// How much of a picture each Gaussian is: the summed weights of a frame against the reference's.

#include <gtest/gtest.h>

#include "render/support.h"
#include "stereo/rig.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::same_bits;

shared::View front() { return make_view(test::front_camera(96, 80, 90)); }

std::vector<double> by_gaussian(const render::Frame& frame, std::uint32_t v, const Model& model) {
  std::vector<double> weights(model.count(), 0.0);
  for (const render::WeighedGaussian& g : frame.read_weights(v)) weights[g.index] = g.weight;
  return weights;
}

std::vector<double> weigh(const Model& model, const shared::View& view, FrameSettings settings = {}) {
  settings.weigh = true;
  render::Frame frame(test::gl_context(), model);
  frame.draw(std::span(&view, 1), settings);
  return by_gaussian(frame, 0, model);
}

// How many weights differ from the reference's by more than the steps of the pixels and fp32 explain.
std::size_t differing(const std::vector<double>& weights, const Model& model, const shared::View& view) {
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const std::vector<double> expected = reference::measure_weights(splats, lists, view);
  std::size_t count = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    count += std::abs(weights[i] - expected[i]) > 1e-4 + 1e-4 * expected[i] ? 1 : 0;
  return count;
}

TEST(Weigh, SumsWhatTheReferenceSums) {
  const Model model = test::random_model(91, 4000, 0);
  Model fainter = model;  // a weight that is a little off is told apart
  for (float& opacity : fainter.opacity) opacity *= 0.995f;
  for (const int tile : {8, 16, 32}) {
    const std::vector<double> weights = weigh(model, front(), {.tile_size = tile});
    // A few may lie where fp32 blends a pixel more or less.
    const std::size_t few = model.count() / 500;
    EXPECT_LE(differing(weights, model, front()), few) << tile;
    EXPECT_GT(differing(weights, fainter, front()), 10 * few) << tile;
    // All of them, and the light that is left, make up the picture.
    const Picture picture = test::draw(model, front());
    double left = 0.0, sum = 0.0;
    for (const glm::vec4& colour : picture.colour) left += colour.a;
    for (const double weight : weights) sum += weight;
    EXPECT_NEAR(sum + left, 96.0 * 80.0, 0.1) << tile;
    EXPECT_EQ(weights, weigh(model, front(), {.tile_size = tile})) << "not the same bits twice";
  }
}

// A sum that two words are needed for, and what it hides.
TEST(Weigh, LargeSumsCarry) {
  Model model;
  test::add(model, {0, 0, 2}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.99f);
  test::add(model, {0, 0, 3}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.9f);
  test::add(model, {0, 0, 4}, glm::vec3(3000.0f, 3000.0f, 0.01f), 0.99f);
  test::add(model, {0, 0, -4}, glm::vec3(0.1f), 0.99f);
  const std::vector<double> weights = weigh(model, front());
  EXPECT_NEAR(weights[0], 0.99 * 96 * 80, 0.1);
  EXPECT_GT(weights[0] * WEIGHT_SCALE, 0x1p33) << "one word would do";
  EXPECT_NEAR(weights[1], 0.01 * 0.9 * 96 * 80, 0.01);
  EXPECT_EQ(weights[2], 0.0) << "it would leave less than the blend goes on with";
  EXPECT_EQ(weights[3], 0.0) << "behind the camera";
}

TEST(Weigh, ThePictureStaysAndEyesHaveTheirOwn) {
  const Model model = test::random_model(92, 3000, 1);
  const stereo::EyePair rig = stereo::make_rig(test::front_camera(96, 80, 90), {.ipd = 0.3});
  render::Frame frame(test::gl_context(), model);
  frame.draw(rig.views, {.weigh = true}, {.slots = 10});  // is drawn again
  const std::vector<Picture> exact = test::draw(model, {rig.views.begin(), rig.views.end()});
  for (std::uint32_t v = 0; v < 2; ++v) {
    EXPECT_TRUE(same_bits(frame.read_pictures()[v], exact[v])) << v;
    EXPECT_EQ(by_gaussian(frame, v, model), weigh(model, rig.views[v])) << v;
  }
  EXPECT_NE(by_gaussian(frame, 0, model), by_gaussian(frame, 1, model));
  frame.draw(rig.views);
  EXPECT_TRUE(frame.read_weights(0).empty());
  EXPECT_TRUE(test::fails_saying(
      [&] { test::draw(model, front(), {.transmittance = TRANSMITTANCE_LAST, .weigh = true}); },
      {"transmittance last", "weighs"}));
}

}  // namespace
}  // namespace binosplat
