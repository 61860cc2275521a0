// binosplat bench along frames, turns of the head and levels of detail, and by the paper's protocol, as a
// user runs it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/scene.h"
#include "support/fixtures.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

using nlohmann::json;
using test::ended;
using test::good;
using test::Outcome;
using test::run_program;
using Words = std::vector<std::string>;

struct BenchAlong : test::SceneTest {
  std::string printed, said;

  BenchAlong() { add_cameras(); }

  /// Writes axes, and measures by them; its results.
  json bench(const std::string& axes, Words more, const Words& scenes = {}) {
    test::write_text(folder / "axes.json", axes);
    std::filesystem::remove_all(out);
    more.insert(more.begin(), {"bench", "--axes", folder / "axes.json", "-o", out});
    if (scenes.empty()) more.push_back(model);
    more.insert(more.end(), scenes.begin(), scenes.end());
    const Outcome outcome = run_program(more);
    EXPECT_TRUE(good(outcome));
    printed = outcome.out;
    said = outcome.err;
    return test::load_json(out + "/results.json").at("points");
  }
  /// A path of cameras in a file.
  std::string path_of(int frames, double step, double seconds = 0.0) const {
    json path;
    for (int n = 0; n < frames; ++n) {
      path.push_back(test::camera_json(fmt::format("frame_{}", n), step * n));
      if (seconds > 0.0) path.back()["time"] = seconds * n;
    }
    test::write_text(folder / "path.json", path.dump());
    return folder / "path.json";
  }
  static std::size_t details_of(const json& point, const std::string& part) {
    return static_cast<std::size_t>(std::ranges::count_if(
        point.at("details"), [&](const json& row) { return row.value("part", "") == part; }));
  }
};

TEST_F(BenchAlong, MotionsGoThroughTheCameras) {
  const json points = bench(R"({"frames": 3, "repeats": 2, "eyes": [2], "sizes": ["36x24"],
      "settings": [{}, {"th": ["squared", "peripheral"], "transmittance": ["one", "last"], "quality": 38}]})",
                            {"--motion", "still,walk", "--rule", "squared,one", "--rule", "peripheral,last"});
  ASSERT_EQ(points.size(), 2u * 3) << "exact, and the two rules";
  EXPECT_EQ(points[0].at("along"), "still");
  EXPECT_EQ(points[3].at("along"), "walk");
  EXPECT_EQ(points[5].at("name"), "peripheral, last, asked for 38 dB");
  EXPECT_EQ(details_of(points[0], "moving"), 3u * 3);
  EXPECT_EQ(details_of(points[0], "stop"), 0u);
  EXPECT_EQ(details_of(points[4], "moving"), 3u * 3);
  EXPECT_EQ(details_of(points[4], "stop"), 3u * 15);
  EXPECT_TRUE(points[4].contains("reported_minus_true_db"));
  EXPECT_TRUE(points[4].contains("speed")) << "times exact";
  EXPECT_NE(printed.find("model, both eyes, size 36x24, along walk"), std::string::npos) << printed;
  EXPECT_NE(test::read_text(out + "/report.html").find("true and reported"), std::string::npos);
  const std::string details = test::read_text(out + "/details.csv");
  EXPECT_NE(details.find("\"model\",2,\"36x24\",\"walk\","), std::string::npos) << details.substr(0, 400);
}

TEST_F(BenchAlong, PathsAreFramesOrKeys) {
  const std::string axes = R"({"repeats": 1, "eyes": [2], "sizes": ["24x16"], "settings": [{}]})";
  json points = bench(axes, {"--path", path_of(4, 0.01), "--mono"});
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].at("eyes"), 1);
  EXPECT_EQ(points[0].at("along"), "path");
  EXPECT_EQ(details_of(points[0], "moving"), 4u);
  points = bench(axes, {"--path", path_of(3, 0.1, 0.2)});
  EXPECT_EQ(details_of(points[0], "moving"), 37u) << "90 a second";
  points = bench(axes, {"--tour", "6,200"});
  EXPECT_EQ(points[0].at("along"), "tour");
  EXPECT_GT(details_of(points[0], "moving"), 3u);
}

