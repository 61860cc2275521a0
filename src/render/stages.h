#pragma once
// The stages of a frame. Each records its dispatches and returns; frame.cpp calls them in order.

#include "gl/dispatch.h"
#include "render/buffers.h"

namespace binosplat::render {

/// The Gaussians of a Scaffold-GS model for the eyes of the frame. Nothing to do for other models.
void decode(gl::Dispatcher& dispatcher, const FramePlan& plan, const ModelBuffers& model,
            const FrameBuffers& buffers);

/// The Gaussians that an order group draws, in index order, as each of its views sees them: splats and tile
/// counts by slot, depths.
void project(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, bool measures,
             const ModelBuffers& model, FrameBuffers& buffers);

/// Their slots front to back, ties by index.
void order(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, FrameBuffers& buffers);

/// (supertile, splat) for every supertile that a splat of the group touches, in depth order, appended to what
/// is there.
void pairs(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t group, FrameBuffers& buffers);

/// All pairs by supertile, in depth order within each.
void tile_sort(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

/// Where each tile's list lies among the pairs.
void ranges(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

/// Tiles whose lists are long, which are blended by a launch of their own: once a frame, before its first
/// blend.
void find_long_lists(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

/// The pictures; and, where the frame `measures` the transmittance, the largest that each splat met.
/// `tiles_a_splat`: of the last frame, 0: not known; the pictures do not depend on it.
void blend(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, double tiles_a_splat,
           FrameBuffers& buffers);

/// A debug view of the same lists, into `debug_values`: SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of shared/axes.h.
/// The pictures stay.
void blend_debug_view(gl::Dispatcher& dispatcher, const FramePlan& plan, int what, FrameBuffers& buffers);

/// Other colours for the splats of a frame of one view: vec4 by slot.
void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers);

/// Adds alpha * T times `scale` times the picture in buffers.colours, which stays, over the pixels of each
/// splat to `sums`: by channel, ivec2 of 64 bits, low first. No channel times `scale` may be larger than
/// TRANSPOSED_SCALE.
void blend_transposed(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums);

/// Adds to `sums`, in channel 0 and multiples of 1 / CHANGE_SCALE, the squared change of each pixel of the
/// picture in buffers.colours, which is theirs and stays, where the splat alone is left out.
void blend_changes(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                   const gl::Buffer& sums);

/// The visibility pass: adds alpha T^2, while T is VISIBILITY_LEAST at least, over the pixels of each splat
/// to `sums`, in multiples of 1 / VISIBILITY_SCALE: by splat, VISIBILITY_LOW_BITS of what each tile has, and
/// those above.
void blend_visibility(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers,
                      const gl::Buffer& sums);

/// Throws Error(out_of_memory) where the driver ended a list of splats before its end.
void refuse_truncated(const gl::Context& context, const shared::Counters& counters);

/// Keeps what the frame measured for the next one, and tells the median depth. Nothing to do for a frame that
/// neither measures nor has a probe.
void keep_measured(gl::Dispatcher& dispatcher, const FramePlan& plan, bool measures, FrameBuffers& buffers);

/// Sums up the squared error in the probe's tiles. Nothing to do without one.
void probe(gl::Dispatcher& dispatcher, const FramePlan& plan, FrameBuffers& buffers);

/// What probe() summed up.
Probed probed(const FramePlan& plan, const shared::Counters& counters);

/// Fills the arguments of the pairs that are to be made, ARGUMENTS_PAIRS, or sorted, ARGUMENTS_ALL_PAIRS.
void count_pairs(gl::Dispatcher& dispatcher, const FramePlan& plan, std::uint32_t kind,
                 FrameBuffers& buffers);

}  // namespace binosplat::render
