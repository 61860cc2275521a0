// binosplat render as users run it: which files it leaves, and that their contents are what the options ask
// for.

#include <cmath>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"

namespace binosplat {
namespace {

using test::good;
using test::Outcome;
using test::read_text;
using test::run_program;
using test::write_text;
using Names = std::set<std::string>;

struct Render : test::SceneTest {
  bool same(const std::string& a, const std::string& b) const {
    return read_text(folder / a) == read_text(folder / b) && !read_text(folder / a).empty();
  }
  bool alike(const std::string& a, const std::string& b, double psnr) const {
    return run_program({"compare", folder / a, folder / b, "--min-psnr", std::to_string(psnr)}).code == 0;
  }
  nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(read_text(folder / name));
  }
};

TEST_F(Render, WithoutCamerasTheModelIsFramed) {
  const Outcome outcome = render({"--size", "90x60", "-o", out});
  ASSERT_TRUE(good(outcome));
  EXPECT_EQ(folder.files(), (Names{"model.ply", "out/framed_left.png", "out/framed_right.png"}));
  EXPECT_FALSE(same("out/framed_left.png", "out/framed_right.png"));
  EXPECT_NE(outcome.out.find(out + "/framed_left.png"), std::string::npos) << outcome.out;
  for (const char* stage : {"project", "order", "pairs", "tile_sort", "ranges", "blend"}) {
    EXPECT_NE(outcome.out.find(stage), std::string::npos) << outcome.out;
  }
  const Image left = load_image(out + "/framed_left.png");
  EXPECT_EQ(left.width, 90);
  EXPECT_EQ(left.height, 60);
  EXPECT_EQ(left.channels, 3);
}

TEST_F(Render, ViewsAreChosenByName) {
  add_cameras();
  const Outcome first = render({"-o", out});
  ASSERT_TRUE(good(first));
  EXPECT_NE(first.err.find("has 3 views; drawing the first, front"), std::string::npos) << first.err;
  EXPECT_EQ(folder.files(),
            (Names{"cameras.json", "model.ply", "out/front_left.png", "out/front_right.png"}));

  ASSERT_TRUE(good(render({"-o", folder / "two", "--view", "side", "pair", "--only", "right"})));
  ASSERT_TRUE(good(render({"-o", folder / "all", "--view", "all"})));
  ASSERT_TRUE(good(render({"-o", folder / "mono", "--view", "all", "--mono"})));
  Names expected = {"cameras.json", "model.ply", "out/front_left.png", "out/front_right.png"};
  expected.insert({"two/side_right.png", "two/pair_right.png"});
  for (const char* view : {"front", "side", "pair"}) {
    for (const char* eye : {"_left.png", "_right.png"}) expected.insert(std::string("all/") + view + eye);
  }
  for (const char* view : {"front", "side", "pair_left", "pair_right"})
    expected.insert(std::string("mono/") + view + ".png");
  EXPECT_EQ(folder.files(), expected);

  // A given pair is its two cameras; the rig's eyes are not the camera.
  EXPECT_TRUE(alike("all/pair_left.png", "mono/pair_left.png", 60));
  EXPECT_TRUE(alike("all/pair_right.png", "mono/pair_right.png", 60));
  EXPECT_FALSE(alike("all/pair_left.png", "mono/pair_right.png", 60));
  EXPECT_FALSE(alike("all/front_left.png", "mono/front.png", 60));
  EXPECT_TRUE(same("two/pair_right.png", "all/pair_right.png"));
}

TEST_F(Render, APoseSavedBesideTheModelIsUsed) {
  add_cameras();
  nlohmann::json pose = test::camera_json("saved", 0.5);
  pose.update({{"up", {0, -1, 0}}, {"units_per_metre", 2.0}, {"ipd_metres", 0.1}, {"near", 0.1}});
  write_text(folder / "model.binosplat.json", nlohmann::json::array({pose}).dump());
  const auto drawn = [&](const std::string& png, std::vector<std::string> more) {
    more.insert(more.end(), {"-o", folder / png, "--json", folder / "r.json"});
    const Outcome outcome = render(more);
    EXPECT_TRUE(good(outcome));
    return outcome.err.find("pose saved there") != std::string::npos;
  };
  EXPECT_TRUE(drawn("saved.png", {}));
  EXPECT_EQ(json("r.json")["views"][0]["ipd_metres"], 0.1);
  EXPECT_EQ(json("r.json")["settings"]["near"], 0.1);
  EXPECT_FALSE(
      drawn("said.png", {"--view", "side", "--units-per-metre", "2", "--ipd", "0.1", "--near", "0.1"}));
  EXPECT_TRUE(alike("saved.png", "said.png", 120.0));
  // Scale and ipd belong to the model, whatever camera is chosen; options go before what is saved.
  EXPECT_FALSE(drawn("view.png", {"--view", "side", "--near", "0.1"}));
  EXPECT_TRUE(alike("saved.png", "view.png", 120.0));
  EXPECT_FALSE(drawn("other.png", {"--view", "side", "--units-per-metre", "1"}));
  EXPECT_FALSE(alike("saved.png", "other.png", 60.0));
  EXPECT_FALSE(drawn("pair.png", {"--view", "pair"}));
  EXPECT_FALSE(drawn("mono.png", {"--mono", "--eye", "0,0,0", "--at", "0,0,1"}));

  write_text(folder / "model.binosplat.json", "[]");
  EXPECT_TRUE(test::ended(render({"-o", out}), 2, "model.binosplat.json"));
}

TEST_F(Render, EachEyeIsTheSameAlone) {
  add_cameras();
  for (const std::vector<std::string>& rig : {std::vector<std::string>{"--ipd", "0.3", "--convergence", "4"},
                                              {"--ipd", "0.2", "--cant", "5"},
                                              {"--ipd", "0.03", "--units-per-metre", "10"}}) {
    const auto draw = [&](const std::string& name, std::vector<std::string> more) {
      more.insert(more.end(), {"-o", folder / name, "--view", "front"});
      more.insert(more.end(), rig.begin(), rig.end());
      ASSERT_TRUE(good(render(more)));
    };
    draw("both", {});
    draw("alone", {"--only", "left"});
    draw("alone", {"--only", "right"});
    EXPECT_EQ(folder.files().size(), 6u);
    EXPECT_TRUE(same("both/front_left.png", "alone/front_left.png")) << rig[2];
    EXPECT_TRUE(same("both/front_right.png", "alone/front_right.png")) << rig[2];
    EXPECT_FALSE(same("both/front_left.png", "both/front_right.png")) << rig[2];
  }
}

TEST_F(Render, OneFileHasBothEyesSideBySide) {
  add_cameras();
  ASSERT_TRUE(good(render({"-o", folder / "pair.png", "--convergence", "3"})));
  ASSERT_TRUE(good(render({"-o", folder / "pair.exr", "--layout", "parallel", "--exr", "float",
                           "--exr-encoding", "display", "--convergence", "3"})));
  ASSERT_TRUE(good(render({"-o", out, "--convergence", "3"})));
  const Image pair = load_image(folder / "pair.png");
  const Image left = load_image(out + "/front_left.png"), right = load_image(out + "/front_right.png");
  ASSERT_EQ(pair.width, left.width + right.width);
  ASSERT_EQ(pair.height, left.height);
  const auto joined = [&](const Image& a, const Image& b) {
    Image image(pair.width, pair.height, 3);
    for (int y = 0; y < pair.height; ++y) {
      for (int k = 0; k < 3 * pair.width; ++k) {
        const int x = k / 3, c = k % 3;
        image.at(x, y, c) = x < a.width ? a.at(x, y, c) : b.at(x - a.width, y, c);
      }
    }
    return image;
  };
  EXPECT_EQ(measure::largest_difference(pair, joined(left, right)).max, 0.0);
  EXPECT_GT(measure::largest_difference(pair, joined(right, left)).max, 0.0)
      << "swapped eyes were not noticed";
  EXPECT_TRUE(alike("pair.png", "pair.exr", 55));
}

TEST_F(Render, TheGpuAgreesWithTheReference) {
  add_cameras();
  const auto draw = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"-o", folder / name, "--mono", "--exr", "float"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_TRUE(good(render(arguments)));
  };
  draw("gpu", {});
  for (const char* stage : {"project", "order", "pairs", "tile_sort", "ranges", "blend"}) {
    draw("reference", {"--reference-until", stage});
    EXPECT_TRUE(alike("gpu/front.exr", "reference/front.exr", 80)) << stage;
  }
  draw("moved", {"--reference-until", "blend", "--eye", "0.001,0,0", "--at", "0.001,0,1", "--size", "72x48"});
  EXPECT_FALSE(alike("gpu/front.exr", "moved/camera.exr", 80)) << "a moved camera was not noticed";
}

