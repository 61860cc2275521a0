// Runs binosplat render like users: checks which files it writes, and that their contents follow the options.

#include "app/scene.h"

namespace binosplat {
namespace {

struct Render : SceneTest {
  bool same(const std::string& a, const std::string& b) const {
    return read_text(folder / a) == read_text(folder / b) && !read_text(folder / a).empty();
  }
  /// Draws into a file or folder.
  void draw(const std::string& name, const Words& words) const {
    ASSERT_TRUE(good(render(joined(words, {"-o", folder / name}))));
  }
  double psnr(const std::string& a, const std::string& b) const {
    return psnr_of_files(folder / a, folder / b);
  }
};

TEST_F(Render, FramesModelWithoutCameras) {
  const Outcome outcome = checked(render({"--size", "90x60"}));
  EXPECT_EQ(folder.files(), (Names{"model.ply", "out/framed_left.png", "out/framed_right.png"}));
  EXPECT_FALSE(same("out/framed_left.png", "out/framed_right.png"));
  for (const char* word : {"/framed_left.png", "project", "bin", "sort", "blend"})
    EXPECT_TRUE(has(outcome.out, word));
  const Image left = load_image(out + "/framed_left.png");
  EXPECT_EQ(left.width, 90);
  EXPECT_EQ(left.height, 60);
  EXPECT_EQ(left.channels, 3);
}

TEST_F(Render, SelectsViewsByName) {
  add_cameras();
  EXPECT_TRUE(has(render({}).err, "has 3 views; drawing the first, front"));
  draw("two", {"--view", "side", "--view", "pair", "--only", "right"});
  draw("all", {"--view", "all"});
  draw("mono", {"--view", "all", "--mono"});
  Names expected = {"cameras.json",        "model.ply",          "out/front_left.png",
                    "out/front_right.png", "two/side_right.png", "two/pair_right.png"};
  for (const char* view : {"front", "side", "pair"}) {
    for (const char* eye : {"_left.png", "_right.png"}) expected.insert(std::string("all/") + view + eye);
  }
  for (const char* view : {"front", "side", "pair_left", "pair_right"})
    expected.insert(std::string("mono/") + view + ".png");
  EXPECT_EQ(folder.files(), expected);

  // A given stereo pair is drawn with its two cameras. A rig's eyes differ from the camera. Each eye alone
  // gives the same picture.
  EXPECT_GE(psnr("all/pair_left.png", "mono/pair_left.png"), 60);
  EXPECT_GE(psnr("all/pair_right.png", "mono/pair_right.png"), 60);
  EXPECT_LT(psnr("all/pair_left.png", "mono/pair_right.png"), 60);
  EXPECT_LT(psnr("all/front_left.png", "mono/front.png"), 60);
  EXPECT_TRUE(same("two/pair_right.png", "all/pair_right.png"));
  EXPECT_TRUE(same("two/side_right.png", "all/side_right.png"));
}

TEST_F(Render, UsesSavedPose) {
  add_cameras();
  save_pose(2.0, 0.1);
  const auto drawn = [&](const std::string& png, const Words& more) {
    const Outcome outcome = checked(render(joined(more, {"-o", folder / png, "--json", folder / "r.json"})));
    return outcome.err.find("pose saved there") != std::string::npos;
  };
  EXPECT_TRUE(drawn("saved.png", {}));
  EXPECT_EQ(load_json(folder / "r.json")["views"][0]["ipd_metres"], 0.1);
  EXPECT_EQ(load_json(folder / "r.json")["settings"]["near"], 0.1);
  EXPECT_FALSE(
      drawn("said.png", {"--view", "side", "--units-per-metre", "2", "--ipd", "0.1", "--near", "0.1"}));
  EXPECT_GE(psnr("saved.png", "said.png"), 120.0);
  // Scale and eye distance belong to the model, whatever the camera is. Options have precedence over the
  // saved pose.
  EXPECT_FALSE(drawn("view.png", {"--view", "side", "--near", "0.1"}));
  EXPECT_GE(psnr("saved.png", "view.png"), 120.0);
  EXPECT_FALSE(drawn("other.png", {"--view", "side", "--units-per-metre", "1"}));
  EXPECT_LT(psnr("saved.png", "other.png"), 60.0);
  EXPECT_FALSE(drawn("mono.png", {"--mono", "--eye", "0,0,0", "--at", "0,0,1"}));

  write_text(folder / "model.binosplat.json", "[]");
  EXPECT_TRUE(ended(render({}), 2, "model.binosplat.json"));
}

TEST_F(Render, OneFileHoldsBothEyes) {
  add_cameras();
  const Words far = {"--convergence", "3"};
  draw("aside.png", far);
  draw("pair.exr", joined(far, {"--layout", "parallel", "--exr", "float", "--exr-encoding", "display"}));
  draw("above", joined(far, {"--view", "front,side", "--layout", "over-under"}));
  draw("out", far);
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "aside.png", "pair.exr", "above/front.png",
                                   "above/side.png", "out/front_left.png", "out/front_right.png"}));
  EXPECT_TRUE(has(read_text(folder / "above/front.png"), "over-under")) << "no note of the layout";
  EXPECT_GE(psnr("aside.png", "pair.exr"), 55);
  const Image left = load_image(out + "/front_left.png"), right = load_image(out + "/front_right.png");
  // Returns one eye of a picture with both eyes side by side or one above the other.
  const auto eye = [&](const char* name, int x0, int y0) {
    const Image whole = load_image(folder / name);
    EXPECT_EQ(whole.data.size(), 2 * left.data.size());
    Image part(left.width, left.height, 3);
    for (int y = 0; y < part.height; ++y) {
      for (int k = 0; k < 3 * part.width; ++k) part.at(k / 3, y, k % 3) = whole.at(x0 + k / 3, y0 + y, k % 3);
    }
    return part.data;
  };
  EXPECT_TRUE(eye("aside.png", 0, 0) == left.data);
  EXPECT_TRUE(eye("aside.png", 72, 0) == right.data);
  EXPECT_TRUE(eye("above/front.png", 0, 0) == left.data);
  EXPECT_TRUE(eye("above/front.png", 0, 48) == right.data);
  EXPECT_FALSE(left.data == right.data) << "swapped eyes go unnoticed";
}

