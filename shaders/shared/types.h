// Structs that GLSL and C++ share, laid out by std430. Members are float, uint, vec2 and vec4 only: vec3 and
// mat3 pad differently in the two languages. C++ checks sizes here; tests/gl asks the driver for the offsets.
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

// One view's camera. World to eye is v = rows * (p - anchor) + translation, rows the camera's axes (x right,
// y down, z forward) in the world. The anchor is a point near all views, the same number in the views of a
// rig: subtracting it first keeps fp32 exact far from the origin, and views with equal anchors and third rows
// see equal depths to the bit.
//
// A model that stands elsewhere than at the frame's origin has views of its own (render/instance.h): then the
// world is the model's, and the rows are as long as `eye.w`.
struct View {
  vec4 row_x;   // axis x, then translation x
  vec4 row_y;   // axis y, then translation y
  vec4 row_z;   // axis z (forward), then translation z
  vec4 anchor;  // world point; w: near, the smallest depth drawn (world units)
  vec4 eye;     // the eye minus the anchor, world axes; w: world units of the frame to one of the model
  vec4 lens;    // fx, fy, cx, cy in px
  vec4 slopes;  // v.x / v.z and v.y / v.z at which J is taken: lowest x, y, highest x, y (docs/method.md 2)
  vec4 centre;  // what distances are sorted by, minus the anchor: the eye, or the point between those of a
                // rig; w: the largest (v.x^2 + v.y^2) / v.z^2 of a ray in the picture
  uint width;   // px
  uint height;  // px
  uint tiles_x;
  uint tiles_y;
  uint supertile_offset;  // this view's first supertile in the frame
  uint pixel_offset;      // this view's first pixel in the frame's pixel buffers
  uint order_group;       // views of equal number see equal depths
  uint pitch;  // px from one of its tiles to the next: a tile's side; more in a probe, whose tiles lie apart
  uint shift_x;  // px, where its first tile begins
  uint shift_y;
  uint is_probe;          // 1: only tiles that lie apart, drawn exactly
  uint left;              // px: where its picture begins in the whole one; above 0 in a window, whose
  uint top;               // `width` and `height` are its own
  uint first_row;         // place of its first row of tiles in region_rows (tiles/regions.glsl)
  float tolerance_share;  // its tolerance over the frame's
  float low_pass_share;   // share of the low-pass that takes no weight from Gaussians (projection.glsl)
  uint lists_shift;       // columns of supertiles, where it shares lists as the second eye (supertiles.glsl)
  float opacity;          // times each Gaussian's
  float table_far;        // world units of the frame, where the table of depths ends
  uint table_first;       // the table's first bin in the buffer of tables
  uint table_bins;
  uint unused_1, unused_2, unused_3;
};

// What holds for all of a frame. It lies in a uniform block, whose std140 agrees with std430 where there are
// no arrays.
struct FrameParameters {
  vec4 background;      // rgb, display-referred; w: unused
  float tolerance;      // of the threshold rule: K or kappa
  uint has_bounds;      // 0: no earlier frame measured bounds of the transmittance for this one
  uint view_count;      // with the probe
  uint asked;           // views without the probe, which comes next and is exact
  uint probed;          // the number of the view that the probe is of; MAX_VIEWS without one
  uint gaussian_count;  // of all instances of the models
  uint slots;           // how many each view has room for
  uint tile_count;      // tiles of all supertiles, over all views
  uint list_per_view;   // 1 with --tiles all: a view's tiles share one list
  uint has_regions;     // 1: of some views only regions are drawn
  // For Scaffold-GS:
  uint offset_count;        // K
  uint views_per_decoding;  // views that share what the networks made
  uint decoding_of_probe;   // number of the decoding that the probe shares with its view
  uint anchor_cull;         // 1: anchors that touch no tile of 3D-GS are not decoded
  float depth_slack;        // how much nearer splats may be than those before them in a list, world units
  uint unused;
};

// A Gaussian of the model as the GPU keeps it. Its SH coefficients lie in a buffer of their own.
struct Gaussian {
  vec4 position;  // world; w: opacity in [0, 1]
  vec4 rotation;  // unit quaternion (w, x, y, z)
  vec4 scale;     // standard deviations along its axes, world units; w: unused
};

// An anchor of a Scaffold-GS model as the GPU keeps it. Its Gaussians' offsets lie in a buffer of their own.
struct Anchor {
  vec4 position;      // world
  vec4 rotation;      // unit quaternion (w, x, y, z)
  vec4 offset_scale;  // world units of an offset; with `rotation` what the anchor cull projects
  vec4 scale;         // the largest standard deviations of its Gaussians, world units
};

