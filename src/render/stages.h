#pragma once
// The stages of a frame. Each records its dispatches and returns; frame.cpp calls them in order.

#include "gl/dispatch.h"
#include "render/buffers.h"

namespace binosplat::render {

/// The Gaussians of a Scaffold-GS model for the eyes of the frame. Nothing to do for other models.
void decode(gl::Dispatcher& dispatcher, const FrameShape& shape, const ModelBuffers& model,
            const FrameBuffers& buffers);

/// The Gaussians that an order group draws, in index order, as each of its views sees them: splats and tile
/// counts by slot, depths.
void project(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group,
             const ModelBuffers& model, FrameBuffers& buffers);

/// Their slots front to back, ties by index.
void order(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group, FrameBuffers& buffers);

/// (tile, splat) for every tile that a splat of the group touches, in depth order, appended to what is there.
void pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t group, FrameBuffers& buffers);

/// All pairs by tile, in depth order within a tile.
void tile_sort(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// Where each tile's list lies among the pairs.
void ranges(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// Tiles whose lists are long, which are blended by a launch of their own: once a frame, before its first
/// blend.
void find_long_lists(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// The pictures; and, for a transmittance that is measured, the most that each splat counted for.
void blend(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// What the blend of the same lists comes by in each pixel, into `shown`: SHOW_ALPHAS to SHOW_MEDIAN_DEPTH of
/// shared/axes.h. The pictures stay.
void show(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, int what);

/// Other colours for the splats of a frame of one view: vec4 by slot.
void recolour(gl::Dispatcher& dispatcher, std::uint32_t slots, const gl::Buffer& colours,
              FrameBuffers& buffers);

/// Adds alpha * T times `scale` times the picture in buffers.colours, which stays, over the pixels of each
/// splat to `sums`: by channel, ivec2 of 64 bits, low first. No channel times `scale` may be larger than
/// TRANSPOSED_SCALE.
void blend_transposed(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers, float scale,
                      const gl::Buffer& sums);

/// Adds to `sums`, in channel 0 and multiples of 1 / CHANGE_SCALE, the squared change of each pixel of the
/// picture in buffers.colours, which is theirs and stays, where the splat alone is left out.
void blend_changes(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers,
                   const gl::Buffer& sums);

/// Adds alpha T^2, while T is SEEN_LEAST at least, over the pixels of each splat to `sums`, in multiples of
/// 1 / SEEN_SCALE: by splat, SEEN_LOW_BITS of what each tile has, and those above.
void blend_seen(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers,
                const gl::Buffer& sums);

/// Throws Error(out_of_memory) where the driver ended a list of splats before its end.
void refuse_cut(const gl::Context& context, const shared::Counters& counters);

/// Keeps what was measured for the next frame, and tells the median depth. Nothing to do where nothing is
/// measured.
void remember(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// Sums up the squared error in the probe's tiles. Nothing to do without one.
void probe(gl::Dispatcher& dispatcher, const FrameShape& shape, FrameBuffers& buffers);

/// What probe() summed up.
Probed probed(const FrameShape& shape, const shared::Counters& counters);

/// WITH_SUBGROUPS, for programs that do the same by subgroups of 32 where there are some.
gl::Defines::value_type subgroups_define(const gl::Context& context);

/// Fills the arguments of the pairs that are to be made, ARGUMENTS_PAIRS, or sorted, ARGUMENTS_ALL_PAIRS.
void count_pairs(gl::Dispatcher& dispatcher, const FrameShape& shape, std::uint32_t kind,
                 FrameBuffers& buffers);

/// Shader defines of a projection, PROJECTION_ of shared/axes.h.
void add_projection(gl::Defines& defines, int projection);

/// Shader defines that pick the variant of a stage which decides pairs.
gl::Defines pair_defines(const FrameShape& shape);

}  // namespace binosplat::render
