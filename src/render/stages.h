#pragma once
// The stages of a frame. Each records its dispatches and returns; frame.cpp calls them in order.

#include "gl/dispatch.h"
#include "render/buffers.h"

namespace binosplat::render {

/// Makes the Gaussians of a Scaffold-GS model for the eyes of the frame. Does nothing for other models.
void decode(gl::Dispatcher& dispatcher, const FramePlan& plan, const ModelBuffers& model,
            const FrameBuffers& buffers);

/// The buffers of the plan's models.
using DrawnModels = std::span<const std::shared_ptr<ModelBuffers>>;

/// Finds the Gaussians that an order group draws, in index order, and makes them as each of its views sees
/// them: splats and tile coverage by slot, depths.
void project(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, bool measures,
             DrawnModels models, FrameBuffers& buffers);

/// Puts (depth, splat) into the list of every supertile that a splat of any view touches, in any order.
void bin(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity, FrameBuffers& buffers);

/// Sorts each supertile's list front to back, ties by the Gaussian's index, and makes its tiles' lists of it.
void sort(gl::Dispatcher& dispatcher, const FramePlan& plan, const Capacity& capacity, FrameBuffers& buffers);

/// Blends the pictures; and, where the frame `measures` the transmittance, the largest that each splat met.
/// `tiles_a_splat` is the last frame's, 0 where it is not known; the pictures do not depend on it.
void blend(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, double tiles_a_splat,
           FrameBuffers& buffers);

/// Writes a debug view of the same lists into `debug_values`: SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of
/// shared/axes.h. The pictures stay.
void blend_debug_view(gl::Dispatcher& dispatcher, const FramePlan& plan, int what, FrameBuffers& buffers);

/// Gives the splats of a frame of one view other colours: vec4 by slot.
void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers);

/// Adds to `sums`, for each splat, alpha * T times `scale` times the picture in buffers.pictures.colours over
/// its pixels; the picture stays. `sums` has an ivec2 of 64 bits a channel, low first. No channel times
/// `scale` may be larger than TRANSPOSED_SCALE.
void blend_transposed(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums);

/// Adds to `sums`, in channel 0 and in multiples of 1 / CHANGE_SCALE, how much each splat alone changes the
/// picture: squared, over its pixels. The splats' picture lies in buffers.pictures.colours, and stays.
void blend_changes(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                   const gl::Buffer& sums);

/// The visibility pass: adds to `sums`, for each splat, alpha T^2 over its pixels while T is at least
/// VISIBILITY_LEAST, in multiples of 1 / VISIBILITY_SCALE. Each splat has two sums: of the low
/// VISIBILITY_LOW_BITS of each tile's sum, and of the bits above.
void blend_visibility(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                      const gl::Buffer& sums);

/// Throws Error(out_of_memory) where the driver ended a list of splats before its end.
void refuse_truncated(const gl::Context& context, const shared::Counters& counters);

/// Keeps what the frame measured for the next one. Does nothing in a frame that measures nothing.
void keep_measured(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, FrameBuffers& buffers);

/// Sums up the squared error in the probe's tiles. Does nothing without a probe.
void probe(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

/// What probe() summed up.
Probed probed(const FramePlan& plan, const shared::Counters& counters);

}  // namespace binosplat::render
