// Foveated pictures: the inset equals the exact picture bit for bit, and only the context surrounds it.

#include "stereo/drawing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/faulty_shaders.h"
#include "render/support.h"
#include "stereo/present.h"
#include "stereo/rig.h"
#include "support/caller.h"
#include "support/errors.h"

namespace binosplat {
namespace {

using stereo::Drawing;
using stereo::Foveation;

constexpr glm::ivec2 size{220, 156};

std::array<shared::View, 2> eyes_of_rig(const stereo::RigSettings& rig) {
  return stereo::make_rig(test::front_camera(size.x, size.y, 150), rig).views;
}

const std::vector<stereo::RigSettings> rigs = {
    {.ipd = 0.1}, {.ipd = 0.1, .convergence = 1.0}, {.ipd = 0.1, .cant_degrees = 5.0}};

struct Drawn {
  std::vector<Picture> pictures;
  std::vector<stereo::FoveatedEye> parts;
  Report report;
};

Drawn draw(const Model& model, std::span<const shared::View> views, const Foveation& foveation,
           render::FrameSettings settings = {}) {
  settings.foveation = foveation;
  Drawing frame(std::make_shared<render::GpuModel>(test::gl_context(), model, settings.precision));
  const auto report = frame.draw(views, settings);
  return {frame.read_pictures(), frame.parts(), report};
}

// Returns the angle between a pixel's ray and a gaze, in degrees, computed differently than in the code.
double degrees_off(const shared::View& view, const glm::dvec2& gaze, int x, int y) {
  const glm::dvec3 ray((x + 0.5 - view.lens.z) / view.lens.x, (y + 0.5 - view.lens.w) / view.lens.y, 1.0);
  const glm::dvec3 at(std::tan(glm::radians(gaze.x)), -std::tan(glm::radians(gaze.y)), 1.0);
  return glm::degrees(std::atan2(glm::length(glm::cross(ray, at)), glm::dot(ray, at)));
}

// Returns whether the pixels within the inset's angle of the gaze equal the exact picture, bit for bit.
testing::AssertionResult is_sharp(const Picture& drawn, const Picture& exact, const shared::View& view,
                                  const Foveation& foveation, const glm::dvec2& gaze) {
  int count = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      if (degrees_off(view, gaze, x, y) > foveation.inset_degrees / 2) continue;
      const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * size.x + x);
      ++count;
      if (std::memcmp(&drawn.colour[k], &exact.colour[k], sizeof(glm::vec4)) != 0 ||
          drawn.z_sum[k] != exact.z_sum[k])
        return testing::AssertionFailure() << "pixel (" << x << ", " << y << ") differs";
    }
  }
  if (count < 100) return testing::AssertionFailure() << "an inset of " << count << " px";
  return testing::AssertionSuccess();
}

TEST(Foveate, InsetEqualsExactPicture) {
  const Model model = test::random_model(71, 3000, 1, 0.75);
  const std::vector<std::vector<glm::dvec2>> gazes = {
      {}, {{12, -7}}, {{-20, 11}, {-17, 11}}, {{34, 25}}};  // the last gaze is at the picture's corner
  for (const stereo::RigSettings& rig : rigs) {
    const auto views = eyes_of_rig(rig);
    const auto exact = test::draw(model, std::vector(views.begin(), views.end()));
    for (std::size_t n = 0; n < gazes.size(); ++n) {
      const Foveation foveation{
          .inset_degrees = 18, .context_scale = 0.3 + 0.1 * static_cast<double>(n), .gaze = gazes[n]};
      const auto drawn = draw(model, views, foveation);
      EXPECT_EQ(drawn.report.order_groups, rig.cant_degrees == 0.0 ? 1u : 2u);
      EXPECT_EQ(drawn.report.stages.back().name, "compose");
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const glm::dvec2 gaze =
            gazes[n].empty() ? glm::dvec2(0.0) : gazes[n][std::min(eye, gazes[n].size() - 1)];
        EXPECT_TRUE(is_sharp(drawn.pictures[eye], exact[eye], views[eye], foveation, gaze)) << n << eye;
        EXPECT_FALSE(test::same_bits(drawn.pictures[eye], exact[eye]));
      }
      // Injected: the gaze of the other eye.
      if (n == 2) {
        EXPECT_FALSE(is_sharp(drawn.pictures[0], exact[0], views[0], foveation, gazes[n][1]));
      }
    }
  }
}

TEST(Foveate, InsetIsExactBesideLossyContext) {
  const Model model = test::random_model(72, 3000, 1, 0.75);
  const auto views = eyes_of_rig(rigs[0]);
  const render::FrameSettings perspective{{.order = Order::distance, .projection = Projection::tangent}};
  const auto exact = test::draw(model, std::vector(views.begin(), views.end()), perspective);
  render::FrameSettings lossy = perspective;
  lossy.threshold = Threshold::squared;
  lossy.tolerance = 0.3f;
  const Foveation foveation{.inset_degrees = 20};
  const auto drawn = draw(model, views, foveation, lossy),
             lossless = draw(model, views, foveation, perspective);
  EXPECT_LT(drawn.report.pairs, lossless.report.pairs);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    EXPECT_TRUE(is_sharp(drawn.pictures[eye], exact[eye], views[eye], foveation, {}));
    EXPECT_FALSE(test::same_bits(drawn.pictures[eye], lossless.pictures[eye]));
  }
}

