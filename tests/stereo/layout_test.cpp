#include "stereo/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "formats/exr.h"
#include "reference/render.h"
#include "shared/layout.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

using LayOut = std::function<Picture(int layout, const Picture& left, const Picture& right)>;

const std::vector<int> all_layouts = {
    LAYOUT_PARALLEL, LAYOUT_CROSS_EYED, LAYOUT_HALF_WIDTH, LAYOUT_OVER_UNDER,  LAYOUT_HALF_HEIGHT,
    LAYOUT_ROWS,     LAYOUT_COLUMNS,    LAYOUT_ANAGLYPH,   LAYOUT_HALF_COLOUR, LAYOUT_GREY};

Picture over_black(int layout, const Picture& left, const Picture& right) {
  return lay_out(layout, left, right, glm::vec3(0.0f));
}

/// The mean column of what is bright in one channel of a part of a picture, each `step` pixels.
struct Part {
  int x = 0, y = 0, width = 0, height = 0, step_x = 1, step_y = 1, channel = 0;
};
double centre_of_part(const Picture& picture, const Part& part) {
  double sum = 0, weight = 0;
  for (int y = part.y; y < part.y + part.height; y += part.step_y) {
    for (int x = part.x; x < part.x + part.width; x += part.step_x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + x;
      const double v = std::max(0.0f, picture.colour[at][part.channel]);
      sum += v * (x - part.x);
      weight += v;
    }
  }
  return weight > 0 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
}

/// Where a viewer of the layout finds each eye's picture, in the eye's own columns.
struct Seen {
  double left = 0, right = 0;
};
Seen seen(int layout, const Picture& picture, int w, int h) {
  switch (layout) {
    case LAYOUT_PARALLEL:
      return {centre_of_part(picture, {0, 0, w, h}), centre_of_part(picture, {w, 0, w, h})};
    case LAYOUT_CROSS_EYED:  // the right eye looks at the left half
      return {centre_of_part(picture, {w, 0, w, h}), centre_of_part(picture, {0, 0, w, h})};
    case LAYOUT_HALF_WIDTH:
      return {2 * centre_of_part(picture, {0, 0, w / 2, h}) + 0.5,
              2 * centre_of_part(picture, {w / 2, 0, w / 2, h}) + 0.5};
    case LAYOUT_HALF_HEIGHT:
      return {centre_of_part(picture, {0, 0, w, h / 2}), centre_of_part(picture, {0, h / 2, w, h / 2})};
    case LAYOUT_OVER_UNDER:
      return {centre_of_part(picture, {0, 0, w, h}), centre_of_part(picture, {0, h, w, h})};
    case LAYOUT_ROWS:
      return {centre_of_part(picture, {0, 0, w, h, 1, 2}), centre_of_part(picture, {0, 1, w, h - 1, 1, 2})};
    case LAYOUT_COLUMNS:
      return {centre_of_part(picture, {0, 0, w, h, 2, 1}),
              centre_of_part(picture, {1, 0, w - 1, h, 2, 1}) + 1};
    default:  // glasses: red before the left eye, cyan before the right
      return {centre_of_part(picture, {0, 0, w, h, 1, 1, 0}), centre_of_part(picture, {0, 0, w, h, 1, 1, 1})};
  }
}

constexpr int layout_width = 96, layout_height = 64;

/// A white ball 1 m away before a black world, both eyes 63 mm apart: docs/method.md 6 puts it 6.3 px further
/// right in the left eye, at 100 px of focal length. It is small: Dubois takes from each channel what the
/// other eye's light would leak through the glasses, where both balls overlap.
std::vector<Picture> near_object(std::optional<double> convergence) {
  Model model;
  test::add(model, {0, 0, 1}, glm::vec3(0.01f), 0.99f);
  RigSettings settings;
  settings.convergence = convergence;
  const EyePair pair = make_rig(test::front_camera(layout_width, layout_height, 100.0), settings);
  std::vector<Picture> eyes;
  for (const shared::View& view : pair.views) eyes.push_back(reference::render(model, view));
  return eyes;
}

/// Whether a layout shows the object as near as the eyes saw it, to half a pixel.
testing::AssertionResult shows_depth(const LayOut& lay_out_with, int layout, const std::vector<Picture>& eyes,
                                     double disparity) {
  const Seen at = seen(layout, lay_out_with(layout, eyes[0], eyes[1]), layout_width, layout_height);
  const auto text = testing::AssertionResult(std::abs(at.left - at.right - disparity) < 0.5);
  return testing::AssertionResult(text) << layout_choices[layout].name << ": left " << at.left << ", right "
                                        << at.right << ", expected " << disparity << " apart";
}

