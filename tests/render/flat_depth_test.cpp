// Depths of flat Gaussians (2D Gaussian Splatting): on their planes, as in the reference.

#include <array>
#include <cmath>

#include "base/choices.h"
#include "reference/blend_pixel.h"
#include "render/faulty_shaders.h"
#include "render/support.h"

namespace binosplat {
namespace {

using render::FrameSettings;
using render::Stage;
using test::draw;
using test::same_bits;

constexpr int width = 96, height = 80;

shared::View view_of_flat() { return make_view(test::front_camera(width, height, 90)); }

/// Returns flat Gaussians of all sizes and turns, and a large steep one behind them.
Model flat_model() {
  Model model = test::random_model(131, 1500, 0);
  for (glm::vec3& scale : model.scale) scale.z = 0.0f;
  model.flat = true;
  const auto half = static_cast<float>(glm::radians(35.0));
  test::add(model, {0.2f, 0.1f, 5.0f}, {2.0f, 1.5f, 0.0f}, 0.95f, glm::vec3(0.5f),
            {std::cos(half), 0.6f * std::sin(half), 0.8f * std::sin(half), 0.0f});
  return model;
}

/// Returns the reference's depths: in pixels without depth, infinity.
Image expected_depths(const Model& model, DepthKind depth, const reference::Settings& settings) {
  const shared::View view = view_of_flat();
  if (depth == DepthKind::mean) return depth_map(reference::render(model, view, settings));
  Model seen = model;
  seen.perspective = *settings.perspective;
  const auto splats = reference::project_all(seen, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  Image image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double z = INFINITY;
      reference::blend_pixel(splats, lists.at_pixel(x, y), {x, y}, {},
                             [&](std::uint32_t i, double alpha, const auto& before, auto verdict) {
                               const bool is_half = before.transmittance * (1.0 - alpha) < 0.5;
                               if (verdict == reference::Verdict::blended && is_half && std::isinf(z))
                                 z = reference::z_at(splats[i], x, y);
                             });
      image.at(x, y, 0) = static_cast<float>(z);
    }
  }
  return image;
}

/// Returns the share of pixels whose depths differ by more than rounding.
double differing_share(const Image& drawn, const Image& expected) {
  std::size_t seen = 0, count = 0;
  for (std::size_t k = 0; k < drawn.data.size(); ++k) {
    if (std::isinf(drawn.data[k]) && std::isinf(expected.data[k])) continue;
    ++seen;
    count += std::abs(drawn.data[k] - expected.data[k]) <= 1e-3f * expected.data[k] ? 0 : 1;
  }
  EXPECT_GT(seen, drawn.data.size() / 2);
  return static_cast<double>(count) / static_cast<double>(seen);
}

struct Way {
  const char* name;
  FrameSettings settings;
  render::DebugOptions debug;
};

// Rounding decides differently about few splats seen nearly edge-on, and about few medians.
constexpr double few = 0.004;

TEST(FlatDepths, EqualReference) {
  const Model model = flat_model();
  const std::vector<Way> ways = {
      {"exact", {}, {}},
      {"measured", {{.transmittance = Transmittance::last}}, {}},
      {"given splats", {}, test::given(Stage::project)},
      {"given lists", {}, test::given(Stage::sort)},
  };
  for (const Perspective& seen :
       {Perspective{Order::depth, Projection::affine}, Perspective{Order::distance, Projection::tangent}}) {
    for (const DepthKind depth : {DepthKind::mean, DepthKind::median}) {
      const Image expected = expected_depths(model, depth, {.perspective = seen});
      const auto drawn = [&](const Model& of, FrameSettings settings, const render::DebugOptions& debug) {
        settings.order = seen.order;
        settings.projection = seen.projection;
        settings.depth = depth;
        return depth_map(draw(of, view_of_flat(), settings, debug));
      };
      for (const auto& [name, settings, debug] : ways)
        EXPECT_LE(differing_share(drawn(model, settings, debug), expected), few)
            << name << " " << name_of(seen.projection) << " " << static_cast<int>(depth);
      // Injected faults: depths of means, and a plane that leans to the other side.
      Model thick = model;
      thick.flat = false;
      EXPECT_GT(differing_share(drawn(thick, {}, {}), expected), 0.5);
      if (depth == DepthKind::median) continue;
      const test::FaultyShaders faulty("blend_depth.glsl", "fma(disc.x, d.x", "fma(-disc.x, d.x");
      EXPECT_GT(differing_share(drawn(model, {}, {}), expected), 0.5);
    }
  }
}

TEST(FlatDepths, ApproximateFramesEqualReference) {
  const Model model = flat_model();
  const FrameSettings settings = test::squared(0.01f);
  const Image drawn = depth_map(draw(model, view_of_flat(), settings));
  const reference::Settings same{.threshold = Threshold::squared, .tolerance = double{*settings.tolerance}};
  Model thick = model;
  thick.flat = false;
  EXPECT_LE(differing_share(drawn, depth_map(reference::render(model, view_of_flat(), same))), few);
  EXPECT_GT(differing_share(drawn, depth_map(reference::render(thick, view_of_flat(), same))), 0.5);
}

/// Returns a disc at z = 4, seen from the side by `tilt` degrees.
Model tilted(double tilt) {
  Model model;
  const auto half = static_cast<float>(glm::radians(0.5 * tilt));
  test::add(model, {0, 0, 4}, {0.8f, 0.8f, 0.0f}, 0.999f, glm::vec3(1.0f),
            {std::cos(half), 0, std::sin(half), 0});
  model.flat = true;
  return model;
}

// The plane is z = 4 / (1 + tan(tilt) x / z) on the ray (x, y, 1).
TEST(FlatDepths, LieOnDiscPlane) {
  const shared::View view = view_of_flat();
  const auto farthest_off = [&](double tilt, const FrameSettings& settings) {
    const Image z = depth_map(draw(tilted(tilt), view, settings));
    const double reach = 3.0 * 0.8 * std::sin(glm::radians(tilt));
    double off = 0.0;
    std::size_t seen = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (std::isinf(z.at(x, y, 0))) continue;
        const double inverse = (1.0 + std::tan(glm::radians(tilt)) * (x + 0.5 - 0.5 * width) / 90.0) / 4.0;
        const double right = std::clamp(inverse > 0.0 ? 1.0 / inverse : 1e9, 4.0 - reach, 4.0 + reach);
        off = std::max(off, std::abs(z.at(x, y, 0) - right));
        ++seen;
      }
    }
    EXPECT_GT(seen, 100u);
    return off;
  };
  for (const DepthKind depth : {DepthKind::mean, DepthKind::median}) {
    for (const Projection projection : {Projection::affine, Projection::tangent}) {
      const FrameSettings settings{{.projection = projection, .depth = depth}};
      EXPECT_LE(farthest_off(0.0, settings), 1e-5);
      EXPECT_LE(farthest_off(60.0, settings), 1e-4);
      EXPECT_LE(farthest_off(85.0, settings), 1e-3);
      // Edge-on the depth is the mean's: its z, or its distance.
      const Image edge_on = depth_map(draw(tilted(90.0), view, settings));
      const float most = projection == Projection::tangent ? 0.1f : 1e-5f;
      for (const float z : edge_on.data) EXPECT_TRUE(std::isinf(z) || std::abs(z - 4.0f) < most) << z;
      if (projection != Projection::affine || depth != DepthKind::mean) continue;
      const test::FaultyShaders faulty("project_discs.glsl", "3.0 * length(onto_axes",
                                       "0.3 * length(onto_axes");
      EXPECT_GT(farthest_off(60.0, settings), 0.1);
    }
  }
}

