// Runs binosplat bench like a user: along frames, turns of the head and levels of detail, and by the paper's
// protocol.

#include <cmath>

#include "app/scene.h"

namespace binosplat {
namespace {

struct BenchAlong : SceneTest {
  std::string printed, said;

  BenchAlong() { add_cameras(); }

  /// Writes the suite, runs the benchmark, and returns its points.
  json bench(const std::string& suite, const Words& more, const Words& scenes = {}) {
    write_text(folder / "suite.json", suite);
    fs::remove_all(out);
    const Outcome outcome = checked(run_into_out(joined(
        joined({"bench", "--suite", folder / "suite.json"}, more), scenes.empty() ? Words{model} : scenes)));
    printed = outcome.out;
    said = outcome.err;
    return load_json(out + "/results.json").at("points");
  }
  /// Returns the file of a path of cameras.
  std::string path_of(int frames, double step, double seconds = 0.0) const {
    json path;
    for (int n = 0; n < frames; ++n) {
      path.push_back(camera_json(fmt::format("frame_{}", n), step * n));
      if (seconds > 0.0) path.back()["time"] = seconds * n;
    }
    return save("path.json", path);
  }
  static std::size_t details_of(const json& point, const std::string& part) {
    return static_cast<std::size_t>(std::ranges::count_if(
        point.at("details"), [&](const json& row) { return row.value("phase", "") == part; }));
  }
};

TEST_F(BenchAlong, MotionsVisitCameras) {
  const json points = bench(R"({"frames": 3, "repeats": 2, "eyes": [2], "sizes": ["36x24"],
      "settings": [{}, {"threshold": ["squared", "adagscale"], "transmittance": ["one", "last"],
      "quality": 38}]})",
                            {"--motion", "still,walk", "--rule", "squared,one", "--rule", "adagscale,last"});
  ASSERT_EQ(points.size(), 2u * 3) << "exact, and the two rules";
  EXPECT_EQ(points[0].at("along"), "still");
  EXPECT_EQ(points[3].at("along"), "walk");
  EXPECT_EQ(points[5].at("name"), "adagscale, last, asked for 38 dB");
  EXPECT_EQ(details_of(points[0], "moving"), 3u * 3);
  EXPECT_EQ(details_of(points[0], "stop"), 0u);
  EXPECT_EQ(details_of(points[4], "moving"), 3u * 3);
  EXPECT_EQ(details_of(points[4], "stop"), 3u * 15);
  EXPECT_TRUE(points[4].contains("reported_minus_true_db"));
  EXPECT_TRUE(points[4].contains("speed")) << "speed vs exact";
  EXPECT_TRUE(has(printed, "model, both eyes, size 36x24, along walk"));
  EXPECT_TRUE(has(read_text(out + "/report.html"), "true and reported"));
  const std::string details = read_text(out + "/details.csv");
  EXPECT_TRUE(has(details, "\"model\",2,\"36x24\",\"walk\",")) << details.substr(0, 400);
}

TEST_F(BenchAlong, PathHasFramesOrKeys) {
  const std::string suite = R"({"repeats": 1, "eyes": [2], "sizes": ["24x16"], "settings": [{}]})";
  json points = bench(suite, {"--path", path_of(4, 0.01), "--mono"});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].at("eyes"), 1);
  EXPECT_EQ(points[0].at("along"), "path");
  EXPECT_EQ(details_of(points[0], "moving"), 4u);
  points = bench(suite, {"--path", path_of(3, 0.1, 0.2)});
  EXPECT_EQ(details_of(points[0], "moving"), 37u) << "90 a second";
  points = bench(suite, {"--tour", "6,200"});
  EXPECT_EQ(points[0].at("along"), "tour");
  EXPECT_GT(details_of(points[0], "moving"), 3u);
}

TEST_F(BenchAlong, TransformsCamerasToModelFrame) {
  REQUIRE_FIXTURES(fixtures);
  json path;
  for (int n = 0; n < 2; ++n) {
    path.push_back(camera_json(fmt::format("frame_{}", n), 0.0));
    path.back()["position"] = {2.0 + 0.01 * n, 3.0, -10.0};
  }
  const std::string file = save("path.json", path);
  const auto pairs_in = [&](const std::string& scene) -> double {
    return bench(R"({"repeats": 1, "settings": [{}]})", {"--path", file}, {fixtures / scene})[0]["pairs"];
  };
  const double ply = pairs_in("ply/inria-train-1000.ply"), gltf = pairs_in("gltf/st-train-sh3.glb");
  EXPECT_GT(ply, 100.0);
  EXPECT_NEAR(gltf, ply, 0.01 * ply) << "x left, y up";
}