TEST(Layout, ANearObjectIsNearInEveryLayout) {
  for (const auto& [convergence, disparity] :
       std::vector<std::pair<std::optional<double>, double>>{{{}, 6.3}, {4.0, 6.3 * 0.75}, {0.5, -6.3}}) {
    const std::vector<Picture> eyes = near_object(convergence);
    for (const int layout : all_layouts) {
      EXPECT_TRUE(shows_depth(over_black, layout, eyes, disparity));
      const LayOut swapped = [](int l, const Picture& a, const Picture& b) { return over_black(l, b, a); };
      EXPECT_FALSE(shows_depth(swapped, layout, eyes, disparity)) << "swapped eyes go unnoticed";
      const LayOut twice = [](int l, const Picture& a, const Picture&) { return over_black(l, a, a); };
      EXPECT_FALSE(shows_depth(twice, layout, eyes, disparity)) << "one eye twice goes unnoticed";
    }
  }
}

Picture random_picture(int w, int h, std::uint32_t seed) {
  Picture picture(w, h);
  test::Uniform uniform(seed);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const auto v = [&] { return static_cast<float>(uniform(0, 1)); };
    picture.colour[k] = {v(), v(), v(), v()};
    picture.z_sum[k] = v();
  }
  return picture;
}

/// Whether `a` has the value of `b` at these pixels, depth included.
bool same(const Picture& a, int ax, int ay, const Picture& b, int bx, int by) {
  const auto at = [](const Picture& p, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(x);
  };
  return a.colour[at(a, ax, ay)] == b.colour[at(b, bx, by)] &&
         a.z_sum[at(a, ax, ay)] == b.z_sum[at(b, bx, by)];
}

