// Structs that GLSL and C++ share, in std430. Members are float, uint, vec2 and vec4 only: vec3 and mat3 pad
// differently in the two languages. C++ checks sizes here; tests/gl compares offsets with the driver's.
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
// right, y down, z forward) in the world. The anchor is a point near the eyes, the same in all views of a
// rig: subtracting it first keeps fp32 exact far from the origin. Views with equal anchors and equal rows z
// have bit-equal depths. Each instance of a model has its own copy of every view (render/instance.h), in
// which the world is the model's, and the rows have the length `eye.w`.
struct View {
  vec4 row_x;   // axis x, then translation x
  vec4 row_y;   // axis y, then translation y
  vec4 row_z;   // axis z (forward), then translation z
  vec4 anchor;  // world point; w: near, the smallest depth drawn (world units)
  vec4 eye;     // the eye minus the anchor, world axes; w: frame's world units per world unit of the model
  vec4 lens;    // fx, fy, cx, cy in px
  vec4 slopes;  // limits of v.x / v.z and v.y / v.z in J: smallest x, y, largest x, y (docs/method.md 2)
  vec4 centre;  // the point that sorted distances start from, minus the anchor: the eye, or a rig's midpoint;
                // w: the largest (v.x^2 + v.y^2) / v.z^2 of a ray in the picture
  uint width;   // px
  uint height;  // px
  uint tiles_x;
  uint tiles_y;
  uint supertile_offset;  // this view's first supertile in the frame
  uint pixel_offset;      // this view's first pixel in the frame's pixel buffers
  uint order_group;       // views with the same number have equal depths
  uint pitch;    // px from tile to tile: a tile's side; in a probe more, because it has gaps between tiles
  uint shift_x;  // px: the first tile's upper left corner in the whole picture
  uint shift_y;
  uint is_probe;          // 1: a probe, which draws only some of the tiles
  uint left;              // px: a window's upper left corner in the whole picture; 0 without a window
  uint top;               // (with a window, `width` and `height` are its size)
  uint first_row;         // index of the view's first row of tiles in region_rows (tiles/regions.glsl)
  float tolerance_share;  // ratio of the view's tolerance to the frame's
  float low_pass_share;   // share of the low-pass that widens splats at unchanged opacity (projection.glsl)
  uint lists_shift;  // second eye in shared lists: the list's column of supertiles minus the view's; else 0
  float opacity;     // of the instance: multiplies each Gaussian's opacity
  float table_far;   // the end of the table by depth, in the frame's world units
  uint table_first;  // index of the table's first bin in the buffer of tables
  uint table_bins;
  uint unused_1, unused_2, unused_3;
};

// Values of a whole frame. They are in a uniform block, whose std140 equals std430 without arrays.
struct FrameParameters {
  vec4 background;       // rgb, display-referred; w: 1 if the Gaussians' colours are linear light
  float tolerance;       // of the threshold rule: K or kappa
  uint has_bounds;       // 1: an earlier frame has measured bounds for this frame
  uint view_count;       // including the probe
  uint requested_views;  // number of views without the probe, which is the last view
  uint probed_view;      // index of the view that the probe samples; MAX_VIEWS without one
  uint gaussian_count;   // of all instances
  uint slots;            // room for splats in each view
  uint list_per_view;    // 1 with --tiles all: all tiles of a view share one list
  uint has_regions;      // 1: some views have regions
  uint has_broad_tiles;  // 1: a splat may be in front of some rays of a tile and behind others
  // For Scaffold-GS:
  uint offset_count;  // K
  uint anchor_cull;   // 1: skips anchors out of view, as trained (docs/method.md 1.1)
  float depth_slack;  // world units: a splat may be this much nearer than earlier splats of its list
  uint unused_1, unused_2, unused_3;
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
  vec4 offset_scale;  // world units per unit of an offset; also the scales of the Gaussian in the anchor cull
  vec4 scale;         // upper limits of its Gaussians' standard deviations, world units
};

// A Gaussian projected into one view.
struct Splat {
  vec2 mean;      // px; the centre of pixel (i, j) lies at (i, j)
  float depth;    // view z, world units
  float opacity;  // sigma
  vec4 conic;     // Q.xx, Q.xy, Q.yy in px^-2; w: sqrt(det C2) in px^2
  vec4 colour;    // rgb, display-referred; w: rho = 2 ln(sigma / Th), for tile tests and approximate blends
};

