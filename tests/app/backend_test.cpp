// render --backend: the same picture with each of Mesa's kinds of context.

#include "app/scene.h"

namespace binosplat {
namespace {

struct BackendTest : SceneTest {
  BackendTest() { add_cameras(); }

  // Draws both eyes as float EXR, which holds all bits of the pictures and does not name the device.
  Outcome draw(const std::string& backend, const std::string& file, const Words& more = {}) {
    return render(joined({"--backend", backend, "-o", folder / file, "--exr", "float", "--view", "front",
                          "--exr-encoding", "display"},
                         more));
  }

  /// Draws a small picture with environment variables.
  Outcome draw_small(const std::map<std::string, std::string>& variables = {}) const {
    fs::remove(folder / "p.png");
    return render({"--mono", "--view", "front", "--size", "36x24", "-o", folder / "p.png"},
                  {.variables = variables});
  }
  std::vector<float> small() const { return load_image(folder / "p.png").data; }
};

TEST_F(BackendTest, SurfacelessEqualsOsMesa) {
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

// Variables that users set for other programs: on WSL GALLIUM_DRIVER is d3d12.
TEST_F(BackendTest, UnusableDriverIsAvoidedOrExitsWithThree) {
  ASSERT_TRUE(good(draw_small()));
  const auto expected = small();
  const bool osmesa = draw("osmesa", "osmesa.exr").code == 0;
  for (std::map<std::string, std::string> variables :
       {std::map<std::string, std::string>{{"GALLIUM_DRIVER", "d3d12"}},
        {{"GALLIUM_DRIVER", ""}},
        {{"GALLIUM_DRIVER", "zink"}, {"LIBGL_ALWAYS_SOFTWARE", "1"}},
        {{"MESA_LOADER_DRIVER_OVERRIDE", "zink"}}}) {
    const std::string name = variables.begin()->first, shown = name + "=" + variables.begin()->second;
    variables["ASAN_OPTIONS"] = "detect_leaks=0";  // leak reports cannot name unloaded drivers
    variables["VK_ICD_FILENAMES"] = "/nowhere";    // zink over Mesa 22's own Vulkan ends by a signal
    const Outcome drawn = draw_small(variables);
    // Mesa 25's zink never returns; then the program names the variable.
    const auto is_ended = [&](const Outcome& outcome) {
      return has(outcome.err, "has made no OpenGL context in 20 s: unset " + name);
    };
    if (osmesa && !is_ended(drawn)) {
      EXPECT_TRUE(good(drawn)) << shown;
    }
    if (drawn.code == 0) {
      EXPECT_EQ(small(), expected) << shown;
    } else {
      EXPECT_EQ(drawn.code, 3) << shown << drawn.err;
    }
    const Outcome devices = run_program({"devices"}, {.variables = variables});
    EXPECT_TRUE(devices.code == 0 || (devices.code == 3 && (!osmesa || is_ended(devices))))
        << shown << devices.code;
  }
}

TEST_F(BackendTest, IgnoresMesaOverrides) {
  ASSERT_TRUE(good(draw_small()));
  const auto expected = small();
  for (const auto& [name, value] : std::multimap<std::string, std::string>{
           {"MESA_GLSL_VERSION_OVERRIDE", "330"},
           {"MESA_EXTENSION_OVERRIDE", "-GL_ARB_compute_shader"},
           {"MESA_EXTENSION_OVERRIDE", "+GL_KHR_shader_subgroup +GL_NV_gpu_shader5"}}) {
    const Outcome drawn = draw_small({{name, value}});
    ASSERT_TRUE(good(drawn)) << name << value;
    EXPECT_TRUE(has(drawn.err, name + "=" + value));
    EXPECT_EQ(small(), expected);
  }
}

TEST_F(BackendTest, DeviceAgreesWithMesa) {
  const Outcome device = draw("device", "device.exr");
  if (device.code == 3) GTEST_SKIP() << "no GPU here";
  ASSERT_TRUE(good(device));
  const std::string other = draw("osmesa", "mesa.exr").code == 0 ? "osmesa" : "surfaceless";
  ASSERT_TRUE(good(draw(other, "mesa.exr")));
  EXPECT_GE(psnr_of_files(folder / "device.exr", folder / "mesa.exr"), 60.0);
  ASSERT_TRUE(good(draw(other, "wide.exr", {"--ipd", "0.1"})));
  EXPECT_LT(psnr_of_files(folder / "device.exr", folder / "wide.exr"), 60.0)
      << "eyes too far apart go unnoticed";
}

}  // namespace
}  // namespace binosplat
