// Constants that GLSL and C++ share. Both include this file, so it has only plain #defines.
#ifndef BINOSPLAT_SHARED_LIMITS_H
#define BINOSPLAT_SHARED_LIMITS_H

// Below this alpha a Gaussian leaves no mark on a pixel of 8 bits (docs/method.md: tau, as in 3D-GS).
#define ALPHA_MIN (1.0 / 255.0)
// alpha is capped so that no single Gaussian makes everything behind it exactly invisible (3D-GS).
#define ALPHA_MAX 0.99
// The blend stops before a Gaussian that would lower the transmittance below this (3D-GS).
#define TRANSMITTANCE_MIN 1e-4
// The approximate blend (docs/method.md 5.2) works in blocks of APPROXIMATE_BLOCK x APPROXIMATE_BLOCK px. It
// ends a block once the transmittance of every pixel is at most min(DARK_TRANSMITTANCE_MAX,
// DARK_TRANSMITTANCE sqrt(tolerance)). It tests the transmittance after every APPROXIMATE_STEP_SHORT splats
// of a tile's list, or APPROXIMATE_STEP_LONG if the list is longer than LONG_LIST.
#define APPROXIMATE_BLOCK 8
#define DARK_TRANSMITTANCE 0.12
#define DARK_TRANSMITTANCE_MAX 0.4
#define APPROXIMATE_STEP_SHORT 64
#define APPROXIMATE_STEP_LONG 128
// A pixel has a depth if its coverage exceeds this.
#define COVERAGE_FOR_DEPTH 0.5
// The low-pass for splats thinner than a pixel (3D-GS): a variance in px^2 that is added to both axes of
// every projected Gaussian. Programs for models with another kernel define their own value.
#ifndef KERNEL_PX2
#define KERNEL_PX2 0.3
#endif
// The affine projection evaluates its Jacobian J at most this far beyond the picture's edges, as a share of
// the picture's size (docs/method.md 2). INRIA's limit is the same: 1.3 times half the
// picture, from the middle.
#define CLAMP_MARGIN 0.15
// PROJECTION_TANGENT narrows Gaussians to at most this standard deviation, in radians. So even an opaque
// Gaussian has an alpha below ALPHA_MIN at a right angle to its direction (docs/method.md 2.2).
#define WIDEST_TANGENT 0.28
// With PROJECTION_TANGENT a splat is wide if an eigenvalue of its Q, in slopes instead of px, is below this
// (docs/method.md 2.2). All other splats are visible where q is below 2 ln 255 = 11.1, so in an ellipse.
#define WIDE_LEVEL 15.0
// A flat Gaussian has the depth of its mean if its normal times the ray to it (z = 1) is below this.
#define EDGE_ON 1e-6
// The side of a tile in px.
#define TILE_SIZE 16

#define MAX_VIEWS 8
// The largest number of views that the blend writes into the caller's images. GL guarantees 8 image units.
#define MAX_CANVASES 4

// Tiles along a side of a supertile (supertiles.glsl).
#define SUPERTILE_SIDE 2
// A work group of bin.comp counts the entries of BIN_BLOCK splats in shared memory, by BIN_THREADS
// invocations.
#define BIN_BLOCK 4096
#define BIN_THREADS 1024
// A work group sorts a supertile's list of at most SORT_MAX entries, with an invocation for every SORT_EACH
// entries. Class k has lists of at most 2^k * 32 * SORT_EACH entries. Longer lists are split into at most
// SORT_SLABS slabs in each of up to SORT_ROUNDS rounds. No list needs so many rounds: a slab has at most 1/32
// of the list's entries, or 1/2,048 of its range of depths or splat indices.
#define SORT_EACH 4
#define SORT_MAX 4096u
#define SORT_BIN_MAX 256u
#define SORT_CLASSES 6u
#define SORT_SLABS 64u
#define SORT_ROUNDS 12u
// The kinds of lists: the classes, crowded lists (more than SORT_BIN_MAX entries of nearly one depth), then
// the lists to split in each round, and lists too long even after the last round.
#define SORT_CROWDED_KIND 6u
#define SORT_LONG_KIND 7u
#define SORT_KINDS 20
#define SORT_GROUPS_MAX 65535u
#define NO_SECOND 0x7FFFFFFFu  // see sort_items.glsl

