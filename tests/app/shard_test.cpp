// binosplat render in parts: shards that come to the files of one run, and runs that go on where one ended.

#include <chrono>
#include <thread>

#include "app/scene.h"

namespace binosplat {
namespace {

using test::ended;
using test::good;
using test::has;
using test::Outcome;
using test::Program;
using test::read_text;
using test::Words;
using test::write_text;

constexpr const char* run_file = "render-run.json";

struct Shards : test::SceneTest {
  Shards() { add_row_of_cameras(5); }

  Words line(const std::string& to, const Words& more) const {
    return joined({"render", model, "-o", to}, more);
  }
  Outcome draw(const std::string& to, const Words& more) const { return test::run_program(line(to, more)); }
  /// The files of a folder, by name.
  static std::map<std::string, std::string> contents(const std::filesystem::path& of) {
    std::map<std::string, std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(of))
      all[entry.path().filename()] = read_text(entry.path());
    return all;
  }
  static std::size_t pictures_in(const std::filesystem::path& of) {
    const auto all = contents(of);
    return all.size() - all.count(run_file);
  }
};

// In whichever order and company they are drawn, also where a frame goes by what the last one left.
TEST_F(Shards, AreTheFilesOfOneRun) {
  for (const Words& settings : {Words{"--view", "all"},
                                {"--view", "all", "--mono", "--exr", "half", "--resume"},
                                {"--view", "all", "--mono", "--tolerance", "1", "--transmittance", "last"},
                                {"--orbit", "5", "--size", "36x24"},
                                {"--path", folder / "cameras.json", "--mono", "--tolerance", "1"}}) {
    const std::string whole = folder / "whole", parts = folder / "parts",
                      shown = fmt::format("{}", settings[1]);
    ASSERT_TRUE(good(draw(whole, settings)));
    const Words second = joined(settings, {"--shard", "2/2"});
    Program one(line(parts, joined(settings, {"--shard", "1/2"}))), two(line(parts, second));
    EXPECT_TRUE(good(one.wait()));
    EXPECT_TRUE(good(two.wait()));
    EXPECT_EQ(contents(parts), contents(whole)) << shown;
    EXPECT_NE(contents(whole).begin()->second, std::next(contents(whole).begin(), 2)->second);

    // Neither draws what the other does.
    ASSERT_TRUE(good(draw(folder / "some", second)));
    EXPECT_EQ(pictures_in(folder / "some"), pictures_in(whole) / 5 * 2) << shown;
    for (const char* name : {"whole", "parts", "some"}) std::filesystem::remove_all(folder / name);
  }
}

// What is refused would come out differently, and so would views if they were carried as a path is.
TEST_F(Shards, FramesThatAreCarriedAreNotOneRunApart) {
  const Words last = {"--mono", "--tolerance", "1", "--transmittance", "last", "--path"};
  ASSERT_TRUE(good(draw(folder / "whole", joined(last, {folder / "cameras.json"}))));
  nlohmann::json cameras = test::load_json(folder / "cameras.json");
  cameras.erase(0);
  write_text(folder / "half.json", cameras.dump());
  ASSERT_TRUE(good(draw(folder / "half", joined(last, {folder / "half.json"}))));
  EXPECT_NE(read_text(folder / "half/view1.png"), read_text(folder / "whole/view1.png"));
}

struct Resume : Shards {
  const Words settings = {"--view", "all", "--mono", "--resume"};

