#include "lab/motion_numbers.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

#include "lab/settings.h"

namespace binosplat::lab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

MovedFrame frame(double left, double right, double told, double pairs = 50.0) {
  return {.view_db = {left, right},
          .reported_db = told,
          .pairs = pairs,
          .exact_pairs = 100.0,
          .tolerance = 0.1,
          .ms = 2.0};
}

/// A segment of so many frames, without views.
MotionSegment segment(std::size_t lead, std::size_t moving, std::size_t stop) {
  return {std::vector<std::vector<shared::View>>(lead + moving + stop), lead, stop};
}

TEST(MotionNumbers, SayWhatSeriesComeTo) {
  std::vector<MovedFrame> frames;
  for (int n = 0; n < 8; ++n) frames.push_back(frame(41.0 + n, 40.0 + n, 40.0 + n));
  frames.push_back(frame(36.0, 45.0, 39.0, 90.0));
  frames.push_back(frame(infinity, infinity, infinity, 10.0));
  frames.back().drawn = 2;
  frames.back().ms = 12.0;
  const MotionSummary s = summary_of(frames);
  EXPECT_EQ(s.frames, 10u);
  EXPECT_DOUBLE_EQ(s.true_db, (8 * 40.0 + 28.0 + 36.0 + equal_db) / 10.0)
      << "the worse eye's; equal ones capped";
  EXPECT_EQ(s.tenth_db, 36.0);
  EXPECT_EQ(s.worst_db, 36.0);
  EXPECT_DOUBLE_EQ(s.reported_beyond, 0.3);
  EXPECT_EQ(s.reported_worst, 3.0);
  EXPECT_EQ(s.pairs, 50.0);
  EXPECT_DOUBLE_EQ(s.removed, 0.5);
  EXPECT_EQ(s.ms, 3.0);
  EXPECT_EQ(s.once_ms, 2.0) << "without the one that was drawn twice";
  EXPECT_EQ(s.most_ms, 12.0);
  EXPECT_EQ(s.equal, 1u);
  EXPECT_EQ(s.drawn, 1.1);
  // Nothing that is not finite gets out.
  const nlohmann::ordered_json json = to_json(MovedFrames{frames});
  EXPECT_EQ(json.dump().find("null"), std::string::npos);
  EXPECT_EQ(json[0]["true_db"][9], equal_db);
  EXPECT_EQ(json[0]["told_db"][9], equal_db);
  EXPECT_EQ(json[0]["view_db"][9], nlohmann::ordered_json({equal_db, equal_db}));
  EXPECT_EQ(json[0]["pairs_removed"][8], 1.0 - 0.9);
  EXPECT_EQ(json[0]["drawn"][9], 2);
  EXPECT_EQ(to_json(s)["told_minus_true_farthest_db"], 3.0);
}

TEST(MotionNumbers, ATellerWhoSaysTooLittleIsFarOffToo) {
  const MotionSummary s = summary_of(std::vector{frame(44.0, 45.0, 39.0), frame(40.0, 41.0, 42.0)});
  EXPECT_EQ(s.reported_worst, -5.0);
  EXPECT_EQ(s.reported_beyond, -1.5);
}

TEST(MotionNumbers, OfNoFramesAreNone) {
  const MotionSummary s = summary_of({});
  EXPECT_EQ(s.frames, 0u);
  EXPECT_EQ(s.removed, 0.0);
}

