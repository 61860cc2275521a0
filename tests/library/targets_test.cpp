// Targets in another program: depths, linear light, and textures into which the blend itself writes.

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/image.h"
#include "library/renderer_fixture.h"
#include "render/frame.h"
#include "stereo/eyes.h"
#include "stereo/present.h"
#include "support/errors.h"
#include "support/models.h"

namespace binosplat {
namespace {

TEST_F(Library, DepthsFollowOpenGL) {
  const Model model = test::random_model(3, 400, 0);
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  render::Frame frame(*caller.context, model);
  frame.draw(stereo::views_from_xr(quest_eyes(), placement, std::array{size, size}));
  const std::vector<Picture> pictures = frame.read_pictures();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::uint32_t layers = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y, 3);
  const std::array<std::uint32_t, 2> formats = {caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y),
                                                caller.texture(GL_DEPTH_COMPONENT24, size.x, size.y)};
  for (const auto& [near, far] :
       {std::pair(0.2, 50.0), std::pair(0.2, inf), std::pair(inf, 0.2), std::pair(50.0, 0.2)}) {
    const auto depth_of = [near = near, far = far](double z) {
      if (std::isinf(near)) return far / z;
      return (std::isinf(far) ? 1.0 : far / (far - near)) * (1.0 - near / z);
    };
    const auto differing = [&](const std::vector<float>& depths, const Picture& picture,
                               bool flipped = false) {
      int count = 0;
      for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) {
          const auto at = static_cast<std::size_t>(std::ptrdiff_t{y} * size.x + x);
          const double cover = 1.0 - picture.colour[at].a;
          const double z = cover > 0.5 ? picture.z_sum[at] / cover : 1e30;
          const int row = flipped ? y : size.y - 1 - y;
          const double is = depths[static_cast<std::size_t>(std::ptrdiff_t{row} * size.x + x)];
          count += std::abs(is - std::clamp(depth_of(z), 0.0, 1.0)) > 1e-6 ? 1 : 0;
        }
      }
      return count;
    };
    std::vector<View> pair = views();
    pair[0].depth = {.texture = formats[0], .near_plane = near, .far_plane = far};
    pair[1].depth = {.texture = layers, .layer = 2, .near_plane = near, .far_plane = far};
    renderer.draw(pair, placement, over_black);
    EXPECT_EQ(differing(read_depths(formats[0]), pictures[0]), 0) << near << " " << far;
    EXPECT_EQ(differing(read_depths(layers, 2), pictures[1]), 0) << near << " " << far;
    EXPECT_GT(differing(read_depths(formats[0]), pictures[1]), 100) << "the other eye goes unnoticed";
    EXPECT_GT(differing(read_depths(formats[0]), pictures[0], true), 100) << "upside down goes unnoticed";
    pair[0].depth->texture = formats[1];
    renderer.draw(pair, placement, over_black);
    EXPECT_EQ(differing(read_depths(formats[1]), pictures[0]), 0) << "24 bits";
  }
  std::vector<View> half = views();
  half[1].depth = {.texture = formats[0]};
  EXPECT_ERROR(renderer.draw(half, placement), "1 of 2 views have a depth target");
}

// In place, the blend writes what the presenter would write.
TEST_F(Library, InPlaceBlendEqualsPresenter) {
  const Model model = test::random_model(3, 400, 0);
  Renderer renderer(caller.get_proc_address(), in_memory(model));
  View one = views()[0];
  const auto drawn = stereo::views_from_xr(std::span(&one.eye, 1), placement, std::span(&one.size, 1));
  const std::uint32_t depth = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
  for (const GLenum format : {GL_SRGB8_ALPHA8, GL_RGBA8, GL_RGB10_A2, GL_RGBA16, GL_RGBA16F, GL_RGBA32F}) {
    for (const bool linear : {false, true}) {
      for (const Background& background : {Background(glm::vec3(0.2f, 0.5f, 0.1f)), Background()}) {
        // A picture in a layer, away from its corner.
        const std::uint32_t texture = caller.texture(format, 2 * size.x, 2 * size.y, 3);
        const Target to = {.texture = texture, .layer = 1, .x = 5, .y = 9, .linear = linear};
        const Target other = {.texture = texture, .layer = 2, .x = 5, .y = 9, .linear = linear};
        const Target third = {.texture = texture, .layer = 0, .x = 5, .y = 9, .linear = !linear};
        const auto written = [&](int layer) {
          return caller.read<float>(texture, 2 * size.x, 2 * size.y, layer);
        };
        one.target = to;
        one.depth = {.texture = depth};
        EXPECT_TRUE(renderer.draw(std::span(&one, 1), placement, {.background = background}).in_place)
            << format;
        render::Frame frame(*caller.context, model);
        frame.draw(drawn);
        stereo::Presenter presenter(*caller.context);
        presenter.draw(frame, 0, LAYOUT_SEPARATE, other, background);
        presenter.draw(frame, 0, LAYOUT_SEPARATE, third, background);
        EXPECT_EQ(written(1), written(2)) << format << linear;
        EXPECT_NE(written(1), written(0)) << "light for display values goes unnoticed";
        const std::array twice = {drawn[0], drawn[0]};
        EXPECT_THROW(
            frame.draw(twice, {}, {}, {.canvases = presenter.canvases(std::span(&to, 1), background).list}),
            Error)
            << "one for two views";
        caller.gl.DeleteTextures(1, &texture);
      }
    }
  }
  // If one view needs a copy, no view is written in place.
  std::vector<View> mixed = views();
  mixed[1].target.texture = caller.texture(GL_RGB8, size.x, size.y);
  EXPECT_FALSE(renderer.draw(mixed, placement, over_black).in_place);
}

