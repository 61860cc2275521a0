// binosplat render in shards, which give the files of one run, and resumed runs.

#include "app/scene.h"

namespace binosplat {
namespace {

constexpr const char* run_file = "render-run.json";

struct Shards : SceneTest {
  Shards() { add_row_of_cameras(5); }

  Words line(const std::string& to, const Words& more) const {
    return joined({"render", model, "-o", to}, more);
  }
  Outcome draw(const std::string& to, const Words& more) const { return run_program(line(to, more)); }
};

// The order and number of shards make no difference, even if frames use measurements of the previous ones.
TEST_F(Shards, EqualSingleRun) {
  for (const Words& settings : {Words{"--view", "all"},
                                {"--view", "all", "--mono", "--exr", "half", "--resume"},
                                {"--view", "all", "--mono", "--tolerance", "1", "--transmittance", "last"},
                                {"--orbit", "5", "--size", "36x24"},
                                {"--path", folder / "cameras.json", "--mono", "--tolerance", "1"}}) {
    const std::string whole = folder / "whole", parts = folder / "parts", some = folder / "some";
    ASSERT_TRUE(good(draw(whole, settings)));
    const Words second = joined(settings, {"--shard", "2/2"});
    Program one(line(parts, joined(settings, {"--shard", "1/2"}))), two(line(parts, second));
    EXPECT_TRUE(good(one.wait()));
    EXPECT_TRUE(good(two.wait()));
    auto expected = contents_of(whole);
    EXPECT_EQ(contents_of(parts), expected) << settings[1];

    // Shards do not draw each other's views.
    ASSERT_TRUE(good(draw(some, second)));
    auto found = contents_of(some);
    for (auto* const files : {&expected, &found}) files->erase(run_file);
    EXPECT_NE(expected.begin()->second, std::next(expected.begin(), 2)->second);
    EXPECT_EQ(found.size(), expected.size() / 5 * 2) << settings[1];
    for (const std::string& drawn : {whole, parts, some}) fs::remove_all(drawn);
  }
}

// Refused combinations would give other pictures: frames of a path depend on the previous ones.
TEST_F(Shards, PathFramesDependOnPrevious) {
  const Words last = {"--mono", "--tolerance", "1", "--transmittance", "last", "--path"};
  ASSERT_TRUE(good(draw(folder / "whole", joined(last, {folder / "cameras.json"}))));
  json cameras = load_json(folder / "cameras.json");
  cameras.erase(0);
  ASSERT_TRUE(good(draw(folder / "half", joined(last, {save("half.json", cameras)}))));
  EXPECT_NE(read_text(folder / "half/view1.png"), read_text(folder / "whole/view1.png"));
}

struct Resume : Shards {
  const Words settings = {"--view", "all", "--mono", "--resume"};

  Outcome again(const Words& more = {}) const { return draw(out, joined(settings, more)); }
  /// Returns whether a run is refused, and changes nothing.
  testing::AssertionResult refused(const std::string& said, const Words& more = {}) const {
    const auto before = contents_of(out);
    const testing::AssertionResult is = ended(again(more), 2, said);
    return contents_of(out) == before ? is : testing::AssertionFailure() << "files have changed";
  }
};

TEST_F(Resume, ContinuesAfterInterrupt) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(draw(whole, settings)));
  Program run(line(out, settings));
  wait_for_file(out + "/view0.png");
  run.send(SIGINT);
  run.wait();
  // Whenever the run was interrupted: one existing picture must stay, and one missing picture must be drawn.
  const std::string as_it_was = read_text(whole + "/view0.png") + "as it was";
  write_text(out + "/view0.png", as_it_was);
  fs::remove(out + "/view4.png");
  const auto there = contents_of(out).size() - 1;
  EXPECT_TRUE(ended(again(), 0, fmt::format("{} of 5 views are in {} already", there, out)));
  auto expected = contents_of(whole);
  expected["view0.png"] = as_it_was;
  EXPECT_EQ(contents_of(out), expected);
  EXPECT_TRUE(ended(again(), 0, "5 of 5 views are in"));
}

// A view with several files counts as drawn only if all of them exist.
TEST_F(Resume, RedrawsIncompletePairs) {
  const Words pairs = {"--view", "all", "--exr", "half", "--resume"};
  ASSERT_TRUE(good(draw(out, pairs)));
  const auto whole = contents_of(out);
  ASSERT_EQ(whole.size(), 21);
  fs::remove(out + "/view1_right.exr");
  EXPECT_TRUE(ended(draw(out, pairs), 0, "4 of 5 views are in"));
  EXPECT_EQ(contents_of(out), whole);

  // Options and cameras are the same, but a pose with a larger eye distance was saved in the model's folder.
  save_pose(1.0, 0.1);
  EXPECT_TRUE(ended(draw(out, pairs), 2, "differs in " + std::string(folder / "model.binosplat.json")));
}

TEST_F(Resume, AcceptsAnyFileNameEncoding) {
  const std::string other = folder / "mod\xe9le.ply";
  fs::copy_file(model, other);
  for (int n = 0; n < 2; ++n)
    EXPECT_TRUE(good(run_program({"render", other, "--view", "view0", "--mono", "--resume", "-o", out})));
}

TEST_F(Resume, RejectsOtherRun) {
  ASSERT_TRUE(good(again({"--shard", "1/2"})));
  EXPECT_TRUE(refused("differs in options", {"--background", "1,1,1"}));
  EXPECT_TRUE(refused("differs in options", {"--tolerance", "1"}));
  // No picture depends on these options.
  EXPECT_TRUE(good(again({"--backend", "surfaceless", "--shard", "2/3"})));

  for (const std::string& input : {model, std::string(folder / "cameras.json")}) {
    const auto time = fs::last_write_time(input);
    write_text(input, read_text(input));
    EXPECT_TRUE(refused("differs in " + input + "."));
    fs::last_write_time(input, time);
  }
  EXPECT_TRUE(good(again()));
}

TEST_F(Resume, RejectsChangedCalibration) {
  const std::string calibration = folder / "c.json";
  ASSERT_TRUE(
      good(run_program({"calibrate", model, "-o", calibration, "--quality", "38", "--view", "view2"})));
  const Words calibrated = {"--calibration", calibration};
  ASSERT_TRUE(good(again(calibrated)));
  EXPECT_TRUE(good(again(calibrated)));
  json other = load_json(calibration);
  for (auto& entry : other["entries"]) entry["tolerance"] = 2.0 * entry["tolerance"].get<double>();
  save("c.json", other);
  EXPECT_TRUE(refused("differs in " + calibration, calibrated));
}

TEST_F(Resume, RejectsUnknownPictures) {
  ASSERT_TRUE(good(draw(out, {"--view", "view3", "--mono"})));
  EXPECT_TRUE(refused("view3.png: it belongs to no known run"));
  fs::remove(out + "/view3.png");
  ASSERT_TRUE(good(again()));
  // A run that draws all views replaces pictures, whatever run they are from.
  ASSERT_TRUE(good(draw(out, {"--view", "view3", "--mono", "--background", "1,1,1"})));
  EXPECT_FALSE(fs::exists(out + "/" + run_file));
  EXPECT_TRUE(refused("it belongs to no known run"));
}

}  // namespace
}  // namespace binosplat