// A Gaussian as one view sees it.
struct Splat {
  vec2 mean;      // px; the centre of pixel (i, j) lies at (i, j)
  float depth;    // view z, world units
  float opacity;  // sigma
  vec4 conic;     // Q.xx, Q.xy, Q.yy in px^-2; w: sqrt(det C2) in px^2
  vec4 colour;    // rgb, display-referred; w: rho = 2 ln(sigma / Th), the level that tile tests use, and the
                  // blocks of the approximate blend
};

// Where the blend writes a view's picture as it is shown, in the image of the view's number.
struct Canvas {
  uint left;  // px, its lower left corner
  uint bottom;
  uint steps;        // how many values above 0 the image's colours have; 0: they are floats
  uint keeps_alpha;  // 1: no background, but associated alpha
  uint linear;       // 1: the image's numbers mean light, not what a screen takes
  uint unused_1, unused_2, unused_3;
};

// Where a view's depths of meshes are in the texture of the view's number, and how they are read.
struct MeshSource {
  vec2 step;        // texels to a pixel of the view
  uint left, top;   // the texel of the picture's upper left pixel
  uint level;       // of the texture
  uint is_inverse;  // 1: z = 1 / (scale d + offset), d being the texture's number; 0: z = scale d
  float scale, offset;
  float nothing;  // d of pixels without a mesh
  float unused_1, unused_2, unused_3;
};

// A ray for a pixel of another picture (a panorama), by where it meets a view's picture.
struct PlacedRay {
  vec2 pixel;  // in the view's picture; (0, 0) is the centre of the first pixel
  uint place;  // number of its pixel in the other picture, row by row
  uint unused;
};

// Lists of one kind (SORT_KINDS), and the groups of the launch that sorts or parts them.
struct ListCount {
  uint count;
  uint groups_x, groups_y, groups_z;
};

// What a frame counts on the GPU, read back after it. An overflow bit says that a buffer was too small for
// the number wanted; the frame is then drawn again with larger ones.
struct Counters {
  uint visible;          // Gaussians drawn, summed over the order groups
  uint order_wanted;     // the most Gaussians that one order group had
  uint pairs;            // entries wanted: Gaussian-supertile pairs, of both eyes one where they share lists
  uint tile_pairs;       // Gaussian-tile pairs wanted, over all views
  uint overflow;         // OVERFLOW_ bits
  uint truncated_lists;  // tiles whose list the driver ended early: the picture must not be used
  uint depths_low;       // sum of what the Gaussians are sorted by, bits of floats, world units, over
  uint depths_high;      // COMPACT_BLOCK: low and high half
  uint probe_low;   // squared error of the probe, summed over pixels and channels, times PROBE_SCALE: low and
  uint probe_high;  // high half
  uint probe_squares_low;  // squares of such sums of THREADS pixels each, likewise
  uint probe_squares_high;
  uint long_lists;  // tiles with more than LONG_LIST pairs, and the groups of their launch
  uint long_x, long_y, long_z;
  uint large;  // splats in many supertiles, of both eyes one if these share lists, and the groups of the
               // launch that bins them
  uint large_x, large_y, large_z;
  uint large_entries;  // what that made, and the groups of the launch that places these
  uint fill_x, fill_y, fill_z;
  uint slabs;  // parts of lists
  uint unused_1, unused_2, unused_3;
  ListCount lists[SORT_KINDS];
};

#define COUNT_MAX 0xFFFFFFFFu
#define PROBE_SCALE 4194304.0       // 2^22: a work group's sum of at most 3 * THREADS stays below 2^32
#define DEPTH_KEY_NONE 0xFFFFFFFFu  // the key of a Gaussian that no view of the order group draws
#define OVERFLOW_ORDER 1u
#define OVERFLOW_LARGE 2u  // entries of large splats
#define OVERFLOW_PAIRS 4u
#define OVERFLOW_COUNT 8u      // more entries than can be counted
#define OVERFLOW_UNSORTED 15u  // any of those above: there is nothing to sort
#define OVERFLOW_TILE_PAIRS 16u
#define OVERFLOW_ROUNDS 32u  // a list needs to be parted more often

// How many things there are, known to the GPU only, and the indirect dispatches that go over them. Group
// counts are split into x and y for drivers that allow few along x.
struct DispatchArguments {
  uint count;
  uint threads_x, threads_y, threads_z;  // THREADS things a group
  uint bin_x, bin_y, bin_z;              // BIN_BLOCK things a group
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
