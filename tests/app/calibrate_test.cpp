// binosplat calibrate, and render with what it found.

#include <chrono>
#include <csignal>
#include <thread>

#include "app/scene.h"
#include "formats/image_file.h"
#include "measure/metrics.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

using nlohmann::ordered_json;
using test::ended;
using test::good;
using test::Outcome;
using test::read_text;
using test::write_text;

struct CalibrateTest : test::SceneTest {
  const std::string file = folder / "calib.json";

  CalibrateTest() { add_cameras(); }
  Outcome calibrate(std::vector<std::string> more) const {
    more.insert(more.begin(), {"calibrate", model, "-o", file});
    return test::run_program(more);
  }
  ordered_json report() const { return ordered_json::parse(read_text(folder / "r.json")); }
};

TEST_F(CalibrateTest, ViewsThatSeeNothingHaveNoSay) {
  ordered_json cameras = ordered_json::parse(read_text(folder / "cameras.json"));
  const auto turn = [&](std::size_t k) {
    cameras[k]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    write_text(folder / "cameras.json", cameras.dump());
  };
  turn(1);
  const Outcome outcome = calibrate({"--quality", "38", "--size", "36x24"});
  ASSERT_TRUE(ended(outcome, 0, "1 of 3 views see nothing of the model and are left out (side)"));
  const ordered_json found = ordered_json::parse(read_text(file));
  EXPECT_EQ(found["views"].size(), 2);
  for (const auto& entry : found["entries"]) EXPECT_LT(entry["tolerance"], 1e3) << entry;
  std::filesystem::remove(file);
  for (const std::size_t k : {0u, 2u, 3u}) turn(k);
  EXPECT_TRUE(ended(calibrate({"--quality", "38"}), 2,
                    "calibrate: none of its views sees anything of the model, so that all would look equal: "
                    "view side looks away from the model"));
  EXPECT_FALSE(std::filesystem::exists(file));
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"bench", model, "--axes", "quick", "-o", folder / "chart"},
           {"bench", model, "--axes", "paper", "--size", "36x24", "-o", folder / "page"},
           {"bench", model, "--motion", "walk", "--size", "36x24", "-o", folder / "walk"},
       })
    EXPECT_TRUE(ended(test::run_program(words), 2, "sees anything of the model")) << words[0];
  // The file is what convert is for.
  const Outcome converted = test::run_program({"convert", model, "--report", "2", "-o", folder / "m.ply"});
  EXPECT_TRUE(ended(converted, 0, "2 of 2 views see nothing of the model and are left out"));
  EXPECT_EQ(converted.out.find("equal"), std::string::npos) << converted.out;
}

