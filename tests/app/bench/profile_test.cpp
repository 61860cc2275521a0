// Runs binosplat profile like a user.

#include "app/scene.h"
#include "lab/trace_rules.h"

namespace binosplat {
namespace {

struct ProfileCommand : SceneTest {
  ProfileCommand() { add_row_of_cameras(4); }

  Outcome profile(const Words& more) const { return run_into_out(joined({"profile", model}, more)); }
  /// Returns the run's only row.
  json row() const { return load_json(out + "/results.json").at("points").at(0); }
  lab::Table frames() const { return test::frames_of(read_text(out + "/frames.csv")); }
};

TEST_F(ProfileCommand, WritesReportTraceAndTable) {
  const Outcome outcome = checked(profile({"--tour", "calm", "--seconds", "0.2", "--size", "48x32"}));
  EXPECT_EQ(folder.files(), (Names{"cameras.json", "model.ply", "out/frames.csv", "out/report.html",
                                   "out/results.csv", "out/results.json", "out/trace.json"}));
  const json trace = json::parse(read_text(out + "/trace.json"));
  EXPECT_EQ(test::faults_of_trace(trace), Words());
  EXPECT_EQ(test::differences_of(trace, frames()), Words());
  EXPECT_EQ(frames().rows.size(), 18u) << "90 a second";
  const json numbers = row();
  EXPECT_EQ(numbers["frames"], 18);
  EXPECT_EQ(numbers["eyes"], 2);
  EXPECT_EQ(numbers["size"], "48x32");
  EXPECT_EQ(numbers["along"], "tour calm");
  EXPECT_EQ(numbers["details"].size(), 10u) << "the worst";
  EXPECT_TRUE(has(outcome.out, "18 frames of 2 x 48 x 32 px, exact"));
  EXPECT_TRUE(has(outcome.out, "missed  "));
  const lab::Table table = frames();
  for (const auto& [name, px] : {std::pair{"width", 48.0}, {"height", 32.0}}) {
    const auto at = std::ranges::find(table.columns, name) - table.columns.begin();
    ASSERT_LT(at, std::ssize(table.columns));
    EXPECT_EQ(table.rows[0][static_cast<std::size_t>(at)], lab::Cell(px));
  }
  EXPECT_TRUE(
      has(outcome.out, is_software(numbers["device"]) ? "\nbound   the CPU, which draws (" : "\nbound   "));
  EXPECT_LE(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 11);
  const std::string page = read_text(out + "/report.html");
  EXPECT_TRUE(has(page, "The frames that took longest"));
  EXPECT_TRUE(has(page, "binosplat profile ")) << "the command";
}

TEST_F(ProfileCommand, AdviceNamesOptions) {
  const Outcome outcome = checked(profile({"--seconds", "0.01", "--size", "640x480", "--fps", "1000"}));
  const std::string advice = row()["advice"];
  if (advice.empty()) GTEST_SKIP() << "no frame was late";
  EXPECT_TRUE(has(advice, "--"));
  EXPECT_EQ(advice.find('`'), std::string::npos) << advice;
  EXPECT_TRUE(has(outcome.out, "\ntry     " + advice + "\n"));
  EXPECT_TRUE(has(read_text(out + "/report.html"), " Try " + advice + "."));
}

TEST_F(ProfileCommand, DefaultsToTour) {
  ASSERT_TRUE(good(profile({"--seconds", "0.1", "--size", "24x16", "--fps", "0", "--no-clock"})));
  const json numbers = row();
  EXPECT_EQ(numbers["along"], "tour walk");
  EXPECT_EQ(numbers["frames"], 9) << "poses are 90 a second";
  EXPECT_EQ(numbers["missed"], 0) << "nothing is due";
  fs::remove(folder / "cameras.json");
  ASSERT_TRUE(good(profile({"--seconds", "0.1", "--size", "24x16", "--fps", "20"})));
  EXPECT_EQ(row()["frames"], 2) << "without cameras it stands";
  add_row_of_cameras(1);
  ASSERT_TRUE(good(profile({"--seconds", "0.1", "--size", "24x16", "--fps", "20"})));
  EXPECT_EQ(row()["along"], "standing at view0");
  EXPECT_TRUE(ended(profile({"--path", folder / "none.json"}), 2, "none.json"));
  ASSERT_TRUE(good(profile({"--path", folder / "cameras.json", "--size", "24x16"})));
  EXPECT_EQ(row()["frames"], 1);
}

TEST_F(ProfileCommand, ComparesWithPreviousRun) {
  const Words still = {"--view", "view1", "--seconds", "0.4",       "--fps", "0",
                       "--size", "36x24", "--mono",    "--quality", "40"};
  ASSERT_TRUE(good(profile(still)));
  EXPECT_EQ(row()["along"], "standing at view1");
  EXPECT_TRUE(has(read_text(out + "/frames.csv"), "drawn exactly: small"));
  const std::string before = folder / "before.json";
  fs::copy(out + "/results.json", before);
  const Words compared = joined(still, {"--compare", before});
  const Outcome same = checked(profile(compared));
  EXPECT_TRUE(has(same.out, "numbers of 1 points in both runs changed beyond noise"));
  // Compared with a run of ten times as many pairs. Pairs are a count, which load on this machine does not
  // change.
  json old = load_json(before);
  old["points"][0]["pairs"] = 10.0 * old["points"][0]["pairs"].get<double>();
  for (const char* times : {"repeats_ms", "cpu_repeats_ms"}) {  // the CPU's only if it draws
    for (auto& ms : old["points"][0][times]) ms = 1e-3 * ms.get<double>();
  }
  save("before.json", old);
  EXPECT_TRUE(has(profile(compared).out, ": pairs "));
  EXPECT_TRUE(ended(profile(joined(compared, {"--fail-if-slower", "50"})), 1, "slower than in"));
}

TEST_F(ProfileCommand, InvalidOptionsLeaveNoFiles) {
  expect_refused_after(
      {"profile", model, "--size", "36x24"},
      {{{"--tour", "calm", "--view", "view1"}, "--tour with --view"},
       {{"--view", "all"}, "--view takes a single camera: name one"},
       {{"--view", "nobody"}, "nobody"},
       {{"--tour", "crawl"}, "--tour crawl"},
       {{"--frames", "3"}, "--frames: binosplat profile has no such option"},
       {{"--fps", "-1"}, "frames a second from 0 to 1000"},
       {{"--fps", "1e-9"}, "--fps 1e-09: expected 0, or 0.01 to 1000"},
       {{"--seconds", "1e18"}, "--seconds: 1e18: expected seconds above zero (0.000001 to 1000000)"},
       {{"--seconds", "1e6", "--view", "view1"}, "fewer --seconds, at most"},
       {{"--compare", folder / "none.json"}, "none.json"},
       {{"--compare", model}, "not JSON"},
       {{"--fail-if-slower", "3"}, "--fail-if-slower needs --compare"},
       {{"-o", model}, "model.ply"},
       {{"--eye", "0,0,0"}, "--eye needs --at"}});
  // The table fits onto the disk and the page does not: neither remains.
  const auto before = folder.files();
  EXPECT_TRUE(ended(run_into_out({"profile", model, "--size", "36x24", "--seconds", "0.1"},
                                 {.limits = {{RLIMIT_FSIZE, 100'000}}}),
                    2, "report.html"));
  EXPECT_EQ(folder.files(), before);
}

}  // namespace
}  // namespace binosplat
