// binosplat calibrate, and render with its file.

#include "app/scene.h"
#include "support/scenes.h"

namespace binosplat {
namespace {

struct CalibrateTest : SceneTest {
  const std::string file = folder / "calib.json";

  CalibrateTest() { add_cameras(); }
  Words line(const Words& more) const { return joined({"calibrate", model, "-o", file}, more); }
  Outcome calibrate(const Words& more) const { return run_program(line(more)); }
  json report() const { return load_json(folder / "r.json"); }
};

TEST_F(CalibrateTest, SkipsEmptyViews) {
  json cameras = load_json(folder / "cameras.json");
  const auto turn = [&](std::size_t k) {
    cameras[k]["rotation"] = {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
    save("cameras.json", cameras);
  };
  turn(1);
  const Outcome outcome = calibrate({"--quality", "38", "--size", "36x24"});
  ASSERT_TRUE(ended(outcome, 0, "the model is not visible in 1 of 4 views, which are skipped (side)"));
  const json found = load_json(file);
  EXPECT_EQ(found["views"].size(), 3);
  for (const auto& entry : found["entries"]) EXPECT_LT(entry["tolerance"], 1e3) << entry;
  fs::remove(file);
  for (const std::size_t k : {0u, 2u, 3u}) turn(k);
  const char* const none = "the model is visible in none of its views";
  expect_refused_after({}, {{line({"--quality", "38"}),
                             "calibrate: the model is visible in none of its views, so all would look equal: "
                             "view front looks away from the model"},
                            {{"trim", model, "--quality", "25", "-o", folder / "t.ply"}, none},
                            {{"refit", model, "--against", "exact", "-o", folder / "t.ply"}, none}});
  for (const Words& axes : {Words{"--suite", "quick"}, {"--suite", "paper"}, {"--motion", "walk"}}) {
    EXPECT_TRUE(ended(run_into_out(joined({"bench", model, "--size", "36x24"}, axes)), 2,
                      "the model is visible in none of its views"))
        << axes[1] << " into a folder in which the ones before left nothing";
  }
}

// One command finds K and draws by it. With a file that does not exist it also writes the calibration there.
TEST_F(CalibrateTest, RenderFindsK) {
  const Words front = {"--mono", "--view", "front", "--bits", "16"};
  ASSERT_TRUE(good(render(joined(front, {"-o", folder / "exact.png"}))));
  const Words by = joined(front, {"--threshold", "adagscale", "--quality", "38", "--calibration", file});
  const Outcome outcome = render(joined(by, {"-o", folder / "k.png", "--json", folder / "r.json"}));
  ASSERT_TRUE(ended(outcome, 0, "AdaGScale: K = "));
  const json entry = load_json(file)["entries"][0], run = report();
  EXPECT_NEAR(run["views"][0]["tolerance"].get<double>(), entry["tolerance"].get<double>(), 1e-6);
  EXPECT_EQ(run["settings"]["transmittance"], "depth");
  const double db = psnr_of_files(folder / "exact.png", folder / "k.png");
  EXPECT_GE(db, 38.0);
  EXPECT_LT(db, 60.0) << "drawn exactly";
  const json again = reported(joined(front, {"--calibration", file, "-o", folder / "again.png"}));
  EXPECT_EQ(again["views"], [&] {
    json same = run["views"];
    for (const char* const changed : {"outputs", "gpu_ms"}) same[0][changed] = again["views"][0][changed];
    return same;
  }());
  EXPECT_TRUE(ended(render(by), 2, "leave one of them out")) << "a calibration that exists has a quality";
}

TEST_F(CalibrateTest, RenderUsesCalibration) {
  const Outcome outcome = checked(
      calibrate({"--quality", "38", "--views", "2", "--rule", "squared,depth", "--rule", "squared,last"}));
  EXPECT_TRUE(has(outcome.out, "target: 38 dB against the exact pictures"));
  const json found = load_json(file);
  EXPECT_EQ(found["views"].size(), 2);
  ASSERT_EQ(found["entries"].size(), 2);
  const Words front = {"--mono", "--view", "front"}, calibrated = joined(front, {"--calibration", file});
  ASSERT_TRUE(good(render(joined(front, {"-o", folder / "exact.png", "--bits", "16"}))));
  const json run =
      reported(joined(calibrated, {"-o", folder / "lossy.png", "--bits", "16", "--transmittance", "depth"}));
  EXPECT_NEAR(run["views"][0]["tolerance"].get<double>(), found["entries"][0]["tolerance"].get<double>(),
              1e-6);
  EXPECT_EQ(run["settings"]["threshold"], "squared");
  const double db = psnr_of_files(folder / "exact.png", folder / "lossy.png");
  EXPECT_GT(db, 34.0);
  EXPECT_LT(db, 60.0) << "drawn exactly";

  // A camera far away gives a warning and the exact picture, of which JSON and table say so. Another model is
  // refused.
  const Outcome far = render(
      {"--mono", "--eye", "0,0,-40", "--at", "0,0,0", "--calibration", file, "--json", folder / "r.json"});
  EXPECT_TRUE(ended(far, 0, "is far from the calibrated views"));
  EXPECT_TRUE(has(far.out, "exact"));
  EXPECT_EQ(report()["views"][0]["threshold"], "exact");
  const std::string out_there = save("far.json", {camera_json("a", 40.0), camera_json("b", 50.0)});
  const std::string said =
      render({"--mono", "--cameras", out_there, "--view", "all", "--calibration", file}).err;
  EXPECT_TRUE(has(said, "far from the calibrated views"));
  EXPECT_EQ(said.find("far from"), said.rfind("far from")) << said;
  EXPECT_EQ(run["views"][0]["threshold"], "squared");
  json other = found;
  other["model"]["hash"] = "0123456789abcdef";
  EXPECT_TRUE(
      ended(render(joined(front, {"--calibration", save("other.json", other), "--transmittance", "last"})), 2,
            "is of another model"));
  EXPECT_TRUE(ended(render(joined(calibrated, {"--size", "36x24"})), 0, "the tolerance is scaled"));
}

TEST_F(CalibrateTest, DropIsMeasuredAgainstPhotos) {
  // Photos with another background, so that the model differs from them. With its own background, photos
  // would equal the exact pictures. Then any difference would be a loss, and every search would go to its
  // end.
  std::vector<const char*> backgrounds = {"0.1,0.1,0.1"};
  if (test::switched_on("BINOSPLAT_LONG")) backgrounds.push_back("0,0,0");
  for (const char* background : backgrounds) {
    for (const char* view : {"front", "side"})
      ASSERT_TRUE(good(render({"--mono", "--view", view, "--background", background, "-o",
                               folder / "photos" / (std::string(view) + ".png")})));
    ASSERT_TRUE(good(calibrate({"--photos", folder / "photos", "--max-drop", "0.5"})));
    const json found = load_json(file);
    EXPECT_EQ(found["views"].size(), 2) << "the pair has no photos";
    EXPECT_EQ(found["target"]["drop_db"], 0.5);
    for (const json& entry : found["entries"]) {
      EXPECT_LE(entry["reached_db"].get<double>(), 0.5);
      if (background == backgrounds[0]) {
        EXPECT_GT(entry["reached_db"].get<double>(), 0.3) << entry;
      }
    }
  }
}

// Test views are every Nth view in the order of names, whatever the file's order is. They must not influence
// a tolerance.
TEST_F(CalibrateTest, ExcludesTestViews) {
  json cameras;
  for (const char* name : {"c", "b", "a", "e", "d", "i", "h", "g", "f"})
    cameras.push_back(camera_json(name, 0.02 * static_cast<double>(cameras.size())));
  save("cameras.json", cameras);
  const auto taken = [&](const Words& more) {
    EXPECT_TRUE(
        ended(calibrate(joined({"--quality", "30", "--size", "18x12", "--rule", "squared,one"}, more)), 0,
              "training views; test views: "));
    std::string names;
    const json found = load_json(file);
    for (const json& view : found["views"]) names += view["name"].get<std::string>();
    return names;
  };
  EXPECT_EQ(taken({}), "cbedhgf") << "a and i are for tests";
  EXPECT_EQ(taken({"--test-every", "3"}), "cbeihf") << "a, d and g are for tests";
}

// The default view is a test view here, and far from the others.
TEST_F(CalibrateTest, ReachCoversListedCameras) {
  json cameras = {camera_json("a", -2.0)};
  for (const char* name : {"b", "c", "d", "e", "f", "g", "h"})
    cameras.push_back(camera_json(name, 0.02 * static_cast<double>(cameras.size())));
  save("cameras.json", cameras);
  const Words small = {"--size", "36x24"};
  EXPECT_TRUE(
      ended(calibrate(joined(small, {"--quality", "38", "--rule", "adagscale,depth"})), 0, "test views: "));
  for (const json& view : load_json(file)["views"]) EXPECT_NE(view["name"], "a");
  const json run = reported(joined(small, {"--threshold", "adagscale", "--calibration", file}));
  EXPECT_EQ(run["views"][0]["threshold"], "adagscale");
}

TEST_F(CalibrateTest, RequiresSameOrderAndProjection) {
  ASSERT_TRUE(good(calibrate({"--quality", "38", "--view", "front", "--order", "distance", "--projection",
                              "tangent", "--size", "36x24"})));
  EXPECT_EQ(load_json(file)["projection"], "tangent");
  const Words by = {"--mono",        "--view", "front",       "--size",   "36x24",
                    "--calibration", file,     "--threshold", "adagscale"};
  EXPECT_TRUE(ended(
      render(by), 2,
      "is for order distance, projection tangent, a low-pass of 0.3 px^2 without anti-aliasing and a near "));
  EXPECT_TRUE(ended(render(joined(by, {"--order", "distance", "--projection", "tangent", "--near", "0.1"})),
                    2,
                    "but the frame has order distance, projection tangent, a low-pass of 0.3 px^2 without "
                    "anti-aliasing and a near plane of 0.1: calibrate with these settings"));
  const Words same = joined(by, {"--order", "distance", "--projection", "tangent"});
  const json settings = reported(same)["settings"];
  EXPECT_EQ(settings["threshold"], "adagscale");
  EXPECT_EQ(settings["transmittance"], "depth");
  // A tolerance given by the user also uses the calibration's table.
  const Words by_tolerance = joined(same, {"--tolerance", "0.5"});
  EXPECT_EQ(reported(by_tolerance)["views"][0]["tolerance"], 0.5);
}

TEST_F(CalibrateTest, RejectsInvalidTargetsAndFiles) {
  ASSERT_TRUE(good(calibrate({"--quality", "30", "--view", "front"})));
  json cut = load_json(file);
  cut["entries"].clear();
  save("cut.json", cut);
  expect_refused_after({"calibrate", model},
                       {{{"--quality", "40", "--max-drop", "1"}, "--max-drop"},
                        {{"--max-drop", "1"}, "--max-drop and --photos go together"},
                        {{"--quality", "40", "--view", "nowhere"}, "nowhere"},
                        {{"--quality", "40", "--size", "big"}, "--size big: expected pixels"}});
  expect_refused({{{"--calibration", folder / "none.json"}, "none.json"},
                  {{"--calibration", model}, "not valid JSON"},
                  {{"--calibration", file, "--tolerance", "1"}, "leave one of them out"},
                  {{"--calibration", file, "--threshold", "exact"}, "has no effect with --threshold exact"},
                  {{"--calibration", folder / "cut.json"}, "has no entry"}});
}

}  // namespace
}  // namespace binosplat