double catmull_rom(double t) {
  t = std::abs(t);
  return t < 1 ? 1 + t * t * (1.5 * t - 2.5) : t < 2 ? 2 + t * (-4 + t * (2.5 - 0.5 * t)) : 0;
}

// Returns the largest difference between colours beyond the seam and the context, drawn alone and resampled.
double around_error(const Drawn& drawn, const Model& model) {
  const stereo::FoveatedEye& part = drawn.parts[0];
  const render::FrameSettings whole{.regions = {{{.low_pass_share = part.context_region.low_pass_share}}}};
  const Picture context = test::draw(model, part.context, whole);
  const Picture& shown = drawn.pictures[0];
  double worst = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec2 p(x, y), begin(part.inset_begin), end(glm::dvec2(part.inset_end) - 1.0);
      const glm::dvec2 beside = glm::max(glm::max(begin - p, p - end), 0.0);
      if (glm::length(beside) == 0.0 || glm::length(beside) < part.seam) continue;
      const glm::dvec2 at = (p + 0.5) * glm::dvec2(context.width, context.height) / glm::dvec2(size) - 0.5;
      const glm::dvec2 cell = glm::floor(at);
      // C, T and Z of the surrounding pixels of the context: rows first, each limited to the range of its
      // nearest two pixels.
      const auto taken = [&](int row, int column) {
        const auto k = static_cast<std::size_t>(std::clamp(row, 0, context.height - 1) * context.width +
                                                std::clamp(column, 0, context.width - 1));
        return std::pair(glm::dvec4(context.colour[k]), static_cast<double>(context.z_sum[k]));
      };
      const auto filtered = [](double t, const auto& of) {
        auto [sum, z] = of(0);
        sum *= 0.0;
        z = 0.0;
        for (int k = -1; k <= 2; ++k) {
          const auto [one, one_z] = of(k);
          sum += catmull_rom(k - t) * one;
          z += catmull_rom(k - t) * one_z;
        }
        const auto [a, a_z] = of(0);
        const auto [b, b_z] = of(1);
        return std::pair(glm::clamp(sum, glm::min(a, b), glm::max(a, b)),
                         std::clamp(z, std::min(a_z, b_z), std::max(a_z, b_z)));
      };
      const auto expected = filtered(at.y - cell.y, [&](int j) {
        return filtered(at.x - cell.x, [&](int i) {
          return taken(static_cast<int>(cell.y) + j, static_cast<int>(cell.x) + i);
        });
      });
      const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * size.x + x);
      const glm::dvec4 d = glm::abs(expected.first - glm::dvec4(shown.colour[k]));
      worst = std::max({worst, d.r, d.g, d.b, d.a, 0.1 * std::abs(expected.second - shown.z_sum[k])});
    }
  }
  return worst;
}

TEST(Foveate, ContextSurroundsInset) {
  const Model model = test::random_model(74, 3000, 1, 0.75);
  const auto views = eyes_of_rig(rigs[1]);
  for (const Foveation& foveation :
       {Foveation{.inset_degrees = 40, .context_scale = 0.55, .seam = 0}, Foveation{.gaze = {{30, 20}}},
        Foveation{.inset_degrees = 30, .context_scale = 0.95, .gaze = {{3, 2}}, .seam = 0.02}}) {
    const auto drawn = draw(model, views, foveation);
    EXPECT_LT(around_error(drawn, model), 1e-4);
  }
  // Injected: the context is shifted by half a pixel.
  const test::FaultyShaders faulty("foveate.comp", "(vec2(pixel) + 0.5) *", "(vec2(pixel) + 1.0) *");
  EXPECT_GT(around_error(draw(model, views, {.gaze = {{30, 20}}}), model), 1e-2);
}

// The context is empty, so the seam must show exactly the inset's weight. Returns the largest difference from
// that.
double farthest_from_seam(const Drawn& drawn, const Picture& exact, double seam) {
  const stereo::FoveatedEye& parts = drawn.parts[0];
  double worst = 0.0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const auto beyond = [](int at, unsigned begin, unsigned end) {
        return std::max({int(begin) - at, at - (int(end) - 1), 0});
      };
      const double t = std::min(std::hypot(beyond(x, parts.inset_begin.x, parts.inset_end.x),
                                           beyond(y, parts.inset_begin.y, parts.inset_end.y)) /
                                    seam,
                                1.0);
      const auto share = static_cast<float>(1.0 - t * t * (3.0 - 2.0 * t));
      const auto k = static_cast<std::size_t>(std::ptrdiff_t{y} * size.x + x);
      const glm::vec4 expected = glm::mix(glm::vec4(0, 0, 0, 1), exact.colour[k], share);
      for (int c = 0; c < 4; ++c)
        worst = std::max(worst, std::abs(double{drawn.pictures[0].colour[k][c]} - double{expected[c]}));
    }
  }
  return worst;
}

