// Models from arrays equal the same models from files.

#include <limits>
#include <utility>

#include "library/renderer_fixture.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

struct Arrays : Library {
  const Model model = test::random_model(3, 200, 2);
  std::vector<glm::vec3> means = model.position, scales = model.scale, sh;
  std::vector<glm::vec4> quats = model.rotation;
  std::vector<float> opacities = model.opacity;

  Arrays() {
    for (std::size_t k = 0; k < model.sh.size(); k += 3)
      sh.emplace_back(model.sh[k], model.sh[k + 1], model.sh[k + 2]);
  }
  Gaussians gaussians() const { return {means, quats, scales, opacities, sh}; }

  double difference_of(const SplatModel& other) {
    Renderer expected(caller.get_proc_address(), in_memory(model));
    expected.draw(views(), placement, over_black);
    const std::vector<float> before = read(0);
    Renderer renderer(caller.get_proc_address(), other);
    renderer.draw(views(), placement, over_black);
    const std::vector<float> now = read(0);
    double most = 0.0;
    for (std::size_t k = 0; k < now.size(); ++k)
      most = std::max(most, static_cast<double>(std::abs(now[k] - before[k])));
    return most;
  }
};

TEST_F(Arrays, DrawLikeModelFile) {
  const SplatModel from_arrays(gaussians(), "mine");
  EXPECT_EQ(from_arrays.name(), "mine");
  EXPECT_EQ(from_arrays.count(), model.count());
  EXPECT_LT(difference_of(from_arrays), 1e-5);
  for (glm::vec4& q : quats) q *= 3.0f;  // quaternions of any length
  EXPECT_LT(difference_of(SplatModel(gaussians())), 1e-5);
  for (glm::vec4& q : quats) q = {q.y, q.z, q.w, q.x};  // injected: x, y, z, w
  EXPECT_GT(difference_of(SplatModel(gaussians())), 1e-2);
}

TEST_F(Arrays, RejectInvalidGaussians) {
  const auto refused = [&](const char* said) {
    return test::fails_saying([&] { const SplatModel made(gaussians()); }, {said});
  };
  // Replaces one value, checks the error, and restores the value.
  const auto value_refused = [&](float& value, float wrong, const char* said) {
    const float right = std::exchange(value, wrong);
    const auto result = refused(said);
    value = right;
    return result;
  };
  constexpr float inf = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(value_refused(scales[7].y, -1.0f, "scales[7]: below 0"));
  EXPECT_TRUE(value_refused(scales[7].y, NAN, "scales[7]: expected finite numbers"));
  EXPECT_TRUE(value_refused(means[3].x, NAN, "means[3]: expected finite numbers"));
  EXPECT_TRUE(value_refused(quats[3].x, inf, "quats[3]: expected finite numbers"));
  EXPECT_TRUE(value_refused(sh[13].z, -inf, "sh[1]: expected finite numbers"));
  EXPECT_TRUE(value_refused(opacities[0], 1.5f, "opacities[0]: expected 0 to 1"));
  EXPECT_TRUE(value_refused(opacities[0], NAN, "opacities[0]: expected 0 to 1"));
  quats[7] = glm::vec4(0.0f);
  EXPECT_TRUE(refused("quats[7]: a quaternion of zeros"));
  quats[7].x = 1.0f;
  opacities.pop_back();
  EXPECT_TRUE(refused("opacities: 199 elements for 200 means"));
  opacities.push_back(0.5f);
  sh.pop_back();
  EXPECT_TRUE(refused("expected 1, 4, 9 or 16 for each"));
  means.clear(), quats.clear(), scales.clear(), opacities.clear(), sh.clear();
  EXPECT_ERROR(const SplatModel made(gaussians()), "no Gaussians");
  Gaussians named;
  named.axes = "XYZ";
  EXPECT_ERROR(const SplatModel made(named), "XYZ");
}

}  // namespace
}  // namespace binosplat
