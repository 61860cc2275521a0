// What --detail and --quality promise of levels of detail, of models that are hard to divide: a few Gaussians
// as wide as all of the scene, others smaller than a pixel.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"
#include "support/models.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using test::good;
using test::run_program;

/// 800 Gaussians around the origin with scales over eight orders of magnitude: of all of them, of each axis
/// of its own, of a fifth of them, or of some giants.
Model wild_model(std::uint32_t seed) {
  test::Uniform uniform(seed);
  const auto spread = [&] { return uniform(-1.0, 1.0) + uniform(-1.0, 1.0) + uniform(-1.0, 1.0); };
  const auto any = [&] { return std::pow(10.0, uniform(-6.0, 2.0)); };
  Model model;
  model.name = "wild";
  model.degree = 1;
  for (int i = 0; i < 800; ++i) {
    const double even = any(), small = std::pow(10.0, uniform(-2.2, -1.3));
    glm::dvec3 scale(even);
    switch (seed % 4) {
      case 0:
        break;
      case 1:
        scale = {any(), any(), any()};
        break;
      case 2:
        scale = uniform(0.0, 1.0) < 0.2 ? glm::dvec3(any(), any(), any()) : glm::dvec3(small);
        break;
      default:
        scale = glm::dvec3(i % 50 == 0 ? std::pow(10.0, uniform(0.0, 1.5)) : small);
    }
    const glm::vec3 colour(uniform(0.0, 1.0), uniform(0.0, 1.0), uniform(0.0, 1.0));
    const glm::vec4 rotation(uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0), 1.0f);
    test::add(model, glm::vec3(spread(), spread(), spread()), glm::vec3(scale),
              static_cast<float>(uniform(0.05, 0.95)), colour, rotation);
    for (std::size_t k = model.sh.size() - 9; k < model.sh.size(); ++k)
      model.sh[k] = static_cast<float>(uniform(-0.3, 0.3));
  }
  return model;
}

/// The first number of a name in a JSON, wherever it stands.
std::optional<double> number_of(const nlohmann::json& json, const std::string& name) {
  const nlohmann::json flat = json.flatten();
  for (const auto& [pointer, value] : flat.items())
    if (pointer.ends_with("/" + name) && value.is_number()) return value.get<double>();
  return std::nullopt;
}

/// Of all leaves of a tree.
void make_errors_small(nlohmann::json& node) {
  for (nlohmann::json& child : node["children"]) make_errors_small(child);
  if (!node.contains("lods")) return;
  for (nlohmann::json& level : node["lods"])
    for (nlohmann::json& of_direction : level["errors"])
      for (nlohmann::json& error : of_direction) error = 1e-6 * error.get<double>();
}

struct Promise {
  double told = 0.0, finest = 0.0;  // dB, and against the finest levels
};

struct LevelsTruth : test::SceneTest {
  using Words = std::vector<std::string>;

  /// A picture from 4 units away.
  Image picture(int turn, const std::string& size, const Words& more) const {
    const double angle = 0.3 * turn;
    const std::string eye = fmt::format("{},0.2,{}", 4.0 * std::sin(angle), -4.0 * std::cos(angle));
    Words line = {"render", out,      "--eye", eye,      "--at", "0,0,0",         "--up",
                  "0,-1,0", "--size", size,    "--mono", "-o",   folder / "r.png"};
    line.insert(line.end(), more.begin(), more.end());
    EXPECT_TRUE(good(run_program(line)));
    return load_image(folder / "r.png");
  }
  double coarsest_psnr(int turn, const std::string& size) const {
    return measure::psnr(picture(turn, size, {"--lod", "0"}), picture(turn, size, {"--lod", "3"}));
  }

  Promise render(int turn, const std::string& size, Words more) const {
    for (const std::string& word : Words{"--detail-report", "--json", folder / "r.json"})
      more.push_back(word);
    picture(turn, size, more);
    const auto json = nlohmann::json::parse(test::read_text(folder / "r.json"));
    const std::optional<double> told = number_of(json, "told_psnr_db");
    return {told ? *told : number_of(json, "predicted_psnr_db").value_or(INFINITY),
            number_of(json, "finest_psnr_db").value_or(INFINITY)};
  }
};

// A giant that stands for several hides what the several do not, and a part that is predicted to lose nothing
// loses all of it then: 30 dB, where 40 were told.
TEST_F(LevelsTruth, HoldsWhateverTheScales) {
  const bool all = test::switched_on("BINOSPLAT_LONG");
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    if (!all && seed != 1) continue;
    SCOPED_TRACE(seed);
    test::save_ply(model, wild_model(seed));
    std::filesystem::remove_all(out);
    ASSERT_TRUE(good(run_program({"levels", model, "-o", out, "--leaf", "64", "--levels", "4"})));
    for (const int turn : all ? std::vector{0, 3, 7} : std::vector{static_cast<int>(seed)}) {
      for (const char* size : {"40x30", "80x60", "320x240"}) {
        if (!all && std::string(size) != "80x60") continue;
        SCOPED_TRACE(fmt::format("{} {}", turn, size));
        for (const Words& asked : {Words{"--quality", "40"}, Words{"--detail", "40dB"}}) {
          SCOPED_TRACE(asked[0]);
          const Promise promise = render(turn, size, asked);
          EXPECT_GE(promise.finest, 38.0);
          EXPECT_NEAR(std::min(promise.told, 60.0), std::min(promise.finest, 60.0), 2.0);
        }
        // Planted: what the coarsest levels look like.
        EXPECT_LT(coarsest_psnr(turn, size), 38.0);
      }
    }
  }
}

// A file that says that its levels lose a millionth of what they do is found out.
TEST_F(LevelsTruth, IsNotWhatAFileSays) {
  test::save_ply(model, wild_model(3));
  ASSERT_TRUE(good(run_program({"levels", model, "-o", out, "--leaf", "64", "--levels", "4"})));
  const std::string path = out + "/lod-meta.json";
  nlohmann::json meta = nlohmann::json::parse(test::read_text(path));
  make_errors_small(meta["tree"]);
  test::write_text(path, meta.dump());
  const Promise promise = render(1, "80x60", {"--detail", "40dB"});
  EXPECT_GE(promise.finest, 38.0);
  EXPECT_NEAR(promise.told, promise.finest, 2.0);
}

}  // namespace
}  // namespace binosplat
