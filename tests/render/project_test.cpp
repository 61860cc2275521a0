// The stage project against its float64 reference.

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "render/support.h"

namespace binosplat {
namespace {

// Largest differences between the GPU's and the reference's splats, in units of the error that fp32 may
// cause: at most 1 if the stage is right.
struct Distance {
  double mean = 0, depth = 0, conic = 0, colour = 0, opacity = 0;
  int compared = 0;
  double worst() const { return std::max({mean, depth, conic, colour, opacity}); }
};

Distance distance(const Model& model, const shared::View& view) {
  test::StageRun run(model, {view});
  run.run_until(render::Stage::project);
  const auto [splats, counts] = run.projected(0);
  Distance d;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const reference::Splat expected = reference::project(model, i, view);
    if (counts[i] == 0) continue;  // the view does not draw it
    EXPECT_TRUE(expected.drawn) << i;
    const shared::Splat& s = splats[i];
    ++d.compared;
    const double size = glm::length(expected.mean) + view.width;
    d.mean = std::max(d.mean, glm::length(glm::dvec2(s.mean) - expected.mean) / (2e-6 * size));
    d.depth = std::max(d.depth, std::abs(s.depth - expected.depth) / (2e-6 * (expected.depth + 1)));
    // The conic's error is the error of q at one standard deviation in each direction. Eight roundings before
    // C2 (5e-7) are magnified by `stretch` in det, and again where the three terms of q cancel.
    const double stretch = expected.covariance.x * expected.covariance.z / expected.det;
    const glm::dvec3 q_error = glm::abs(glm::dvec3(s.conic) - expected.conic) * expected.covariance;
    d.conic = std::max(d.conic, (q_error.x + q_error.y + q_error.z) / (3e-6 * stretch * stretch));
    const glm::dvec3 c_error = glm::abs(glm::dvec3(s.colour) - expected.colour);
    d.colour = std::max(d.colour, std::max({c_error.x, c_error.y, c_error.z}) / 2e-5);
    // Antialiased models multiply the opacity by the area of a parallelogram over sqrt(det C2). Its two sides
    // have the eight roundings, and so has C2, magnified as above.
    const double kept_bound = 1e-6 * std::sqrt(stretch) + 5e-7 * stretch * expected.opacity;
    const double opacity_bound = model.antialiased ? kept_bound : 1e-7;
    d.opacity = std::max(d.opacity, std::abs(s.opacity - expected.opacity) / opacity_bound);
  }
  return d;
}

TEST(Project, EqualsReferenceForEveryDegree) {
  Camera turned = test::front_camera(300, 200, 250);  // its principal point is off the centre
  turned.cx = 60;
  turned.cy = 180;
  turned.fy = 310;
  const double a = 0.3;
  turned.rotation = glm::dmat3(std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a), 0, 0, 0, 1);
  turned.position = {0.1, -0.2, -0.3};
  for (int degree = 0; degree <= 3; ++degree) {
    const Model model = test::random_model(static_cast<std::uint32_t>(10 + degree), 3000, degree);
    for (const Camera& camera : {test::front_camera(320, 240, 300), turned}) {
      const Distance d = distance(model, make_view(camera));
      EXPECT_GT(d.compared, 500);
      EXPECT_LE(d.worst(), 1.0) << degree << ": mean " << d.mean << " depth " << d.depth << " conic "
                                << d.conic << " colour " << d.colour << " opacity " << d.opacity;
    }
  }
}

TEST(Project, AntialiasedModelsEqualReference) {
  for (const double kernel : {0.3, 0.1, 2.5}) {
    Model model = test::random_model(6, 3000, 0);
    for (std::size_t i = 0; i < model.count(); i += 2)
      model.scale[i] *= glm::vec3(0.001f, 1.0f, 0.02f);  // thin ones
    model.antialiased = true;
    model.kernel_px2 = kernel;
    const shared::View view = make_view(test::front_camera(320, 240, 300));
    const Distance d = distance(model, view);
    EXPECT_GT(d.compared, 500);
    EXPECT_LE(d.worst(), 1.0) << kernel << ": opacity " << d.opacity << " conic " << d.conic;
    // Injected faults: no compensation, another kernel.
    test::StageRun run(model, {view});
    run.run_until(render::Stage::project);
    const auto [splats, counts] = run.projected(0);
    double plain = 0, other = 0;
    Model without = model, wider = model;
    without.antialiased = false;
    wider.kernel_px2 = 1.01 * kernel;
    for (std::size_t i = 0; i < splats.size(); ++i) {
      if (counts[i] == 0) continue;
      plain = std::max(plain, std::abs(splats[i].opacity - reference::project(without, i, view).opacity));
      other = std::max(other, std::abs(splats[i].opacity - reference::project(wider, i, view).opacity));
    }
    EXPECT_GT(plain, 0.01);
    EXPECT_GT(other, 1e-4);
  }
}

