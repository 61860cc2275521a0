#pragma once
// The buffers that the stages of a frame read and write on the GPU.

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
  gl::Buffer indices;    // uint by slot: the index of a Gaussian
};

struct DrawnGaussian {
  std::uint32_t index = 0;  // in the model
  std::uint32_t slot = 0;
};

struct FrameBuffers {
  explicit FrameBuffers(gl::Context& context);
  gl::Context& context() const { return context_; }

  /// Uploads the frame's parameters, views and table by depth.
  void upload(const FramePlan& plan, bool uses_measured);

  /// Allocates buffers of `capacity` for a frame of this plan. Call it before upload().
  void reserve(const FramePlan& plan, std::span<const std::shared_ptr<ModelBuffers>> models,
               const Capacity& capacity);

  /// Call it when a frame is complete. If the frame measured, its `next_bounds` become the `bounds` of the
  /// next frame.
  void swap_bounds(bool measured_now);

  /// The Gaussians that the last frame drew in its view `v`, in index order.
  std::vector<DrawnGaussian> read_drawn(const FramePlan& plan, std::uint32_t v) const;

  /// The views with which `project` projects the models.
  const gl::Buffer& views_of_instances(const FramePlan& plan) const {
    return plan.instances.empty() ? views : instance_views;
  }

  std::uint32_t slots = 0;  // capacity for Gaussians of one order group

  gl::Buffer parameters;      // FrameParameters
  gl::Buffer views;           // View; the last is the error sample's
  gl::Buffer instance_views;  // View by (instance, view); used if the plan has instances
  gl::Buffer region_rows;     // uvec2 by row of tiles of a view; used if a view has a region
  gl::Buffer counters;        // Counters

  /// The upper bounds of transmittance: a table by depth, or measured values by (view, Gaussian). A frame
  /// reads `bounds` and writes `next_bounds`. If no frame measures, the buffers of measured values are empty.
  struct TransmittanceBounds {
    gl::Buffer depth_tables;  // float by bin: the settings' table, then the instances'
    std::unique_ptr<gl::Buffer> bounds, next_bounds;  // float
    gl::Buffer measured;                              // uint by splat: the bits of the largest T as a float
  } transmittance;

  // For Scaffold-GS, one buffer per page of the model: uint by (view, anchor). Bit k is set if the
  // anchor's Gaussian k exists.
  std::vector<std::unique_ptr<gl::Buffer>> kept;

  std::vector<std::unique_ptr<DrawnBuffers>> drawn;  // by order group

  /// The result of the cull over all Gaussians of the model; each order group overwrites it.
  struct Culled {
    gl::Buffer depth_keys;    // uint by Gaussian
    gl::Buffer block_counts;  // uint by block of COMPACT_BLOCK Gaussians: how many of them are drawn
  } culled;

  /// The results of `project` for the drawn Gaussians of all views.
  struct Projected {
    gl::Buffer depths;     // uint by (order group, slot): the bits of the sort key
    gl::Buffer splats;     // Splat or Halves, by (view, slot)
    gl::Buffer discs;      // vec4 by (view, slot): project.comp; used if the plan has discs
    gl::Buffer coverages;  // uint by (view, slot): supertiles.glsl
    gl::Buffer large;      // uint: splats in many supertiles
  } projected;

  struct Lists {
    std::uint32_t large_offset = 0;  // index of the first entry of large splats, after all others
    gl::Buffer entries;  // uvec2 (depth, entry) by supertile; then (supertile, entry) of large splats
    gl::Buffer supertile_counts;      // uint by supertile; 0 between frames
    gl::Buffer supertile_ends;        // uint by supertile: the place of its list's next entry
    std::uint32_t item_capacity = 0;  // of each kind
    gl::Buffer items;                 // uvec4 by kind: lists to sort (sort_items.glsl)
    gl::Buffer slab_tiles;            // uint by (slab, tile of its list): sort_split.comp

    // The lists that the blend reads:
    gl::Buffer tile_ranges;  // uvec2 by tile: begin, end in tile_values; TILES_ALL: at a view's first tile
    gl::Buffer tile_values;  // uint: indices of splats
    gl::Buffer long_lists;   // tiles with more than LONG_LIST pairs
  } lists;

  struct Pictures {
    gl::Buffer canvases;      // Canvas by view; a frame on canvases leaves colours unwritten
    gl::Buffer colours;       // vec4 by pixel: C, T
    gl::Buffer z_sums;        // float by pixel
    gl::Buffer unfinished;    // blend.comp: pixels whose lists are continued
    gl::Buffer mesh_sources;  // MeshSource by view
    // Written by blend_debug_view():
    gl::Buffer debug_values;         // float by pixel
    gl::Buffer debug_transmittance;  // uint by splat: the bits of the largest T
  } pictures;

  gl::Sampler nearest;  // reads the caller's textures
  LookBack look_back;

 private:
  gl::Context& context_;
};

}  // namespace binosplat::render
