// Bands of a picture that take equally long.
#include "formats/look_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace binosplat {
namespace {

/// Looks at a picture, and at another like it, whose bands take so long; the longest of them, ms.
double look(LookBands& bands, const std::function<double(const Band&)>& ms) {
  double longest = 0.0;
  for (int picture = 0; picture < 2; ++picture) {
    EXPECT_TRUE(bands.is_first());
    double end = 0.0;
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
  }
  return longest;
}

/// Of a picture that takes 2 ms in any band, and so many in all a narrow part of it.
double at_horizon(const Band& band, double ms) {
  constexpr double begin = 0.45, end = 0.55;
  return 2.0 + ms * std::max(0.0, std::min(end, band.end) - std::max(begin, band.begin)) / (end - begin);
}

TEST(LookBands, AreOneWhereThatIsFast) {
  LookBands bands;
  EXPECT_TRUE(bands.next().is_all());
  for (int n = 0; n < 3; ++n) {
    look(bands, [](const Band&) { return 4.4; });
    bands.divide(8);
    EXPECT_TRUE(bands.next().is_all());
  }
}

TEST(LookBands, TakeEquallyLong) {
  LookBands bands;
  std::vector<double> longest;
  for (int n = 0; n < 8; ++n) {
    longest.push_back(look(bands, [](const Band& band) { return at_horizon(band, 8.0); }));
    bands.divide(100);
  }
  EXPECT_EQ(longest[0], 10.0);
  EXPECT_GT(longest[1], 5.9) << "planted: equally wide";
  for (int n = 4; n < 8; ++n) EXPECT_LT(longest[static_cast<std::size_t>(n)], 4.5) << n;
  EXPECT_EQ(bands.count(), 4) << "as many as a frame has time for";
  look(bands, [](const Band& band) { return at_horizon(band, 8.0); });
  bands.divide(3);
  EXPECT_EQ(bands.count(), 3);
  look(bands, [](const Band&) { return 0.5; });
  bands.divide(8);
  EXPECT_TRUE(bands.next().is_all()) << "when it is fast again";
}

// Nor does a frame that something else held up, nor a band that is too narrow to show anything.
TEST(LookBands, GoByWhatTheyTakeThemselves) {
  for (const bool held_up : {false, true}) {
    LookBands bands;
    look(bands, [](const Band&) { return 34.0; });
    bands.divide(8);
    ASSERT_EQ(bands.count(), 8);
    for (int picture = 0; picture < 2; ++picture) {
      for (int k = 0; k < 8; ++k) {
        const double ms = k == 3 ? 0.3 : k == 4 ? 16.0 : 5.0;
        bands.note(held_up && picture == k % 2 ? 40.0 : ms);
      }
    }
    bands.divide(8);
    std::vector<Band> all;
    look(bands, [&](const Band& band) {
      all.push_back(band);
      return 1.0;
    });
    EXPECT_EQ(std::ranges::count_if(all, [](const Band& b) { return b.begin > 0.49 && b.end < 0.63; }), 2 * 2)
        << held_up;
  }
}

// More bands do not help where each takes long whatever it shows.
TEST(LookBands, AreFewWhereMoreDoNotHelp) {
  LookBands bands;
  for (int n = 0; n < 6; ++n) {
    look(bands, [](const Band& band) { return 5.0 + 0.6 * (band.end - band.begin); });
    bands.divide(8);
    EXPECT_LE(bands.count(), 2) << n << ", planted: as if all depended on pixels";
  }
}

// What was found of half a picture is found again.
TEST(LookBands, StartAgain) {
  LookBands bands;
  look(bands, [](const Band&) { return 20.0; });
  bands.divide(4);
  ASSERT_EQ(bands.count(), 4);
  const Band first = bands.next();
  bands.note(1.0);
  EXPECT_FALSE(bands.is_first());
  bands.start_again();
  EXPECT_TRUE(bands.is_first());
  EXPECT_EQ(bands.next().end, first.end);
}

}  // namespace
}  // namespace binosplat
