#pragma once
// Everything that the stages of a frame read and write on the GPU.

#include <cstdint>
#include <memory>
#include <vector>

#include "gl/buffer.h"
#include "gl/texture.h"
#include "render/frame_plan.h"
#include "render/gpu_model.h"
#include "render/look_back.h"
#include "render/memory.h"
#include "shared/types.h"

namespace binosplat::render {

/// The Gaussians that an order group draws.
struct DrawnBuffers {
  explicit DrawnBuffers(gl::Context& context)
      : arguments(context, "arguments of the Gaussians drawn"),
        indices(context, "indices of the Gaussians drawn") {}

  gl::Buffer arguments;  // DispatchArguments
  gl::Buffer indices;    // Gaussian by slot
};

/// A Gaussian that a view draws, and its slot.
struct DrawnGaussian {
  std::uint32_t index = 0;  // in the model
  std::uint32_t slot = 0;
};

struct FrameBuffers {
  explicit FrameBuffers(gl::Context& context);
  gl::Context& context() const { return context_; }

  /// What the CPU knows of a frame: its parameters, its views and its table of depths.
  void upload(const FramePlan& plan, bool uses_measured);

  /// Makes room for a frame of this plan, as `capacity` says. To be called before upload().
  void reserve(const FramePlan& plan, std::span<const std::shared_ptr<ModelBuffers>> models,
               const Capacity& capacity);

  /// To be called once a frame is complete: `next_bounds` become the next frame's `bounds`, if this one
  /// measured.
  void keep_last(bool measured_now);

  /// The Gaussians that the last frame drew in its view `v`, in index order.
  std::vector<DrawnGaussian> read_drawn(const FramePlan& plan, std::uint32_t v) const;

  /// The views by which the models are projected.
  const gl::Buffer& views_of_instances(const FramePlan& plan) const {
    return plan.instances.empty() ? views : instance_views;
  }

  std::uint32_t slots = 0;  // room for the Gaussians that one order group draws

  gl::Buffer parameters;      // FrameParameters
  gl::Buffer views;           // View, the probe last
  gl::Buffer instance_views;  // View by (instance, view), where the plan has instances
  gl::Buffer region_rows;     // uvec2 by row of tiles of a view, where a view is not drawn whole
  gl::Buffer counters;        // Counters

  /// The upper bounds of transmittance that thresholds go by: T_upper from a table, or by (view, Gaussian) as
  /// measured for the next frame, written while the last frame's is read. Empty where nothing is measured.
  struct Transmittance {
    gl::Buffer depth_tables;                          // float by bin: the settings', then instances'
    std::unique_ptr<gl::Buffer> bounds, next_bounds;  // float
    gl::Buffer measured;                              // uint by splat, bits of the largest float
  } transmittance;

  // For Scaffold-GS, by page of the model, uint (decoding, anchor): bit k: Gaussian k is there.
  std::vector<std::unique_ptr<gl::Buffer>> kept;

  std::vector<std::unique_ptr<DrawnBuffers>> drawn;  // by order group

  /// What is found of all Gaussians of the model, for one order group after another.
  struct Culled {
    gl::Buffer depth_keys;    // uint by Gaussian
    gl::Buffer block_counts;  // uint, Gaussians drawn by block of COMPACT_BLOCK
  } culled;

  /// What `project` makes of the Gaussians that are drawn, for all views.
  struct Projected {
    gl::Buffer depths;     // uint by (order group, slot): bits of what they are sorted by
    gl::Buffer splats;     // Splat, or Halves by (view, slot)
    gl::Buffer coverages;  // uint by (view, slot): supertiles.glsl
    gl::Buffer large;      // uint, splats in many supertiles
  } projected;

  /// Which splats are in each tile's list.
  struct Lists {
    std::uint32_t first_large = 0;  // entry of large splats: how many others there is room for
    gl::Buffer entries;  // uvec2 (depth, entry) by supertile; then (supertile, entry) of large splats
    gl::Buffer supertile_counts;  // uint; 0 between frames
    gl::Buffer supertile_ends;    // uint, where the next entry of each goes
    std::uint32_t item_room = 0;  // of each kind
    gl::Buffer items;             // uvec4 by kind: sort_items.glsl
    gl::Buffer slab_tiles;        // uint by slab and tile of its list: sort_split.comp

    // The blend reads these.
    gl::Buffer tile_ranges;  // begin and end by tile; with --tiles all by the first tile of a view
    gl::Buffer tile_values;  // splats
    gl::Buffer long_lists;   // tiles with more than LONG_LIST pairs
  } lists;

  /// What the blend makes of the lists.
  struct Pictures {
    gl::Buffer canvases;      // Canvas by view, where pictures go into images, and not into the next two
    gl::Buffer colours;       // vec4 by pixel: C, T
    gl::Buffer z_sums;        // float by pixel
    gl::Buffer mesh_sources;  // MeshSource by view
    // Filled by blend_debug_view().
    gl::Buffer debug_values;         // float by pixel
    gl::Buffer debug_transmittance;  // uint by splat, bits of the largest T
  } pictures;

  gl::Sampler nearest;  // by which the caller's textures are read
  LookBack look_back;

 private:
  gl::Context& context_;
};

}  // namespace binosplat::render
