// The profile of simulated frames.

#include "lab/profile.h"

#include <gtest/gtest.h>

#include <fstream>

#include "lab/chromium.h"
#include "lab/trace_rules.h"
#include "support/errors.h"

namespace binosplat::lab {
namespace {

using nlohmann::json;
using render::FrameEvent;
using std::chrono::microseconds;

/// Returns `count` frames, one each 20 ms: 2 ms of project and 3 of blend on a GPU whose clock is 7 s ahead,
/// 1 ms of submitting, 5 of waiting. Frame 3 was drawn again, 5 compiled, 7 had levels uploaded.
Profile sample_profile(std::size_t count = 20) {
  Profile profile{.facts = {"fox.ply", "tour walk", "exact", "a GPU", false}};
  render::Recording& recording = profile.recording;
  recording.fps = 100.0;
  recording.no_clock = "it was not requested";
  const Clock::time_point start = Clock::time_point() + std::chrono::hours(1);
  constexpr std::int64_t ahead = 7'000'000'000;
  recording.first = {start, ahead};
  recording.last = {start + std::chrono::seconds(1), ahead + 1'000'000'000};
  for (std::size_t n = 0; n < count; ++n) {
    render::FrameRecord& frame = recording.frames.emplace_back();
    frame.due = frame.begin = start + n * microseconds(20'000);
    const int draws = n == 3 ? 2 : 1;
    const auto compiling = microseconds(n == 5 ? 8'000 : 0);
    std::int64_t gpu =
        ahead + static_cast<std::int64_t>(n) * 20'000'000 + 1'000'000 + 1000 * compiling.count();
    for (int k = 0; k < draws; ++k) {
      frame.report.spans.push_back({"project", gpu, gpu + 2'000'000});
      frame.report.spans.push_back({"blend", gpu + 2'000'000, gpu + 5'000'000});
      gpu += 5'500'000;
    }
    frame.end = frame.begin + draws * microseconds(6'000) + compiling;
    frame.report.redraws = draws - 1;
    frame.report.submit_ms = 1.0 + 1e-3 * double(compiling.count());
    frame.report.wait_ms = 5.0 * draws;
    frame.report.new_programs = n == 5 ? 1 : 0;
    frame.report.gpu_bytes = n < 3 ? 1'000'000 : 3'000'000;
    frame.report.pairs = 1000 + n;
    frame.gaussians = 600;
    frame.levels.uploaded = n == 7 ? 250 : 0;
    frame.views.resize(2);
    frame.views[0].width = frame.views[1].width = 64;
    frame.views[0].height = frame.views[1].height = 48;
    if (n == 5)
      recording.spans.push_back({"compile blend.comp", "draws", frame.begin, frame.begin + compiling});
    recording.spans.push_back({"submit", "draws", frame.begin, frame.begin + microseconds(1000) + compiling});
    recording.spans.push_back({"read levels", "reads levels", frame.begin, frame.end});
  }
  return profile;
}

TEST(Profile, ExplainsSlowFrames) {
  const Profile profile = sample_profile();
  const ProfileSummary summary = summary_of(profile);
  const auto reason = [&](std::size_t n) { return reason_of(profile, summary, n); };
  EXPECT_EQ(reason(0), "like other frames");
  EXPECT_EQ(reason(3),
            "drawn again: once, since a buffer was too small; buffers grew: 2.0 MB; blend took 3.00 ms more "
            "than usual");
  EXPECT_EQ(reason(5), "program compiled: blend.comp; submit took 8.00 ms more than usual");
  EXPECT_EQ(reason(7), "levels uploaded: 250 Gaussians");
  EXPECT_EQ(std::vector<std::size_t>(summary.worst.begin(), summary.worst.begin() + 2),
            (std::vector<std::size_t>{5, 3}));
  EXPECT_EQ(summary.missed, 2u);
  EXPECT_EQ(summary.gpu.median, 5.0);
  EXPECT_EQ(summary.wall.max, 14.0);
  EXPECT_EQ(summary.gpu_bound, 19u) << "all but the one that compiles";
  EXPECT_EQ(bound_of(profile, summary), "GPU (blend 60 %), in 19 of 20 frames");
  Profile software = profile;
  software.facts.is_software = true;
  EXPECT_EQ(bound_of(software, summary), "the CPU, which draws (blend 60 %)");
}

TEST(Profile, ReportsRepeatsCutsAndClocks) {
  Profile profile = sample_profile(4);
  profile.recording.frames[1].report.exact = ExactReason::no_gain;
  profile.recording.frames[1].report.sampled_error = true;
  profile.recording.frames[2].report.exact = ExactReason::unmeasured;
  for (render::FrameRecord& frame : profile.recording.frames) frame.mhz = 1980.0;
  profile.recording.frames[2].mhz = 1200.0;
  profile.recording.frames[0].display = render::FrameDisplay{20.0, 2};
  const auto names = [&](std::size_t n) {
    std::vector<std::string> texts;
    for (const FrameEvent& event : events_of(profile.recording, n, fastest_mhz(profile.recording)))
      texts.push_back(event.text());
    return texts;
  };
  EXPECT_EQ(names(0), (std::vector<std::string>{"display missed: 2 times"}));
  EXPECT_EQ(names(1), (std::vector<std::string>{"drawn exactly: no gain", "measured its error"}));
  EXPECT_EQ(names(2), (std::vector<std::string>{"drawn exactly: unmeasured", "low clock: 1200 MHz"}));
  EXPECT_TRUE(is_missed(profile.recording, 0));
  EXPECT_EQ(summary_of(profile).slow_clock, 1u);
}

TEST(Profile, TraceFollowsFormat) {
  const Profile profile = sample_profile();
  const json trace = test::trace_of(profile);
  EXPECT_EQ(test::faults_of_trace(trace), std::vector<std::string>());
  EXPECT_EQ(test::differences_of(trace, frames_table(profile.recording)), std::vector<std::string>());
  // GPU times are converted to the CPU's clock: frame 1 begins at 20 ms, and its first stage a millisecond
  // later.
  std::map<std::string, int> kinds;
  double project = -1.0;
  std::set<std::string> instants;
  for (const json& event : trace["traceEvents"]) {
    ++kinds[event["ph"]];
    if (event["name"] == "project" && event["args"]["frame"] == 1) project = event["ts"];
    if (event["ph"] == "i")
      instants.insert(event["name"].get<std::string>() + " " + event["args"]["detail"].get<std::string>());
  }
  EXPECT_DOUBLE_EQ(project, 21'000.0);
  EXPECT_EQ(kinds["C"], 4 * 20) << "pairs, Gaussians in view and of the model, memory";
  EXPECT_EQ(instants,
            (std::set<std::string>{"drawn again once, since a buffer was too small", "buffers grew 2.0 MB",
                                   "program compiled blend.comp", "levels uploaded 250 Gaussians"}));
}

TEST(Profile, InjectedTraceFaultsAreDetected) {
  const Profile profile = sample_profile();
  const json good = test::trace_of(profile);
  const auto first = [](json& trace, const std::string& name) -> json& {
    for (json& event : trace["traceEvents"]) {
      if (event["name"] == name && event["ph"] == "X") return event;
    }
    throw std::runtime_error("no " + name);
  };
  const auto faulty = [&](const auto& inject) {
    json trace = good;
    inject(trace);
    return !test::faults_of_trace(trace).empty();
  };
  EXPECT_TRUE(faulty([&](json& t) { first(t, "blend")["dur"] = -1.0; }));
  EXPECT_TRUE(faulty([&](json& t) { first(t, "blend")["dur"] = 4000.0; })) << "beyond its frame";
  EXPECT_TRUE(faulty([&](json& t) { first(t, "project")["ts"] = 0.0; })) << "before its frame";
  EXPECT_TRUE(faulty([&](json& t) { first(t, "submit").erase("ts"); }));
  EXPECT_TRUE(faulty([&](json& t) { first(t, "read levels")["tid"] = 9; })) << "a track without a name";
  EXPECT_TRUE(faulty([&](json& t) { t["traceEvents"][0]["name"] = "thread_name"; })) << "no process_name";
  json trace = good;
  first(trace, "blend")["dur"] = 2000.0;
  EXPECT_FALSE(test::differences_of(trace, frames_table(profile.recording)).empty()) << "another sum";
}

TEST(Profile, PartialWritesMakeOneTable) {
  const Profile longer = sample_profile(2 * rows_at_once + 7);
  std::string written;
  write_frames(longer.recording, [&](std::string_view part) { written += part; });
  EXPECT_EQ(written, csv(frames_table(longer.recording)));
  EXPECT_NE(written.find("\"drawn again: once, since a buffer was too small; buffers grew: 2.0 MB\"\n"),
            std::string::npos);
}

TEST(Profile, RowSummarizesFrames) {
  Profile profile = sample_profile(60);
  const Point point = profile_point(profile, summary_of(profile));
  const Row& row = point.row;
  EXPECT_EQ(text(row, "scene"), "fox.ply");
  EXPECT_EQ(text(row, "along"), "tour walk");
  EXPECT_EQ(text(row, "size"), "64x48");
  EXPECT_NEAR(number(row, "frame_ms"), 5.0 * 61 / 60, 1e-9) << "one of 60 was drawn twice";
  EXPECT_EQ(number(row, "frames"), 60);
  EXPECT_EQ(number(row, "missed"), 2);
  EXPECT_NEAR(number(row, "stage_blend_ms"), 3.0 * 61 / 60, 1e-9);
  EXPECT_EQ(row["repeats_ms"], std::vector<double>(10, 5.0)) << "medians of ten stretches";
  EXPECT_EQ(row["wall_repeats_ms"].size(), 10u);
  EXPECT_FALSE(row.contains("cpu_repeats_ms"));
  profile.cpu.assign(60, {9.0, 1.0});
  EXPECT_EQ(profile_point(profile, summary_of(profile)).row["cpu_repeats_ms"], std::vector<double>(10, 9.0));
  EXPECT_NEAR(number(profile_point(profile, summary_of(profile)).row, "waited"), 10.0, 1e-9);
  ASSERT_EQ(point.details.size(), 10u);
  EXPECT_EQ(number(point.details[0], "frame"), 5);
  EXPECT_NE(text(point.details[0], "reason").find("program compiled"), std::string::npos);
}

TEST(Profile, AdviceFitsBottleneck) {
  const auto advice = [](const auto& change) {
    Profile profile = sample_profile();
    change(profile);
    return advice_of(profile, summary_of(profile));
  };
  const Saving saving{40.0, 0.3};
  EXPECT_NE(advice([&](Profile& p) { p.saving = saving; }).find("`quality` 40 would save 30 %"),
            std::string::npos);
  EXPECT_NE(advice([&](Profile& p) {
              p.saving = saving;
              for (auto& frame : p.recording.frames) frame.report.plan_ms = 9.0;
            }).find("the GPU waits for the CPU"),
            std::string::npos);
  EXPECT_NE(advice([&](Profile& p) {
              for (auto& frame : p.recording.frames) frame.levels.ms = 9.0;
            }).find("a coarser `detail`"),
            std::string::npos);
  EXPECT_EQ(advice([&](Profile& p) {
              p.saving = saving;
              p.recording.fps = 20.0;
            }),
            "")
      << "every frame is in time";
  EXPECT_EQ(advice([](Profile&) {}),
            "a smaller `size`, `quality` 40 or `foveate` if a device tracks the eyes");
  EXPECT_EQ(advice([](Profile& p) {
              p.saving = Saving{40.0, 0.0};
            }),
            "a smaller `size` or `foveate` if a device tracks the eyes")
      << "--quality was tried";
  EXPECT_EQ(advice([](Profile& p) { p.facts.drawing = "at about 40 dB"; }),
            "a smaller `size` or a lower `quality`");
  EXPECT_EQ(advice([](Profile& p) { p.facts.drawing = "exact, foveated"; }),
            "a smaller `size` or a smaller context of `foveate`");
  EXPECT_EQ(advice([](Profile& p) { p.recording.fps = 0.0; }), "") << "nothing is due, nothing was tried";
}

// Perfetto groups slices by name, so every frame has the same name. Injected: names with numbers.
TEST(Profile, TraceGivesFramesOneName) {
  const auto names = [](const std::string& trace) {
    std::set<std::string> found;
    const nlohmann::json parsed = nlohmann::json::parse(trace);
    for (const nlohmann::json& event : parsed["traceEvents"]) {
      if (event["ph"] == "X" && event["name"].get<std::string>().starts_with("frame"))
        found.insert(event["name"]);
    }
    return found;
  };
  std::string trace = test::trace_of(sample_profile()).dump();
  EXPECT_EQ(names(trace), std::set<std::string>{"frame"});
  trace.replace(trace.find("\"name\":\"frame\""), 14, "\"name\":\"frame 7\"");
  EXPECT_EQ(names(trace).size(), 2u);
}

TEST(Profile, SummaryCountsRedrawnFrames) {
  const auto again = [](const Profile& profile) {
    std::vector<std::string> lines = lines_of(profile, summary_of(profile));
    std::erase_if(lines, [](const std::string& line) { return !line.starts_with("again"); });
    return lines;
  };
  Profile profile = sample_profile();
  EXPECT_EQ(again(profile),
            std::vector<std::string>{"again   1 of 20 frames were drawn again: frame 3 most often (1 x)"});
  for (std::size_t n = 6; n < 12; ++n) profile.recording.frames[n].report.redraws = static_cast<int>(n) - 4;
  EXPECT_EQ(again(profile),
            std::vector<std::string>{"again   7 of 20 frames were drawn again: frame 11 most often (7 x)"});
  for (render::FrameRecord& frame : profile.recording.frames) frame.report.redraws = 0;
  EXPECT_TRUE(again(profile).empty());
}

TEST(Profile, TenMinutesTakeUnder200MB) {
  const auto status_kb = [](const std::string& name) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);)
      if (line.starts_with(name + ":")) return std::stol(line.substr(name.size() + 1));
    return 0l;
  };
  Profile profile = sample_profile(54'000);
  for (render::FrameRecord& frame : profile.recording.frames) {
    frame.mhz = 1980.0;
    for (const char* const stage : {"decode", "project", "bin", "sort", "blend", "probe"})
      frame.report.spans.push_back(
          {stage, frame.report.spans.back().end_ns, frame.report.spans.back().end_ns + 1000});
  }
  std::ofstream("/proc/self/clear_refs") << "5";  // resets the peak
  const long before = status_kb("VmRSS");
  if (status_kb("VmHWM") > before + 1024) GTEST_SKIP() << "this system does not forget a peak of memory";
  std::size_t bytes = 0;
  const Write count = [&](std::string_view part) { bytes += part.size(); };
  const ProfileSummary summary = summary_of(profile);
  count(html(profile_page(profile, summary, {}), profile_point(profile, summary).row));
  write_trace(profile, count);
  write_frames(profile.recording, count);
  EXPECT_GT(bytes, 100'000'000u);
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer keeps freed memory";
#endif
  const long grown_kb = status_kb("VmHWM") - before;
  RecordProperty("grown_kb", static_cast<int>(grown_kb));
  EXPECT_LT(grown_kb, 200'000);
}

TEST(Profile, PageShowsBudgetReasonsAndPictures) {
  Profile profile = sample_profile();
  profile.pictures.assign(10, Image(4, 3, 3));
  const ProfileSummary summary = summary_of(profile);
  const Page page =
      profile_page(profile, summary,
                   {"wall_ms: median 1 -> 2 (+100.0 %, noise 3.0 %)", "1 of 9 numbers changed beyond noise"});
  std::vector<std::string> ids;
  for (const Section& section : page.sections) ids.push_back(section.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"frames", "stages", "spread", "worst", "bound", "work", "clock",
                                           "changes"}));
  EXPECT_EQ(page.sections[0].numbers->rows[5],
            row(std::size_t{5}, "program compiled: blend.comp", 14.0, 5.0, 10.0));
  EXPECT_EQ(page.sections[1].chart->y, (std::vector<std::string>{"project", "blend"}));
  EXPECT_EQ(page.sections[3].table->rows[0].back(),
            "program compiled: blend.comp; submit took 8.00 ms more than usual");
  EXPECT_EQ(page.sections[3].figures.size(), 10u);
  EXPECT_TRUE(page.sentence.ends_with(" Try " + advice_of(profile, summary) + "."));
  EXPECT_NE(page.sections[6].problem.find("it was not requested"), std::string::npos);
  EXPECT_FALSE(html(page, profile_point(profile, summary).row).empty());
  EXPECT_LE(lines_of(profile, summary).size(), 11u);
  EXPECT_ERROR(summary_of(Profile()), "no frame was recorded");
}

using ProfileInBrowser = test::InChromium;

TEST_F(ProfileInBrowser, HasLinesAreasAndPictures) {
  Profile profile = sample_profile();
  profile.pictures.assign(10, Image(4, 3, 3));
  const ProfileSummary summary = summary_of(profile);
  save_page(file, profile_page(profile, summary, {}), profile_point(profile, summary).row);
  const std::string found =
      ask("return JSON.stringify({alerts: [...document.querySelectorAll('[role=alert]')].map((a) => "
          "a.textContent),"
          "lines: document.querySelectorAll('#frames figure svg g[aria-label=line] path').length,"
          "areas: [...document.querySelectorAll('#stages figure svg g[aria-label=area] path')].map((a) =>"
          "a.getBoundingClientRect().height),"
          "pictures: document.querySelectorAll('#worst img').length,"
          "first: document.querySelector('#worst tbody tr').textContent});");
  const json shown = json::parse(found, nullptr, false);
  ASSERT_TRUE(shown.is_object()) << found;
  EXPECT_EQ(shown["alerts"].size(), 1u) << "only the clock is unknown: " << found;
  EXPECT_EQ(shown["lines"], 3) << "frame, GPU and budget";
  ASSERT_EQ(shown["areas"].size(), 2u) << found;
  EXPECT_GT(shown["areas"][0].get<double>(), 10.0);
  EXPECT_GT(shown["areas"][1].get<double>(), shown["areas"][0].get<double>()) << "blend lies on project";
  EXPECT_EQ(shown["pictures"], 10);
  EXPECT_NE(shown["first"].get<std::string>().find("program compiled: blend.comp"), std::string::npos);
}

}  // namespace
}  // namespace binosplat::lab
