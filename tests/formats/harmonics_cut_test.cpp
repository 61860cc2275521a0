// What leaving out harmonics of degree 4 is said to cost, against colours in random directions.

#include "formats/harmonics_cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "formats/model_file.h"
#include "support/gltf.h"
#include "support/models.h"
#include "support/ply.h"
#include "support/program.h"
#include "support/usd.h"

namespace binosplat {
namespace {

/// The real harmonic of degree 4 and order m, by the associated Legendre functions.
double harmonic_4(int m, const glm::dvec3& d) {
  const auto order = static_cast<unsigned>(std::abs(m));
  double norm = 9.0 / (4.0 * glm::pi<double>());
  for (int k = 4 - static_cast<int>(order) + 1; k <= 4 + static_cast<int>(order); ++k) norm /= k;
  const double azimuth = std::atan2(d.y, d.x),
               legendre = std::sqrt(norm) * std::assoc_legendre(4, order, d.z);
  if (m == 0) return legendre;
  return std::sqrt(2.0) * legendre * (m > 0 ? std::cos(m * azimuth) : std::sin(-m * azimuth));
}

glm::dvec3 random_direction(test::Uniform& uniform) {
  const double z = uniform(-1, 1), angle = uniform(0, glm::two_pi<double>()), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

struct HarmonicsCut : testing::Test {
  Model model;
  std::vector<std::array<float, cut_values>> cut;
  std::vector<float> squares;

  void SetUp() override {
    test::Uniform uniform(1);
    for (int i = 0; i < 10; ++i) {
      const auto size = static_cast<float>(uniform(0.1, 1));
      test::add(model, glm::vec3(0.0f), {size, 0.5f * size, 0.1f * size}, static_cast<float>(uniform(0, 1)));
      for (float& c : cut.emplace_back()) c = static_cast<float>(uniform(-0.1, 0.1) * (i + 1));
      squares.push_back(square_sum(cut.back()));
    }
  }

  /// The PSNR of what is left out in random directions, Gaussians as often as they are seen.
  double drawn_db() const {
    test::Uniform uniform(2);
    double changes = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < cut.size(); ++i) {
      const double weight = model.opacity[i] * model.scale[i].x * model.scale[i].y;
      constexpr int directions = 10000;
      for (int k = 0; k < directions; ++k) {
        const glm::dvec3 d = random_direction(uniform);
        for (std::size_t c = 0; c < 3; ++c) {
          double change = 0.0;
          for (std::size_t m = 0; m < 9; ++m)
            change += cut[i][3 * m + c] * harmonic_4(static_cast<int>(m) - 4, d);
          changes += weight * change * change / (3.0 * directions);
        }
      }
      weights += weight;
    }
    return -10.0 * std::log10(changes / weights);
  }
};

TEST_F(HarmonicsCut, IsWhatRandomDirectionsShow) {
  EXPECT_NEAR(cut_harmonics_db(model, squares).value(), drawn_db(), 0.1);
  // Planted faults: another weight, and another norm.
  Model other = model;
  for (std::size_t i = 0; i < 10; ++i) other.opacity[i] = i < 3 ? 1.0f : 0.01f;
  EXPECT_GT(std::abs(*cut_harmonics_db(other, squares) - drawn_db()), 0.3);
  for (float& square : squares) square *= 1.2f;
  EXPECT_GT(std::abs(*cut_harmonics_db(model, squares) - drawn_db()), 0.3);
}

TEST_F(HarmonicsCut, OfNothingIsNothing) {
  EXPECT_FALSE(cut_harmonics_db(model, std::vector<float>(10, 0.0f)));
  EXPECT_FALSE(cut_harmonics_db(model, {}));
  squares[3] = INFINITY;  // of a Gaussian that is left out
  EXPECT_TRUE(std::isfinite(*cut_harmonics_db(model, squares)));
}

/// The same Gaussians in a ply, in OpenUSD and in glTF, which have the coefficients in different orders.
TEST_F(HarmonicsCut, IsTheSameOfEachFormat) {
  test::PlyFile ply = test::inria_file(0, 10);
  for (std::size_t k = 0; k < 72; ++k) ply.columns.push_back(fmt::format("f_rest_{}", k));
  for (std::size_t i = 0; i < 10; ++i) {
    ply.rows[i].resize(ply.columns.size());
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t m = 0; m < 9; ++m)
        ply.at(i, fmt::format("f_rest_{}", 24 * c + 15 + m)) = cut[i][3 * m + c];
    }
  }
  const test::TempFolder folder;
  test::write_text(folder / "a.ply", to_bytes(ply));
  const Model of_ply = load_model(folder / "a.ply");
  ASSERT_TRUE(of_ply.cut_db);
  EXPECT_EQ(of_ply.degree, 3);
  EXPECT_DOUBLE_EQ(*of_ply.cut_db, *cut_harmonics_db(of_ply, squares));
  std::string usd = test::usd_prim(of_ply);
  usd.replace(usd.find("Degree = 3"), 10, "Degree = 4");
  const std::size_t at = usd.find("Coefficients = ") + 15;
  usd = usd.substr(0, at) +
        test::usd_list(250, 3,
                       [&](std::size_t k, int c) {
                         const auto channel = static_cast<std::size_t>(c);
                         const std::size_t i = k / 25, m = k % 25;
                         return m < 16 ? of_ply.sh[48 * i + 3 * m + channel] : cut[i][3 * (m - 16) + channel];
                       }) +
        "\n}\n";
  const Model of_usd = test::load_usd_text(test::usd_file(usd));
  EXPECT_EQ(of_usd.sh, of_ply.sh);
  EXPECT_NEAR(of_usd.cut_db.value(), *of_ply.cut_db, 1e-4);

  test::Glb glb = test::gltf_of(of_ply);
  for (std::size_t m = 0; m < 9; ++m) {
    std::vector<float> numbers;
    for (std::size_t i = 0; i < 10; ++i) numbers.insert(numbers.end(), &cut[i][3 * m], &cut[i][3 * m] + 3);
    glb.attributes()[fmt::format("{}:SH_DEGREE_4_COEF_{}", test::splatting, m)] =
        glb.add_accessor(test::packed<float>(numbers), 10, "VEC3");
  }
  const Model of_gltf = test::load_gltf_bytes(glb.bytes());
  EXPECT_EQ(of_gltf.sh, of_ply.sh);
  EXPECT_NEAR(of_gltf.cut_db.value(), *of_ply.cut_db, 1e-4);
}

}  // namespace
}  // namespace binosplat
