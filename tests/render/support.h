#pragma once
// What the stage tests share: small frames, and their buffers read back.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "base/image.h"
#include "measure/metrics.h"
#include "primitives/amount.h"
#include "reference/render.h"
#include "reference/transmittance.h"
#include "render/frame.h"
#include "render/stages.h"
#include "scene/camera.h"
#include "support/gl.h"
#include "support/models.h"

namespace binosplat::test {

inline std::vector<Picture> draw(const Model& model, const std::vector<shared::View>& views,
                                 const render::FrameSettings& settings = {}) {
  render::Frame frame(gl_context(), model);
  frame.draw(views, settings);
  return frame.read_pictures();
}

inline Picture draw(const Model& model, const shared::View& view,
                    const render::FrameSettings& settings = {}) {
  return draw(model, std::vector{view}, settings).front();
}

/// Whether two pictures are equal bit for bit; says where they are not.
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

/// PSNR over black, floats.
inline double psnr(const Picture& a, const Picture& b) {
  return measure::psnr(composite(a, glm::vec3(0.0f)), composite(b, glm::vec3(0.0f)));
}

/// The stages of a frame run one after another by themselves, with every buffer at hand.
struct StageRun {
  StageRun(const Model& model, const std::vector<shared::View>& views,
           const render::FrameSettings& settings = {}, const std::optional<render::Probe>& probe = {})
      : shape(render::make_shape(views, settings, model, probe)),
        frame(gl_context()),
        model_buffers(gl_context(), model) {
    if (model_buffers.box) render::limit_keys(shape, *model_buffers.box);
    frame.upload(shape);
    frame.counters.upload(std::vector{shared::Counters{}});
    frame.reserve(shape, 1 << 20, 1 << 20);
    model_buffers.reserve(shape);
    const std::uint32_t blocks = (shape.gaussian_count + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
    frame.block_amount.upload(std::vector{primitives::make_amount(blocks, gl_context().limits().groups)});
  }

  void run_until(render::Stage stage) {
    gl::Dispatcher dispatcher(gl_context());
    render::decode(dispatcher, shape, model_buffers, frame);
    if (stage == render::Stage::decode) return;
    for (std::uint32_t group = 0; group < shape.groups.size(); ++group) {
      render::project(dispatcher, shape, group, model_buffers, frame);
      indices.push_back(frame.drawn[group]->indices.read<std::uint32_t>(
          frame.drawn[group]->amounts.read<shared::Amount>(1).front().count));
      if (stage == render::Stage::project) continue;
      render::order(dispatcher, shape, group, frame);
      if (stage != render::Stage::order) render::pairs(dispatcher, shape, group, frame);
    }
    if (stage <= render::Stage::pairs) return;
    render::tile_sort(dispatcher, shape, frame);
    if (stage == render::Stage::tile_sort) return;
    render::ranges(dispatcher, shape, frame);
  }

  /// The splats of a view by Gaussian of the model; tiles 0 where the view does not draw it. With lists of
  /// one tile: those of several are not only counted (lists.glsl).
  struct Projected {
    std::vector<shared::Splat> splats;
    std::vector<std::uint32_t> tiles;
  };
  Projected projected(std::uint32_t view) const {
    const std::size_t all = std::size_t{shape.slots} * shape.view_count();
    const auto splats = frame.splats.read<shared::Splat>(all);
    const auto tiles = frame.touched.read<std::uint32_t>(all);
    Projected out{std::vector<shared::Splat>(shape.gaussian_count),
                  std::vector<std::uint32_t>(shape.gaussian_count)};
    const auto& drawn = indices[shape.views[view].order_group];
    for (std::size_t slot = 0; slot < drawn.size(); ++slot) {
      out.splats[drawn[slot]] = splats[std::size_t{view} * shape.slots + slot];
      out.tiles[drawn[slot]] = tiles[slot * shape.view_count() + view];
    }
    return out;
  }

  render::FrameShape shape;
  render::FrameBuffers frame;
  render::ModelBuffers model_buffers;
  std::vector<std::vector<std::uint32_t>> indices;  // Gaussian by slot, for each order group
};

/// What a first frame leaves for the next, by Gaussian (Scaffold-GS: by id).
inline std::vector<float> measured_on_gpu(const Model& model, const shared::View& view) {
  StageRun run(model, {view}, {.transmittance = TRANSMITTANCE_LAST});
  run.shape.records = true;
  run.run_until(render::Stage::ranges);
  gl::Dispatcher dispatcher(gl_context());
  render::blend(dispatcher, run.shape, run.frame);
  render::remember(dispatcher, run.shape, run.frame);
  return run.frame.upper_next->read<float>(model.count());
}

/// How many Gaussians have another measurement in the reference than these.
inline std::size_t differing(const std::vector<float>& measured, const Model& model,
                             const shared::View& view) {
  const auto splats = reference::project_all(model, view);
  const auto lists = reference::make_lists(splats, reference::depth_order(splats), view, TILES_ELLIPSE);
  const auto expected =
      reference::floored(reference::measure_transmittance(splats, lists, view), UPPER_FLOOR);
  std::size_t count = 0;
  for (std::size_t i = 0; i < measured.size(); ++i)
    count += std::abs(measured[i] - expected[i]) > 1e-4 ? 1 : 0;
  return count;
}

}  // namespace binosplat::test
