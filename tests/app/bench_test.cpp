// binosplat bench: its measurements, resuming, and joining shards to the same table.

#include "app/scene.h"

namespace binosplat {
namespace {

struct BenchTest : SceneTest {
  const std::string axes = folder / "axes.json";

  BenchTest() {
    add_cameras();
    write_axes(R"(["36x24"])");
  }
  /// Writes axes of four settings, for one eye and for two.
  void write_axes(const std::string& sizes) const {
    write_text(
        axes,
        R"({"views": 2, "frames": 2, "repeats": 2, "eyes": [1, 2], "settings": [{"tiles": ["aabb", "ellipse"]},
      {"th": "squared", "transmittance": "last", "tolerance": [0.05, 2]}], "sizes": )" +
            sizes + "}");
  }
  static Outcome bench(const Words& words, const std::string& to) {
    return run_program(joined({"bench", "-o", to}, words));
  }
  Outcome measure(const std::string& to, const Words& more = {}) const {
    return bench(joined({model, "--suite", axes}, more), to);
  }
  static json results(const std::string& of) { return load_json(of + "/results.json"); }
};

/// Removes times and values derived from them, which differ between runs.
json without_times(json results) {
  for (json& point : results["points"]) {
    for (const char* key :
         {"frame_ms", "p99_ms", "most_ms", "noise_ms", "repeats_ms", "settled", "submit_ms",
          "stage_project_ms", "stage_bin_ms", "stage_sort_ms", "stage_blend_ms", "pareto", "speed"}) {
      EXPECT_TRUE(point.contains(key)) << key;
      point.erase(key);
    }
    for (const char* key : {"cpu_ms", "cpu_repeats_ms", "waited"})
      EXPECT_EQ(point.erase(key), is_software(point["device"]) ? 1u : 0u) << key;
    // How many frames go before, and so what the last one has measured, depends on a GPU's times.
    if (!is_software(point["device"]) && point.value("transmittance", "") == "last")
      point = {{"name", point["name"]}};
  }
  return results;
}

TEST_F(BenchTest, MeasuresEveryPoint) {
  write_axes(R"(["own", "36x24"])");
  const Outcome outcome = well(measure(out));
  const json found = results(out);
  ASSERT_EQ(found["points"].size(), 16);
  for (const json& point : found["points"]) {
    EXPECT_GT(point["frame_ms"].get<double>(), 0.0);
    EXPECT_GE(point["p99_ms"], point["frame_ms"]);
    EXPECT_EQ(point["frames"], 8);
    EXPECT_EQ(point["details"].size(), 2);
    EXPECT_GT(point["pairs"].get<double>(), 0.0);
    if (point["name"] == "ellipse") {
      EXPECT_EQ(point["psnr_db"], 100.0);
      EXPECT_EQ(point["ssim"], 1.0);
      EXPECT_EQ(point["flip"], 0.0);
    }
    // 2 px of squared colour is a large tolerance for so small a picture: visible, with fewer pairs.
    if (point["name"] == "squared, last, 2") {
      EXPECT_LT(point["psnr_db"].get<double>(), 50.0);
      EXPECT_LT(point["pairs"], found["points"][1]["pairs"]);
      EXPECT_GT(point["flip"].get<double>(), 0.0);
    }
  }
  // One eye at the camera's size, one eye at the other size, then both eyes.
  EXPECT_EQ(found["points"][4]["size"], "36x24");
  EXPECT_LT(found["points"][5]["pairs"], found["points"][1]["pairs"]);
  EXPECT_EQ(found["points"][8]["eyes"], 2);
  EXPECT_TRUE(has(outcome.out, "model, both eyes, size 36x24"));
  EXPECT_TRUE(has(read_text(out + "/report.html"), "<!doctype html>"));
  EXPECT_TRUE(has(read_text(out + "/results.csv"), "\"squared, last, 2\""));
}

TEST_F(BenchTest, GoesOnWhereItWas) {
  Program run({"bench", model, "--suite", axes, "-o", out});
  wait_for_file(out + "/points/00002.json");
  run.send(SIGINT);
  EXPECT_EQ(run.wait().code, -SIGINT);
  EXPECT_FALSE(fs::exists(out + "/results.json"));
  const std::string finished = read_text(out + "/points/00001.json");
  std::size_t points = 0;
  for (const std::string& name : folder.files()) {
    points += name.find("points/") != std::string::npos && name.ends_with(".json");
    EXPECT_FALSE(has(name, ".part")) << "half a file is left";
  }
  ASSERT_LT(points, 8);
  const Outcome again = measure(out);
  ASSERT_TRUE(ended(again, 0, fmt::format("{} points to measure; {} are in", 8 - points, points)));
  EXPECT_EQ(read_text(out + "/points/00001.json"), finished) << "measured again";
  EXPECT_EQ(results(out)["points"].size(), 8);
  EXPECT_TRUE(ended(measure(out), 0, "0 points to measure; 8 are in"));
}

TEST_F(BenchTest, ShardsJoinToOneRun) {
  const std::string one = folder / "one", two = folder / "two", whole = folder / "whole";
  ASSERT_TRUE(good(measure(whole)));
  ASSERT_TRUE(good(measure(one, {"--shard", "1/2"})));
  ASSERT_TRUE(good(measure(two, {"--shard", "2/2"})));
  EXPECT_FALSE(results(one)["points"][1].contains("frame_ms"));
  EXPECT_TRUE(has(read_text(one + "/report.html"), "not measured yet"));
  ASSERT_TRUE(good(bench({"--merge", one, "--merge", two}, out)));
  EXPECT_EQ(without_times(results(out)), without_times(results(whole)));
  // One shard is not the complete table.
  ASSERT_TRUE(good(bench({"--merge", one}, folder / "half")));
  EXPECT_NE(results(folder / "half"), results(out));

  // A comparison with itself finds no change. With other numbers of pairs, it finds a change at each point.
  ASSERT_TRUE(good(bench({"--merge", out, "--compare", out + "/results.json"}, out)));
  json old = results(out);
  for (json& point : old["points"]) point["pairs"] = 1.0;
  const Outcome compared = bench({"--merge", out, "--compare", save("old.json", old)}, out);
  EXPECT_TRUE(has(compared.out, "8 numbers of 8 points in both runs changed beyond noise"));
}

