// binosplat devices.

#include "app/scene.h"

namespace binosplat {
namespace {

using test::has;

TEST(Devices, ListsWaysToDrawThatRenderTakes) {
  const test::TempFolder folder;
  const test::Outcome outcome = test::run_program({"devices", "--json", folder / "devices.json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.out, "--backend surfaceless"));
  const auto list = test::load_json(folder / "devices.json");
  bool any = false;
  for (const auto& device : list) {
    if (!device.at("usable").get<bool>()) continue;
    any = true;
    EXPECT_GE(device.at("limits").at("storage_blocks").get<int>(), 13);
    EXPECT_TRUE(has(outcome.out, device.at("renderer").get<std::string>()));
  }
  EXPECT_TRUE(any);
}

TEST(Devices, WithoutEglOsMesaDraws) {
  const test::TempFolder folder;
  test::write_text(folder / "libEGL.so.1", "no library");
  const test::Surroundings none = {.variables = {{"LD_LIBRARY_PATH", folder.path().string()}}};
  const test::Outcome outcome = test::run_program({"devices", "--json", folder / "devices.json"}, none);
  if (outcome.code == 3) GTEST_SKIP() << "no OSMesa: apt install libosmesa6";
  ASSERT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const auto list = test::load_json(folder / "devices.json");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_FALSE(list[0].at("usable").get<bool>());
  EXPECT_EQ(list[1].at("options"), "--backend osmesa");
  const test::Outcome render =
      test::run_program({"render", "demo:room", "--size", "48x32", "-o", folder / "out"}, none);
  EXPECT_EQ(render.code, 0) << render.err;
  EXPECT_TRUE(has(render.err, "(OSMesa,"));
}

TEST(Devices, WithoutAnySaysWhatToInstall) {
  // Libraries of those names which are none stand before the real ones.
  const test::TempFolder folder;
  test::write_text(folder / "libEGL.so.1", "no library");
  test::write_text(folder / "libOSMesa.so.8", "no library");
  const test::Surroundings none = {.variables = {{"LD_LIBRARY_PATH", folder.path().string()}}};
  const test::Outcome devices = test::run_program({"devices"}, none);
  EXPECT_EQ(devices.code, 3) << devices.out << devices.err;
  EXPECT_TRUE(has(devices.out, "apt install libegl1"));
  const test::Outcome render = test::run_program({"render", "demo:room", "-o", folder / "out"}, none);
  EXPECT_EQ(render.code, 3) << render.err;
  EXPECT_TRUE(has(render.err, "apt install libegl1"));
  EXPECT_TRUE(has(render.err, "apt install libosmesa6"));
}

TEST(Devices, WithoutProgramBinariesSaysWhatThatCosts) {
  const test::Outcome outcome =
      test::run_program({"devices"}, {.variables = {{"MESA_SHADER_CACHE_DISABLE", "true"}}});
  EXPECT_EQ(outcome.code, 0);
  if (outcome.out.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "no Mesa here";
  if (outcome.out.find("Mesa 22") == std::string::npos)
    GTEST_SKIP() << "newer ones have program binaries without their cache, too";
  EXPECT_TRUE(has(outcome.out, "lacks program binaries"));
}

}  // namespace
}  // namespace binosplat
