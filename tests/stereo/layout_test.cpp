#include "stereo/layout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "formats/pictures/exr.h"
#include "shared/layout.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

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

/// Returns whether `a` equals `b` at these pixels, in colour and depth.
bool same(const Picture& a, int ax, int ay, const Picture& b, int bx, int by) {
  const auto at = [](const Picture& p, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) + static_cast<std::size_t>(x);
  };
  return a.colour[at(a, ax, ay)] == b.colour[at(b, bx, by)] &&
         a.z_sum[at(a, ax, ay)] == b.z_sum[at(b, bx, by)];
}

TEST(Layout, PlacementKeepsColourCoverageAndDepth) {
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

TEST(Layout, HalvesAveragePixelPairs) {
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

TEST(Layout, AnaglyphsMatchSources) {
  const auto mixed = [](int layout, const glm::vec3& left, const glm::vec3& right) {
    return shared::layout_mix(static_cast<shared::uint>(layout), left, right);
  };
  const glm::vec3 left(0.8f, 0.4f, 0.1f), right(0.2f, 0.6f, 0.9f);
  const float luma = 0.299f * 0.8f + 0.587f * 0.4f + 0.114f * 0.1f;
  const float other = 0.299f * 0.2f + 0.587f * 0.6f + 0.114f * 0.9f;
  EXPECT_LT(glm::length(mixed(LAYOUT_GREY, left, right) - glm::vec3(luma, other, other)), 1e-6f);
  EXPECT_LT(glm::length(mixed(LAYOUT_HALF_COLOUR, left, right) - glm::vec3(luma, 0.6f, 0.9f)), 1e-6f);
  // Computed in double, with exr.h's curve: the red of linear light.
  const auto light = [](float v) { return srgb_to_linear(v); };
  const double red = 0.437 * light(0.8f) + 0.449 * light(0.4f) + 0.164 * light(0.1f) - 0.011 * light(0.2f) -
                     0.032 * light(0.6f) - 0.007 * light(0.9f);
  EXPECT_NEAR(mixed(LAYOUT_ANAGLYPH, left, right).r, linear_to_srgb(red), 1e-5);
  const double plain = 0.437 * 0.8 + 0.449 * 0.4 + 0.164 * 0.1 - 0.011 * 0.2 - 0.032 * 0.6 - 0.007 * 0.9;
  EXPECT_GT(std::abs(mixed(LAYOUT_ANAGLYPH, left, right).r - plain), 0.01)
      << "display values taken for light go unnoticed";
  // Grey in both eyes stays grey, to the three digits of the matrix.
  for (const float grey : {0.0f, 0.3f, 1.0f}) {
    for (const int layout : {LAYOUT_ANAGLYPH, LAYOUT_HALF_COLOUR, LAYOUT_GREY}) {
      EXPECT_LT(glm::length(mixed(layout, glm::vec3(grey), glm::vec3(grey)) - grey), 5e-3f) << layout;
    }
  }
}

TEST(Layout, MixesOverBackground) {
  Picture white(1, 1), black(1, 1);
  white.colour[0] = {1, 1, 1, 0};
  black.colour[0] = {0, 0, 0, 0};
  for (const int layout : {LAYOUT_ANAGLYPH, LAYOUT_HALF_COLOUR, LAYOUT_GREY}) {
    const glm::vec4 mixed = lay_out(layout, white, black, glm::vec3(0.0f)).colour[0];
    EXPECT_GT(mixed.r, mixed.g + 0.5f) << layout << ": swapped eyes go unnoticed";
  }
  Picture nothing(2, 1);
  const glm::vec3 background(0.2f, 0.5f, 0.7f);
  const Picture out = lay_out(LAYOUT_HALF_COLOUR, nothing, nothing, background);
  EXPECT_NEAR(out.colour[0].g, 0.5, 1e-6);
  EXPECT_EQ(out.colour[0].a, 0.0f);
  EXPECT_EQ(composite(out, glm::vec3(1.0f)).at(0, 0, 2), 0.7f) << "the background came in twice";
}

TEST(Layout, RejectsInvalidSizes) {
  const Picture a(6, 4), b(6, 5), odd(5, 4);
  EXPECT_ERROR(lay_out(LAYOUT_PARALLEL, a, b, {}), "`layout` parallel", "6 x 4", "6 x 5", "separate");
  EXPECT_ERROR(lay_out(LAYOUT_GREY, a, a, {}), "grey", "give a background");
  EXPECT_ERROR(lay_out(LAYOUT_HALF_WIDTH, odd, odd, {}), "5 px", "even width");
  EXPECT_ERROR(lay_out(LAYOUT_HALF_HEIGHT, b, b, {}), "5 px", "even height");
}

}  // namespace
}  // namespace binosplat::stereo
