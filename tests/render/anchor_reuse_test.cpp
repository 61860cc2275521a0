// Anchors that Th would leave out whole are not decoded again: the picture is the same bit for bit while
// nothing moves, and what comes out from behind is decoded again within a few frames.

#include <algorithm>
#include <cmath>

#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/rig.h"
#include "support/scaffold.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using test::same_bits;

/// Anchors whose Gaussians are opaque: a wall of them, and as many behind it that nobody sees.
Model wall_of_anchors() {
  Scaffold s = test::random_scaffold(5, {.anchors = 1200, .offsets = 6});
  for (std::size_t n = 0; n < s.anchor_count(); ++n) {
    const float z = n < 600 ? 2.0f : 4.0f + static_cast<float>(n % 7);
    const auto at = static_cast<float>(n % 600);
    s.position[n] = {0.05f * z * (std::fmod(at, 25.0f) - 12.0f), 0.05f * z * (std::floor(at / 25.0f) - 12.0f),
                     z};
    s.offset_scale[n] = glm::vec3(0.01f * z);
    s.scale[n] = glm::vec3(0.08f * z);
  }
  for (float& bias : s.opacity.second_bias) bias += 2.5f;
  return stand_in(std::make_shared<Scaffold>(std::move(s)));
}

std::vector<shared::View> eyes_at_anchors(double near_plane = near_default) {
  const auto rig = stereo::make_rig(test::front_camera(96, 80, 90), {.ipd = 0.05, .near_plane = near_plane});
  return {rig.views.begin(), rig.views.end()};
}

/// Anchors that are not decoded in the second frame of a camera that stands still, over all decodings.
std::size_t reused(const Model& model, const FrameSettings& settings,
                   const std::vector<shared::View>& views = eyes_at_anchors(),
                   const render::Workings& workings = {}) {
  render::Frame frame(test::gl_context(), model);
  frame.draw(views, settings, workings);
  frame.draw_until(render::Stage::decode, views, settings, workings);
  std::size_t count = 0;
  const std::vector<render::ModelBuffers::Page>& pages = frame.model_buffers().pages;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    const auto kept = frame.buffers().kept[p]->read<std::uint32_t>(std::size_t{pages[p].anchors->count} *
                                                                   frame.plan().decoding_count());
    count +=
        std::count_if(kept.begin(), kept.end(), [](std::uint32_t bits) { return (bits & KEPT_HIDDEN) != 0; });
  }
  return count;
}

const FrameSettings squared_last{.th = TH_SQUARED, .transmittance = TRANSMITTANCE_LAST, .tolerance = 0.1f};
const FrameSettings peripheral{.th = TH_PERIPHERAL, .transmittance = TRANSMITTANCE_LAST, .tolerance = 8.0f};

TEST(AnchorReuse, WhatIsHiddenIsNotDecodedAgain) {
  const Model model = wall_of_anchors();
  for (const FrameSettings& way : {squared_last, peripheral}) {
    EXPECT_GT(reused(model, way), 500u) << th_choices[way.th].name;
    FrameSettings other = way;
    other.decode = DECODE_CYCLOPEAN;
    EXPECT_GT(reused(model, other), 250u) << th_choices[way.th].name;
    EXPECT_EQ(reused(model, way, eyes_at_anchors(), {.anchor_reuse = false}), 0u);
    other = way;
    other.transmittance = TRANSMITTANCE_ONE;
    EXPECT_EQ(reused(model, other), 0u) << "nothing is known of what is hidden";
  }
}

TEST(AnchorReuse, ChangesNoBitWhileNothingMoves) {
  const Model model = wall_of_anchors();
  for (const FrameSettings& way : {squared_last, peripheral}) {
    render::Frame with(test::gl_context(), model), without(test::gl_context(), model);
    for (int n = 0; n < 12; ++n) {
      const render::FrameReport report = with.draw(eyes_at_anchors(), way);
      EXPECT_EQ(without.draw(eyes_at_anchors(), way, {.anchor_reuse = false}).pairs, report.pairs) << n;
      const std::vector<Picture> a = with.read_pictures(), b = without.read_pictures();
      for (std::size_t v = 0; v < 2; ++v) EXPECT_TRUE(same_bits(a[v], b[v])) << th_choices[way.th].name << n;
    }
  }
}

TEST(AnchorReuse, AnchorsLeftOutTooSoonAreSeen) {
  const Model model = wall_of_anchors();
  render::Frame right(test::gl_context(), model);
  for (int n = 0; n < 4; ++n) right.draw(eyes_at_anchors(), squared_last);
  const Picture expected = right.read_pictures()[0];
  const test::FaultyShaders faulty("decode.comp", "bound) > 1.0", "bound) > 0.1");
  render::Frame wrong(test::gl_context(), model);
  for (int n = 0; n < 4; ++n) wrong.draw(eyes_at_anchors(), squared_last);
  EXPECT_FALSE(same_bits(wrong.read_pictures()[0], expected));
}

TEST(AnchorReuse, ChangesNoBitWhenBuffersHaveToGrow) {
  const Model model = wall_of_anchors();
  render::Frame tight(test::gl_context(), model), ample(test::gl_context(), model);
  for (int n = 0; n < 4; ++n) {
    ample.draw(eyes_at_anchors(), squared_last);
    EXPECT_GT(tight.draw(eyes_at_anchors(), squared_last, {.slots = 100}).redrawn, 0);
    EXPECT_TRUE(same_bits(tight.read_pictures()[1], ample.read_pictures()[1])) << n;
  }
}

TEST(AnchorReuse, WhatComesOutFromBehindIsDecodedAgain) {
  const Model model = wall_of_anchors();
  render::Frame frame(test::gl_context(), model);
  for (int n = 0; n < 5; ++n) frame.draw(eyes_at_anchors(), squared_last);
  // The wall is gone: what is nearer than 3 is not drawn.
  const Picture exact = test::draw(model, eyes_at_anchors(3.0))[0];
  frame.draw(eyes_at_anchors(3.0), squared_last);
  const double at_once = test::psnr(frame.read_pictures()[0], exact);
  for (int n = 0; n < 25; ++n) frame.draw(eyes_at_anchors(3.0), squared_last);
  EXPECT_GT(test::psnr(frame.read_pictures()[0], exact), 30.0);
  EXPECT_LT(at_once, 25.0) << "the first frame still goes by what was hidden";
}

TEST(AnchorReuse, OfARealModel) {
  REQUIRE_SCENE("scaffold", scenes);
  REQUIRE_SCENE("fox", fox);
  const Model model = load_model(scenes / "fox");
  const std::vector<Camera> cameras = load_cameras(fox / "cameras.json");
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [](const Camera& c) { return c.name == "0042"; });
  ASSERT_NE(found, cameras.end());
  const auto rig = stereo::make_rig(resized(*found, 259, 472), {.ipd = 0.11});
  const std::vector<shared::View> views(rig.views.begin(), rig.views.end());
  FrameSettings settings = squared_last;
  settings.tolerance = 0.148f;  // about 40 dB
  const double share = double(reused(model, settings, views)) / double(2 * model.scaffold->anchor_count());
  RecordProperty("share", std::to_string(share));
  EXPECT_GT(share, 0.0);
}

}  // namespace
}  // namespace binosplat
