// Debug views: their colours, their range, and the exact pictures with which they compare.

#include "stereo/debug_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

#include "reference/render.h"
#include "stereo/disagreement.h"
#include "stereo/rig.h"
#include "support/errors.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

constexpr int shown_width = 64, shown_height = 40;

struct ShowTest : testing::Test {
  const Model model = test::random_model(9, 400, 0, 0.6);
  const EyePair pair =
      make_rig(test::front_camera(shown_width, shown_height, 55.0), {.ipd = 0.2, .convergence = 2.0});
  const render::FrameSettings coarse = {{.tolerance = 3.0f, .threshold = Threshold::squared}};
  render::Frame frame{test::gl_context(), model};
  DebugView show{frame.model()};
  std::vector<Picture> pictures, exact;

  ShowTest() {
    frame.draw(pair.views);
    exact = frame.read_pictures();
    frame.draw(pair.views, coarse);
    pictures = frame.read_pictures();
  }

  DebugPictures made(int what, double split = 0.5) {
    return show.make(what, {frame, pair.views, pictures, coarse}, glm::vec3(0.0f), split);
  }
  /// Returns the colour that shows a number.
  static glm::vec3 colour(double number, double most) {
    return map_colour(static_cast<float>(number / most));
  }
};

TEST(MapColour, IsMonotonicViridis) {
  const auto lightness = [](const glm::vec3& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; };
  for (int k = 0; k < 255; ++k) {
    EXPECT_LT(lightness(map_colour(static_cast<float>(k) / 255.0f)),
              lightness(map_colour(static_cast<float>(k + 1) / 255.0f)));
  }
  // Numbers from matplotlib.
  EXPECT_LT(glm::length(map_colour(0.0f) - glm::vec3(0.267f, 0.005f, 0.329f)), 0.02f);
  EXPECT_LT(glm::length(map_colour(0.5f) - glm::vec3(0.128f, 0.567f, 0.551f)), 0.02f);
  EXPECT_LT(glm::length(map_colour(1.0f) - glm::vec3(0.993f, 0.906f, 0.144f)), 0.02f);
  EXPECT_EQ(map_colour(7.0f), map_colour(1.0f));
}

TEST_F(ShowTest, ReturnsPictureUnchanged) {
  EXPECT_TRUE(same_bits(made(SHOW_PICTURE).pictures, pictures));
  EXPECT_FALSE(made(SHOW_PICTURE).max);
}

TEST_F(ShowTest, SplitShowsDrawnAndExact) {
  EXPECT_TRUE(same_bits(made(SHOW_SPLIT, 1.0).pictures, pictures));
  EXPECT_TRUE(same_bits(made(SHOW_SPLIT, 0.0).pictures, exact));
  EXPECT_FALSE(same_bits(pictures, exact)) << "this tolerance changes nothing";
  const std::vector<Picture> middle = made(SHOW_SPLIT, 0.25).pictures;
  for (std::size_t v = 0; v < 2; ++v) {
    for (int y = 0; y < shown_height; ++y) {
      for (int x = 0; x < shown_width; ++x) {
        const auto k = static_cast<std::size_t>(y) * shown_width + x;
        ASSERT_EQ(middle[v].colour[k], (x < 16 ? pictures : exact)[v].colour[k]) << x << " " << y;
      }
    }
  }
}

