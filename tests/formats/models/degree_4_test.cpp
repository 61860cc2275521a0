// Harmonics of degree 4, which binosplat does not draw, in glTF, whose order of coefficients differs from
// ply's. Degrees 0 to 3 are kept.

#include <gtest/gtest.h>

#include "support/gltf.h"
#include "support/ply.h"
#include "support/ply_models.h"

namespace binosplat {
namespace {

TEST(DegreeFour, IsDroppedFromGltf) {
  constexpr std::size_t count = 10;
  const Model model = test::load(test::inria_file(3, count));
  test::Glb glb = test::gltf_of(model);
  EXPECT_FALSE(test::load_gltf_bytes(glb.bytes()).lacks_degree_4);
  for (std::size_t m = 0; m < 9; ++m) {
    glb.attributes()[fmt::format("{}:SH_DEGREE_4_COEF_{}", test::splatting, m)] =
        glb.add_accessor(test::packed<float>(std::vector<float>(3 * count, 99.0f)), count, "VEC3");
  }
  const Model of_gltf = test::load_gltf_bytes(glb.bytes());
  EXPECT_EQ(of_gltf.sh, model.sh);
  EXPECT_TRUE(of_gltf.lacks_degree_4);
}

}  // namespace
}  // namespace binosplat
