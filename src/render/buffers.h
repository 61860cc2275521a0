#pragma once
// Everything that the stages of a frame read and write on the GPU.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gl/buffer.h"
#include "primitives/radix_sort.h"
#include "render/anchors.h"
#include "render/shape.h"
#include "scene/model.h"
#include "shared/types.h"

namespace binosplat::render {

/// The model on the GPU, in pages of Gaussians whose buffers a shader can reach. Of Scaffold-GS a page holds
/// whole anchors, and its Gaussians and their colours (as harmonics of degree 0) are made anew each frame,
/// once for each decoding: (decoding, id).
struct ModelBuffers {
  struct Page {
    std::uint32_t first = 0;  // Gaussian of the model
    std::uint32_t count = 0;
    std::unique_ptr<gl::Buffer> gaussians;  // Gaussian, or Halves
    std::unique_ptr<gl::Buffer> harmonics;  // packed vec4s, or as many halves (sh.glsl)
    std::unique_ptr<AnchorBuffers> anchors;
  };

  /// Uploads; `page_gaussians` limits a page for tests, 0: what the driver reaches.
  ModelBuffers(gl::Context& context, const Model& model, int precision = PRECISION_FULL,
               std::uint32_t page_gaussians = 0);

  /// Another model in the place of this one, or the same in another precision, in the buffers that there are
  /// where they are large enough.
  void upload(gl::Context& context, const Model& model, int precision);

  int precision() const { return precision_; }

  /// Room for what a frame of this shape decodes.
  void reserve(const FrameShape& shape);

  /// Once a frame is complete: what it kept of each anchor is the last frame's for the next.
  void keep_last();

  std::vector<Page> pages;
  NetworkBuffers networks;
  std::optional<Bounds> box;  // around all positions; none of a model that is decoded or empty

 private:
  void upload_pages(gl::Context& context, const Model& model, std::size_t step);
  void upload_pages(gl::Context& context, const Scaffold& scaffold, std::size_t step);

  std::uint32_t page_gaussians_;
  int precision_ = PRECISION_FULL;
};

/// Blocks that so many sorted pairs are split among their tiles in.
std::uint32_t tile_blocks(std::int64_t pairs);

/// Pairs that a first frame has room for: most models need some tiles a Gaussian; what is missing is grown.
std::int64_t starting_pairs(const FrameShape& shape);

/// Bytes that the model takes on the GPU, and those that a frame of it starts with besides; a shape whose
/// lists are left to the frame is taken to have one a tile.
struct MemoryNeeds {
  std::int64_t model = 0;
  std::int64_t frame = 0;
};
MemoryNeeds memory_needs(const FrameShape& shape);

/// The Gaussians that an order group draws.
struct DrawnBuffers {
  explicit DrawnBuffers(gl::Context& context)
      : amounts(context, "amounts of the depth order"), indices(context, "indices of the Gaussians drawn") {}

  gl::Buffer amounts;  // SortAmounts
  gl::Buffer indices;  // Gaussian by slot
};

struct FrameBuffers {
  explicit FrameBuffers(gl::Context& context);

  /// What the CPU knows of a frame: its views and its table of depths.
  void upload(const FrameShape& shape);

  /// Room for a frame of this shape and its slots, and so many pairs; and where lists are of several tiles,
  /// so many of the tiles.
  void reserve(const FrameShape& shape, std::int64_t pair_capacity, std::int64_t tile_pair_capacity);

  /// What tiles are blended by: begin and end in the values, by tile; and those, splats.
  gl::Buffer& ranges_of_tiles(const FrameShape& shape) {
    return shape.settings.list_tiles == 1 ? ranges : tile_ranges;
  }
  gl::Buffer& values_of_tiles(const FrameShape& shape) {
    return shape.settings.list_tiles == 1 ? pairs.values() : tile_values;
  }

  gl::Buffer views;     // View, those between eyes last
  gl::Buffer counters;  // Counters

  // Of the order group at hand.
  gl::Buffer depth_keys;          // uint by Gaussian
  gl::Buffer block_amount;        // Amount of the compaction's blocks
  gl::Buffer block_counts;        // uint, Gaussians drawn by block of COMPACT_BLOCK, scanned
  primitives::PairBuffers order;  // depth bits, slot
  gl::Buffer pair_offsets;        // uint by rank in the depth order, scanned

  std::vector<std::unique_ptr<DrawnBuffers>> drawn;  // by order group

  // What is remembered for the next frame's Th, T_upper as float (view, Gaussian); written while the last
  // frame's is read. Empty where nothing is measured.
  std::unique_ptr<gl::Buffer> upper;
  std::unique_ptr<gl::Buffer> upper_next;
  gl::Buffer measured;     // uint by splat, bits of the largest float; two, low first, where weighed
  gl::Buffer depth_table;  // float by bin

  // Of all views.
  gl::Buffer splats;   // Splat, or Halves (view, slot)
  gl::Buffer touched;  // uint (slot, view): lists.glsl
  gl::Buffer tall;     // splats over many rows of tiles
  // In their place, once their tiles are counted: uint (rank, view of the group), lists.glsl.
  gl::Buffer& touched_in_order = tall;
  gl::Buffer pair_amounts;        // SortAmounts of the pairs at hand
  primitives::PairBuffers pairs;  // list (view with --tiles all), splat (lists.glsl)
  gl::Buffer ranges;              // begin, end by list
  // Where lists are of several tiles, in place of `ranges`.
  gl::Buffer tile_amount;  // Amount of the counts below
  gl::Buffer tile_counts;  // uint, pairs by tile of a list, then by block of TILE_BLOCK, scanned
  gl::Buffer tile_ranges;  // begin, end by tile
  gl::Buffer tile_values;  // splats by these
  gl::Buffer long_lists;   // tiles with more than LONG_LIST pairs

  gl::Buffer colours;  // vec4 by pixel: C, T
  gl::Buffer z_sums;   // float by pixel

  // Of show().
  gl::Buffer shown;        // float by pixel
  gl::Buffer shown_light;  // uint by splat, bits of the largest T

  primitives::Scan scan;
  primitives::RadixSort sort;

 private:
  gl::Context& context_;
};

}  // namespace binosplat::render