TEST_F(ShowTest, MapsColourNumbers) {
  const auto matches = [&](int what, const std::vector<Image>& numbers) {
    const DebugPictures shown = made(what);
    int off = 0;
    for (std::size_t v = 0; v < 2; ++v) {
      for (std::size_t k = 0; k < numbers[v].data.size(); ++k) {
        const float number = numbers[v].data[k];
        const glm::vec4 expected =
            number < 0.0f ? glm::vec4(0, 0, 0, 1) : glm::vec4(colour(number, *shown.max), 0.0f);
        off += glm::length(shown.pictures[v].colour[k] - expected) > 1e-3f ? 1 : 0;
      }
    }
    return off == 0;
  };
  std::vector<Image> depth, difference, swapped;
  for (std::size_t v = 0; v < 2; ++v) {
    depth.push_back(depth_map(pictures[v]));
    for (float& z : depth[v].data) z = std::isfinite(z) ? z : -1.0f;
    Image& error = difference.emplace_back(shown_width, shown_height, 1);
    for (std::size_t k = 0; k < error.data.size(); ++k) {
      for (int c = 0; c < 3; ++c) {
        error.data[k] =
            std::max(error.data[k], 255.0f * std::abs(pictures[v].colour[k][c] - exact[v].colour[k][c]));
      }
    }
  }
  EXPECT_TRUE(matches(SHOW_DEPTH, depth));
  EXPECT_TRUE(matches(SHOW_DIFFERENCE, difference));
  const std::vector<Image> pairs = frame.read_debug_view(SHOW_PAIRS);
  EXPECT_TRUE(matches(SHOW_PAIRS, pairs));
  render::Frame exact_frame(test::gl_context(), model);
  exact_frame.draw(pair.views);
  std::vector<Image> left_out = exact_frame.read_debug_view(SHOW_PAIRS);
  for (std::size_t v = 0; v < 2; ++v)
    std::ranges::transform(left_out[v].data, pairs[v].data, left_out[v].data.begin(), std::minus<>());
  EXPECT_TRUE(matches(SHOW_LEFT_OUT, left_out));
  std::swap(depth[0], depth[1]);
  EXPECT_FALSE(matches(SHOW_DEPTH, depth)) << "swapped eyes go unnoticed";
  EXPECT_FALSE(matches(SHOW_DEPTH, difference)) << "other numbers go unnoticed";
}

TEST_F(ShowTest, DisagreementIsPerEye) {
  const DebugPictures shown = made(SHOW_DISAGREEMENT);
  const auto expected = [&](std::size_t eye) {
    const std::array from = {exact[eye], exact[1 - eye]}, to = {pictures[eye], pictures[1 - eye]};
    return disagreement({pair.views[eye], pair.views[1 - eye]}, from, to).picture;
  };
  for (std::size_t v = 0; v < 2; ++v) {
    int off = 0, other = 0;
    for (int y = 0; y < shown_height; ++y) {
      for (int x = 0; x < shown_width; ++x) {
        const auto worst = [&](const Image& e) {
          return 255.0 * std::max({e.at(x, y, 0), e.at(x, y, 1), e.at(x, y, 2)});
        };
        const glm::vec3 seen(shown.pictures[v].colour[static_cast<std::size_t>(y) * shown_width + x]);
        off += glm::length(seen - colour(worst(expected(v)), *shown.max)) > 1e-3f ? 1 : 0;
        other += glm::length(seen - colour(worst(expected(1 - v)), *shown.max)) > 1e-3f ? 1 : 0;
      }
    }
    EXPECT_EQ(off, 0);
    EXPECT_GT(other, 20) << "the other eye's goes unnoticed";
  }
  EXPECT_TRUE(test::fails_saying(
      [&] {
        const auto left = std::span(pair.views).first(1);
        show.make(SHOW_DISAGREEMENT, {frame, left, std::span(pictures).first(1), coarse}, glm::vec3(0.0f));
      },
      {"both eyes"}));
}

/// The number of pixels of a map whose error of disparity is not fx ipd |1/z - 1/z_true|, by eye.
std::array<int, 2> differing_disparities(const std::vector<Image>& maps, const std::vector<Picture>& drawn,
                                         const std::vector<Picture>& true_pictures, double fx_ipd) {
  std::array<int, 2> differing{};
  for (std::size_t v = 0; v < 2; ++v) {
    const Image z = depth_map(drawn[v]), z_true = depth_map(true_pictures[v]);
    for (std::size_t k = 0; k < maps[v].data.size(); ++k) {
      const double expected = fx_ipd * std::abs(1.0 / z.data[k] - 1.0 / z_true.data[k]);
      if (maps[v].data[k] >= 0.0f) differing[v] += std::abs(maps[v].data[k] - expected) > 1e-3 ? 1 : 0;
    }
  }
  return differing;
}

