// Bands of a picture that take equally long.
#include "stream/look_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace binosplat {
namespace {

/// Of 90 degrees, turned to the right by so many.
shared::View turned_by(double degrees) {
  const auto turn = static_cast<float>(glm::radians(degrees));
  shared::View view{};
  view.row_x = {std::cos(turn), 0, -std::sin(turn), 0};
  view.row_y = {0, 1, 0, 0};
  view.row_z = {std::sin(turn), 0, std::cos(turn), 0};
  view.width = view.height = 1000;
  view.lens = {500, 500, 500, 500};
  return view;
}

using Ms = std::function<double(const Band&)>;

/// Looks at a picture whose bands take so long; the longest of them, ms.
double look_once(LookBands& bands, const shared::View& view, const Ms& ms) {
  double longest = 0.0, end = 0.0;
  EXPECT_TRUE(bands.is_first());
  bands.begin(view, 4.5);
  for (bool is_last = false; !is_last;) {
    const Band band = bands.next();
    EXPECT_EQ(band.begin, end) << "side by side";
    EXPECT_GT(band.end, band.begin);
    end = band.end;
    const double took_ms = ms(band);
    longest = std::max(longest, took_ms);
    is_last = bands.note(took_ms);
  }
  EXPECT_EQ(end, 1.0);
  return longest;
}

/// The same of another like it, too.
double look(LookBands& bands, const Ms& ms) {
  const double first = look_once(bands, turned_by(0), ms);
  return std::max(first, look_once(bands, turned_by(0), ms));
}

/// Of a picture that takes 2 ms in any band, and so many in all a narrow part of it.
double at_horizon(const Band& band, double ms, double turned = 0.0) {
  const auto column = [&](double degrees) { return 0.5 + 0.5 * std::tan(glm::radians(degrees - turned)); };
  const double begin = column(-5.7), end = column(5.7);
  return 2.0 + ms * std::max(0.0, std::min(end, band.end) - std::max(begin, band.begin)) / (end - begin);
}

TEST(LookBands, AreOneWhereThatIsFast) {
  LookBands bands;
  EXPECT_TRUE(bands.next().is_all());
  for (int n = 0; n < 3; ++n) {
    look(bands, [](const Band&) { return 4.4; });
    EXPECT_EQ(bands.count(), 1);
    bands.allow(8);
  }
}

TEST(LookBands, TakeEquallyLong) {
  LookBands bands;
  std::vector<double> longest;
  for (int n = 0; n < 8; ++n) {
    longest.push_back(look(bands, [](const Band& band) { return at_horizon(band, 8.0); }));
    bands.allow(100);
  }
  EXPECT_EQ(longest[0], 10.0);
  EXPECT_GT(longest[1], 5.9) << "planted: equally wide";
  for (int n = 4; n < 8; ++n) EXPECT_LT(longest[static_cast<std::size_t>(n)], 4.5) << n;
  EXPECT_EQ(bands.count(), 4) << "as many as a frame has time for";
  bands.allow(3);
  look(bands, [](const Band& band) { return at_horizon(band, 8.0); });
  EXPECT_EQ(bands.count(), 3);
  bands.allow(8);
  look(bands, [](const Band&) { return 0.5; });
  EXPECT_EQ(bands.count(), 1) << "when it is fast again";
}

// What takes long is elsewhere in the picture then.
TEST(LookBands, TurnWithTheHead) {
  const auto longest = [](bool turns) {
    LookBands bands;
    bands.allow(8);
    double most = 0.0;
    for (int n = 0; n < 24; ++n) {
      const double degrees = -30.0 + 2.5 * n;
      const double ms = look_once(bands, turned_by(turns ? degrees : 0.0),
                                  [&](const Band& band) { return at_horizon(band, 16.0, degrees); });
      if (n >= 6) most = std::max(most, ms);
    }
    return most;
  };
  EXPECT_LT(longest(true), 7.0);
  EXPECT_GT(longest(false), 9.0) << "planted: as if it stayed where it was";
}

// A frame that something else held up counts for one picture only, a band that is too narrow to show anything
// not at all.
TEST(LookBands, GoByWhatTheyTakeThemselves) {
  for (const bool held_up : {false, true}) {
    LookBands bands;
    bands.allow(8);
    look(bands, [](const Band&) { return 34.0; });
    int k = 0;
    if (held_up) look_once(bands, turned_by(0), [&](const Band&) { return k++ == 1 ? 40.0 : 5.0; });
    const auto once = [&](const Band& band) {
      return band.end - band.begin < 0.01 ? 0.3 : at_horizon(band, 16.0);
    };
    for (int n = 0; n < 2; ++n) look_once(bands, turned_by(0), once);
    EXPECT_LT(look_once(bands, turned_by(0), once), 7.0) << held_up;
  }
}

// More bands do not help where each takes long whatever it shows.
TEST(LookBands, AreFewWhereMoreDoNotHelp) {
  LookBands bands;
  for (int n = 0; n < 6; ++n) {
    look(bands, [](const Band& band) { return 5.0 + 0.6 * (band.end - band.begin); });
    EXPECT_LE(bands.count(), 2) << n << ", planted: as if all depended on pixels";
    bands.allow(8);
  }
}

// What was found of half a picture is found again.
TEST(LookBands, StartAgain) {
  LookBands bands;
  bands.allow(4);
  look_once(bands, turned_by(0), [](const Band&) { return 20.0; });
  bands.begin(turned_by(0), 4.5);
  ASSERT_EQ(bands.count(), 4);
  const Band first = bands.next();
  bands.note(1.0);
  EXPECT_FALSE(bands.is_first());
  bands.start_again();
  EXPECT_TRUE(bands.is_first());
  bands.begin(turned_by(0), 4.5);
  EXPECT_EQ(bands.next().end, first.end);
}

}  // namespace
}  // namespace binosplat