TEST(FlatDepths, LeaveColoursUnchanged) {
  const Model model = flat_model();
  Model thick = model;
  thick.flat = false;
  const auto colours = [&](const Model& of, const FrameSettings& settings) {
    return draw(of, view_of_flat(), settings).colour;
  };
  for (const FrameSettings& settings :
       {FrameSettings{}, FrameSettings{.tiles = TILES_ALL}, test::squared(0.01f),
        FrameSettings{{.depth = DepthKind::median}},
        FrameSettings{{.order = Order::distance, .projection = Projection::tangent}}})
    EXPECT_EQ(colours(model, settings), colours(thick, settings));
  // Half precision has the depths of means, and so has a model that is not flat.
  const FrameSettings half{.precision = PRECISION_HALF};
  EXPECT_TRUE(same_bits(draw(model, view_of_flat(), half), draw(thick, view_of_flat(), half)));
  EXPECT_FALSE(same_bits(draw(model, view_of_flat()), draw(thick, view_of_flat()))) << "nothing to compare";
  // All programs of the blend compute the same bits.
  for (const DepthKind depth : {DepthKind::mean, DepthKind::median})
    EXPECT_TRUE(same_bits(draw(model, view_of_flat(), {{.depth = depth}}),
                          draw(model, view_of_flat(), {{.depth = depth}, TILES_ALL})));
}