TEST_F(CalibrateTest, GoesOnWhereItWasEnded) {
  const std::vector<std::string> words = {"--quality", "38",          "--size", "36x24",
                                          "--rule",    "squared,one", "--rule", "squared,last"};
  const auto result = [&] {
    ordered_json json = ordered_json::parse(read_text(file));
    json["depth_table"].erase("seconds");
    for (ordered_json& entry : json["entries"]) entry.erase("seconds");
    return json;
  };
  const auto before = folder.files();
  ASSERT_TRUE(good(calibrate(words)));
  const ordered_json whole = result();
  EXPECT_EQ(whole["entries"].size(), 2);
  std::filesystem::remove(file);
  std::vector<std::string> all = {"calibrate", model, "-o", file};
  all.insert(all.end(), words.begin(), words.end());
  test::Program program(all);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  const auto kept = [&] {
    std::size_t count = 0;
    for (const std::string& name : folder.files()) count += name.find(".unfinished/") != std::string::npos;
    return count;
  };
  while (kept() < 2 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.send(SIGINT);
  ASSERT_EQ(program.wait().code, -SIGINT);
  EXPECT_FALSE(std::filesystem::exists(file));
  const auto there = folder.files();
  ASSERT_GT(there.size(), before.size());
  const std::string step = *std::ranges::find_if(
      there, [](const std::string& name) { return name.find(".unfinished/") != std::string::npos; });
  const auto written = std::filesystem::last_write_time(folder / step);
  // Other options go on from none of it, and leave it.
  ASSERT_TRUE(good(test::run_program({"calibrate", model, "-o", folder / "other.json", "--quality", "38",
                                      "--size", "36x24", "--rule", "squared,one"})));
  EXPECT_EQ(std::filesystem::last_write_time(folder / step), written);
  std::filesystem::remove(folder / "other.json");
  ASSERT_TRUE(good(calibrate(words)));
  EXPECT_EQ(result(), whole);
  std::filesystem::remove(file);
  EXPECT_EQ(folder.files(), before) << "what was kept is gone";
}

TEST_F(CalibrateTest, RenderGoesByIt) {
  const Outcome outcome = calibrate({"--quality", "38", "--views", "2"});
  ASSERT_TRUE(good(outcome));
  EXPECT_NE(outcome.out.find("target: 38 dB against the exact pictures"), std::string::npos) << outcome.out;
  const ordered_json found = ordered_json::parse(read_text(file));
  EXPECT_EQ(found["views"].size(), 2);
  EXPECT_EQ(found["entries"].size(), 6);
  ASSERT_TRUE(good(render({"--mono", "--view", "front", "-o", folder / "exact.png", "--bits", "16"})));
  ASSERT_TRUE(good(render({"--mono", "--view", "front", "-o", folder / "lossy.png", "--bits", "16",
                           "--calibration", file, "--transmittance", "depth", "--json", folder / "r.json"})));
  EXPECT_NEAR(report()["views"][0]["tolerance"].get<double>(), found["entries"][4]["tolerance"].get<double>(),
              1e-6);
  EXPECT_EQ(report()["settings"]["th"], "squared");
  const double db = measure::psnr(load_image(folder / "exact.png"), load_image(folder / "lossy.png"));
  EXPECT_GT(db, 34.0);
  EXPECT_LT(db, 60.0) << "drawn exactly";

  // A camera far away: a warning, and the exact picture. Another model is refused.
  const Outcome far = render(
      {"--mono", "--eye", "0,0,-40", "--at", "0,0,0", "-o", folder / "far.png", "--calibration", file});
  ASSERT_TRUE(good(far));
  EXPECT_NE(far.err.find("is far from the calibrated views"), std::string::npos) << far.err;
  ordered_json other = found;
  other["model"]["hash"] = "0123456789abcdef";
  write_text(folder / "other.json", other.dump());
  EXPECT_TRUE(ended(render({"--mono", "--view", "front", "-o", folder / "again.png", "--calibration",
                            folder / "other.json", "--transmittance", "last"}),
                    2, "is of another model"));
  const Outcome small = render(
      {"--mono", "--view", "front", "--size", "36x24", "-o", folder / "small.png", "--calibration", file});
  ASSERT_TRUE(good(small));
  EXPECT_NE(small.err.find("the tolerance is scaled"), std::string::npos) << small.err;
}

// Of small models the tests above hold it, and what measured light is worth on fox those of the reference.
TEST(CalibrateFox, PrunedAndAtAQuarterOfItsSize) {
  if (!test::switched_on("BINOSPLAT_LONG")) GTEST_SKIP() << "a quarter of a minute: set BINOSPLAT_LONG=1";
  REQUIRE_SCENE("fox", fox);
  const test::TempFolder folder;
  const Outcome outcome = test::run_program({"calibrate", fox / "fox_pruned.ply", "--view", "0003", "--size",
                                             "129x236", "--quality", "40", "-o", folder / "fox.json"});
  ASSERT_TRUE(good(outcome));
  const ordered_json found = ordered_json::parse(read_text(folder / "fox.json"));
  ASSERT_EQ(found["entries"].size(), 6);
  double paper = 0.0, ours = 0.0;  // pairs removed at 40 dB
  for (const ordered_json& entry : found["entries"]) {
    EXPECT_GE(entry["reached_db"].get<double>(), 40.0) << entry;
    EXPECT_LT(entry["reached_db"].get<double>(), 40.6) << entry;
    if (entry["th"] == "peripheral" && entry["transmittance"] == "one") paper = entry["pairs_removed"];
    if (entry["th"] == "squared" && entry["transmittance"] == "last") ours = entry["pairs_removed"];
  }
  EXPECT_GT(paper, 0.1);
  EXPECT_GT(ours, paper + 0.1)
      << "docs/method.md 8: squared with measured light removes far more at equal error";
}

TEST_F(CalibrateTest, DropsAreAgainstPhotos) {
  // Photos of another background are what a model comes near; of its own they are the exact pictures
  // themselves, of which nothing is lost only where they stay equal: that takes every search to its end.
  std::vector<const char*> backgrounds = {"0.1,0.1,0.1"};
  if (test::switched_on("BINOSPLAT_LONG")) backgrounds.push_back("0,0,0");
  for (const char* background : backgrounds) {
    for (const char* view : {"front", "side"})
      ASSERT_TRUE(good(render({"--mono", "--view", view, "--background", background, "-o",
                               folder / "photos" / (std::string(view) + ".png")})));
    ASSERT_TRUE(good(calibrate({"--photos", folder / "photos", "--max-drop", "0.5"})));
    const ordered_json found = ordered_json::parse(read_text(file));
    EXPECT_EQ(found["views"].size(), 1) << "the pair has no photos, and front is for tests";
    EXPECT_EQ(found["target"]["drop_db"], 0.5);
    for (const ordered_json& entry : found["entries"]) {
      EXPECT_LE(entry["reached_db"].get<double>(), 0.5);
      if (background == backgrounds[0]) {
        EXPECT_GT(entry["reached_db"].get<double>(), 0.3) << entry;
      }
    }
  }
}

// Tests are every Nth view by the order of names, whatever the file's order is: no tolerance may see them.
TEST_F(CalibrateTest, ViewsForTestsHaveNoSay) {
  nlohmann::json cameras;
  for (const char* name : {"c", "b", "a", "e", "d", "i", "h", "g", "f"})
    cameras.push_back(test::camera_json(name, 0.02 * static_cast<double>(cameras.size())));
  write_text(folder / "cameras.json", cameras.dump());
  const auto taken = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--quality", "30", "--size", "18x12"});
    const Outcome outcome = calibrate(more);
    EXPECT_TRUE(good(outcome));
    EXPECT_NE(outcome.err.find("training views; for tests are"), std::string::npos) << outcome.err;
    std::string names;
    const ordered_json found = ordered_json::parse(read_text(file));
    for (const ordered_json& view : found["views"]) names += view["name"].get<std::string>();
    return names;
  };
  EXPECT_EQ(taken({}), "cbedhgf") << "a and i are for tests";
  EXPECT_EQ(taken({"--hold-out", "3"}), "cbeihf") << "a, d and g are for tests";
}