TEST_F(Render, GpuAgreesWithReference) {
  add_cameras();
  const Words what = {"--mono", "--exr", "float", "--exr-encoding", "display"};
  draw("gpu.exr", what);
  for (const char* stage : {"project", "blend"}) {
    draw("reference.exr", joined(what, {"--reference-until", stage}));
    EXPECT_GE(psnr("gpu.exr", "reference.exr"), 80) << stage;
  }
  draw("moved.exr", joined(what, {"--reference-until", "blend", "--eye", "0.001,0,0", "--at", "0.001,0,1",
                                  "--size", "72x48"}));
  EXPECT_LT(psnr("gpu.exr", "moved.exr"), 80) << "a moved camera was not noticed";
}

TEST_F(Render, WritesBackgroundBitsAndExr) {
  add_cameras();
  draw("out", {"--mono", "--bits", "16", "--exr", "half", "--background", "1,0.5,0"});
  EXPECT_GE(psnr("out/front.png", "out/front.exr"), 55);
  EXPECT_EQ(load_image(out + "/front.png").channels, 3);
  draw("none.png", {"--mono", "--background", "none"});
  EXPECT_EQ(load_image(folder / "none.png").channels, 4);
  draw("black.png", {"--mono"});
  EXPECT_LT(psnr("black.png", "out/front.png"), 50);
  // The file's header has the scale at which the stereo picture is correct.
  EXPECT_TRUE(has(read_text(out + "/front.exr"), "binosplatUnitsPerMetre"));
  EXPECT_TRUE(has(read_text(folder / "none.png"), "binosplatUnitsPerMetre"));
}

TEST_F(Render, HalfPrecisionIsApproximate) {
  add_cameras();
  draw("full.exr", {"--mono", "--exr", "float"});
  const json report =
      reported({"-o", folder / "half.exr", "--mono", "--exr", "float", "--precision", "half"});
  EXPECT_GE(psnr("full.exr", "half.exr"), 60);
  EXPECT_LT(psnr("full.exr", "half.exr"), 110);
  EXPECT_EQ(report["settings"]["precision"], "half");
}

