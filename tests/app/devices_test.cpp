// binosplat devices.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Devices : SceneTest {
  /// Returns an environment in which the loader finds invalid files in place of these libraries.
  Surroundings without(const Words& libraries) const {
    for (const std::string& name : libraries) write_text(folder / name, "no library");
    return {.variables = {{"LD_LIBRARY_PATH", folder.path().string()}}};
  }
  Outcome devices(const Surroundings& surroundings = {}) const {
    return run_program({"devices", "--json", folder / "devices.json"}, surroundings);
  }
  json list() const { return load_json(folder / "devices.json"); }
};

TEST_F(Devices, ListsBackendsForRender) {
  const Outcome outcome = checked(devices());
  EXPECT_TRUE(has(outcome.out, "--backend surfaceless"));
  bool any = false;
  const json all = list();
  for (const auto& device : all) {
    if (!device.at("usable").get<bool>()) continue;
    any = true;
    EXPECT_GE(device.at("limits").at("storage_blocks").get<int>(), 13);
    EXPECT_TRUE(has(outcome.out, device.at("renderer").get<std::string>()));
  }
  EXPECT_TRUE(any);
}

TEST_F(Devices, FallsBackToOsMesa) {
  const Surroundings none = without({"libEGL.so.1"});
  const Outcome outcome = devices(none);
  if (outcome.code == 3) GTEST_SKIP() << "no OSMesa: apt install libosmesa6";
  ASSERT_TRUE(good(outcome));
  ASSERT_EQ(list().size(), 2u);
  EXPECT_FALSE(list()[0].at("usable").get<bool>());
  EXPECT_EQ(list()[1].at("options"), "--backend osmesa");
  EXPECT_TRUE(ended(render({"--size", "48x32"}, none), 0, "(OSMesa,"));
}

TEST_F(Devices, NamesMissingPackages) {
  const Surroundings none = without({"libEGL.so.1", "libOSMesa.so.8"});
  const Outcome outcome = devices(none);
  EXPECT_EQ(outcome.code, 3) << outcome.out << outcome.err;
  EXPECT_TRUE(has(outcome.out, "apt install libegl1"));
  const Outcome drawn = render({}, none);
  EXPECT_TRUE(ended(drawn, 3, "apt install libegl1"));
  EXPECT_TRUE(ended(drawn, 3, "no usable OpenGL"));
  EXPECT_TRUE(ended(render({"--backend", "osmesa"}, none), 3, "apt install libosmesa6"));
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Devices, ReportsMissingProgramBinaries) {
  const Outcome outcome = devices({.variables = {{"MESA_SHADER_CACHE_DISABLE", "true"}}});
  EXPECT_EQ(outcome.code, 0);
  if (outcome.out.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "no Mesa here";
  if (outcome.out.find("Mesa 22") == std::string::npos)
    GTEST_SKIP() << "newer ones have program binaries without their cache, too";
  EXPECT_TRUE(has(outcome.out, "lacks program binaries"));
}

}  // namespace
}  // namespace binosplat
