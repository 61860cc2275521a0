// Models written and loaded again. The bounds follow from the steps of each format.

#include <gtest/gtest.h>

#include <functional>

#include "support/errors.h"
#include "support/ply.h"
#include "support/round_trip.h"

namespace binosplat {
namespace {

using test::difference;
using test::formats;
using test::hard_model;
using test::in_axes_of;
using test::name_of;
using test::round_trip;
using test::same_bits;
using test::Written;

TEST(ModelOutput, PlyRoundTripsBits) {
  for (int degree = 0; degree <= 3; ++degree) {
    Model model = hard_model(degree, degree == 1 ? 200000 : 1);
    const Written written = round_trip(model, ModelFormat::ply);
    EXPECT_TRUE(same_bits(written.model, model)) << "degree " << degree;
    EXPECT_TRUE(written.losses.empty());
    model.sh[model.sh.size() - 1] = std::nextafter(model.sh[model.sh.size() - 1], 9.0f);
    EXPECT_FALSE(same_bits(written.model, model));
  }
}

// INRIA's own programs rely on the names, on their order, on the count in the third line, and on normals of
// 0.
TEST(ModelOutput, PlyMatchesTrainer) {
  const test::PlyFile trained = test::inria_file(3, 10);
  const test::TempFolder folder;
  test::write_text(folder / "trained.ply", to_bytes(trained));
  const std::string bytes = round_trip(load_model(folder / "trained.ply"), ModelFormat::ply).bytes;
  ASSERT_TRUE(bytes.starts_with(header_of(trained)));
  for (std::size_t i = 0; i < 10; ++i) {
    for (std::size_t k = 0; k < 62; ++k) {
      float value = 0;
      std::memcpy(&value, &bytes[header_of(trained).size() + 4 * (62 * i + k)], 4);
      const std::string& name = trained.columns[k];
      if (name[0] == 'n') {
        EXPECT_EQ(value, 0.0f);
      } else if (name.starts_with("rot_")) {
        const double w = trained.at(i, "rot_0"), x = trained.at(i, "rot_1"), y = trained.at(i, "rot_2"),
                     z = trained.at(i, "rot_3");
        EXPECT_NEAR(value, trained.rows[i][k] / std::sqrt(w * w + x * x + y * y + z * z), 1e-6);
      } else if (name == "opacity" || name.starts_with("scale_")) {
        EXPECT_NEAR(value, trained.rows[i][k], 2e-6) << name;
      } else {
        EXPECT_EQ(value, trained.rows[i][k]) << name;
      }
    }
  }
}

TEST(ModelOutput, FormatsStayWithinQuantisation) {
  for (const ModelFormat format : formats) {
    for (int degree = 0; degree <= 3; ++degree) {
      for (const std::size_t count : {1u, 255u, 256u, 257u, 3000u}) {
        if (count == 3000 && degree != 3) continue;
        const Model model = in_axes_of(hard_model(degree, count), format);
        const Written written = round_trip(model, format);
        EXPECT_EQ(difference(model, written.model, format), "")
            << name_of(format) << ", degree " << degree << ", " << count;
        if (count == 3000) {
          EXPECT_EQ(round_trip(model, format).bytes, written.bytes) << name_of(format);
        }
      }
    }
  }
  for (const int bits : {1, 4, 7}) {
    const Model model = in_axes_of(hard_model(3, 1000), ModelFormat::spz);
    EXPECT_EQ(difference(model, round_trip(model, ModelFormat::spz, bits).model, ModelFormat::spz, bits), "");
    EXPECT_EQ(difference(model, round_trip(model, ModelFormat::spz, bits).model, ModelFormat::spz, bits + 1),
              "sh");
  }
}

TEST(ModelOutput, ComparisonDetectsFaults) {
  const auto each = [](auto& list, const auto& spoil) {
    for (auto& value : list) spoil(value);
  };
  using Spoil = std::function<void(Model&)>;
  const std::pair<std::string, Spoil> faults[] = {
      {"position", [&](Model& m) { each(m.position, [](glm::vec3& p) { std::swap(p.x, p.y); }); }},
      {"scale", [&](Model& m) { each(m.scale, [](glm::vec3& s) { std::swap(s.y, s.z); }); }},
      {"rotation", [&](Model& m) { each(m.rotation, [](glm::vec4& q) { q.x = -q.x; }); }},
      {"opacity", [&](Model& m) { each(m.opacity, [](float& a) { a = 0.5f * a + 0.3f; }); }},
      {"dc", [&](Model& m) { std::swap(m.sh[0], m.sh[1]); }},
      {"sh", [&](Model& m) { std::swap(m.sh[45], m.sh[42]); }},
      {"axes", [&](Model& m) { m.axes.letters = "LUF"; }},
      {"count", [&](Model& m) { m.resize(m.count() - 1); }}};
  for (const ModelFormat format : formats) {
    const Model model = in_axes_of(hard_model(3, 700, 7), format);
    const Model back = round_trip(model, format).model;
    for (const auto& [attribute, spoil] : faults) {
      Model faulty = back;
      spoil(faulty);
      EXPECT_EQ(difference(model, faulty, format), attribute) << name_of(format);
    }
  }
}

// Returns a thousand Gaussians within a cube with edges of `wide` units.
Model model_of_width(double wide) {
  test::Uniform uniform(3);
  Model model;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 at(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5));
    test::add(model, glm::vec3(wide * at), glm::vec3(static_cast<float>(0.01 * wide)), 0.5f);
  }
  return model;
}

TEST(ModelOutput, SmallModelsKeepShape) {
  for (const double wide : {0.02, 0.08, 1.0, 50.0, 1e5}) {
    const Model model = in_axes_of(model_of_width(wide), ModelFormat::spz);
    const Model back = round_trip(model, ModelFormat::spz).model;
    double farthest = 0.0;
    for (std::size_t i = 0; i < model.count(); ++i)
      farthest = std::max(farthest, double{glm::length(model.position[i] - back.position[i])});
    // With the 12 fractional bits of other writers, a width of 0.02 would have 82 steps.
    EXPECT_LT(farthest, 3e-5 * wide) << wide;
  }
  // A message says if even 24 fractional bits are too few.
  const auto losses = round_trip(in_axes_of(model_of_width(1e-4), ModelFormat::spz), ModelFormat::spz).losses;
  ASSERT_EQ(losses.size(), 2u);
  EXPECT_TRUE(losses[0].starts_with("the model is so small")) << losses[0];
}

TEST(ModelOutput, UnreadableModelIsNotWritten) {
  Model model = model_of_width(1.0);
  model.rotation[3] = glm::vec4(0.0f);
  const test::TempFolder folder;
  EXPECT_TRUE(test::fails_saying(
      [&] {
        OutputFile file(folder / "model.ply");
        write_model(file, model, ModelFormat::ply);
        read_back(file, model, ModelFormat::ply);
      },
      {"ply cannot store this model; of 1000 written Gaussians, 999 can be read back"}));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace binosplat
