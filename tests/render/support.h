#pragma once
// Draws small frames and reads their buffers, for the tests of the stages.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/image.h"
#include "measure/metrics.h"
#include "measure/reference_stages.h"
#include "reference/adagscale_transmittance.h"
#include "reference/render.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::test {

inline std::vector<Picture> draw(const Model& model, const std::vector<shared::View>& views,
                                 const render::FrameSettings& settings = {},
                                 const render::DebugOptions& debug = {}) {
  render::Frame frame(gl_context(), model);
  frame.draw(views, settings, debug);
  return frame.read_pictures();
}

inline Picture draw(const Model& model, const shared::View& view, const render::FrameSettings& settings = {},
                    const render::DebugOptions& debug = {}) {
  return draw(model, std::vector{view}, settings, debug).front();
}

/// Replaces the stages up to `until` by the float64 reference.
inline render::DebugOptions given(render::Stage until) {
  return {.stand_in = measure::reference_until(until)};
}

/// Returns whether two pictures are equal bit for bit. The message names the first pixel that differs.
inline testing::AssertionResult same_bits(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height) return testing::AssertionFailure() << "different sizes";
  for (std::size_t k = 0; k < a.colour.size(); ++k) {
    if (std::memcmp(&a.colour[k], &b.colour[k], sizeof(glm::vec4)) != 0 ||
        std::memcmp(&a.z_sum[k], &b.z_sum[k], sizeof(float)) != 0) {
      return testing::AssertionFailure()
             << "pixel (" << k % static_cast<std::size_t>(a.width) << ", "
             << k / static_cast<std::size_t>(a.width) << ") differs: " << a.colour[k].x << " "
             << b.colour[k].x << ", T " << a.colour[k].w << " " << b.colour[k].w;
    }
  }
  return testing::AssertionSuccess();
}

/// Returns the PSNR of float pictures, composited over black.
inline double psnr(const Picture& a, const Picture& b) {
  return measure::psnr(composite(a, glm::vec3(0.0f)), composite(b, glm::vec3(0.0f)));
}

/// Draws a frame up to a stage, and gives access to all its buffers.
struct StageRun {
  StageRun(const Model& model, std::vector<shared::View> of_views, const render::FrameSettings& with = {},
           const std::optional<render::Probe>& and_probe = {})
      : drawn(std::make_shared<render::GpuModel>(gl_context(), model, with.precision)),
        views(std::move(of_views)),
        settings(with),
        probe(and_probe) {}

  void run_until(render::Stage stage) {
    drawn.draw_until(stage, views, settings, debug, probe, exact);
    indices.clear();
    for (std::size_t group = 0; stage > render::Stage::decode && group < plan.groups.size(); ++group) {
      const auto arguments = frame.drawn[group]->arguments.read<shared::DispatchArguments>(1);
      indices.push_back(frame.drawn[group]->indices.read<std::uint32_t>(arguments.front().count));
    }
  }

  /// The splats of a view, by Gaussian of the model. Coverage 0: the view does not draw the Gaussian.
  struct Projected {
    std::vector<shared::Splat> splats;
    std::vector<std::uint32_t> coverages;
  };
  Projected projected(std::uint32_t view) const {
    const std::size_t all = std::size_t{frame.slots} * plan.view_count();
    const auto splats = frame.projected.splats.read<shared::Splat>(all);
    const auto coverages = frame.projected.coverages.read<std::uint32_t>(all);
    Projected out{std::vector<shared::Splat>(plan.gaussian_count),
                  std::vector<std::uint32_t>(plan.gaussian_count)};
    const auto& of_group = indices[plan.views[view].order_group];
    for (std::size_t slot = 0; slot < of_group.size(); ++slot) {
      out.splats[of_group[slot]] = splats[std::size_t{view} * frame.slots + slot];
      out.coverages[of_group[slot]] = coverages[std::size_t{view} * frame.slots + slot];
    }
    return out;
  }