TEST(Layout, PlacedPixelsKeepColourCoverageAndDepth) {
  const int w = 6, h = 5;
  const Picture left = random_picture(w, h, 1), right = random_picture(w, h, 2);
  const auto all_from = [&](int layout, const auto& source) {
    const Picture out = lay_out(layout, left, right, std::nullopt);
    EXPECT_EQ(glm::ivec2(out.width, out.height), layout_size(layout, {w, h}));
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        if (!source(out, x, y)) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(all_from(LAYOUT_PARALLEL, [&](const Picture& out, int x, int y) {
    return x < w ? same(out, x, y, left, x, y) : same(out, x, y, right, x - w, y);
  }));
  EXPECT_TRUE(all_from(LAYOUT_CROSS_EYED, [&](const Picture& out, int x, int y) {
    return x < w ? same(out, x, y, right, x, y) : same(out, x, y, left, x - w, y);
  }));
  EXPECT_TRUE(all_from(LAYOUT_OVER_UNDER, [&](const Picture& out, int x, int y) {
    return y < h ? same(out, x, y, left, x, y) : same(out, x, y, right, x, y - h);
  }));
  EXPECT_TRUE(all_from(LAYOUT_ROWS, [&](const Picture& out, int x, int y) {
    return same(out, x, y, y % 2 == 0 ? left : right, x, y);
  }));
  EXPECT_TRUE(all_from(LAYOUT_COLUMNS, [&](const Picture& out, int x, int y) {
    return same(out, x, y, x % 2 == 0 ? left : right, x, y);
  }));
  EXPECT_FALSE(all_from(LAYOUT_COLUMNS, [&](const Picture& out, int x, int y) {
    return same(out, x, y, y % 2 == 0 ? left : right, x, y);
  })) << "columns that are rows go unnoticed";
}

TEST(Layout, HalvesAreTheMeansOfTwoColumnsOrRows) {
  const Picture left = random_picture(8, 8, 1), right = random_picture(8, 8, 2);
  for (const int layout : {LAYOUT_HALF_WIDTH, LAYOUT_HALF_HEIGHT}) {
    const Picture out = lay_out(layout, left, right, std::nullopt);
    ASSERT_EQ(glm::ivec2(out.width, out.height), glm::ivec2(8, 8));
    const bool wide = layout == LAYOUT_HALF_WIDTH;
    for (std::size_t y = 0; y < 8; ++y) {
      for (std::size_t x = 0; x < 8; ++x) {
        const Picture& eye = (wide ? x : y) < 4 ? left : right;
        const std::size_t at = wide ? y * 8 + 2 * (x % 4) : 2 * (y % 4) * 8 + x;
        const std::size_t next = at + (wide ? 1 : 8), to = y * 8 + x;
        EXPECT_LT(glm::length(out.colour[to] - 0.5f * (eye.colour[at] + eye.colour[next])), 1e-6f);
        EXPECT_GT(glm::length(out.colour[to] - eye.colour[at]), 1e-6f) << "every other one goes unnoticed";
        EXPECT_NEAR(out.z_sum[to], 0.5f * (eye.z_sum[at] + eye.z_sum[next]), 1e-6);
      }
    }
  }
}

TEST(Layout, AnaglyphsAreWhatTheirSourcesSay) {
  const auto mixed = [](int layout, const glm::vec3& left, const glm::vec3& right) {
    return shared::layout_mix(static_cast<shared::uint>(layout), left, right);
  };
  const glm::vec3 left(0.8f, 0.4f, 0.1f), right(0.2f, 0.6f, 0.9f);
  const float luma = 0.299f * 0.8f + 0.587f * 0.4f + 0.114f * 0.1f;
  const float other = 0.299f * 0.2f + 0.587f * 0.6f + 0.114f * 0.9f;
  EXPECT_LT(glm::length(mixed(LAYOUT_GREY, left, right) - glm::vec3(luma, other, other)), 1e-6f);
  EXPECT_LT(glm::length(mixed(LAYOUT_HALF_COLOUR, left, right) - glm::vec3(luma, 0.6f, 0.9f)), 1e-6f);
  // By hand in double, with exr.h's curve: red of light.
  const auto light = [](float v) { return srgb_to_linear(v); };
  const double red = 0.437 * light(0.8f) + 0.449 * light(0.4f) + 0.164 * light(0.1f) - 0.011 * light(0.2f) -
                     0.032 * light(0.6f) - 0.007 * light(0.9f);
  EXPECT_NEAR(mixed(LAYOUT_ANAGLYPH, left, right).r, linear_to_srgb(red), 1e-5);
  const double plain = 0.437 * 0.8 + 0.449 * 0.4 + 0.164 * 0.1 - 0.011 * 0.2 - 0.032 * 0.6 - 0.007 * 0.9;
  EXPECT_GT(std::abs(mixed(LAYOUT_ANAGLYPH, left, right).r - plain), 0.01)
      << "display values taken for light go unnoticed";
  // Grey of both eyes stays grey, to the third digit of the matrix.
  for (const float grey : {0.0f, 0.3f, 1.0f}) {
    for (const int layout : {LAYOUT_ANAGLYPH, LAYOUT_HALF_COLOUR, LAYOUT_GREY}) {
      EXPECT_LT(glm::length(mixed(layout, glm::vec3(grey), glm::vec3(grey)) - grey), 5e-3f) << layout;
    }
  }
}

TEST(Layout, MixedColoursStandBeforeTheBackground) {
  Picture nothing(2, 1);
  const glm::vec3 background(0.2f, 0.5f, 0.7f);
  const Picture out = lay_out(LAYOUT_HALF_COLOUR, nothing, nothing, background);
  EXPECT_NEAR(out.colour[0].g, 0.5, 1e-6);
  EXPECT_EQ(out.colour[0].a, 0.0f);
  EXPECT_EQ(composite(out, glm::vec3(1.0f)).at(0, 0, 2), 0.7f) << "the background came in twice";
}

TEST(Layout, WhatCannotBeIsRefused) {
  const Picture a(6, 4), b(6, 5), odd(5, 4);
  EXPECT_TRUE(test::fails_saying([&] { lay_out(LAYOUT_PARALLEL, a, b, {}); },
                                 {"--layout parallel", "6 x 4", "6 x 5", "separate"}));
  EXPECT_TRUE(test::fails_saying([&] { lay_out(LAYOUT_GREY, a, a, {}); }, {"grey", "--background"}));
  EXPECT_TRUE(test::fails_saying([&] { lay_out(LAYOUT_HALF_WIDTH, odd, odd, {}); }, {"5 px", "even width"}));
  EXPECT_TRUE(test::fails_saying([&] { lay_out(LAYOUT_HALF_HEIGHT, b, b, {}); }, {"5 px", "even height"}));
}

}  // namespace
}  // namespace binosplat::stereo