TEST_F(Render, JsonMatchesOutput) {
  add_cameras();
  const Outcome outcome =
      checked(render({"--json", folder / "r.json", "--frames", "4", "--ipd", "0.07", "--units-per-metre", "2",
                      "--convergence", "3", "--tiles", "aabb"}));
  const json report = load_json(folder / "r.json");
  EXPECT_EQ(report["version"], "0.1.0");
  EXPECT_EQ(report["scene"]["gaussians"], 300);
  EXPECT_EQ(report["settings"]["tiles"], "aabb");
  EXPECT_EQ(report["settings"]["precision"], "full");
  EXPECT_FALSE(report["device"]["renderer"].get<std::string>().empty());
  EXPECT_EQ(report["frames"], 3) << "the first of several compiles shaders and is left out";
  EXPECT_TRUE(has(outcome.out, "3 frames"));
  ASSERT_EQ(report["stages"].size(), 5u);
  for (const json& stage : report["stages"])
    EXPECT_GE(stage["p99_ms"].get<double>(), stage["median_ms"].get<double>());
  // 300 Gaussians of 48 bytes, and 12 SH coefficients of 4 bytes each.
  const json& memory = report["memory"];
  EXPECT_EQ(memory["model_bytes"], 300 * (48 + 48));
  EXPECT_GT(memory["min_frame_bytes"].get<double>(), 2 * 72 * 48 * 16);
  EXPECT_LT(memory["min_frame_bytes"].get<double>(), memory["gpu_peak_bytes"].get<double>());
  EXPECT_TRUE(has(outcome.err, "GPU memory: 0.0 MB for the model, at least "));

  ASSERT_EQ(report["views"].size(), 1u);
  const json& view = report["views"][0];
  EXPECT_EQ(view["name"], "front");
  EXPECT_EQ(view["ipd_metres"], 0.07);
  EXPECT_EQ(view["units_per_metre"], 2.0);
  EXPECT_EQ(view["depth_orders"], 1);
  EXPECT_GT(view["pairs"].get<int>(), 100);
  EXPECT_TRUE(has(outcome.out, "  " + view["pairs"].dump() + "  "));
  const json &left = view["eyes"][0], &right = view["eyes"][1];
  EXPECT_EQ(left["eye"], "left");
  EXPECT_DOUBLE_EQ(right["position"][0].get<double>() - left["position"][0].get<double>(), 0.14);
  // Convergence: right cx - left cx = fx ipd / D.
  EXPECT_NEAR(right["cx"].get<double>() - left["cx"].get<double>(), 60.0 * 0.07 / 3.0, 1e-9);
  for (const json& file : view["outputs"]) EXPECT_TRUE(fs::exists(file.get<std::string>())) << file;
}

TEST_F(Render, GeneratesCameras) {
  add_cameras();  // which are then ignored
  draw("out", {"--orbit", "3", "--size", "60x40", "--mono", "--fov", "50"});
  draw("out", {"--eye", "0,0,-1", "--at", "0,0,4", "--size", "60x40", "--only", "left"});
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "out/orbit_000.png", "out/orbit_001.png",
                                   "out/orbit_002.png", "out/camera_left.png"}));
  EXPECT_FALSE(same("out/orbit_000.png", "out/orbit_001.png"));
  for (const char* name : {"out/orbit_001.png", "out/camera_left.png"}) {
    const Image image = load_image(folder / name);
    EXPECT_GT(std::count_if(image.data.begin(), image.data.end(), [](float v) { return v > 0.1f; }), 500);
  }
}

TEST_F(Render, LoadsShadersFromFolder) {
  add_cameras();
  const auto shaders = folder / "shaders";
  fs::copy(fs::path(BINOSPLAT_SOURCE_DIR) / "shaders", shaders, fs::copy_options::recursive);
  draw("a.png", {});
  draw("b.png", {"--shader-dir", shaders});
  EXPECT_TRUE(same("a.png", "b.png"));

  // Another constant makes another picture. An error message names the file and line.
  const std::string limits = read_text(shaders / "shared/limits.h");
  write_text(shaders / "shared/limits.h", limits + "#undef KERNEL_PX2\n#define KERNEL_PX2 3.0\n");
  draw("b.png", {"--shader-dir", shaders});
  EXPECT_FALSE(same("a.png", "b.png"));
  write_text(shaders / "shared/limits.h", limits);
  write_text(shaders / "project.comp", read_text(shaders / "project.comp") + "this is no GLSL\n");
  EXPECT_TRUE(ended(render({"-o", folder / "c.png", "--shader-dir", shaders}), 3, "project.comp:"));
  EXPECT_FALSE(fs::exists(folder / "c.png"));
}

}  // namespace
}  // namespace binosplat
