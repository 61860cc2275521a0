// After Renderer::prepare(), no visible frame compiles a shader.

#include <gtest/gtest.h>

#include "library/renderer_fixture.h"
#include "support/models.h"

namespace binosplat {
namespace {

struct Prepare : Library {
  const Model model = test::random_model(3, 400, 2);

  /// Returns the number of programs that the first frames make: a camera cut, frames after it, and measuring
  /// frames.
  int made_by_frames(Renderer& renderer, const std::vector<View>& drawn, const Settings& settings) const {
    int made = 0;
    Placement moved = placement;
    for (int n = 0; n < 10; ++n) {
      moved.origin.x = 0.002 * n;
      made += renderer.draw(drawn, moved, settings).new_programs;
    }
    return made;
  }

  void expect_prepared(const std::vector<View>& drawn, const Settings& settings,
                       Precision precision = Precision::full) {
    Renderer renderer(caller.get_proc_address(), in_memory(model), precision);
    renderer.prepare(drawn, placement, settings);
    EXPECT_EQ(made_by_frames(renderer, drawn, settings), 0);
  }
};

TEST_F(Prepare, CompilesAllPrograms) {
  const Settings measured{.quality = 40.0f, .transmittance = Transmittance::last};
  Renderer cold(caller.get_proc_address(), in_memory(model));
  EXPECT_GT(made_by_frames(cold, views(), measured), 0) << "there is nothing to prepare";
  expect_prepared(views(), measured);
  expect_prepared(views(), over_black, Precision::half);
  expect_prepared(views(), {.background = glm::vec3(0.0f), .foveation = Foveation{}});
  std::vector<View> both = views();
  both[0].target.texture = caller.texture(GL_RGBA8, 2 * size.x, size.y);
  expect_prepared(both, {.background = glm::vec3(0.0f), .layout = Layout::parallel});
}

TEST_F(Prepare, CoversDepthsAndMeshes) {
  std::vector<View> with_depths = views();
  std::vector<View> with_meshes = views();
  for (std::size_t k = 0; k < 2; ++k) {
    const std::uint32_t depth = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
    with_depths[k].depth = {.texture = depth};
    with_meshes[k].mesh_depth = {.texture = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y),
                                 .near_plane = 0.2,
                                 .far_plane = 100.0};
  }
  expect_prepared(with_depths, {.quality = 40.0f});
  expect_prepared(with_meshes, {.quality = 40.0f}, Precision::half);
}

TEST_F(Prepare, ChangesNoPicture) {
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  renderer.draw(views(), placement, over_black);
  const std::vector<float> before = read(0);
  std::vector<View> other = views();
  other[0].eye.position.x += 1.0;
  renderer.prepare(other, placement, {.quality = 30.0f});
  EXPECT_EQ(read(0), before) << "it wrote into a target";
  renderer.draw(views(), placement, over_black);
  EXPECT_EQ(read(0), before);
  // What a frame leaves for the next is still as that frame left it.
  renderer.prepare(other, placement, over_black);
  EXPECT_GT(renderer.draw(other, placement, over_black).visible, 0u);
  const std::vector<float> prepared = read(0);
  renderer.draw(views(), placement, over_black);
  renderer.draw(other, placement, over_black);
  EXPECT_EQ(prepared, read(0));
  EXPECT_NE(prepared, before);
}

}  // namespace
}  // namespace binosplat