// OpenGL lets shaders write only the levels from the base to the highest level.
TEST_F(Library, LevelOutsideMipmapRangeIsWritten) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 400, 0)));
  std::vector<View> pair = views();
  std::uint32_t mipmap = 0;
  caller.gl.CreateTextures(GL_TEXTURE_2D, 1, &mipmap);
  caller.gl.TextureStorage2D(mipmap, 3, GL_RGBA32F, 2 * size.x, 2 * size.y);
  pair[0].target = {.texture = mipmap, .level = 1};
  const auto drawn = [&](const Settings& settings) {
    EXPECT_TRUE(renderer.draw(pair, placement, settings).in_place);
    std::vector<float> pixels(std::size_t{4} * size.x * size.y);
    caller.GetTextureSubImage(mipmap, 1, 0, 0, 0, size.x, size.y, 1, GL_RGBA, GL_FLOAT,
                              static_cast<GLsizei>(pixels.size() * sizeof(float)), pixels.data());
    return pixels;
  };
  const std::vector<float> usual = drawn({});
  for (const auto& [parameter, value] : {std::pair{GL_TEXTURE_BASE_LEVEL, 2}, {GL_TEXTURE_MAX_LEVEL, 0}}) {
    EXPECT_NE(drawn(over_black), usual);
    caller.TextureParameteri(mipmap, parameter, value);
    EXPECT_EQ(drawn({}), usual);
    caller.TextureParameteri(mipmap, parameter, parameter == GL_TEXTURE_BASE_LEVEL ? 0 : 1000);
  }
}

// Depth textures with fewer pixels take the depth at the middle of each of their pixels.
TEST_F(Library, SmallerDepthTexturesSampleCentres) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 400, 0)));
  const Target copied = {.texture = caller.texture(GL_RGB8, size.x, size.y)};
  const Target written = {.texture = textures[0]};
  const std::uint32_t whole = caller.texture(GL_DEPTH_COMPONENT32F, size.x, size.y);
  for (const DepthKind kind : {DepthKind::mean, DepthKind::median}) {
    const auto draw = [&](const Target& to, std::uint32_t texture) {
      const View view = {quest_eyes()[0], size, to, DepthTarget{.texture = texture}};
      Settings settings = over_black;
      settings.depth = kind;
      return renderer.draw(std::span(&view, 1), placement, settings);
    };
    EXPECT_FALSE(draw(copied, whole).in_place);
    const std::vector<float> all = read_depths(whole);
    for (const int step : {1, 2, 4}) {
      const glm::ivec2 few = size / step;
      const std::uint32_t texture = caller.texture(GL_DEPTH_COMPONENT32F, few.x, few.y);
      EXPECT_TRUE(draw(written, texture).in_place);
      const std::vector<float> depths = caller.read_depths(texture, few.x, few.y);
      int differ = 0, unlike = 0;
      for (int y = 0; y < few.y; ++y) {
        for (int x = 0; x < few.x; ++x) {
          int row = (2 * (few.y - 1 - y) + 1) * step / 2;  // from the top
          if (step > 1) row -= row % 2;
          const int from = (size.y - 1 - row) * size.x + (2 * x + 1) * step / 2;
          const float is = depths[static_cast<std::size_t>(std::ptrdiff_t{y} * few.x + x)];
          differ += std::abs(is - all[static_cast<std::size_t>(from)]) > 1e-6f ? 1 : 0;
          unlike += std::abs(is - all[static_cast<std::size_t>(from == 0 ? 1 : from - 1)]) > 1e-6f ? 1 : 0;
        }
      }
      EXPECT_EQ(differ, 0) << step;
      EXPECT_GT(unlike, few.x * few.y / 20) << "a pixel beside goes unnoticed";
    }
  }
}

// Targets whose numbers are linear light.
TEST_F(Library, LinearTargetsHoldLinearLight) {
  Renderer renderer(caller.get_proc_address(), in_memory(test::random_model(3, 400, 0)));
  std::vector<View> same = views();
  same[1].eye = same[0].eye;
  same[1].target.linear = true;
  renderer.draw(same, placement, over_black);
  const std::vector<float> shown = read(0), light = read(1);
  int differ = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const double v = shown[k];
    const double wanted = k % 4 == 3 ? 1.0 : v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(light[k], wanted, 1e-4 * std::max(1.0, wanted));
    differ += std::abs(light[k] - v) > 0.01 ? 1 : 0;
  }
  EXPECT_GT(differ, 1000) << "display values go unnoticed";
}

}  // namespace
}  // namespace binosplat
