// binosplat bench: its measurements, comparisons and resuming.

#include "app/scene.h"

namespace binosplat {
namespace {

struct BenchTest : SceneTest {
  const std::string suite = folder / "suite.json";

  BenchTest() {
    add_cameras();
    write_suite(R"(["36x24"])");
  }
  /// Writes a suite of four settings, for one eye and for two.
  void write_suite(const std::string& sizes) const {
    write_text(
        suite,
        R"({"views": 2, "frames": 2, "repeats": 2, "eyes": [1, 2], "settings": [{"tiles": ["aabb", "ellipse"]},
      {"threshold": "squared", "transmittance": "last", "tolerance": [0.05, 2]}], "sizes": )" +
            sizes + "}");
  }
  static Outcome bench(const Words& words, const std::string& to) {
    return run_program(joined({"bench", "-o", to}, words));
  }
  Outcome measure(const std::string& to, const Words& more = {}) const {
    return bench(joined({model, "--suite", suite}, more), to);
  }
  static json results(const std::string& of) { return load_json(of + "/results.json"); }
};

TEST_F(BenchTest, MeasuresEveryPoint) {
  write_suite(R"(["own", "36x24"])");
  const Outcome outcome = checked(measure(out));
  const json found = results(out);
  ASSERT_EQ(found["points"].size(), 16);
  for (const json& point : found["points"]) {
    EXPECT_GT(point["frame_ms"].get<double>(), 0.0);
    EXPECT_GE(point["p99_ms"], point["frame_ms"]);
    EXPECT_EQ(point["frames"], 8);
    EXPECT_EQ(point["details"].size(), 2);
    EXPECT_GT(point["pairs"].get<double>(), 0.0);
    if (point["name"] == "exact") {
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

TEST_F(BenchTest, ResumesUnfinishedRun) {
  Program run({"bench", model, "--suite", suite, "-o", out});
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

TEST_F(BenchTest, TriesRuleFromShaderFolder) {
  write_text(suite, R"({"views": 1, "frames": 1, "repeats": 1,
      "settings": [{"threshold": "squared", "tolerance": 0.05}], "sizes": ["36x24"]})");
  const auto shaders = folder / "shaders";
  const std::string rule = shaders / "threshold/squared.glsl";
  fs::copy(fs::path(BINOSPLAT_SOURCE_DIR) / "shaders", shaders, fs::copy_options::recursive);
  const std::string text = read_text(rule), sought = "sqrt(tolerance / covered)";
  ASSERT_NE(text.find(sought), std::string::npos);
  const auto multiply = [&](const std::string& by) {
    write_text(rule, std::string(text).replace(text.find(sought), sought.size(), by + " * " + sought));
  };
  ASSERT_TRUE(good(measure(out)));
  ASSERT_TRUE(good(measure(folder / "same", {"--shader-dir", shaders})));
  multiply("2.0");
  const Outcome changed = measure(folder / "changed", {"--shader-dir", shaders});
  ASSERT_TRUE(good(changed)) << changed.out;
  EXPECT_TRUE(has(changed.out, "SSIM vs exact"));
  const json before = results(out)["points"], same = results(folder / "same")["points"],
             now = results(folder / "changed")["points"];
  ASSERT_EQ(before.size(), 2u);
  EXPECT_EQ(before[0]["name"], "exact") << "the suite has no exact setting";
  EXPECT_EQ(now[0]["psnr_db"], 100.0);
  EXPECT_EQ(now[0]["pairs"], before[0]["pairs"]);
  EXPECT_EQ(same[1]["pairs"], before[1]["pairs"]);
  EXPECT_LT(now[1]["pairs"], before[1]["pairs"]);
  EXPECT_LT(now[1]["psnr_db"], before[1]["psnr_db"]);
  multiply("3.0");
  EXPECT_TRUE(ended(measure(folder / "changed", {"--shader-dir", shaders}), 2, "squared.glsl"));
  // Injected: a fault in exact stages.
  const std::string limits = read_text(shaders / "shared/limits.h");
  write_text(shaders / "shared/limits.h", limits + "#undef KERNEL_PX2\n#define KERNEL_PX2 3.0\n");
  const Outcome faulty = measure(folder / "faulty", {"--shader-dir", shaders});
  EXPECT_EQ(faulty.code, 1);
  EXPECT_TRUE(has(faulty.out, "px differ from the float64 reference"));
}

// Injected: with other numbers of pairs, a comparison with itself finds a change at each point.
TEST_F(BenchTest, ComparesWithEarlierRun) {
  ASSERT_TRUE(good(measure(out)));
  ASSERT_TRUE(good(measure(out, {"--compare", out + "/results.json"})));
  json old = results(out);
  for (json& point : old["points"]) point["pairs"] = 1.0;
  const Outcome compared = measure(out, {"--compare", save("old.json", old)});
  EXPECT_TRUE(has(compared.out, "8 numbers of 8 points in both runs changed beyond noise"));
}

TEST_F(BenchTest, FailsWhenSlower) {
  ASSERT_TRUE(good(measure(out)));
  json old = results(out);
  const auto compared = [&](const std::string& percent) {
    return measure(out, {"--compare", save("old.json", old), "--fail-if-slower", percent});
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
  EXPECT_TRUE(ended(measure(out, {"--fail-if-slower", "3"}), 2, "--fail-if-slower needs --compare"));
}

TEST_F(BenchTest, MeasuresCalibratedPoints) {
  const std::string calibration = folder / "c.json";
  ASSERT_TRUE(good(run_program({"calibrate", model, "-o", calibration, "--quality", "38", "--view", "front",
                                "--rule", "adagscale", "--rule", "squared"})));
  write_text(suite, R"({"views": 1, "frames": 1, "repeats": 1, "settings": [{}]})");
  const Outcome outcome = measure(out, {"--calibration", calibration, "--view", "front"});
  ASSERT_TRUE(good(outcome)) << outcome.out;
  const json points = results(out)["points"];
  ASSERT_EQ(points.size(), 3) << "exact, and two that were calibrated";
  const json entries = load_json(calibration)["entries"];
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(points[i + 1]["threshold"], entries[i]["threshold"]);
    EXPECT_NEAR(points[i + 1]["tolerance"].get<double>(), entries[i]["tolerance"].get<double>(), 1e-5);
    EXPECT_NEAR(points[i + 1]["psnr_db"].get<double>(), entries[i]["reached_db"].get<double>(), 0.3)
        << entries[i];
  }
}

TEST_F(BenchTest, ResumeRequiresSameOptionsAndInputs) {
  ASSERT_TRUE(good(measure(out)));
  EXPECT_TRUE(ended(measure(out, {"--ppd", "60"}), 2, "bench-run.json differs in options."));
  for (const std::string& input : {model, suite, std::string(folder / "cameras.json")}) {
    const auto time = fs::last_write_time(input);
    fs::last_write_time(input, time + std::chrono::seconds(1));
    EXPECT_TRUE(ended(measure(out), 2, "bench-run.json differs in " + input + "."));
    fs::last_write_time(input, time);
  }
  EXPECT_TRUE(ended(measure(out), 0, "0 points to measure; 8 are in"));
}

// The lock of a process that was killed is no obstacle.
TEST_F(BenchTest, RejectsLockedFolder) {
  const std::string lock = out + "/bench-run.json.lock";
  Program first({"bench", model, "--suite", suite, "-o", out});
  wait_until([&] { return !read_text(lock).empty(); });
  first.send(SIGSTOP);
  EXPECT_TRUE(ended(measure(out), 2, out + ": process " + read_text(lock) + " is writing there: wait until"));
  first.send(SIGKILL);
  first.wait();
  EXPECT_TRUE(fs::exists(lock));
  EXPECT_TRUE(good(measure(out)));
  EXPECT_FALSE(fs::exists(lock));
}

TEST_F(BenchTest, ErrorsSuggestFix) {
  const std::string whole = folder / "whole", text = folder / "text.json", list = folder / "list.json",
                    other = folder / "other.json";
  ASSERT_TRUE(good(measure(whole)));
  write_text(other, R"({"settings": [{}], "views": 1, "frames": 1, "repeats": 1})");
  write_text(list, "[1, 2]");
  write_text(text, "{\"points\"");
  expect_refused_after({"bench"},
                       {{{model, "--suite", other, "-o", whole}, "has points of another run"},
                        {{model, "--suite", folder / "none.json"}, "none.json"},
                        {{model, "--suite", list}, "list.json: expected an object"},
                        {{model, model, "--suite", suite}, "two scenes are called model"},
                        {{model, "demo:room", "--photos", folder.path()}, "belong to one scene"},
                        {{}, "SCENE is required"},
                        {{model, "--compare", text}, "text.json: not JSON"},
                        {{model, "--compare", list}, "not the results.json of a"},
                        {{folder / "missing.ply", "--suite", suite}, "missing.ply"},
                        {{model, "--suite", suite, "-o", model}, "is a file where a folder is needed"}});
}

}  // namespace
}  // namespace binosplat