TEST_F(Render, BackgroundBitsAndExr) {
  add_cameras();
  ASSERT_TRUE(
      good(render({"-o", out, "--mono", "--bits", "16", "--exr", "half", "--background", "1,0.5,0"})));
  EXPECT_TRUE(alike("out/front.png", "out/front.exr", 55));
  const Image orange = load_image(out + "/front.png");
  EXPECT_EQ(orange.channels, 3);
  ASSERT_TRUE(good(render({"-o", folder / "none.png", "--mono", "--background", "none"})));
  EXPECT_EQ(load_image(folder / "none.png").channels, 4);
  ASSERT_TRUE(good(render({"-o", folder / "black.png", "--mono"})));
  EXPECT_FALSE(alike("black.png", "out/front.png", 50));
  // The header says at which scale the picture is right.
  EXPECT_NE(read_text(out + "/front.exr").find("binosplatUnitsPerMetre"), std::string::npos);
  EXPECT_NE(read_text(folder / "none.png").find("binosplatUnitsPerMetre"), std::string::npos);
}

TEST_F(Render, HalfPrecisionIsNearButNotTheSame) {
  add_cameras();
  ASSERT_TRUE(good(render({"-o", folder / "full.exr", "--mono", "--exr", "float"})));
  ASSERT_TRUE(good(render({"-o", folder / "half.exr", "--mono", "--exr", "float", "--precision", "half",
                           "--json", folder / "r.json"})));
  EXPECT_TRUE(alike("full.exr", "half.exr", 60));
  EXPECT_FALSE(alike("full.exr", "half.exr", 110));
  const nlohmann::json report = json("r.json");
  EXPECT_EQ(report["settings"]["precision"], "half");
  EXPECT_EQ(report["settings"]["tile"], "auto");
  EXPECT_EQ(report["views"][0]["tile"], 16) << "of one frame";
}

