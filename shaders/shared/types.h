// Structs that GLSL and C++ share, in the layout std430. Members are float, uint, vec2 and vec4 only: vec3
// and mat3 pad differently in the two languages. C++ checks sizes here; tests/gl compares offsets with the
// driver's.
#ifndef BINOSPLAT_SHARED_TYPES_H
#define BINOSPLAT_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#endif

#include "shared/limits.h"

#ifdef __cplusplus
namespace binosplat::shared {
using uint = std::uint32_t;
using vec2 = glm::vec2;
using vec4 = glm::vec4;
#endif

// One view's camera. World to eye is v = rows * (p - anchor) + translation; the rows are the camera's axes (x
// right, y down, z forward) in the world. The anchor is a point near all views, and equal in the views of a
// rig. Subtracting it first keeps fp32 exact far from the origin. Views with equal anchors and third rows
// have bit-equal depths.
//
// Each instance of a model has views of its own (render/instance.h), in which the world is the model's and
// the rows are as long as `eye.w`.
struct View {
  vec4 row_x;   // axis x, then translation x
  vec4 row_y;   // axis y, then translation y
  vec4 row_z;   // axis z (forward), then translation z
  vec4 anchor;  // world point; w: near, the smallest depth drawn (world units)
  vec4 eye;     // the eye minus the anchor, world axes; w: world units of the frame to one of the model
  vec4 lens;    // fx, fy, cx, cy in px
  vec4 slopes;  // limits of v.x / v.z and v.y / v.z in J: lowest x, y, highest x, y (docs/method.md 2)
  vec4 centre;  // origin of sorted distances minus the anchor: the eye, or a rig's midpoint; w: the largest
                // (v.x^2 + v.y^2) / v.z^2 of a ray in the picture
  uint width;   // px
  uint height;  // px
  uint tiles_x;
  uint tiles_y;
  uint supertile_offset;  // this view's first supertile in the frame
  uint pixel_offset;      // this view's first pixel in the frame's pixel buffers
  uint order_group;       // views of equal number have equal depths
  uint pitch;             // px from tile to tile: a tile's side; more in a probe, whose tiles lie apart
  uint shift_x;           // px, the begin of its first tile
  uint shift_y;
  uint is_probe;          // 1: only tiles that lie apart, drawn exactly
  uint left;              // px: a window's begin in the whole picture, else 0
  uint top;               // (`width` and `height` are the window's own)
  uint first_row;         // index of its first row of tiles in region_rows (tiles/regions.glsl)
  float tolerance_share;  // its tolerance over the frame's
  float low_pass_share;   // share of the low-pass that costs Gaussians no weight (projection.glsl)
  uint lists_shift;       // columns of supertiles, if it shares lists as the second eye (supertiles.glsl)
  float opacity;          // factor of each Gaussian's opacity
  float table_far;        // world units of the frame, the end of the table by depth
  uint table_first;       // index of the table's first bin in the buffer of tables
  uint table_bins;
  uint unused_1, unused_2, unused_3;
};

// Values of a whole frame. They are in a uniform block, whose std140 equals std430 without arrays.
struct FrameParameters {
  vec4 background;       // rgb, display-referred; w: unused
  float tolerance;       // of the threshold rule: K or kappa
  uint has_bounds;       // 0: no earlier frame measured bounds for this one
  uint view_count;       // including the probe
  uint requested_views;  // views without the probe, which comes next and is exact
  uint probed_view;      // index of the view that the probe samples; MAX_VIEWS without one
  uint gaussian_count;   // of all instances
  uint slots;            // room for Gaussians in each view
  uint tile_count;       // tiles of all supertiles, over all views
  uint list_per_view;    // 1 with --tiles all: a view's tiles share one list
  uint has_regions;      // 1: some views have regions
  // For Scaffold-GS:
  uint offset_count;        // K
  uint views_per_decoding;  // views that share decoded Gaussians
  uint decoding_of_probe;   // index of the decoding that the probe shares with its view
  uint anchor_cull;         // 1: skips anchors that touch no tile of 3D-GS
  float depth_slack;        // how much nearer a splat may be than its predecessors in a list, world units
  uint unused;
};

// A Gaussian of the model on the GPU. Its SH coefficients are in another buffer.
struct Gaussian {
  vec4 position;  // world; w: opacity in [0, 1]
  vec4 rotation;  // unit quaternion (w, x, y, z)
  vec4 scale;     // standard deviations along its axes, world units; w: unused
};

// An anchor of a Scaffold-GS model on the GPU. Its Gaussians' offsets are in another buffer.
struct Anchor {
  vec4 position;      // world
  vec4 rotation;      // unit quaternion (w, x, y, z)
  vec4 offset_scale;  // world units of an offset; the anchor cull projects it with `rotation`
  vec4 scale;         // the largest standard deviations of its Gaussians, world units
};

// A Gaussian projected into one view.
struct Splat {
  vec2 mean;      // px; the centre of pixel (i, j) lies at (i, j)
  float depth;    // view z, world units
  float opacity;  // sigma
  vec4 conic;     // Q.xx, Q.xy, Q.yy in px^-2; w: sqrt(det C2) in px^2
  vec4 colour;    // rgb, display-referred; w: rho = 2 ln(sigma / Th), for tile tests and approximate blocks
};

// The destination of a view's final picture, in the image of the view's index.
struct Canvas {
  uint left;  // px, its lower left corner
  uint bottom;
  uint steps;        // largest integer of the image's colours; 0: floats
  uint keeps_alpha;  // 1: no background, but premultiplied alpha
  uint linear;       // 1: the image stores linear light instead of display values
  uint unused_1, unused_2, unused_3;
};

// A view's mesh depths in the texture of the view's index, and their meaning.
struct MeshSource {
  vec2 step;        // texels per pixel of the view
  uint left, top;   // the texel of the picture's upper left pixel
  uint level;       // of the texture
  uint is_inverse;  // 1: z = 1 / (scale d + offset), d the texture's number; 0: z = scale d
  float scale, offset;
  float nothing;  // d of pixels without a mesh
  float unused_1, unused_2, unused_3;
};

// A ray for a pixel of another picture (a panorama), given by its point in a view's picture.
struct PlacedRay {
  vec2 pixel;  // in the view's picture; (0, 0) is the centre of the first pixel
  uint place;  // index of its pixel in the other picture, row by row
  uint unused;
};

// The number of lists of one kind (SORT_KINDS), and the groups of the dispatch that sorts or splits them.
struct ListCount {
  uint count;
  uint groups_x, groups_y, groups_z;
};

// The counts of a frame on the GPU, read back at its end. An overflow bit marks a buffer that was too small
// for the number wanted; the frame is then drawn again with larger ones.
struct Counters {
  uint visible;          // Gaussians drawn, summed over the order groups
  uint slots_wanted;     // the most Gaussians that one order group had
  uint pairs;            // entries wanted: pairs with supertiles; both eyes have one if they share lists
  uint tile_pairs;       // Gaussian-tile pairs wanted, over all views
  uint overflow;         // OVERFLOW_ bits
  uint truncated_lists;  // tiles whose list the driver ended early: the picture must not be used
  uint depths_low;       // sum of the sort keys of the Gaussians (bits of floats, world units) over
  uint depths_high;      // COMPACT_BLOCK: low and high half
  uint probe_low;   // squared error of the probe, summed over pixels and channels, times PROBE_SCALE: low and
  uint probe_high;  // high half
  uint probe_squares_low;  // squares of such sums of THREADS pixels each, low and high half
  uint probe_squares_high;
  uint long_lists;  // tiles with more than LONG_LIST pairs, and the groups of their dispatch
  uint long_x, long_y, long_z;
  uint large_splats;  // splats in many supertiles (as `pairs`), and the groups of their dispatch
  uint large_x, large_y, large_z;
  uint large_entries;  // entries of these, and the groups of the dispatch that places them
  uint fill_x, fill_y, fill_z;
  uint slabs;  // slabs of long lists
  uint unused_1, unused_2, unused_3;
  ListCount lists[SORT_KINDS];
};

#define COUNT_MAX 0xFFFFFFFFu
#define PROBE_SCALE 4194304.0       // 2^22: a work group's sum of at most 3 * THREADS stays below 2^32
#define DEPTH_KEY_NONE 0xFFFFFFFFu  // the key of a Gaussian that no view of the order group draws
#define OVERFLOW_ORDER 1u
#define OVERFLOW_LARGE 2u  // entries of large splats
#define OVERFLOW_PAIRS 4u
#define OVERFLOW_COUNT 8u      // too many entries to count
#define OVERFLOW_UNSORTED 15u  // any of those above: the lists are invalid
#define OVERFLOW_TILE_PAIRS 16u
#define OVERFLOW_ROUNDS 32u  // a list needs more rounds of splitting

// The number of objects that only the GPU knows, and its indirect dispatches. Group counts are split into x
// and y for drivers that allow few along x.
struct DispatchArguments {
  uint count;
  uint threads_x, threads_y, threads_z;  // THREADS objects a group
  uint bin_x, bin_y, bin_z;              // BIN_BLOCK objects a group
  uint unused;
};

#ifdef __cplusplus
static_assert(sizeof(View) == 224 && offsetof(View, slopes) == 96 && offsetof(View, low_pass_share) == 188);
static_assert(sizeof(FrameParameters) == 80 && offsetof(FrameParameters, tolerance) == 16);
static_assert(sizeof(Gaussian) == 48 && offsetof(Gaussian, scale) == 32);
static_assert(sizeof(Anchor) == 64 && offsetof(Anchor, scale) == 48);
static_assert(sizeof(Splat) == 48 && offsetof(Splat, conic) == 16 && offsetof(Splat, colour) == 32);
static_assert(sizeof(Canvas) == 32 && offsetof(Canvas, linear) == 16);
static_assert(sizeof(MeshSource) == 48 && offsetof(MeshSource, scale) == 24);
static_assert(sizeof(PlacedRay) == 16 && offsetof(PlacedRay, place) == 8);
static_assert(sizeof(ListCount) == 16 && sizeof(Counters) == 112 + SORT_KINDS * 16);
static_assert(offsetof(Counters, large_x) == 68 && offsetof(Counters, lists) == 112);
static_assert(sizeof(DispatchArguments) == 32 && offsetof(DispatchArguments, bin_x) == 16);
}  // namespace binosplat::shared
#endif

#endif