// A measured transmittance of a Gaussian (docs/method.md 5) is at least BOUND_FLOOR, because the formulas of
// Th divide by it. While Th drops a Gaussian, each frame that measures multiplies its bound by BOUND_AGEING,
// up to 1, until it is drawn and measured again.
#define BOUND_FLOOR 0.01
#define BOUND_AGEING 1.25
// The value that a blend measures of each splat, over the pixels that it reaches: none, the largest
// transmittance in front of it, or a sum. From MEASURE_TRANSPOSED on, the blend writes no picture.
#define MEASURE_NONE 0
#define MEASURE_TRANSMITTANCE 1
#define MEASURE_TRANSPOSED 2
#define MEASURE_CHANGES 3
#define MEASURE_VISIBILITY 4
// The transposed blend sums alpha T times the picture as integers, in units of 1 / TRANSPOSED_SCALE. The
// caller scales the picture to at most 1. The smallest alpha T, tau TRANSMITTANCE_MIN, is more than half a
// unit. The sum over a tile of 1,024 px fits in a signed word.
#define TRANSPOSED_SCALE 2097152.0
// MEASURE_CHANGES: removing a splat changes a pixel. The square of this change is clamped to CHANGE_MAX and
// summed as an integer, in units of 1 / CHANGE_SCALE.
#define CHANGE_SCALE 67108864.0
#define CHANGE_MAX 0.015625
// MEASURE_VISIBILITY: the visibility of a splat in a pixel is alpha T^2, an integer in units of 1 /
// VISIBILITY_SCALE. A pixel ends once its T is below VISIBILITY_MIN: all later splats together would add
// less than VISIBILITY_MIN^2.
#define VISIBILITY_SCALE 1048576.0
#define VISIBILITY_MIN 0.01
#define VISIBILITY_LOW_BITS 14  // the low bits of a tile's sum are added to one word, the others to a second
// The depth that a blend writes for a pixel: none, the mean, the sum of the visibility of its splats (not a
// depth), the median, or the median in every second row (others may have none).
#define DEPTH_NONE 0
#define DEPTH_MEAN 1
#define DEPTH_VISIBILITY 2
#define DEPTH_MEDIAN 3
#define DEPTH_MEDIAN_OF_TWO_ROWS 4

// Tile test `ellipse`: tests a splat with more than TALL_ROWS rows of tiles against the picture before its
// rows.
#define TALL_ROWS 4u
// bin_large.comp: a work group takes LARGE_VIEWS splats, of both eyes in all if they share lists. The
// dispatch has up to LARGE_ROW groups along x.
#define LARGE_VIEWS 64u
#define LARGE_ROW 1024u

// Invocations of a work group, in shaders that give each invocation one object.
#define THREADS 256
// Pixels of a work group of present.comp. It reads each row as 512 contiguous bytes.
#define PRESENT_COLUMNS 32u
#define PRESENT_ROWS 8u
// Pixels of a work group that composes foveated pictures.
#define COMPOSE_COLUMNS 32u
#define COMPOSE_ROWS 32u
// Gaussians that one work group compacts, in several rounds of THREADS.
#define COMPACT_BLOCK 2048
// Splats in one round of the blend's loop. llvmpipe silently ends a shader's loops after 65,535 rounds of
// all loops together, which are enough for some 200,000 splats.
#define BLEND_UNROLL 8
// Where a driver ended a list early, blend.comp draws LIST_PART splats of each list at a time.
#define LIST_PART 65536
// Side in px of the blend's cells: 2 x 2 tiles. Positions are relative to a cell's middle.
#define BLEND_CELL 32u
// Tiles with more pairs than this have a separate dispatch, which starts first, with more invocations a tile.
#ifndef LONG_LIST
#define LONG_LIST 2048
#endif
#define LONG_ROW 1024u  // work groups along x of the separate dispatch

#endif