TEST(BenchPath, CamerasEnterTheModelsFrame) {
  REQUIRE_FIXTURES(fixtures);
  const test::TempFolder folder;
  json path;
  for (int n = 0; n < 2; ++n) {
    path.push_back(test::camera_json(fmt::format("frame_{}", n), 0.0));
    path.back()["position"] = {2.0 + 0.01 * n, 3.0, -10.0};
  }
  test::write_text(folder / "path.json", path.dump());
  test::write_text(folder / "axes.json", R"({"repeats": 1, "settings": [{}]})");
  const auto pairs_in = [&](const std::string& model) -> double {
    const std::string to = folder / std::filesystem::path(model).stem().string();
    EXPECT_TRUE(good(run_program({"bench", fixtures / model, "--axes", folder / "axes.json", "--path",
                                  folder / "path.json", "--cameras", folder / "path.json", "-o", to})));
    return test::load_json(to + "/results.json").at("points")[0].at("pairs");
  };
  const double ply = pairs_in("ply/inria-train-1000.ply"), gltf = pairs_in("gltf/st-train-sh3.glb");
  EXPECT_GT(ply, 100.0);
  EXPECT_NEAR(gltf, ply, 0.01 * ply) << "x left, y up";
}

TEST_F(BenchAlong, ATurnedHeadIsMeasuredAgainstPhotosToo) {
  const std::string photos = folder / "photos";
  ASSERT_TRUE(good(run_program({"render", model, "--mono", "--view", "all", "--order", "distance",
                                "--projection", "tangent", "-o", photos})));
  const json points = bench(R"({"views": 4, "frames": 1, "repeats": 1, "along": ["turn", "sideways", "views"],
      "settings": [{"order": ["depth", "distance"], "projection": ["affine", "tangent"]}]})",
                            {"--view", "front", "--photos", photos});
  ASSERT_EQ(points.size(), 3u * 4);
  EXPECT_EQ(points[0].at("details").size(), 15u);
  EXPECT_LT(points[0].at("psnr_db").get<double>(), 100.0);
  EXPECT_TRUE(points[4].contains("popping_7_db"));
  EXPECT_LT(points[8].at("photo_psnr_db").get<double>(), 70.0);
  EXPECT_FALSE(points[11].contains("photo_psnr_db")) << "equal: the photos are of these";
}

TEST_F(BenchAlong, MetresAreThoseOfTheOption) {
  test::save_ply(model, test::floor_model());
  std::filesystem::remove(folder / "cameras.json");
  bench(R"({"along": "turn", "settings": [{}], "sizes": ["36x24"]})", {"--units-per-metre", "0.5"});
  EXPECT_NE(said.find("from 0.8 units above the ground"), std::string::npos) << said;
}

constexpr const char* small_paper = R"({"views": 24, "training": 16, "frames": 1, "repeats": 1,
    "sizes": ["SIZE"], "contributions": true, "settings": [{"tiles": ["aabb", "ellipse"]},
    {"th": "peripheral", "transmittance": "depth", "far": [100, null], "found_on": ["test", "training"],
     "max_drop": [0.1, 0.2]},
    {"th": "peripheral", "transmittance": "depth", "far": [100, null], "found_on": ["test", "training"],
     "min_psnr": [40, 34]}]})";

std::string sized_paper(const std::string& size) {
  std::string text = small_paper;
  return text.replace(text.find("SIZE"), 4, size);
}

TEST_F(BenchAlong, ThePapersTablesAreMadeOfTestViews) {
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
  EXPECT_NE(said.find("1 views for tests; 2 others for training"), std::string::npos) << said;
  const std::string page = test::read_text(out + "/report.html");
  for (const char* title :
       {"pairs removed (table IV)", "speed at equal error (figure 8)", "(figures 4a, 5a, 5b)"})
    EXPECT_NE(page.find(title), std::string::npos) << title;
}