TEST_F(BenchAlong, OptionSetsMetres) {
  save_ply(model, room_model());
  fs::remove(folder / "cameras.json");
  bench(R"({"frames": 1, "repeats": 1, "settings": [{}], "sizes": ["36x24"]})", {"--units-per-metre", "0.5"});
  EXPECT_TRUE(has(said, "from 0.8 units above its floor"));
}

constexpr const char* small_paper = R"({"views": 24, "training": 16, "frames": 1, "repeats": 1,
    "sizes": ["SIZE"], "contributions": true, "settings": [{"tiles": ["aabb", "ellipse"]},
    {"threshold": "adagscale", "transmittance": "depth", "far": [100, null],
     "found_on": ["test", "training"], "max_drop": [0.1, 0.2]},
    {"threshold": "adagscale", "transmittance": "depth", "far": [100, null],
     "found_on": ["test", "training"], "min_psnr": [40, 34]}]})";

std::string sized_paper(const std::string& size) {
  std::string text = small_paper;
  return text.replace(text.find("SIZE"), 4, size);
}

TEST_F(BenchAlong, PaperTablesUseTestViews) {
  const json points = bench(sized_paper("36x24"), {"--test", "side"});
  ASSERT_EQ(points.size(), 2u + 2 * 2 * 2 + 1);
  for (const json& point : points) {
    if (!point.contains("min_psnr")) continue;
    EXPECT_EQ(point.at("worst_view"), "side");
    EXPECT_TRUE(point.contains("found_tolerance") && point.contains("pairs_removed"));
    if (point.at("found_on") == "test") {
      EXPECT_GE(point.at("psnr_db").get<double>(), point.at("min_psnr").get<double>() - 1e-6);
    }
  }
  EXPECT_EQ(points.back().at("name"), "contributions");
  EXPECT_TRUE(has(said, "1 views for tests; 2 others for training"));
  const std::string page = read_text(out + "/report.html");
  for (const char* title :
       {"pairs removed (table IV)", "speed at equal error (figure 8)", "(figures 4a, 5a, 5b)"})
    EXPECT_TRUE(has(page, title)) << title;
}

// Two scenes in one run, and the choice of views: cameras in the order of INRIA's trainer, test views first.
TEST_F(BenchAlong, AddsMeanOfScenesAndSplitsViews) {
  json cameras;
  for (const char* name : {"b", "h", "a", "c", "d", "e", "f", "g", "i", "j"})
    cameras.push_back(camera_json(name, 0.05 * static_cast<double>(cameras.size())));
  write_text(folder / "cameras.json", cameras.dump());
  const std::string other = folder / "other.ply";
  fs::copy_file(model, other);
  const json points = bench(sized_paper("18x12"), {"--cameras", folder / "cameras.json"}, {model, other});
  EXPECT_EQ(points.back().at("scene"), "mean of 2 scenes");
  EXPECT_TRUE(has(said, "2 views for tests: the 2 that"));
  EXPECT_TRUE(has(said, "; 8 others for training"));
  const auto& views = points[0].at("details");
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].at("view"), "b");
  EXPECT_EQ(views[1].at("view"), "h");
}

struct BenchLevelsCommand : SceneTest {
  /// Returns a folder of levels, with cameras in it.
  std::string make_levels(const std::string& name, bool cameras = true) {
    std::string made = folder / name;
    EXPECT_TRUE(good(run_program({"levels", model, "-o", made, "--chunk", "64", "--levels", "4"})));
    if (cameras) {
      add_row_of_cameras(3);
      fs::rename(folder / "cameras.json", folder / (name + "/cameras.json"));
    }
    return made;
  }

  Outcome bench(const Words& scenes, const Words& more) const {
    return run_into_out(joined(joined({"bench"}, scenes), joined({"--frames", "1"}, more)));
  }
};

