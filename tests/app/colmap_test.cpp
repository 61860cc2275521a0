// A model with nothing but COLMAP's reconstruction and the photos beside it.

#include <gtest/gtest.h>

#include "support/fixtures.h"
#include "support/program.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(ColmapScene, GivesThePublishedPsnr) {
  REQUIRE_SCENE("fox", scene);
  const test::TempFolder folder;
  for (const char* name : {"fox.ply", "sparse", "photos"}) fs::create_symlink(scene / name, folder / name);
  const bool all = test::switched_on("BINOSPLAT_LONG");
  std::vector<std::string> arguments = {"render",       folder / "fox.ply", "--mono",
                                        "--photos",     "beside",           "-o",
                                        folder / "out", "--json",           folder / "report.json"};
  const json published = test::load_json(scene / "psnr.json");
  for (const auto& [view, psnr] : published.items()) {
    if (all || view == "0001" || view == "0110") arguments.insert(arguments.end(), {"--view", view + ".jpg"});
  }
  const test::Outcome outcome = test::run_program(arguments);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json report = test::load_json(folder / "report.json");
  std::size_t views = 0;
  for (const json& view : report["views"]) {
    const std::string name = fs::path(view["name"].get<std::string>()).stem();
    EXPECT_NEAR(view["photo_psnr_db"].get<double>(), published[name].get<double>(), 0.02) << name;
    // Planted fault: another view's figure.
    EXPECT_GT(std::abs(view["photo_psnr_db"].get<double>() -
                       published[name == "0001" ? "0110" : "0001"].get<double>()),
              0.02);
    ++views;
  }
  EXPECT_EQ(views, all ? 7u : 2u);
}

}  // namespace
}  // namespace binosplat