TEST(Project, KeepsPrecisionFarFromOrigin) {
  Model model = test::random_model(4, 2000, 0);
  const glm::vec3 far(65536.0f, -32768.0f, 131072.0f);
  for (glm::vec3& p : model.position) p += far;
  Camera camera = test::front_camera(320, 240, 300);
  camera.position = glm::dvec3(far);
  EXPECT_LE(distance(model, make_view(camera)).worst(), 1.0);
}

TEST(Project, ComparisonDetectsInjectedFaults) {
  const Model model = test::random_model(5, 500, 1);
  const shared::View view = make_view(test::front_camera(320, 240, 300));
  EXPECT_LE(distance(model, view).worst(), 1.0);
  test::StageRun run(model, {view});
  run.run_until(render::Stage::project);
  const auto [splats, counts] = run.projected(0);

  // The reference with one negated SH coefficient differs as much as a GPU with that fault.
  Model wrong = model;
  for (std::size_t i = 0; i < wrong.count(); ++i) {
    for (int c = 0; c < 3; ++c) wrong.sh[i * 12 + 3 + c] *= -1.0f;
  }
  double colour = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (counts[i] == 0) continue;
    const glm::dvec3 e = glm::abs(glm::dvec3(splats[i].colour) - reference::project(wrong, i, view).colour);
    colour = std::max(colour, std::max({e.x, e.y, e.z}) / 2e-5);
  }
  EXPECT_GT(colour, 100.0);

  shared::View shifted = view;  // injected: half a pixel, as if pixel centres were corners
  shifted.lens.z += 0.5f;
  double mean = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (counts[i] == 0) continue;
    mean = std::max(
        mean, glm::length(glm::dvec2(splats[i].mean) - reference::project(model, i, shifted).mean) / 2e-3);
  }
  EXPECT_GT(mean, 100.0);
}

TEST(Project, CullsBeforeNearPlane) {
  Model model;
  test::add(model, {0, 0, 0.2f}, glm::vec3(0.01f), 0.9f);  // at the near plane: not drawn
  test::add(model, {0, 0, std::nextafter(0.2f, 1.0f)}, glm::vec3(0.01f), 0.9f);  // just behind it
  test::add(model, {0, 0, -1.0f}, glm::vec3(0.01f), 0.9f);
  test::StageRun run(model, {make_view(test::front_camera(64, 64, 64))});
  run.run_until(render::Stage::project);
  const auto counts = run.projected(0).coverages;
  EXPECT_EQ(counts[0], 0u);
  EXPECT_GT(counts[1], 0u);
  EXPECT_EQ(counts[2], 0u);
}

TEST(Project, ExtremeSizesGetExpectedTileCounts) {
  Model model;
  test::add(model, {0, 0, 1}, glm::vec3(0.0f), 0.9f);                   // a point: only the low-pass is left
  test::add(model, {0, 0, 2}, glm::vec3(1e7f), 0.5f);                   // covers everything
  test::add(model, {1e7f, 0, 3}, glm::vec3(1e7f, 1e-7f, 1e-7f), 0.5f);  // a needle from far away
  test::add(model, {0, 0, 4}, glm::vec3(1e30f), 0.5f);                  // its covariance overflows fp32
  test::add(model, {0, 0, 5}, glm::vec3(1.0f, 1e-20f, 1e-20f), 1.0f, glm::vec3(1), {1, 1, 1, 1});
  const shared::View view = make_view(test::front_camera(64, 48, 64));
  test::StageRun run(model, {view});
  run.run_until(render::Stage::sort);
  std::array<std::uint32_t, 5> counts{};
  for (const auto& list : run.lists())
    for (const std::uint32_t i : list) ++counts[i];
  EXPECT_EQ(counts[0], 2u);  // centred on the edge of two tiles: (31.5, 23.5)
  EXPECT_EQ(counts[1], 12u);
  EXPECT_LE(counts[2], 12u);
  EXPECT_EQ(counts[3], 0u);
  EXPECT_GT(counts[4], 0u);
}

}  // namespace
}  // namespace binosplat
