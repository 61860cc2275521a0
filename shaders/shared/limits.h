// Constants that GLSL and C++ share. Plain #defines only: this file is included by both.
#ifndef BINOSPLAT_SHARED_LIMITS_H
#define BINOSPLAT_SHARED_LIMITS_H

// Below this alpha a Gaussian leaves no mark on a pixel of 8 bits (docs/method.md: tau, as in 3D-GS).
#define ALPHA_MIN (1.0 / 255.0)
// alpha is capped so that no single Gaussian makes everything behind it exactly invisible (3D-GS).
#define ALPHA_MAX 0.99
// The blend stops before a Gaussian that would lower the transmittance below this (3D-GS).
#define TRANSMITTANCE_MIN 1e-4
// The approximate blend (docs/method.md 5.2) works in blocks of APPROXIMATE_BLOCK x APPROXIMATE_BLOCK px. It
// ends a block once no pixel's transmittance exceeds DARK_TRANSMITTANCE times the root of the tolerance, at
// most DARK_TRANSMITTANCE_MOST. It tests this after every APPROXIMATE_STEP_SHORT pairs of a list; in a long
// list, after every APPROXIMATE_STEP_LONG.
#define APPROXIMATE_BLOCK 8
#define DARK_TRANSMITTANCE 0.12
#define DARK_TRANSMITTANCE_MOST 0.4
#define APPROXIMATE_STEP_SHORT 64
#define APPROXIMATE_STEP_LONG 128
// A pixel has a depth if its coverage exceeds this.
#define COVERAGE_FOR_DEPTH 0.5
// The low-pass for splats thinner than a pixel (3D-GS): a variance in px^2 that is added to both axes of
// every projected Gaussian. Programs for models with another kernel define their own value.
#ifndef KERNEL_PX2
#define KERNEL_PX2 0.3
#endif
// J is evaluated at most this share of the picture's size beyond its edges; 0.15 a side is INRIA's 1.3
// (docs/method.md 2).
#define CLAMP_MARGIN 0.15
// The largest standard deviation, in radians, that PROJECTION_TANGENT draws. At a right angle to such a
// Gaussian even an opaque one is below ALPHA_MIN (docs/method.md 2).
#define WIDEST_TANGENT 0.28
// The least eigenvalue of a cone's quadratic form, in squared slopes of the picture, for which every visible
// level line is an ellipse. Visible levels are below 2 ln 255 = 11.1.
#define WIDE_LEVEL 15.0
// The default side of a tile in px.
#define TILE_SIZE_DEFAULT 16
// Side of the tiles in px that an anchor of Scaffold-GS must touch, as trained.
#define ANCHOR_TILE 16

#define MAX_VIEWS 8
// Views whose pictures the blend can write into the caller's images. Drivers have 8 image units, of which
// others use some.
#define MAX_CANVASES 4

// Tiles along a side of a supertile (supertiles.glsl).
#define SUPERTILE_SIDE 2
// Splats whose entries a work group counts in shared memory at a time, and the size of the group.
#define BIN_BLOCK 4096
#define BIN_THREADS 1024
// One work group sorts a supertile's list of at most SORT_MOST entries, with one invocation for each
// SORT_EACH. There is a class of groups for each power of two of entries, from 32 * SORT_EACH on. Longer
// lists are split into at most SORT_SLABS slabs a round. SORT_ROUNDS exceeds the need of any list: a round
// leaves at most a 32nd of its entries, or a 2,048th of its range of depths or splats.
#define SORT_EACH 4
#define SORT_MOST 4096u
#define SORT_BIN_MOST 256u
#define SORT_CLASSES 6u
#define SORT_SLABS 64u
#define SORT_ROUNDS 12u
#define SORT_CROWDED_KIND 6u  // kinds of lists: classes, crowded (over SORT_BIN_MOST of about one depth),
#define SORT_LONG_KIND 7u     // those to split in each round, and those left after the last
#define SORT_KINDS 20
#define SORT_GROUPS_MOST 65535u
#define NO_SECOND 0x7FFFFFFFu  // see sort_items.glsl

// A measured transmittance of a Gaussian (docs/method.md 5) is at least BOUND_FLOOR, because Th divides by
// it. While Th drops a Gaussian, each frame that measures multiplies its bound by BOUND_AGEING, up to 1,
// until it is drawn and measured again.
#define BOUND_FLOOR 0.01
#define BOUND_AGEING 1.25
// The value that a blend measures of each splat, over the pixels that it reaches: none, the largest
// transmittance in front of it, or a sum. From MEASURE_TRANSPOSED on, the pictures stay unchanged.
#define MEASURE_NONE 0
#define MEASURE_TRANSMITTANCE 1
#define MEASURE_TRANSPOSED 2
#define MEASURE_CHANGES 3
#define MEASURE_VISIBILITY 4
// The transposed blend sums alpha T times the picture, at most 1, times this, and rounds. The least weight of
// a pixel is tau times the least T: more than half a unit. The sum of a tile of 1,024 px fits in a signed
// word.
#define TRANSPOSED_SCALE 2097152.0
// The squared change of a pixel without a splat is limited to CHANGE_MOST, multiplied by CHANGE_SCALE and
// rounded.
#define CHANGE_SCALE 67108864.0
#define CHANGE_MOST 0.015625
// The visibility of a splat in a pixel is alpha T^2 times VISIBILITY_SCALE, rounded. A pixel ends once its T
// is below VISIBILITY_LEAST: all later splats together would add at most half of that squared.
#define VISIBILITY_SCALE 1048576.0
#define VISIBILITY_LEAST 0.01
#define VISIBILITY_LOW_BITS 14  // low bits of a tile's sum, summed apart from the higher ones
// The depth that a blend writes for a pixel: none, the mean, the sum of its splats' visibility instead of a
// depth, the median, or the median of at least every second row.
#define DEPTH_NONE 0
#define DEPTH_MEAN 1
#define DEPTH_VISIBILITY 2
#define DEPTH_MEDIAN 3
#define DEPTH_MEDIAN_OF_TWO_ROWS 4

// A box of more than TALL_ROWS rows of tiles is first tested against the picture's rectangle.
#define TALL_ROWS 4u
// Splats in many supertiles that a work group bins, counted once per eye; LARGE_ROW groups along x.
#define LARGE_VIEWS 64u
#define LARGE_ROW 1024u

// Invocations of a work group with one object each.
#define THREADS 256
// Pixels of a work group of `present`: it reads each row as 512 contiguous bytes.
#define PRESENT_COLUMNS 32u
#define PRESENT_ROWS 8u
// Pixels of a work group that composes foveated pictures.
#define COMPOSE_COLUMNS 32u
#define COMPOSE_ROWS 32u
// Gaussians that one work group compacts, in several rounds of THREADS.
#define COMPACT_BLOCK 2048
// The unrolled statements of the blend's loop. llvmpipe ends a loop silently after 65,535 rounds (of all
// loops of a group of lanes together). So a tile's list may have some 200,000 entries; a longer one is
// truncated, and this is reported.
#define BLEND_UNROLL 8
// Side in px of the cells in which the blend computes a pixel's place: the side of the largest tiles.
#define BLEND_CELL 32u
// A tile with more pairs than this is drawn by more invocations, in a dispatch that starts first.
#ifndef LONG_LIST
#define LONG_LIST 2048
#endif
#define LONG_ROW 1024u  // groups along x of that dispatch

#endif