TEST(DebugViews, DisparityErrorsMatchFloat64Depths) {
  Model wall;  // a wavy wall behind faint Gaussians, which `coarse` leaves out
  test::Uniform uniform(3);
  for (double y = -1.5; y <= 1.5; y += 0.1) {
    for (double x = -2.5; x <= 2.5; x += 0.1)
      test::add(wall, {x, y, 2.0 + 0.1 * std::sin(x)}, glm::vec3(0.07f), 0.9f);
  }
  for (int k = 0; k < 200; ++k)
    test::add(wall, {uniform(-2, 2), uniform(-1.5, 1.5), uniform(1.5, 1.9)}, glm::vec3(0.03f), 0.02f);
  const EyePair pair = make_rig(test::front_camera(shown_width, shown_height, 55.0), {.ipd = 0.2});
  const render::FrameSettings coarse = {{.tolerance = 3.0f, .threshold = Threshold::squared}};
  render::Frame frame(test::gl_context(), wall);
  DebugView show(frame.model());
  frame.draw(pair.views, coarse);
  const std::vector<Picture> drawn = frame.read_pictures();
  std::vector<Picture> true_pictures;
  for (const shared::View& view : pair.views) true_pictures.push_back(reference::render(wall, view));
  const auto map = [&](const std::vector<Picture>& of) {
    return show.map(SHOW_DISPARITY, {frame, pair.views, of, coarse}, {});
  };
  const double fx_ipd = 55.0 * 0.2;
  const std::vector<Image> found = map(drawn);
  for (const Image& errors : found) {
    EXPECT_GT(std::ranges::count_if(errors.data, [](float px) { return px >= 0.0f; }), 1500);
    EXPECT_GT(*std::ranges::max_element(errors.data), 0.02f) << "this tolerance changes no depth";
  }
  for (const int count : differing_disparities(found, drawn, true_pictures, fx_ipd)) EXPECT_EQ(count, 0);
  for (const int count : differing_disparities({found[1], found[0]}, drawn, true_pictures, fx_ipd))
    EXPECT_GT(count, 100) << "swapped eyes go unnoticed";
  std::vector<Picture> off = drawn;  // injected: the drawn depths are off by 0.1 %
  for (Picture& picture : off) {
    for (float& z : picture.z_sum) z *= 1.001f;
  }
  for (const int count : differing_disparities(map(off), drawn, true_pictures, fx_ipd))
    EXPECT_GT(count, 1000);
}

TEST_F(ShowTest, RangeIsRound) {
  const double most = *made(SHOW_VISIBLE).max;
  const double digit = most / std::pow(10.0, std::floor(std::log10(most) + 1e-9));
  EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 || std::abs(digit - 5) < 1e-9) << most;
  pictures = exact;
  frame.draw(pair.views);
  EXPECT_EQ(made(SHOW_DIFFERENCE).max, 0.0) << "an exact picture differs from itself";
}

// Compare a new debug view above or in tests/render/debug_view_test.cpp, then raise this number.
static_assert(std::size(show_choices) == 12);

TEST(DebugViews, DocumentationHasEach) {
  std::ifstream in(BINOSPLAT_SOURCE_DIR "/docs/pictures.md");
  const std::string page(std::istreambuf_iterator<char>(in), {});
  const auto has = [&](const std::string& name) {
    return page.find("\n| `" + name + "` |") != std::string::npos;
  };
  for (const Choice& view : show_choices) EXPECT_TRUE(has(view.name)) << view.name;
  EXPECT_FALSE(has("no-such-view"));
}

TEST_F(ShowTest, KeepsFrameMeasurements) {
  const render::FrameSettings last = {
      {.tolerance = 0.2f, .threshold = Threshold::squared, .transmittance = Transmittance::last}};
  render::Frame other(test::gl_context(), model);
  Report report;
  for (int n = 0; n < 3; ++n) {
    report = frame.draw(pair.views, last);
    other.draw(pair.views, last);
    pictures = frame.read_pictures();
    made(SHOW_DIFFERENCE);
  }
  EXPECT_TRUE(report.used_last);
  EXPECT_TRUE(same_bits(pictures, other.read_pictures()));
}

}  // namespace
}  // namespace binosplat::stereo
