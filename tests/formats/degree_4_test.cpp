// Harmonics of degree 4, which binosplat does not draw, in formats whose order of coefficients differs from
// ply. Degrees 0 to 3 are kept.

#include <gtest/gtest.h>

#include "support/gltf.h"
#include "support/ply.h"
#include "support/ply_models.h"
#include "support/usd.h"

namespace binosplat {
namespace {

struct DegreeFour : testing::Test {
  static constexpr std::size_t count = 10;
  Model model = test::load(test::inria_file(3, count));

  /// Returns coefficient m of the 25, which has one value per channel.
  float coefficient(std::size_t i, std::size_t m, std::size_t channel) const {
    return m < 16 ? model.sh[48 * i + 3 * m + channel] : 99.0f;
  }
};

TEST_F(DegreeFour, IsLeftOutOfOpenUsd) {
  std::string usd = test::usd_prim(model);
  usd.replace(usd.find("Degree = 3"), 10, "Degree = 4");
  const std::size_t at = usd.find("Coefficients = ") + 15;
  const auto value = [&](std::size_t k, int c) {
    return coefficient(k / 25, k % 25, static_cast<std::size_t>(c));
  };
  usd = usd.substr(0, at) + test::usd_list(25 * count, 3, value) + "\n}\n";
  const Model of_usd = test::load_usd_text(test::usd_file(usd));
  EXPECT_EQ(of_usd.sh, model.sh);
  EXPECT_TRUE(of_usd.lacks_degree_4);
  EXPECT_FALSE(test::load_usd_text(test::usd_file(test::usd_prim(model))).lacks_degree_4);
}

TEST_F(DegreeFour, IsLeftOutOfGltf) {
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