  /// Returns each tile's list after the stage sort, in the order of blending. The tiles are row by row, view
  /// after view. An entry is view * (number of Gaussians of the model) + Gaussian.
  using Lists = std::vector<std::vector<std::uint32_t>>;
  Lists lists() const {
    const auto counters = frame.counters.read<shared::Counters>(1).front();
    EXPECT_EQ(counters.overflow, 0u);
    const auto values = frame.lists.tile_values.read<std::uint32_t>(counters.tile_pairs);
    const auto ranges = frame.lists.tile_ranges.read<glm::uvec2>(plan.tile_count());
    Lists lists;
    std::size_t total = 0;
    for (std::uint32_t v = 0; v < plan.view_count(); ++v) {
      const shared::View& view = plan.views[v];
      const std::uint32_t side = SUPERTILE_SIDE, across = (view.tiles_x + side - 1) / side;
      for (std::uint32_t n = 0; n < view.tiles_x * view.tiles_y; ++n) {
        const std::uint32_t x = n % view.tiles_x, y = n / view.tiles_x;
        const std::uint32_t supertile = view.supertile_offset + y / side * across + x / side;
        const glm::uvec2 range = ranges[supertile * side * side + y % side * side + x % side];
        std::vector<std::uint32_t>& list = lists.emplace_back();
        for (std::uint32_t k = range.x; k < range.y; ++k) {
          EXPECT_EQ(values.at(k) / frame.slots, v);
          list.push_back(v * plan.gaussian_count + indices[view.order_group].at(values[k] % frame.slots));
        }
        total += list.size();
      }
    }
    EXPECT_EQ(total, counters.tile_pairs) << "entries beyond the pictures";
    return lists;
  }

  render::Frame drawn;
  std::vector<shared::View> views;
  render::FrameSettings settings;
  render::DebugOptions debug;
  std::optional<render::Probe> probe;
  bool exact = false;  // FramePlan::exact
  const render::FramePlan& plan = drawn.plan();
  render::FrameBuffers& frame = drawn.buffers();
  std::vector<std::vector<std::uint32_t>> indices;  // Gaussian by slot, for each order group
};

/// Returns faint Gaussians. The tiles in the middle have so many that separate dispatches draw these tiles.
inline Model long_lists_model() {
  Model model;
  Uniform uniform(104);
  for (int i = 0; i < 2 * LONG_LIST; ++i) {
    add(model, glm::vec3(uniform(-0.05, 0.05), uniform(-0.05, 0.05), uniform(1.0, 2.0)),
        glm::vec3(uniform(0.01, 0.1)), 0.02f, glm::vec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)));
  }
  return model;
}

/// Returns the bounds that a first frame measures for the next, by Gaussian (Scaffold-GS: by id).
inline std::vector<float> measured_on_gpu(const Model& model, const shared::View& view) {
  render::Frame frame(gl_context(), model);
  frame.draw(std::span(&view, 1), {{.transmittance = Transmittance::last}});
  return frame.buffers().transmittance.bounds->read<float>(model.count());
}

/// Returns the number of Gaussians whose measurement differs from the reference's.
inline std::size_t differing(const std::vector<float>& measured, const Model& model,
                             const shared::View& view) {
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const auto expected =
      reference::floored(reference::measure_transmittance(splats, lists, view), BOUND_FLOOR);
  std::size_t count = 0;
  for (std::size_t i = 0; i < measured.size(); ++i)
    count += std::abs(measured[i] - expected[i]) > 1e-4 ? 1 : 0;
  return count;
}

/// Returns the tile tests that make every visible pair, or those that clip tails. `all` is in neither list:
/// tests compare its pictures with the others'.
inline std::vector<int> tiles_of_kind(bool exact) {
  std::vector<int> tiles;
  for (int t = 0; t < std::ssize(tiles_choices); ++t)
    if (t != TILES_ALL && render::has_every_pair(t) == exact) tiles.push_back(t);
  return tiles;
}
inline const std::vector<int> exact_tiles = tiles_of_kind(true), clipping_tiles = tiles_of_kind(false);

/// The settings of the rule `squared`.
inline render::FrameSettings squared(float tolerance, Transmittance transmittance = Transmittance::one) {
  return {{.tolerance = tolerance, .threshold = Threshold::squared, .transmittance = transmittance}};
}

/// The threshold rules that have a tolerance.
inline constexpr Threshold tolerant_rules[] = {Threshold::adagscale, Threshold::squared};

}  // namespace binosplat::test
