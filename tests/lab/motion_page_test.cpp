#include "lab/motion_page.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace binosplat::lab {
namespace {

/// Two stretches of one lead, two moving and one stop frame at such dB.
MovedPass pass(float request, double db, double pairs, double ms, bool stops = true) {
  MovedPass made{request, {}, {}, {}, {}};
  for (int s = 0; s < 2; ++s) {
    auto& frames = made.frames.emplace_back();
    for (int n = 0; n < (stops ? 4 : 3); ++n) {
      frames.push_back({.view_db = {db + s, db + 5.0},
                        .reported_db = 40.0,
                        .pairs = pairs,
                        .exact_pairs = 4e6,
                        .tolerance = 0.1,
                        .ms = ms});
    }
  }
  const auto summary = [&](std::size_t begin, std::size_t end) {
    std::vector<MovedFrame> some;
    for (const auto& frames : made.frames) {
      for (std::size_t n = begin; n < std::min(end, frames.size()); ++n) some.push_back(frames[n]);
    }
    return summary_of(some);
  };
  made.lead = summary(0, 1);
  made.moving = summary(1, 3);
  made.stop = summary(3, 4);
  return made;
}

MotionPath path_named(const std::string& name) {
  const MotionSegment segment{std::vector<std::vector<shared::View>>(4), 1, 1};
  return {name, "1.5 m/s", {segment, segment}};
}

MotionStudy motion_results(bool compared = true) {
  MotionStudy study{.device = "llvmpipe",
                    .scene = "fox",
                    .gaussians = 1000,
                    .eyes = 2,
                    .width = 64,
                    .height = 48,
                    .frames_per_second = 90.0,
                    .units_per_metre = 0.25,
                    .metre_source = "--units-per-metre"};
  for (const char* name : {"calm", "walk"}) {
    const bool walk = std::string(name) == "walk";
    MotionResult result{path_named(name), pass(0.0f, 100.0, 4e6, 4.0), {}};
    result.rules.push_back({Rule{}, pass(40.0f, 39.5, 2e6, 2.0)});
    result.rules.push_back(
        {Rule{.transmittance = TRANSMITTANCE_LAST}, pass(40.0f, walk ? 36.0 : 38.0, 1e6, 1.0)});
    for (MovedRule& rule : result.rules) {
      rule.compared = compared;
      if (compared) rule.equal = pass(42.5f, 39.5, walk ? 3e6 : 1.5e6, walk ? 3.0 : 1.5, false);
    }
    study.paths.push_back(std::move(result));
  }
  return study;
}

TEST(MotionPage, SaysWhoKeepsTheirWordAndWhatThatTakes) {
  const MotionStudy study = motion_results();
  const Page page = motion_page(study);
  ASSERT_EQ(page.sections.size(), 2u + 2 * 3);
  // 39.5 and 40.5 dB in the two stretches: just what was asked for, and 2 or 4 dB less.
  EXPECT_NE(page.sentence.find(
                "“squared, last” falls farthest below: its moving frames come to 36.5 dB in the mean (walk)"),
            std::string::npos)
      << page.sentence;
  const Table& words = *page.sections[0].table;
  EXPECT_EQ(words.columns[2], "walk: true dB");
  EXPECT_EQ(words.rows[1][0], "squared, last");
  EXPECT_EQ(words.rows[1][2], 36.5);
  EXPECT_EQ(words.rows[1][6], 3.5) << "reported minus true, walk";
  const Table& gains = *page.sections[1].table;
  EXPECT_EQ(gains.columns[1], "calm: ms of `one`");
  EXPECT_EQ(gains.rows[1], row("squared, last", 1.0, 1.0, 1.0, 1.0, 0.375, 0.75));
}

TEST(MotionPage, DrawsEveryFrame) {
  const Page page = motion_page(motion_results());
  EXPECT_EQ(page.sections[5].id, "asked-walk");
  EXPECT_NE(page.sections[5].sentence.find(
                "2 stretches of 2 frames, after 1 to find a tolerance, then a stop of 1"),
            std::string::npos)
      << page.sections[5].sentence;
  const Table& quality = *page.sections[5].numbers;
  EXPECT_EQ(quality.columns,
            (std::vector<std::string>{"frame", "part", "squared, one: true dB", "squared, one: reported dB",
                                      "squared, last: true dB", "squared, last: reported dB"}));
  ASSERT_EQ(quality.rows.size(), 8u);
  EXPECT_EQ(quality.rows[3], row(3, "stretch 1, stop", 39.5, 40.0, 36.0, 40.0));
  EXPECT_EQ(quality.rows[4], row(4, "stretch 2, lead", 40.5, 40.0, 37.0, 40.0));
  EXPECT_EQ(page.sections[6].numbers->rows[7], row(7, "stretch 2, stop", 4.0, 2.0, 1.0));
  EXPECT_EQ(page.sections[6].table->rows[1][1], 42.5);
  EXPECT_EQ(page.sections[7].numbers->rows[2][3], 2.0);
  EXPECT_NE(html(page, {}).find("stretch 2, lead"), std::string::npos);
}

TEST(MotionPage, TablesNameWhatWasMeasured) {
  const MotionStudy study = motion_results();
  const Table asked = asked_table(study.paths[0]);
  ASSERT_EQ(asked.rows.size(), 3u);
  EXPECT_EQ(asked.rows[0][0], "exact");
  EXPECT_EQ(asked.rows[2][9], 1.0);    // M pairs
  EXPECT_EQ(asked.rows[2][10], 75.0);  // removed %
  EXPECT_EQ(asked.rows[2][14], 0.5);   // of `one`
  for (const auto& row : asked.rows) EXPECT_EQ(row.size(), asked.columns.size());
}

TEST(MotionPage, WhatDoesNotComeToTheTargetSaysWhy) {
  MotionStudy study = motion_results();
  for (MotionResult& path : study.paths) path.rules[1].problem = "not within 0.1 dB of 40 dB";
  EXPECT_EQ(motion_page(study).sections[1].table->rows[1].back(), "not within 0.1 dB of 40 dB");
}

TEST(MotionPage, WithoutAComparisonSaysSo) {
  const MotionStudy study = motion_results(false);
  EXPECT_TRUE(target_table(study.paths[0]).rows.empty());
  const Page page = motion_page(study);
  EXPECT_NE(page.sections[1].problem.find("--no-equal"), std::string::npos);
  EXPECT_FALSE(page.sections[3].table);
  EXPECT_FALSE(html(page, {}).empty());
}

}  // namespace
}  // namespace binosplat::lab