TEST_F(BenchLevelsCommand, ReportsSameAsRender) {
  save_ply(model, test::random_model(4, 700, 0));
  const std::string made = make_levels("made");
  const Outcome outcome = checked(bench({made}, {"--detail", "25dB,35dB", "--ipd", "0.1"}));
  const json points = load_json(out + "/results.json").at("points");
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0].at("gaussians"), 700.0) << "the finest";
  EXPECT_EQ(points[2].at("detail"), "35dB");
  EXPECT_TRUE(has(outcome.out, "ellipse, levels for 35dB"));
  EXPECT_TRUE(has(read_text(out + "/report.html"), "what levels of detail lose"));

  ASSERT_TRUE(good(run_program({"render", made, "--view", "all", "--detail", "35dB", "--ipd", "0.1", "-o",
                                folder / "r", "--json", folder / "r.json"})));
  const auto rendered = load_json(folder / "r.json").at("views");
  const auto views = points[2]["details"], coarser = points[1]["details"];
  ASSERT_EQ(views.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& levels = rendered[k]["levels_of_detail"];
    EXPECT_EQ(views[k]["view"], rendered[k]["name"]);
    EXPECT_EQ(views[k]["gaussians"], levels["gaussians"]);
    EXPECT_EQ(views[k]["reported_db"], levels["predicted_psnr_db"]);
    // Injected: coarser levels are different.
    EXPECT_GT(std::abs(coarser[k]["psnr_db"].get<double>() - views[k]["psnr_db"].get<double>()), 1.0);
    EXPECT_GT(coarser[k]["flip"], views[k]["flip"]);
    EXPECT_LT(coarser[k]["disagreement_db"], views[k]["disagreement_db"]);
  }
}

TEST_F(BenchLevelsCommand, ReportsGrowthWithModelSize) {
  const std::string small = make_levels("small");
  save_ply(model, test::random_model(2, 900, 1));
  const std::string large = make_levels("large", false);
  const Outcome outcome =
      checked(bench({small, large}, {"--detail", "2", "--cameras", small + "/cameras.json", "--view", "view2",
                                     "--mono", "--size", "36x24"}));
  const auto points = load_json(out + "/results.json").at("points");
  EXPECT_EQ(points[2]["gaussians"], 900.0);
  EXPECT_EQ(points[3]["details"][0]["view"], "view2");
  EXPECT_FALSE(points[3].contains("disagreement_db")) << "one eye";
  EXPECT_FALSE(points[3].contains("reported_db")) << "pixels predict nothing";
  EXPECT_TRUE(has(read_text(out + "/report.html"), "growth with the model"));
}

TEST_F(BenchLevelsCommand, RejectsInvalidInput) {
  const std::string made = make_levels("made", false), beside = "no cameras beside " + made;
  add_cameras();
  expect_refused_after({"bench"},
                       {{{model, "--detail", "30dB"}, model + " is not a folder with levels of detail"},
                        {{"demo:room", "--suite", "levels"}, "`binosplat levels MODEL -o DIR` makes"},
                        {{made, "--detail", "30dB"}, beside}});
  expect_refused_after({"bench", made, "--cameras", folder / "cameras.json", "--detail"},
                       {{{"30dB", "--view", "no-such"}, "--view no-such"},
                        {{"30dB", "--view", "pair", "--mono"}, "pair_left"},
                        {{"40db,x"}, "--detail x: expected"},
                        {{"90dB"}, "--detail 90dB"}});
}

TEST_F(BenchAlong, RejectsInvalidOptions) {
  const std::string alone = save("alone.json", json({camera_json("alone", 0.0)}));
  write_text(folder / "foveated.json", R"({"settings": [{"inset": 20}]})");
  write_text(folder / "pair.json", R"({"eyes": 2, "settings": [{"threshold": "squared", "min_psnr": 40}]})");
  write_text(folder / "drop.json", R"({"settings": [{"threshold": "squared", "max_drop": 0.1}]})");
  expect_refused_after(
      {"bench", model},
      {{{"--motion", "crawl"}, "--motion crawl: expected one of still, calm"},
       {{"--motion", "walk", "--rule", "squared,first"}, "'first' is not one of one"},
       {{"--motion", "walk", "--rule", "exact,one"}, "is exact, and has no tolerance"},
       {{"--motion", "walk", "--cameras", alone}, "two cameras or more"},
       {{"--path", alone}, "two cameras or more"},
       {{"--path", alone, "--motion", "walk"}, "each is measured by itself"},
       {{"--motion", "walk", "--suite", folder / "foveated.json"},
        "foveated pictures are measured only with"},
       {{"--suite", folder / "pair.json"}, "find tolerances in single views"},
       {{"--suite", folder / "drop.json"}, "'max_drop' needs photos: name them with --photos"},
       {{"--size", "big"}, "--size big: expected own, WxH"},
       {{"--tour", "crawl"}, "--tour crawl"},
       {{"--view", "no-such"}, "--view no-such"}});
  fs::remove(folder / "cameras.json");
  expect_refused_after({"bench", model}, {{{"--motion", "walk"}, "--cameras"}});
}

}  // namespace
}  // namespace binosplat