TEST(MotionNumbers, PartsAreOfEverySegment) {
  const MotionPath path{"", "", {segment(1, 2, 1), segment(0, 1, 2)}};
  MovedFrames frames(2);
  for (int n = 0; n < 4; ++n) frames[0].push_back(frame(n, n, 0));
  for (int n = 4; n < 7; ++n) frames[1].push_back(frame(n, n, 0));
  const auto db = [&](MotionPart part) {
    std::vector<double> values;
    for (const MovedFrame& one : frames_of(path, frames, part)) values.push_back(one.true_db());
    return values;
  };
  EXPECT_EQ(db(MotionPart::lead), (std::vector<double>{0}));
  EXPECT_EQ(db(MotionPart::moving), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(db(MotionPart::stop), (std::vector<double>{3, 5, 6}));
}

TEST(MotionPaths, StretchesAreSpreadEvenly) {
  using Starts = std::vector<std::size_t>;
  EXPECT_EQ(stretch_starts(100, 10, 4), (Starts{0, 30, 60, 90}));
  EXPECT_EQ(stretch_starts(100, 10, 1), (Starts{45}));
  EXPECT_EQ(stretch_starts(25, 10, 3), (Starts{0, 15})) << "a third would overlap";
  EXPECT_EQ(stretch_starts(10, 10, 3), (Starts{0}));
  EXPECT_EQ(stretch_starts(7, 10, 3), (Starts{0})) << "shorter than one";
}

TEST(MotionPaths, SegmentsEndInAStop) {
  std::vector<std::vector<shared::View>> frames(10, std::vector<shared::View>(2));
  for (std::size_t n = 0; n < 10; ++n) frames[n][0].width = static_cast<std::uint32_t>(n);
  const MotionSegment some = segment_of(frames, {.lead = 3, .moving = 99, .stop = 2});
  EXPECT_EQ(some.moving(), 7u);
  ASSERT_EQ(some.frames.size(), 12u);
  EXPECT_EQ(some.frames[11][0].width, 9u);
  frames.resize(3);
  const MotionSegment few = segment_of(frames, {.lead = 12, .moving = 60, .stop = 1});
  EXPECT_EQ(few.lead, 1u);
  EXPECT_EQ(few.moving(), 2u);
  const MotionSegment still = still_segment(frames[2], {.lead = 2, .moving = 3, .stop = 9});
  EXPECT_EQ(still.frames.size(), 5u);
  EXPECT_EQ(still.moving(), 3u);
  EXPECT_EQ(still.frames[4][0].width, 2u);
}

/// Searches, and checks that what is said of the search is so.
FoundRequest search(const std::function<double(double)>& value, double target, double start) {
  int asked = 0;
  const FoundRequest found = find_request(
      [&](double request) {
        ++asked;
        return value(request);
      },
      {.target = target, .start = start, .start_value = value(start)});
  EXPECT_EQ(found.evaluations, asked);
  EXPECT_EQ(found.value, value(found.request));
  EXPECT_EQ(found.reached, std::abs(found.value - target) <= 0.1);
  return found;
}

TEST(FindRequest, FindsWhatComesToTheTarget) {
  EXPECT_EQ(search([](double x) { return x; }, 40.0, 40.0).evaluations, 0);
  EXPECT_EQ(search([](double x) { return x - 3.5; }, 40.0, 40.0).evaluations, 1);
  for (const double start : {30.0, 40.0, 55.0}) {
    SCOPED_TRACE(start);
    // Errors that grow with the request, an answer by steps, and one that wavers.
    const auto slow = search([](double x) { return 20.0 + 0.5 * x; }, 40.0, start);
    EXPECT_TRUE(slow.reached);
    EXPECT_LE(slow.evaluations, 4);
    EXPECT_TRUE(search([](double x) { return 45.0 - 300.0 / x; }, 38.0, start).reached);
    EXPECT_TRUE(search([](double x) { return std::round(12.0 * (x - 2.0)) / 12.0; }, 40.0, start).reached);
    EXPECT_TRUE(search([](double x) { return x - 2.0 + 0.3 * std::sin(3.0 * x); }, 40.0, start).reached);
  }
}

TEST(FindRequest, EndsWhereThereIsNone) {
  EXPECT_FALSE(search([](double) { return 100.0; }, 40.0, 40.0).reached);
  EXPECT_FALSE(search([](double) { return 20.0; }, 40.0, 40.0).reached);
  const FoundRequest jump = search([](double x) { return x < 41.0 ? 30.0 : 47.0; }, 40.0, 40.0);
  EXPECT_FALSE(jump.reached);
  EXPECT_EQ(jump.value, 47.0) << "the nearest that was seen";
  EXPECT_LE(jump.evaluations, 8);
}

}  // namespace
}  // namespace binosplat::lab