  Outcome again(const Words& more = {}) const { return draw(out, joined(settings, more)); }
  /// Whether a run is, and changes nothing.
  testing::AssertionResult refused(const std::string& said, const Words& more = {}) const {
    const auto before = contents(out);
    const testing::AssertionResult is = ended(again(more), 2, said);
    return contents(out) == before ? is : testing::AssertionFailure() << "files have changed";
  }
};

TEST_F(Resume, GoesOnAfterAnInterruption) {
  const std::string whole = folder / "whole";
  ASSERT_TRUE(good(draw(whole, settings)));
  Program run(line(out, settings));
  while (!std::filesystem::exists(out + "/view0.png"))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  run.send(SIGINT);
  run.wait();
  // However far it came, one of those that are there is left as it is, and one that is not is drawn.
  const std::string as_it_was = read_text(whole + "/view0.png") + "as it was";
  write_text(out + "/view0.png", as_it_was);
  std::filesystem::remove(out + "/view4.png");
  const auto there = contents(out).size() - 1;
  const Outcome outcome = again();
  ASSERT_TRUE(good(outcome));
  EXPECT_TRUE(has(outcome.err, fmt::format("{} of 5 views are in {} already", there, out)));
  auto expected = contents(whole);
  expected["view0.png"] = as_it_was;
  EXPECT_EQ(contents(out), expected);
  const Outcome third = again();
  ASSERT_TRUE(good(third));
  EXPECT_TRUE(has(third.err, "5 of 5 views are in"));
}

// A view of several files is there when all of them are.
TEST_F(Resume, DrawsPairsOfWhichAFileIsMissing) {
  const Words pairs = {"--view", "all", "--exr", "half", "--resume"};
  ASSERT_TRUE(good(draw(out, pairs)));
  const auto whole = contents(out);
  ASSERT_EQ(whole.size(), 21);
  std::filesystem::remove(out + "/view1_right.exr");
  const Outcome outcome = draw(out, pairs);
  ASSERT_TRUE(good(outcome));
  EXPECT_TRUE(has(outcome.err, "4 of 5 views are in"));
  EXPECT_EQ(contents(out), whole);

  // The same options and cameras, but a pose was saved beside the model, with eyes that are farther apart.
  nlohmann::json pose = test::camera_json("saved", 0.5);
  pose.update({{"up", {0, -1, 0}}, {"units_per_metre", 1.0}, {"ipd_metres", 0.1}, {"near", 0.1}});
  write_text(folder / "model.binosplat.json", nlohmann::json::array({pose}).dump());
  EXPECT_TRUE(ended(draw(out, pairs), 2, "says other views."));
}

TEST_F(Resume, TakesNamesInAnyEncoding) {
  const std::string other = folder / "mod\xe9le.ply";
  std::filesystem::copy_file(model, other);
  for (int n = 0; n < 2; ++n)
    EXPECT_TRUE(
        good(test::run_program({"render", other, "--view", "view0", "--mono", "--resume", "-o", out})));
}

TEST_F(Resume, TakesNoPicturesOfAnotherRun) {
  ASSERT_TRUE(good(again({"--shard", "1/2"})));
  EXPECT_TRUE(refused("says other options", {"--background", "1,1,1"}));
  EXPECT_TRUE(refused("says other options", {"--tolerance", "1"}));
  // On which no picture depends.
  EXPECT_TRUE(good(again({"--backend", "surfaceless", "--shard", "2/3"})));

  const std::string bytes = read_text(model), cameras = read_text(folder / "cameras.json");
  std::string other = bytes;
  ++other[other.size() - 100];
  write_text(model, other);
  EXPECT_TRUE(refused("says other model"));
  write_text(model, bytes);
  nlohmann::json moved = nlohmann::json::parse(cameras);
  moved[4]["position"][1] = 0.25;
  write_text(folder / "cameras.json", moved.dump());
  EXPECT_TRUE(refused("says other cameras, views"));
  write_text(folder / "cameras.json", cameras);
  EXPECT_TRUE(good(again()));
}

TEST_F(Resume, TakesACalibrationAsItIs) {
  const std::string calibration = folder / "c.json";
  ASSERT_TRUE(
      good(test::run_program({"calibrate", model, "-o", calibration, "--quality", "38", "--view", "view2"})));
  const Words calibrated = {"--calibration", calibration};
  ASSERT_TRUE(good(again(calibrated)));
  EXPECT_TRUE(good(again(calibrated)));
  nlohmann::ordered_json other = nlohmann::ordered_json::parse(read_text(calibration));
  for (auto& entry : other["entries"]) entry["tolerance"] = 2.0 * entry["tolerance"].get<double>();
  write_text(calibration, other.dump());
  EXPECT_TRUE(refused("says other calibration", calibrated));
}

TEST_F(Resume, TakesNoPicturesOfWhichNothingTells) {
  ASSERT_TRUE(good(draw(out, {"--view", "view3", "--mono"})));
  EXPECT_TRUE(refused("view3.png: nothing says how it was drawn"));
  std::filesystem::remove(out + "/view3.png");
  ASSERT_TRUE(good(again()));
  // A run that draws all replaces pictures, whatever it draws them with.
  ASSERT_TRUE(good(draw(out, {"--view", "view3", "--mono", "--background", "1,1,1"})));
  EXPECT_FALSE(std::filesystem::exists(out + "/" + run_file));
  EXPECT_TRUE(refused("nothing says how it was drawn"));
}

}  // namespace
}  // namespace binosplat
