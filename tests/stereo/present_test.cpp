// The screen shows what files store: compares the layouts on the GPU with those on the CPU.

#include "stereo/present.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stereo/layout.h"
#include "stereo/rig.h"
#include "support/caller.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat::stereo {
namespace {

constexpr int present_width = 60, present_height = 34;
const glm::vec3 blue(0.1f, 0.2f, 0.6f);

struct Present : testing::Test {
  test::Caller caller;
  const Model model = test::random_model(5, 300, 1, 0.6);
  render::Frame frame{*caller.context, model};
  Presenter presenter{*caller.context};
  std::vector<Picture> eyes;

  Present() {
    const EyePair pair =
        make_rig(test::front_camera(present_width, present_height, 55.0), {.ipd = 0.2, .convergence = 2.0});
    frame.draw(pair.views);
    eyes = frame.read_pictures();
  }

  /// Returns the largest difference between a texture's pixels, bottom row first, and a picture's.
  static double difference(const std::vector<float>& pixels, const Image& image) {
    double worst = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < image.channels; ++c) {
          const std::size_t row =
              static_cast<std::size_t>(image.height - 1 - y) * static_cast<std::size_t>(image.width);
          const std::size_t at = 4 * (row + static_cast<std::size_t>(x)) + static_cast<std::size_t>(c);
          worst = std::max(worst, std::abs(double{pixels[at]} - image.at(x, y, c)));
        }
      }
    }
    return worst;
  }

  std::vector<float> shown(std::size_t first, int layout, const Background& background) {
    const glm::ivec2 size = layout_size(layout, {present_width, present_height});
    const std::uint32_t texture = caller.texture(GL_RGBA32F, size.x, size.y);
    presenter.draw(frame, first, layout, {.texture = texture}, background);
    auto pixels = caller.read<float>(texture, size.x, size.y);
    caller.gl.DeleteTextures(1, &texture);
    return pixels;
  }
};

TEST_F(Present, LayoutsMatchFiles) {
  for (int layout = LAYOUT_PARALLEL; layout <= LAYOUT_GREY; ++layout) {
    const auto pixels = shown(0, layout, blue);
    const auto written = [&](int as, const Picture& left, const Picture& right) {
      return composite(lay_out(as, left, right, blue), blue);
    };
    // The two implementations of pow() differ in the last digits, everything else by rounding only.
    const double bound = layout == LAYOUT_ANAGLYPH ? 2e-5 : 1e-6;
    EXPECT_LE(difference(pixels, written(layout, eyes[0], eyes[1])), bound) << layout_choices[layout].name;
    EXPECT_GT(difference(pixels, written(layout, eyes[1], eyes[0])), 0.01)
        << layout_choices[layout].name << ": swapped eyes go unnoticed";
  }
}

TEST_F(Present, DrawsSingleEye) {
  for (std::size_t eye = 0; eye < 2; ++eye) {
    EXPECT_LE(difference(shown(eye, LAYOUT_SEPARATE, blue), composite(eyes[eye], blue)), 1e-6);
    EXPECT_GT(difference(shown(eye, LAYOUT_SEPARATE, blue), composite(eyes[1 - eye], blue)), 0.01);
  }
  // Without a background: colours premultiplied by alpha, and alpha.
  const auto pixels = shown(1, LAYOUT_SEPARATE, std::nullopt);
  Image associated(present_width, present_height, 4);
  for (std::size_t k = 0; k < eyes[1].colour.size(); ++k) {
    for (std::size_t c = 0; c < 4; ++c)
      associated.data[4 * k + c] =
          c < 3 ? eyes[1].colour[k][static_cast<int>(c)] : 1.0f - eyes[1].colour[k].a;
  }
  EXPECT_LE(difference(pixels, associated), 1e-6);
  EXPECT_GT(difference(pixels, composite(eyes[1], std::nullopt)), 0.01) << "straight alpha goes unnoticed";
}

TEST_F(Present, EveryTargetHoldsDisplayValues) {
  // The pictures are written in place, through a view, or copied, with rows above and columns left of them.
  const auto immutable = [&](GLenum format) {
    return caller.texture(format, present_width + 3, present_height + 5);
  };
  std::uint32_t mutable_one = 0;
  caller.gl.CreateTextures(GL_TEXTURE_2D, 1, &mutable_one);
  caller.BindTexture(GL_TEXTURE_2D, mutable_one);
  caller.TexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, present_width + 3, present_height + 5, 0, GL_RGBA,
                    GL_UNSIGNED_BYTE, nullptr);
  caller.gl.Enable(GL_FRAMEBUFFER_SRGB);
  const Image image = composite(eyes[0], blue);
  struct Kind {
    const char* name;
    std::uint32_t texture;
    float bound;  // half a step of its colours; for halves a whole step, since drivers may truncate
  };
  const float byte = 0.51f / 255;
  for (const auto& [name, texture, bound] : {Kind{"RGBA8", immutable(GL_RGBA8), byte},
                                             {"RGB10_A2", immutable(GL_RGB10_A2), 0.51f / 1023},
                                             {"RGBA16", immutable(GL_RGBA16), 0.51f / 65535},
                                             {"RGBA16F", immutable(GL_RGBA16F), 1.01f / 2048},
                                             {"SRGB8_ALPHA8", immutable(GL_SRGB8_ALPHA8), byte},
                                             {"SRGB8_ALPHA8, mutable", mutable_one, byte},
                                             {"RGB8", immutable(GL_RGB8), byte}}) {
    presenter.draw(frame, 0, LAYOUT_SEPARATE, {.texture = texture, .x = 3}, blue);
    const auto pixels = caller.read<float>(texture, present_width + 3, present_height + 5);
    int off = 0, encoded_twice = 0, upside_down = 0;
    for (int k = 0; k < present_width * present_height; ++k) {
      const int x = k % present_width, y = k / present_width;
      const float v = std::min(1.0f, image.at(x, present_height - 1 - y, 1));
      const float shown = pixels[4 * static_cast<std::size_t>(y * (present_width + 3) + x + 3) + 1];
      if (std::abs(shown - v) > bound) ++off;
      if (std::abs(shown - std::pow(v, 1.0f / 2.2f)) > bound) ++encoded_twice;
      if (std::abs(shown - std::min(1.0f, image.at(x, y, 1))) > bound) ++upside_down;
    }
    EXPECT_EQ(off, 0) << name;
    EXPECT_GT(encoded_twice, 100) << name << ": this picture cannot tell";
    EXPECT_GT(upside_down, 100) << name << ": this picture cannot tell";
  }
}