// Two scenes at once, and the choice of views: cameras as INRIA's trainer lists them, those for tests first.
TEST_F(BenchAlong, ScenesAreJoinedAndTestsAreHeldOut) {
  json cameras;
  for (const char* name : {"b", "h", "a", "c", "d", "e", "f", "g", "i", "j"})
    cameras.push_back(test::camera_json(name, 0.05 * static_cast<double>(cameras.size())));
  test::write_text(folder / "cameras.json", cameras.dump());
  const std::string other = folder / "other.ply";
  std::filesystem::copy_file(model, other);
  const json points = bench(sized_paper("18x12"), {"--cameras", folder / "cameras.json"}, {model, other});
  EXPECT_EQ(points.back().at("scene"), "mean of 2 scenes");
  EXPECT_NE(said.find("2 views for tests: the 2 that"), std::string::npos) << said;
  EXPECT_NE(said.find("; 8 others for training"), std::string::npos) << said;
  const auto& views = points[0].at("details");
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].at("view"), "b");
  EXPECT_EQ(views[1].at("view"), "h");
}

TEST_F(BenchAlong, DropsNeedPhotosOfTheirViews) {
  std::filesystem::create_directory(folder / "photos");
  EXPECT_TRUE(
      ended(run_program({"bench", model, "--axes", "paper", "--photos", folder / "photos", "-o", out}), 2,
            "there is no photo of any view"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

struct BenchLevelsCommand : test::SceneTest {
  /// A folder of levels, with cameras in it.
  std::string make_levels(const std::string& name, bool cameras = true) {
    std::string made = folder / name;
    EXPECT_TRUE(good(run_program({"levels", model, "-o", made, "--leaf", "64", "--levels", "4"})));
    if (cameras) {
      add_row_of_cameras(3);
      std::filesystem::rename(folder / "cameras.json", folder / (name + "/cameras.json"));
    }
    return made;
  }

  Outcome bench(const Words& scenes, const Words& more = {}) const {
    Words all = {"bench"};
    all.insert(all.end(), scenes.begin(), scenes.end());
    all.insert(all.end(), {"--frames", "1", "--ipd", "0.1", "-o", out});
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  }
};

TEST_F(BenchLevelsCommand, TellWhatRenderTells) {
  test::save_ply(model, test::random_model(4, 1500, 0));
  const std::string made = make_levels("made");
  const Outcome outcome = bench({made}, {"--detail", "25dB,35dB"});
  ASSERT_TRUE(good(outcome));
  const json points = test::load_json(out + "/results.json").at("points");
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0].at("gaussians"), 1500.0) << "the finest";
  EXPECT_EQ(points[2].at("detail"), "35dB");
  EXPECT_NE(outcome.out.find("ellipse, levels for 35dB"), std::string::npos) << outcome.out;
  EXPECT_NE(test::read_text(out + "/report.html").find("what levels of detail lose"), std::string::npos);

  ASSERT_TRUE(good(run_program({"render", made, "--view", "all", "--detail", "35dB", "--detail-report",
                                "--ipd", "0.1", "-o", folder / "r", "--json", folder / "r.json"})));
  const auto rendered = test::load_json(folder / "r.json").at("views");
  const auto views = points[2]["details"], coarser = points[1]["details"];
  ASSERT_EQ(views.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& levels = rendered[k]["levels_of_detail"];
    EXPECT_EQ(views[k]["view"], rendered[k]["name"]);
    EXPECT_EQ(views[k]["gaussians"], levels["gaussians"]);
    EXPECT_EQ(views[k]["reported_db"], levels["predicted_psnr_db"]);
    const double psnr = levels["finest_psnr_db"];
    EXPECT_NEAR(views[k]["psnr_db"].get<double>(), psnr, 0.1) << "of both eyes: by squared errors there";
    // Planted: other levels are not the same.
    EXPECT_GT(std::abs(coarser[k]["psnr_db"].get<double>() - psnr), 1.0);
    EXPECT_GT(coarser[k]["flip"], views[k]["flip"]);
    EXPECT_LT(coarser[k]["disagreement_db"], views[k]["disagreement_db"]);
  }
}

TEST_F(BenchLevelsCommand, OfSeveralScenesTellHowTimesGrow) {
  const std::string small = make_levels("small");
  test::save_ply(model, test::random_model(2, 900, 1));
  const std::string large = make_levels("large", false);
  const Outcome outcome = bench({small, large}, {"--detail", "2", "--cameras", small + "/cameras.json",
                                                 "--view", "view2", "--mono", "--size", "36x24"});
  ASSERT_TRUE(good(outcome));
  const auto points = test::load_json(out + "/results.json").at("points");
  EXPECT_EQ(points[2]["gaussians"], 900.0);
  EXPECT_EQ(points[3]["details"][0]["view"], "view2");
  EXPECT_FALSE(points[3].contains("disagreement_db")) << "one eye";
  EXPECT_FALSE(points[3].contains("reported_db")) << "pixels predict nothing";
  EXPECT_NE(test::read_text(out + "/report.html").find("growth with the model"), std::string::npos);
}

TEST_F(BenchLevelsCommand, WhatIsWrongIsNamed) {
  const std::string made = make_levels("made", false);
  add_cameras();
  EXPECT_TRUE(ended(bench({model}, {"--detail", "30dB"}), 2, model + " is no folder with levels of detail"));
  EXPECT_TRUE(
      ended(bench({"demo:room"}, {"--axes", "levels"}), 2, "`binosplat levels MODEL -o DIR` makes one"));
  EXPECT_TRUE(ended(bench({made}, {"--detail", "30dB"}), 2, "no cameras beside " + made));
  const std::string cameras = folder / "cameras.json";
  for (const auto& [options, message] : std::vector<std::pair<Words, std::string>>{
           {{"--detail", "30dB", "--view", "no-such"}, "--view no-such"},
           {{"--detail", "30dB", "--view", "pair", "--mono"}, "pair_left"},
           {{"--detail", "40db,x"}, "--detail x: expected"},
           {{"--detail", "90dB"}, "--detail 90dB"}}) {
    Words all = {"--cameras", cameras};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_TRUE(ended(bench({made}, all), 2, message));
  }
  // Without what its levels lose.
  const std::string meta = made + "/lod-meta.json";
  auto without = test::load_json(meta);
  const std::function<void(json&)> forget = [&](json& node) {
    node.erase("pixels");
    if (node.contains("children")) {
      for (auto& child : node["children"]) forget(child);
    }
  };
  forget(without["tree"]);
  test::write_text(meta, without.dump());
  EXPECT_TRUE(ended(bench({made}, {"--cameras", cameras, "--detail", "30dB"}), 2,
                    "has no errors of its levels to go by"));
}

TEST_F(BenchAlong, WhatMakesNoSenseIsNamed) {
  test::write_text(folder / "alone.json", json({test::camera_json("alone", 0.0)}).dump());
  test::write_text(folder / "foveated.json", R"({"settings": [{"inset": 20}]})");
  test::write_text(folder / "pair.json", R"({"eyes": 2, "settings": [{"th": "squared", "min_psnr": 40}]})");
  test::write_text(folder / "drop.json", R"({"settings": [{"th": "squared", "max_drop": 0.1}]})");
  const std::vector<std::pair<Words, std::string>> wrong = {
      {{"--motion", "crawl"}, "--motion crawl: expected of still, sideways, calm"},
      {{"--motion", "walk", "--rule", "squared"}, "expected TH,SOURCE"},
      {{"--motion", "walk", "--rule", "squared,first"}, "'first' is not one of one"},
      {{"--motion", "walk", "--rule", "tau,one"}, "is exact, and always measured"},
      {{"--motion", "walk", "--cameras", folder / "alone.json"}, "two cameras or more"},
      {{"--path", folder / "alone.json"}, "two cameras or more"},
      {{"--path", folder / "alone.json", "--motion", "walk"}, "are measured one by one"},
      {{"--turn", "--motion", "walk"}, "are measured one by one"},
      {{"--motion", "walk", "--axes", folder / "foveated.json"},
       "foveated pictures are measured along views"},
      {{"--axes", folder / "pair.json"}, "find tolerances in single views"},
      {{"--axes", folder / "drop.json"}, "'max_drop' is lost against photos: name them with --photos"},
      {{"--size", "big"}, "--size big: expected own, WxH"},
      {{"--tour", "crawl"}, "--tour crawl"},
      {{"--turn", "--view", "no-such"}, "--view no-such"}};
  for (const auto& [options, message] : wrong) {
    Words all = {"bench", model, "-o", out};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_TRUE(ended(run_program(all), 2, message));
  }
  std::filesystem::remove(folder / "cameras.json");
  EXPECT_TRUE(ended(run_program({"bench", model, "--motion", "walk", "-o", out}), 2, "--cameras"));
}

}  // namespace
}  // namespace binosplat