TEST_F(CalibrateTest, GoesWithItsOrderAndProjection) {
  ASSERT_TRUE(good(calibrate({"--quality", "38", "--view", "front", "--order", "distance", "--projection",
                              "tangent", "--size", "36x24"})));
  EXPECT_EQ(ordered_json::parse(read_text(file))["projection"], "tangent");
  const std::vector<std::string> by = {"--mono",         "--view",        "front", "--size", "36x24",    "-o",
                                       folder / "p.png", "--calibration", file,    "--th",   "adagscale"};
  EXPECT_TRUE(ended(render(by), 2,
                    "is for order distance and projection tangent, and this is drawn with order depth and "
                    "projection affine"));
  std::vector<std::string> same = by;
  same.insert(same.end(), {"--order", "distance", "--projection", "tangent", "--json", folder / "r.json"});
  ASSERT_TRUE(good(render(same)));
  EXPECT_EQ(report()["settings"]["th"], "peripheral");
  EXPECT_EQ(report()["settings"]["transmittance"], "depth");
  // Its table goes with a tolerance of the user's, too.
  same.insert(same.end(), {"--tolerance", "0.5"});
  ASSERT_TRUE(good(render(same)));
  EXPECT_EQ(report()["views"][0]["tolerance"], 0.5);
  same.insert(same.end(), {"--transmittance", "last"});
  EXPECT_TRUE(ended(render(same), 2, "--th adagscale goes by its table by depth"));
}

TEST_F(CalibrateTest, ErrorsSayWhatToDo) {
  ASSERT_TRUE(good(calibrate({"--quality", "30", "--view", "front"})));
  const std::string none = folder / "none.json";
  EXPECT_TRUE(ended(calibrate({}), 2, "calibrate needs a target"));
  EXPECT_TRUE(ended(calibrate({"--quality", "40", "--max-drop", "1"}), 2, "calibrate needs a target"));
  EXPECT_TRUE(ended(calibrate({"--max-drop", "1"}), 2, "--max-drop and --photos go together"));
  EXPECT_TRUE(
      ended(calibrate({"--max-drop", "1", "--photos", folder.path()}), 2, "there is no photo of any view"));
  EXPECT_TRUE(ended(calibrate({"--quality", "40", "--view", "nowhere"}), 2, "nowhere"));
  EXPECT_TRUE(ended(calibrate({"--quality", "0"}), 2, "--help"));
  EXPECT_TRUE(ended(calibrate({"--quality", "40", "--size", "big"}), 2, "--size big: expected pixels"));
  EXPECT_TRUE(ended(render({"-o", out, "--calibration", none}), 2, "none.json"));
  EXPECT_TRUE(ended(render({"-o", out, "--calibration", model}), 2, "not valid JSON"));
  EXPECT_TRUE(
      ended(render({"-o", out, "--calibration", file, "--tolerance", "1"}), 2, "leave one of them out"));
  EXPECT_TRUE(
      ended(render({"-o", out, "--calibration", file, "--th", "tau"}), 2, "has no effect with --th tau"));
  ordered_json cut = ordered_json::parse(read_text(file));
  cut["entries"].clear();
  write_text(none, cut.dump());
  EXPECT_TRUE(ended(render({"-o", out, "--calibration", none}), 2,
                    "has no entry for threshold squared with transmittance one"));
}

}  // namespace
}  // namespace binosplat