TEST_F(Present, CopiesIntoUnwritableTargets) {
  const std::array targets = {
      Target{.texture = caller.texture(GL_SRGB8_ALPHA8, present_width, present_height)},
      Target{.texture = caller.texture(GL_SRGB8_ALPHA8, present_width, present_height), .in_place = false}};
  std::vector<std::vector<unsigned char>> shown;
  for (const Target& target : targets) {
    EXPECT_EQ(presenter.canvases(std::span(&target, 1), std::nullopt).list.empty(), !target.in_place);
    presenter.draw(frame, 0, LAYOUT_SEPARATE, target, glm::vec3(0.2f));
    shown.push_back(caller.read<unsigned char>(target.texture, present_width, present_height));
  }
  EXPECT_EQ(shown[0], shown[1]);
}

TEST_F(Present, DrawsIntoArraysAndFramebuffers) {
  const std::uint32_t array = caller.texture(GL_RGBA32F, present_width, present_height, 2);
  for (int eye = 0; eye < 2; ++eye) {
    presenter.draw(frame, static_cast<std::size_t>(eye), LAYOUT_SEPARATE, {.texture = array, .layer = eye},
                   blue);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto pixels = caller.read<float>(array, present_width, present_height, static_cast<int>(eye));
    EXPECT_LE(difference(pixels, composite(eyes[eye], blue)), 1e-6);
  }

  // Both eyes are drawn separately into one framebuffer of the caller, in place or by a copy. They equal the
  // parallel layout, and nothing outside changes.
  for (const auto& [format, bound] : {std::pair{GL_RGBA32F, 1e-6}, {GL_RGB8, 0.51 / 255}}) {
    const std::uint32_t texture =
        caller.texture(static_cast<GLenum>(format), 2 * present_width + 3, present_height + 5);
    presenter.draw(frame, 0, LAYOUT_PARALLEL, {.framebuffer = caller.framebuffer(texture), .x = 2, .y = 4},
                   blue);
    const auto pixels = caller.read<float>(texture, 2 * present_width + 3, present_height + 5);
    const Image expected = composite(lay_out(LAYOUT_PARALLEL, eyes[0], eyes[1], blue), blue);
    for (int y = 0; y < present_height + 5; ++y) {
      for (int x = 0; x < 2 * present_width + 3; ++x) {
        const bool inside = x >= 2 && x < 2 * present_width + 2 && y >= 4 && y < present_height + 4;
        const float value =
            pixels[4 * (static_cast<std::size_t>(y) * (2 * present_width + 3) + static_cast<std::size_t>(x)) +
                   2];
        ASSERT_NEAR(value, inside ? expected.at(x - 2, present_height - 1 - (y - 4), 2) : 0.0f, bound)
            << x << " " << y;
      }
    }
  }
}

TEST_F(Present, RejectsInvalidTargets) {
  const auto fails = [&](std::size_t first, int layout, const Target& target, const Background& background,
                         const std::string& said) {
    return test::fails_saying([&] { presenter.draw(frame, first, layout, target, background); }, {said});
  };
  const std::uint32_t depth = caller.texture(GL_DEPTH_COMPONENT32F, present_width, present_height);
  const std::uint32_t plain = caller.texture(GL_RGBA8, present_width, present_height);
  EXPECT_TRUE(fails(1, LAYOUT_ROWS, {.texture = plain}, blue, "view 2 of a frame of 2 views"));
  EXPECT_TRUE(fails(0, LAYOUT_SEPARATE, {.texture = depth}, blue, "cannot be drawn into"));
  EXPECT_TRUE(fails(0, LAYOUT_SEPARATE, {.texture = 4711}, blue, "texture 4711"));
  std::uint32_t empty = 0;
  caller.gl.CreateFramebuffers(1, &empty);
  EXPECT_TRUE(fails(0, LAYOUT_SEPARATE, {.framebuffer = empty}, blue, "expected a complete framebuffer"));
  EXPECT_TRUE(fails(0, LAYOUT_GREY, {.texture = plain}, std::nullopt, "give a background"));
  EXPECT_TRUE(fails(0, LAYOUT_QUAD_BUFFER, {.texture = plain}, blue, "needs two framebuffers"));
  EXPECT_TRUE(fails(0, LAYOUT_MULTI_VIEW, {.texture = plain}, blue, "for OpenEXR"));
  EXPECT_TRUE(caller.context->take_errors().empty()) << "an error of binosplat's was left to the caller";
}

}  // namespace
}  // namespace binosplat::stereo
