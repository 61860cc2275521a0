// Compares the reference's pictures of a trained Scaffold-GS model with INRIA's rasteriser. One view by
// default, all views with BINOSPLAT_LONG=1.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/models/model_file.h"
#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "reference/trained.h"

namespace binosplat::reference {
namespace {

namespace fs = std::filesystem;

constexpr double inria_bound = 65.0;  // dB

class ScaffoldPictures : public testing::TestWithParam<const char*> {
 protected:
  // Returns the picture in 8 bits.
  Image draw(const Model& model, bool anchor_cull) const {
    const shared::View view = make_view(camera_named(fox / "cameras.json", GetParam()));
    Settings settings{TILES_AABB};
    settings.anchor_cull = anchor_cull;
    return quantised(on_black(render(model, view, settings)));
  }
  double psnr_to_photo(const Image& image) const {
    return measure::psnr(image, load_image(fox / "photos" / (std::string(GetParam()) + ".jpg")));
  }

  fs::path fox = test::scene_folder("fox");
};

TEST_P(ScaffoldPictures, MatchInriaAndPhotos) {
  REQUIRE_SCENE("scaffold", scenes);
  REQUIRE_SCENE("fox", fox_folder);
  const std::string name = GetParam();
  if (name != "0001" && !test::switched_on("BINOSPLAT_LONG")) {
    GTEST_SKIP() << "one of the longer runs: set BINOSPLAT_LONG=1";
  }
  const fs::path folder = scenes / "fox";
  const auto number = [&](const char* file) {
    return nlohmann::json::parse(std::ifstream(folder / file)).at(name);
  };
  const Model model = load_model(folder);
  const Image culled = draw(model, true);
  const fs::path inria = folder / "inria" / (name + ".png");
  if (fs::exists(inria)) {
    const double psnr = measure::psnr(culled, load_image(inria));
    EXPECT_GT(psnr, inria_bound);
    RecordProperty("inria", std::to_string(psnr));
  }
  EXPECT_NEAR(psnr_to_photo(culled), number("psnr.json").get<double>(), 0.01);
  const Image whole = draw(model, false);
  EXPECT_NEAR(psnr_to_photo(whole), number("nocull.json").at("psnr").get<double>(), 0.01);
  // The comparison distinguishes pictures with and without the anchor cull.
  EXPECT_GT(std::abs(psnr_to_photo(whole) - number("psnr.json").get<double>()), 0.01);
  if (fs::exists(inria)) {
    EXPECT_LT(measure::psnr(whole, load_image(inria)), inria_bound);
  }
}

INSTANTIATE_TEST_SUITE_P(Fox, ScaffoldPictures,
                         testing::Values("0001", "0012", "0027", "0042", "0073", "0089", "0110"),
                         [](const auto& named) { return std::string(named.param); });

}  // namespace
}  // namespace binosplat::reference