// The canvas of a view: the place of its final picture in the caller's image.
struct Canvas {
  uint left;  // px: the picture's lower left corner in the image
  uint bottom;
  uint steps;        // largest value of an integer colour channel, such as 255; 0: float channels
  uint keeps_alpha;  // without a background: premultiplied display values (1) or linear light (2); else 0
  uint linear;       // 1: the image stores linear light instead of display values
  uint unused_1, unused_2, unused_3;
};

// The place of a view's mesh depths in the caller's texture, and the conversion of a texel to a depth z.
struct MeshSource {
  vec2 step;        // texels per pixel of the view
  uint left, top;   // the texel of the picture's upper left pixel
  uint level;       // mipmap level of the texture
  uint is_inverse;  // d is the texel. 1: z = 1 / (scale d + offset); 0: z = scale d
  float scale, offset;
  float nothing;  // the d of texels without a mesh
  float unused_1, unused_2, unused_3;
};

// The ray of a pixel of another picture, such as a panorama. A view gives its origin and direction.
struct PlacedRay {
  vec2 pixel;  // the ray's point in the view's picture; (0, 0) is the centre of the first pixel
  uint place;  // index of the pixel in the other picture, row by row
  uint unused;
};

// The number of lists of a kind (SORT_KINDS), and the group counts of the dispatch that sorts or splits them.
struct ListCount {
  uint count;
  uint groups_x, groups_y, groups_z;
};

// The counts of a frame on the GPU, read back at its end. An overflow bit marks a buffer that is too small
// for the count; the frame is then drawn again with larger buffers.
struct Counters {
  uint visible;          // Gaussians drawn, summed over the order groups
  uint slots_wanted;     // the largest number of Gaussians in an order group
  uint pairs;            // entries needed: one per splat and supertile; in shared lists one for both eyes
  uint tile_pairs;       // Gaussian-tile pairs needed, over all views
  uint overflow;         // OVERFLOW_ bits
  uint truncated_lists;  // tiles whose loop the driver ended early: the picture is invalid
  // Sums of 64 bits in two words. depths: the sort keys of the drawn Gaussians (bits of floats), each divided
  // by COMPACT_BLOCK. probe: the squared error over pixels and channels, times PROBE_SCALE. probe_squares:
  // the squares of the sums over THREADS pixels, also times PROBE_SCALE.
  uint depths_low;
  uint depths_high;
  uint probe_low;
  uint probe_high;
  uint probe_squares_low;
  uint probe_squares_high;
  uint long_lists;  // tiles with more than LONG_LIST pairs, and the group counts of their dispatch
  uint long_x, long_y, long_z;
  uint large_splats;  // splats for bin_large.comp (in shared lists one for both eyes), and its group counts
  uint large_x, large_y, large_z;
  uint large_entries;  // entries of large splats, and the group counts of the dispatch that moves entries
  uint fill_x, fill_y, fill_z;
  uint slabs;         // number of slabs into which too long lists are split
  uint probe_pairs;   // Gaussian-tile pairs of the probe's tiles
  uint probed_pairs;  // and of the same tiles of its view
  uint unused;
  ListCount lists[SORT_KINDS];
};

#define COUNT_MAX 0xFFFFFFFFu
#define PROBE_SCALE 4194304.0       // 2^22: a work group's sum, at most 3 * THREADS, stays below 2^32
#define DEPTH_KEY_NONE 0xFFFFFFFFu  // the key of a Gaussian that no view of the order group draws
#define OVERFLOW_ORDER 1u
#define OVERFLOW_LARGE 2u  // entries of large splats
#define OVERFLOW_PAIRS 4u
#define OVERFLOW_COUNT 8u      // more entries than a word can count
#define OVERFLOW_UNSORTED 15u  // mask of all bits above: with any of them the lists are invalid
#define OVERFLOW_TILE_PAIRS 16u
#define OVERFLOW_ROUNDS 32u  // a list needs more rounds of splitting

// A number of objects that only the GPU knows, and the group counts of the indirect dispatches over these
// objects. The groups are split into x and y, because drivers limit the groups along x.
struct DispatchArguments {
  uint count;
  uint threads_x, threads_y, threads_z;  // for groups of THREADS objects
  uint bin_x, bin_y, bin_z;              // for groups of BIN_BLOCK objects
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