TEST_F(BenchTest, FailsWhereItHasBecomeSlower) {
  ASSERT_TRUE(good(measure(out)));
  json old = results(out);
  const auto compared = [&](const std::string& percent) {
    return bench({"--merge", out, "--compare", save("old.json", old), "--fail-if-slower", percent}, out);
  };
  EXPECT_TRUE(good(compared("0"))) << "than itself";
  for (json& point : old["points"]) {
    for (const char* list : {"repeats_ms", "cpu_repeats_ms"}) {
      for (json& ms : point[list]) ms = ms.get<double>() / 1000.0;
    }
  }
  EXPECT_TRUE(ended(compared("50"), 1, "more than --fail-if-slower 50"));
  EXPECT_TRUE(good(compared("1e9")));
  const json whole = old;
  old["points"][0][is_software(old["points"][0]["device"]) ? "cpu_repeats_ms" : "repeats_ms"][0] = 0;
  EXPECT_TRUE(ended(compared("1e9"), 1, "could not be compared"));
  old = whole;
  for (json& point : old["points"]) point["scene"] = "another";
  EXPECT_TRUE(ended(compared("50"), 2, "no point of this run is in"));
  EXPECT_TRUE(ended(bench({"--merge", out, "--fail-if-slower", "3"}, out), 2,
                    "--fail-if-slower goes with --compare"));
}

TEST_F(BenchTest, MeasuresWhatWasCalibrated) {
  const std::string calibration = folder / "c.json";
  ASSERT_TRUE(
      good(run_program({"calibrate", model, "-o", calibration, "--quality", "38", "--view", "front"})));
  write_text(axes, R"({"views": 1, "frames": 1, "repeats": 1, "settings": [{}]})");
  const Outcome outcome = measure(out, {"--calibration", calibration, "--view", "front"});
  ASSERT_TRUE(good(outcome)) << outcome.out;
  const json points = results(out)["points"];
  ASSERT_EQ(points.size(), 7) << "exact, and six that were calibrated";
  const json entries = load_json(calibration)["entries"];
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(points[i + 1]["th"], entries[i]["th"]);
    EXPECT_NEAR(points[i + 1]["tolerance"].get<double>(), entries[i]["tolerance"].get<double>(), 1e-5);
    EXPECT_NEAR(points[i + 1]["psnr_db"].get<double>(), entries[i]["reached_db"].get<double>(), 0.3)
        << entries[i];
  }
}

TEST_F(BenchTest, GoesOnWithTheSameContentOnly) {
  const std::string bytes = read_text(model), cameras = read_text(folder / "cameras.json");
  ASSERT_TRUE(good(measure(out, {"--shard", "16/16"})));
  EXPECT_TRUE(good(measure(out, {"--shard", "7/8"})));
  std::string other = bytes;
  ++other[other.size() - 100];  // keeps the file's size
  write_text(model, other);
  EXPECT_TRUE(ended(measure(out, {"--shard", "6/8"}), 2, "has points of another run"));
  write_text(model, bytes);
  json moved = json::parse(cameras);
  moved[0]["position"][1] = 0.25;
  save("cameras.json", moved);  // with the same names
  EXPECT_TRUE(ended(measure(out, {"--shard", "6/8"}), 2, "has points of another run"));
  write_text(folder / "cameras.json", cameras);
  EXPECT_TRUE(good(measure(out, {"--shard", "6/8"})));
}

TEST_F(BenchTest, ErrorsSayWhatToDo) {
  const std::string whole = folder / "whole", text = folder / "text.json", list = folder / "list.json",
                    other = folder / "other.json";
  ASSERT_TRUE(good(measure(whole, {"--shard", "16/16"})));
  write_text(other, R"({"settings": [{}], "views": 1, "frames": 1, "repeats": 1})");
  write_text(list, "[1, 2]");
  write_text(text, "{\"points\"");
  expect_refused_after({"bench"},
                       {{{model, "--suite", other, "-o", whole}, "has points of another run"},
                        {{model, "--suite", folder / "none.json"}, "none.json"},
                        {{model, "--suite", list}, "list.json: expected an object"},
                        {{model, "--suite", axes, "--shard", "3/2"}, "--shard 3/2: expected I/N"},
                        {{model, model, "--suite", axes}, "two scenes are called model"},
                        {{model, "demo:room", "--photos", folder.path()}, "belong to one scene"},
                        {{}, "needs scenes to measure, or --merge"},
                        {{model, "--merge", whole}, "needs scenes to measure, or --merge"},
                        {{"--merge", folder.path()}, "plan.json"},
                        {{"--merge", whole, "--compare", text, "-o", whole}, "text.json: not JSON"},
                        {{"--merge", whole, "--compare", list, "-o", whole}, "not the results.json of a"},
                        {{folder / "missing.ply", "--suite", axes}, "missing.ply"},
                        {{model, "--suite", axes, "-o", model}, "is a file where a folder is needed"}});
}

}  // namespace
}  // namespace binosplat
