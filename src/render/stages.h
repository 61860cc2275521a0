#pragma once
// The stages of a frame. Each records its dispatches and returns; frame.cpp calls them in order.

#include "gl/dispatch.h"
#include "render/buffers.h"

namespace binosplat::render {

/// Decodes the Gaussians of a Scaffold-GS model for the frame's eyes. Does nothing for other models.
void decode(gl::Dispatcher& dispatcher, const FramePlan& plan, const ModelBuffers& model,
            const FrameBuffers& buffers);

using DrawnModels = std::span<const std::shared_ptr<ModelBuffers>>;

/// Culls the Gaussians for an order group, and projects the remaining Gaussians in index order for each of
/// its views. Writes splats and tile coverage by slot, and depths.
void project(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, bool measures,
             DrawnModels models, FrameBuffers& buffers);

/// Writes (depth, splat) into the list of every supertile that a splat of any view touches, in any order.
void bin(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity, FrameBuffers& buffers);

/// Sorts each supertile's list front to back, and splats of equal depth by the Gaussian's index. Makes the
/// lists of the supertile's tiles.
void sort(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity, FrameBuffers& buffers);

/// What the previous frame's lists were in the mean; 0 if unknown.
struct ListMeans {
  double tiles_a_splat = 0.0, splats_a_tile = 0.0;
};

/// Blends the pictures. If the frame `measures` the transmittance, also stores the largest T of each splat.
/// `means` affects only speed.
void blend(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, const ListMeans& means,
           FrameBuffers& buffers);

/// Writes a debug view of the frame's lists into `debug_values`: SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of
/// shared/choices.h. Leaves the pictures unchanged.
void blend_debug_view(gl::Dispatcher& dispatcher, const FramePlan& plan, int what, FrameBuffers& buffers);

/// Replaces the colours of the splats of a one-view frame: vec4 by slot.
void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers);

/// For each splat, adds to `sums` the sum over its pixels of alpha * T * `scale` times the picture in
/// buffers.pictures.colours, which stays unchanged. `sums` has 64 bits per channel, as an ivec2, low word
/// first. No channel of the picture times `scale` may exceed TRANSPOSED_SCALE.
void blend_transposed(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums);

/// For each splat, adds to channel 0 of `sums` the squared change of the picture if this splat is removed,
/// summed over its pixels, in multiples of 1 / CHANGE_SCALE. The picture is in buffers.pictures.colours, and
/// stays unchanged.
void blend_changes(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                   const gl::Buffer& sums);

/// The visibility pass: for each splat, adds to `sums` the sum of alpha T^2 over its pixels, in units of 1 /
/// VISIBILITY_SCALE. The blend of a pixel ends when its T falls below VISIBILITY_MIN. Each splat has two
/// sums: of the low VISIBILITY_LOW_BITS of each tile's sum, and of the bits above.
void blend_visibility(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                      const gl::Buffer& sums);

/// Throws Error(out_of_memory) if the driver truncated a list of splats.
void throw_if_truncated(const gl::Context& context, const shared::Counters& counters);

/// Stores the frame's measurements for the next frame. Does nothing in a frame that does not measure.
void store_measured(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, FrameBuffers& buffers);

/// Sums the squared error in the probe's tiles. Does nothing without a probe.
void probe(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

ProbeResult probe_result(const FramePlan& plan, const shared::Counters& counters);

}  // namespace binosplat::render
