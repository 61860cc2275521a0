// The stage blend against its float64 reference: both get the same splats and lists.

#include "render/support.h"

namespace binosplat {
namespace {

const render::DebugOptions only_blend = test::given(render::Stage::sort);

// Many opaque layers, so that most pixels end early.
Model layers_of_light() {
  Model model;
  test::Uniform uniform(31);
  for (int i = 0; i < 400; ++i) {
    const double z = 1.0 + 0.01 * i;
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    test::add(model, {uniform(-0.4, 0.4) * z, uniform(-0.4, 0.4) * z, z}, glm::vec3(0.2f),
              static_cast<float>(uniform(0.3, 1)), colour);
  }
  return model;
}

TEST(Blend, EqualsReference) {
  const shared::View view = make_view(test::front_camera(96, 80, 90));
  for (const Model& model : {test::random_model(32, 2000, 0), layers_of_light()}) {
    const Picture expected = reference::render(model, view);
    const Picture drawn = test::draw(model, view, {}, only_blend);
    EXPECT_GE(test::psnr(drawn, expected), 100.0);
    const Image z = depth_map(drawn);
    const Image z_expected = depth_map(expected);
    for (std::size_t k = 0; k < z.data.size(); ++k) {
      if (std::isinf(z_expected.data[k]) || std::isinf(z.data[k])) continue;
      EXPECT_NEAR(z.data[k], z_expected.data[k], 1e-4) << k;
    }
  }
}

TEST(Blend, ComparisonDetectsLateStop) {
  const Model model = layers_of_light();
  const shared::View view = make_view(test::front_camera(96, 80, 90));
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const Picture late = reference::blend(splats, lists, view, {.stop_late = true});
  EXPECT_LT(test::psnr(test::draw(model, view, {}, only_blend), late), 95.0);
}

}  // namespace
}  // namespace binosplat