// A flat model in the left half of the picture, and one with thickness in the right half.
TEST(FlatDepths, OtherModelsKeepDepths) {
  Model left, right = test::random_model(132, 400, 0);
  test::add(left, {-1.2f, 0, 4}, {0.2f, 0.4f, 0.0f}, 0.95f, glm::vec3(1.0f), {0.8f, 0, 0.6f, 0});
  left.flat = true;
  for (std::size_t i = 0; i < right.count(); ++i) {
    right.position[i].x = 0.3f * right.position[i].z + 0.2f * std::abs(right.position[i].x);
    right.scale[i] = glm::vec3(0.02f * right.position[i].z, 0.02f * right.position[i].z, 0.0f);
  }
  const auto upload = [](const Model& model) {
    return std::make_shared<render::GpuModel>(test::gl_context(), model);
  };
  const auto both = [&](bool is_flat) {
    Model other = left;
    other.flat = is_flat;
    render::Frame frame(upload(right));
    frame.place({{upload(other), {.translation = {0, 0, 0.5}, .scale = 0.9}}, {frame.model(), {}}});
    frame.draw(std::vector{view_of_flat()});
    return frame.read_pictures().front();
  };
  const Picture a = both(true), b = both(false);
  std::array<std::size_t, 2> differing{}, seen{};
  for (std::size_t k = 0; k < a.z_sum.size(); ++k) {
    const std::size_t side = k % width >= width / 2 ? 1 : 0;
    differing[side] += a.z_sum[k] != b.z_sum[k] ? 1 : 0;
    seen[side] += a.z_sum[k] != 0.0f ? 1 : 0;
  }
  EXPECT_GT(differing[0], seen[0] / 2);
  EXPECT_GT(seen[1], 500u);
  EXPECT_EQ(differing[1], 0u);
  EXPECT_EQ(a.colour, b.colour);
  // The placed disc: at z = 4.1, and its plane is that of a model with these values.
  Model moved = left;
  moved.position[0] = moved.position[0] * 0.9f + glm::vec3(0, 0, 0.5f);
  moved.scale[0] *= 0.9f;
  const Image expected = depth_map(reference::render(moved, view_of_flat())), drawn = depth_map(a);
  for (std::size_t k = 0; k < expected.data.size(); ++k) {
    if (k % width >= width / 2 || std::isinf(expected.data[k]) || std::isinf(drawn.data[k])) continue;
    EXPECT_NEAR(drawn.data[k], expected.data[k], 1e-4);
  }
}

// The debug view of the median shows the median, also of flat Gaussians.
TEST(FlatDepths, DebugViewShowsMedians) {
  for (const Projection projection : {Projection::affine, Projection::tangent}) {
    const Model model = flat_model();
    render::Frame frame(test::gl_context(), model);
    frame.draw(std::vector{view_of_flat()}, {{.projection = projection, .depth = DepthKind::median}});
    const Image median = depth_map(frame.read_pictures()[0]);
    const Image shown = frame.read_debug_view(SHOW_MEDIAN_DEPTH)[0];
    std::size_t differ = 0;
    for (std::size_t k = 0; k < median.data.size(); ++k) {
      const bool has_none = std::isinf(median.data[k]);
      const bool is =
          has_none ? shown.data[k] < 0.0f : std::abs(median.data[k] / shown.data[k] - 1.0f) <= 1e-5f;
      differ += is ? 0 : 1;
    }
    EXPECT_LE(differ, 2u);
  }
}

}  // namespace
}  // namespace binosplat
