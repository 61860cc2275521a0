// Measures the error of decoding a Scaffold-GS model once for both eyes, from their midpoint, instead of for
// each eye, and how much this error differs between the eyes. It does so at three distances;
// tests/bench/results/scaffold.md has the numbers.

#include <algorithm>
#include <array>

#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "render/support.h"
#include "stereo/disagreement.h"
#include "stereo/rig.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

struct Cost {
  double depth = 0.0;         // median over the left eye's pixels, world units
  double error = 0.0;         // of the left eye, dB
  double disagreement = 0.0;  // dB
};

double median_depth(const Picture& picture) {
  std::vector<float> depths;
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const float covered = 1.0f - picture.colour[k].w;
    if (covered > float(COVERAGE_FOR_DEPTH)) depths.push_back(picture.z_sum[k] / covered);
  }
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2),
                   depths.end());
  return depths[depths.size() / 2];
}

Cost cost_of(render::Frame& frame, const std::array<shared::View, 2>& views) {
  const auto pictures = [&](int decode) {
    frame.draw(views, {.decode = decode});
    return frame.read_pictures();
  };
  const std::vector<Picture> own = pictures(DECODE_EYES), shared = pictures(DECODE_CYCLOPEAN);
  return {median_depth(own[0]), test::psnr(shared[0], own[0]), stereo::disagreement(views, own, shared).db};
}

TEST(Cyclopean, ErrorAndDisagreementAtThreeDistances) {
  if (!test::switched_on("BINOSPLAT_LONG") && test::gl_context().software())
    GTEST_SKIP() << "the numbers of a page: set BINOSPLAT_LONG=1";
  REQUIRE_SCENE("scaffold", scenes);
  REQUIRE_SCENE("fox", fox);
  const std::vector<Camera> cameras = load_cameras(fox / "cameras.json");
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [](const Camera& c) { return c.name == "0042"; });
  ASSERT_NE(found, cameras.end());
  const Model model = load_model(scenes / "fox");
  render::Frame frame(test::gl_context(), model);
  const Camera head = resized(*found, 259, 472);
  // The eye distance is 0.11 units here. The eyes' errors are nearly opposite, so the eyes disagree by 6 dB
  // more.
  struct Step {
    double back, depth, error, disagreement;
  };
  for (const Step& step :
       {Step{-2.0, 2.4, 54.4, 48.6}, Step{0.0, 4.3, 62.9, 56.3}, Step{4.0, 8.3, 69.1, 64.0}}) {
    Camera moved = head;
    moved.position -= step.back * head.rotation[2];
    const Cost cost = cost_of(frame, stereo::make_rig(moved, {.ipd = 0.11}).views);
    EXPECT_NEAR(cost.depth, step.depth, 0.1);
    EXPECT_NEAR(cost.error, step.error, 0.3);
    EXPECT_NEAR(cost.disagreement, step.disagreement, 0.3);
  }
  // Planted: eyes four times as far apart change the numbers.
  const Cost wide = cost_of(frame, stereo::make_rig(head, {.ipd = 0.44}).views);
  EXPECT_LT(wide.error, 62.9 - 9.0);
  EXPECT_LT(wide.disagreement, 56.3 - 9.0);
}

}  // namespace
}  // namespace binosplat
