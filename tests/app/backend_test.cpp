// render --backend: the same picture from each of Mesa's ways to a context.

#include "app/scene.h"
#include "formats/image_file.h"

namespace binosplat {
namespace {

using test::good;
using test::has;
using test::Outcome;
using test::read_text;

struct BackendTest : test::SceneTest {
  // Both eyes as float EXR, which holds all bits of the pictures and says nothing of the device.
  Outcome draw(const std::string& backend, const std::string& file, const test::Words& more = {}) {
    return render(joined({"--backend", backend, "-o", folder / file, "--exr", "float", "--view", "front",
                          "--exr-encoding", "display"},
                         more));
  }
};

TEST_F(BackendTest, SurfacelessAndOsMesaAreEqualBitForBit) {
  add_cameras();
  const Outcome surfaceless = draw("surfaceless", "egl.exr");
  const Outcome osmesa = draw("osmesa", "osmesa.exr");
  if (osmesa.code == 3) GTEST_SKIP() << osmesa.err;
  if (surfaceless.err.find("llvmpipe") == std::string::npos)
    GTEST_SKIP() << "the surfaceless platform is not Mesa's here: " << surfaceless.err;
  ASSERT_TRUE(good(surfaceless));
  ASSERT_TRUE(good(osmesa));
  EXPECT_TRUE(has(osmesa.err, "(OSMesa,"));
  EXPECT_FALSE(has(surfaceless.err, "(OSMesa,"));
  EXPECT_EQ(read_text(folder / "egl.exr"), read_text(folder / "osmesa.exr"));
  ASSERT_TRUE(good(draw("surfaceless", "other.exr", {"--tiles", "aabb"})));
  EXPECT_NE(read_text(folder / "egl.exr"), read_text(folder / "other.exr"))
      << "another picture goes unnoticed";
}

// As people have them for other programs: on WSL GALLIUM_DRIVER is d3d12.
TEST_F(BackendTest, DriversThatMesaLacksAreNoCrash) {
  add_cameras();
  const std::vector<std::string> line = {"--mono", "--view", "front",         "--size",
                                         "36x24",  "-o",     folder / "p.png"};
  ASSERT_TRUE(good(render(line)));
  const auto seen = [&] { return load_image(folder / "p.png").data; };
  const auto expected = seen();
  const bool osmesa = draw("osmesa", "osmesa.exr").code == 0;
  for (std::map<std::string, std::string> variables :
       {std::map<std::string, std::string>{{"GALLIUM_DRIVER", "d3d12"}},
        {{"GALLIUM_DRIVER", "zink"}},
        {{"GALLIUM_DRIVER", "nonsense"}},
        {{"GALLIUM_DRIVER", ""}},
        {{"GALLIUM_DRIVER", "zink"}, {"LIBGL_ALWAYS_SOFTWARE", "1"}},
        {{"MESA_LOADER_DRIVER_OVERRIDE", "zink"}}}) {
    std::filesystem::remove(folder / "p.png");
    const std::string shown = variables.begin()->first + "=" + variables.begin()->second;
    variables["ASAN_OPTIONS"] = "detect_leaks=0";  // of drivers that are no longer there to be named
    const Outcome drawn = render(line, {.variables = variables});
    if (osmesa) {
      EXPECT_TRUE(good(drawn)) << shown;
    }
    if (drawn.code == 0) {
      EXPECT_EQ(seen(), expected) << shown;
    } else {
      EXPECT_EQ(drawn.code, 3) << shown << drawn.err;
      EXPECT_TRUE(has(drawn.err, shown));
    }
    const Outcome devices = test::run_program({"devices"}, {.variables = variables});
    EXPECT_TRUE(devices.code == 0 || (devices.code == 3 && !osmesa)) << shown << devices.code;
  }
}

TEST_F(BackendTest, WhatMesaIsMadeToReportIsIgnored) {
  add_cameras();
  const std::vector<std::string> line = {"--mono", "--view", "front",         "--size",
                                         "36x24",  "-o",     folder / "p.png"};
  ASSERT_TRUE(good(render(line)));
  const auto expected = load_image(folder / "p.png").data;
  for (const auto& [name, value] : std::multimap<std::string, std::string>{
           {"MESA_GLSL_VERSION_OVERRIDE", "330"},
           {"MESA_GLSL_VERSION_OVERRIDE", "460"},
           {"MESA_EXTENSION_OVERRIDE", "-GL_ARB_compute_shader"},
           {"MESA_EXTENSION_OVERRIDE", "+GL_KHR_shader_subgroup +GL_NV_gpu_shader5"}}) {
    std::filesystem::remove(folder / "p.png");
    const Outcome drawn = render(line, {.variables = {{name, value}}});
    ASSERT_TRUE(good(drawn)) << name << value;
    EXPECT_TRUE(has(drawn.err, name + "=" + value));
    EXPECT_EQ(load_image(folder / "p.png").data, expected);
  }
}

TEST_F(BackendTest, TheDeviceAgreesWithMesa) {
  add_cameras();
  const Outcome device = draw("device", "device.exr");
  if (device.code == 3) GTEST_SKIP() << "no GPU here";
  ASSERT_TRUE(good(device));
  const std::string other = draw("osmesa", "mesa.exr").code == 0 ? "osmesa" : "surfaceless";
  ASSERT_TRUE(good(draw(other, "mesa.exr")));
  const auto compared = [&](const std::string& file) {
    return test::run_program({"compare", folder / "device.exr", folder / file, "--min-psnr", "60"}).code;
  };
  EXPECT_EQ(compared("mesa.exr"), 0);
  ASSERT_TRUE(good(draw(other, "wide.exr", {"--ipd", "0.1"})));
  EXPECT_EQ(compared("wide.exr"), 1) << "eyes too far apart go unnoticed";
}

}  // namespace
}  // namespace binosplat