TEST(Foveate, SeamIsSmooth) {
  const Model model = test::random_model(76, 3000, 0, 0.75);
  const auto views = eyes_of_rig(rigs[0]);
  const auto exact = test::draw(model, views[0]);
  render::FrameSettings nothing;
  nothing.threshold = Threshold::squared;
  nothing.tolerance = 1e9f;
  const Foveation foveation{.inset_degrees = 18, .context_scale = 1.0, .seam = 0.5};
  const Drawn drawn = draw(model, views, foveation, nothing);
  const double seam = drawn.parts[0].seam;
  EXPECT_GT(seam, 20.0);
  EXPECT_LT(farthest_from_seam(drawn, exact, seam), 1e-5);
  EXPECT_GT(farthest_from_seam(drawn, exact, 0.9 * seam), 0.05) << "another seam goes unnoticed";
  // A context with as many pixels as the picture is equal to it, and so is the composed picture.
  EXPECT_GE(test::psnr(draw(model, views, foveation).pictures[0], exact), 120.0);
}

// Composing into the caller's textures equals presenting composed pictures.
TEST(Foveate, ComposesOntoCanvases) {
  test::Caller caller;
  const Model model = test::random_model(77, 500, 0, 0.75);
  Drawing frame(std::make_shared<render::GpuModel>(*caller.context, model, PRECISION_FULL));
  stereo::Presenter presenter(*caller.context);
  const Background background = glm::vec3(0.1f, 0.2f, 0.6f);
  const render::FrameSettings settings = {
      {.background = *background, .foveation = Foveation{.gaze = {{5, 5}}}}};
  std::array<Target, 2> targets;
  for (Target& target : targets) target.texture = caller.texture(GL_SRGB8_ALPHA8, size.x, size.y);
  const auto written = [&](std::size_t eye) {
    return caller.read<unsigned char>(targets[eye].texture, size.x, size.y);
  };
  frame.draw(eyes_of_rig(rigs[0]), settings);
  for (std::size_t eye = 0; eye < 2; ++eye)
    presenter.draw(frame.colours(), frame.views(), eye, LAYOUT_SEPARATE, targets[eye], background);
  const std::array presented = {written(0), written(1)};
  for (Target& target : targets) target.texture = caller.texture(GL_SRGB8_ALPHA8, size.x, size.y);
  const stereo::Canvases canvases = presenter.canvases(targets, background);
  EXPECT_TRUE(frame.draw(eyes_of_rig(rigs[0]), settings, {}, {.canvases = canvases.list}).in_place);
  EXPECT_EQ(written(0), presented[0]);
  EXPECT_EQ(written(1), presented[1]);
  EXPECT_NE(presented[0], presented[1]) << "one eye twice goes unnoticed";
  EXPECT_THROW(frame.read_pictures(), Error);
  EXPECT_THROW(
      frame.draw(eyes_of_rig(rigs[0]), settings, {}, {.canvases = std::span(canvases.list).first(1)}), Error);
}

TEST(Foveate, RejectsInvalidParameters) {
  const auto view = eyes_of_rig(rigs[0])[0];
  const auto said = [&](const Foveation& foveation) { return [=] { stereo::foveate(view, foveation, 2); }; };
  const double nan = std::nan("");
  EXPECT_TRUE(test::fails_saying(said({.inset_degrees = 0}), {"inset 0", "1 to 120"}));
  EXPECT_TRUE(test::fails_saying(said({.inset_degrees = nan}), {"inset nan"}));
  EXPECT_TRUE(test::fails_saying(said({.context_scale = 1.5}), {"context 1.5", "0.05 to 1"}));
  EXPECT_TRUE(test::fails_saying(said({.gaze = {{0, 95}}}), {"gaze 0,95", "80 degrees"}));
  EXPECT_TRUE(
      test::fails_saying(said({.gaze = {{70, 0}}}), {"gaze 70,0", "outside the picture of 220 x 156"}));
  EXPECT_TRUE(test::fails_saying(said({.gaze = {{0, 0}, {0, 0}}}), {"2 gazes", "eye 2"}));
  EXPECT_TRUE(test::fails_saying(said({.seam = -1}), {"seam -1"}));
  render::FrameSettings settings{{.foveation = Foveation{}}};
  EXPECT_ERROR(stereo::foveated_views(std::vector(5, view), settings), "5 eyes", "1 to 4");
  settings.regions.emplace_back();
  EXPECT_ERROR(stereo::foveated_views(std::vector(1, view), settings), "foveation with view regions");
}

}  // namespace
}  // namespace binosplat