TEST_F(Render, JsonHasWhatWasPrinted) {
  add_cameras();
  const Outcome outcome =
      render({"-o", out, "--json", folder / "r.json", "--frames", "4", "--ipd", "0.07", "--units-per-metre",
              "2", "--convergence", "3", "--tiles", "aabb", "--tile", "8"});
  ASSERT_TRUE(good(outcome));
  const nlohmann::json report = json("r.json");
  EXPECT_EQ(report["version"], "0.1.0");
  EXPECT_EQ(report["scene"]["gaussians"], 300);
  EXPECT_EQ(report["settings"]["tiles"], "aabb");
  EXPECT_EQ(report["settings"]["tile"], 8);
  EXPECT_EQ(report["settings"]["precision"], "full");
  EXPECT_FALSE(report["device"]["renderer"].get<std::string>().empty());
  EXPECT_EQ(report["frames"], 3) << "the first of several compiles shaders and is left out";
  EXPECT_NE(outcome.out.find("3 frames"), std::string::npos) << outcome.out;
  ASSERT_EQ(report["stages"].size(), 7u);
  for (const auto& stage : report["stages"])
    EXPECT_GE(stage["p99_ms"].get<double>(), stage["median_ms"].get<double>());
  EXPECT_GT(report["memory"]["gpu_peak_bytes"].get<double>(), 1000.0);

  ASSERT_EQ(report["views"].size(), 1u);
  const nlohmann::json& view = report["views"][0];
  EXPECT_EQ(view["name"], "front");
  EXPECT_EQ(view["ipd_metres"], 0.07);
  EXPECT_EQ(view["units_per_metre"], 2.0);
  EXPECT_EQ(view["depth_orders"], 1);
  EXPECT_GT(view["pairs"].get<int>(), 100);
  EXPECT_NE(outcome.out.find(view["pairs"].dump() + " pairs"), std::string::npos) << outcome.out;
  const nlohmann::json &left = view["eyes"][0], &right = view["eyes"][1];
  EXPECT_EQ(left["eye"], "left");
  EXPECT_DOUBLE_EQ(right["position"][0].get<double>() - left["position"][0].get<double>(), 0.14);
  // Convergence: right cx - left cx = fx ipd / D.
  EXPECT_NEAR(right["cx"].get<double>() - left["cx"].get<double>(), 60.0 * 0.07 / 3.0, 1e-9);
  for (const auto& file : view["outputs"])
    EXPECT_TRUE(std::filesystem::exists(file.get<std::string>())) << file;
}

TEST_F(Render, PhotosAreComparedAsEightBits) {
  add_cameras();
  std::filesystem::create_directories(folder / "photos");
  ASSERT_TRUE(good(render({"-o", folder / "photos", "--view", "front", "side", "--mono"})));
  const auto psnr = [&](const std::string& view) {
    const Outcome outcome = render({"-o", out, "--view", view, "--mono", "--photos", folder / "photos",
                                    "--json", folder / "r.json", "--bits", "16"});
    EXPECT_TRUE(good(outcome));
    return json("r.json")["views"][0]["photo_psnr_db"];
  };
  EXPECT_TRUE(psnr("front").is_null()) << "equal: infinite";

  Image photo = load_image(folder / "photos/front.png");
  photo.at(10, 10, 0) += photo.at(10, 10, 0) > 0.5f ? -0.2f : 0.2f;
  save_png(folder / "photos/front.png", photo);
  EXPECT_NEAR(psnr("front").get<double>(), -10.0 * std::log10(0.2 * 0.2 / (72 * 48 * 3)), 0.001);
}

TEST_F(Render, CamerasCanBeMadeUp) {
  add_cameras();  // and are not looked at
  ASSERT_TRUE(good(render({"-o", out, "--orbit", "3", "--size", "60x40", "--mono", "--fov", "50"})));
  ASSERT_TRUE(
      good(render({"-o", out, "--eye", "0,0,-1", "--at", "0,0,4", "--size", "60x40", "--only", "left"})));
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "out/orbit_000.png", "out/orbit_001.png",
                                   "out/orbit_002.png", "out/camera_left.png"}));
  EXPECT_FALSE(same("out/orbit_000.png", "out/orbit_001.png"));
  const auto lit = [&](const char* name) {
    const Image image = load_image(folder / name);
    return std::count_if(image.data.begin(), image.data.end(), [](float v) { return v > 0.1f; });
  };
  EXPECT_GT(lit("out/orbit_001.png"), 500);
  EXPECT_GT(lit("out/camera_left.png"), 500);
}

TEST_F(Render, TheBuiltInRoomNeedsNoFile) {
  test::Surroundings here;
  here.folder = folder.path();
  ASSERT_TRUE(good(run_program({"render", "demo:room", "--size", "96x54"}, here)));
  EXPECT_EQ(folder.files(),
            (Names{"model.ply", "out/room/model.txt", "out/room/room_left.png", "out/room/room_right.png"}));
}

TEST_F(Render, ShadersFromAFolder) {
  add_cameras();
  const auto shaders = folder / "shaders";
  std::filesystem::copy(std::filesystem::path(BINOSPLAT_SOURCE_DIR) / "shaders", shaders,
                        std::filesystem::copy_options::recursive);
  ASSERT_TRUE(good(render({"-o", folder / "a.png"})));
  ASSERT_TRUE(good(render({"-o", folder / "b.png", "--shader-dir", shaders})));
  EXPECT_TRUE(same("a.png", "b.png"));

  // Another constant makes another picture; a mistake is named by file and line.
  const std::string limits = read_text(shaders / "shared/limits.h");
  write_text(shaders / "shared/limits.h", limits + "#undef KERNEL_PX2\n#define KERNEL_PX2 3.0\n");
  ASSERT_TRUE(good(render({"-o", folder / "b.png", "--shader-dir", shaders})));
  EXPECT_FALSE(same("a.png", "b.png"));
  write_text(shaders / "shared/limits.h", limits);
  write_text(shaders / "project.comp", read_text(shaders / "project.comp") + "this is no GLSL\n");
  const Outcome broken = render({"-o", folder / "c.png", "--shader-dir", shaders});
  EXPECT_TRUE(test::ended(broken, 3, "project.comp:"));
  EXPECT_FALSE(std::filesystem::exists(folder / "c.png"));
}

}  // namespace
}  // namespace binosplat
