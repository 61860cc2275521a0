// Constants that GLSL and C++ share. Plain #defines only: this file is included by both.
#ifndef BINOSPLAT_SHARED_LIMITS_H
#define BINOSPLAT_SHARED_LIMITS_H

// Below this alpha a Gaussian leaves no mark on a pixel of 8 bits (docs/method.md: tau, as in 3D-GS).
#define ALPHA_MIN (1.0 / 255.0)
// alpha is capped so that no single Gaussian makes everything behind it exactly invisible (3D-GS).
#define ALPHA_MAX 0.99
// The blend stops before a Gaussian that would leave a transmittance of less than this behind it (3D-GS).
#define TRANSMITTANCE_MIN 1e-4
// The approximate blend (docs/method.md 5.2) works in blocks of APPROXIMATE_BLOCK x APPROXIMATE_BLOCK px. It
// ends a block once no pixel's transmittance exceeds DARK_TRANSMITTANCE times the root of the tolerance, at
// most DARK_TRANSMITTANCE_MOST. It asks that after every APPROXIMATE_STEP_SHORT pairs of a list; of a long
// list, after every APPROXIMATE_STEP_LONG.
#define APPROXIMATE_BLOCK 8
#define DARK_TRANSMITTANCE 0.12
#define DARK_TRANSMITTANCE_MOST 0.4
#define APPROXIMATE_STEP_SHORT 64
#define APPROXIMATE_STEP_LONG 128
// A pixel has a depth where more than this much of it is covered.
#define COVERAGE_FOR_DEPTH 0.5
// Variance in px^2 added to both axes of every projected Gaussian, a low-pass for splats thinner than a pixel
// (3D-GS). A model of another kernel is drawn by programs that define theirs.
#ifndef KERNEL_PX2
#define KERNEL_PX2 0.3
#endif
// J is evaluated at most this share of the picture's size beyond its edges; 0.15 a side is INRIA's 1.3
// (docs/method.md 2).
#define CLAMP_MARGIN 0.15
// The widest standard deviation, in radians, that PROJECTION_TANGENT draws: at a right angle to such a
// Gaussian even an opaque one has faded below ALPHA_MIN (docs/method.md 2).
#define WIDEST_TANGENT 0.28
// Where the quadratic form of a cone, in squared slopes of the picture, has an eigenvalue below this the cone
// may cut the picture in something else than an ellipse: levels that can be seen are below 2 ln 255 = 11.1.
#define WIDE_LEVEL 15.0
// Side of a tile in px where nothing else is known.
#define TILE_SIZE_DEFAULT 16
// Side of the tiles in px that an anchor of Scaffold-GS must touch, as trained.
#define ANCHOR_TILE 16

#define MAX_VIEWS 8
// Views whose pictures the blend can write into images of the caller's: drivers have 8 of these, and others
// use some.
#define MAX_CANVASES 4

// Tiles along a side of a supertile (supertiles.glsl).
#define SUPERTILE_SIDE 2
// Splats whose entries a work group counts in shared memory at a time, and its invocations.
#define BIN_BLOCK 4096
#define BIN_THREADS 1024
// A supertile's list of at most SORT_MOST entries is sorted by one work group, of an invocation for each
// SORT_EACH: there is a class of groups for lists of each power of two of entries from 32 * SORT_EACH on.
// Longer lists are parted, into at most SORT_SLABS parts a round. SORT_ROUNDS are more than any list needs: a
// round leaves at most a 32nd of its entries, or a 2,048th of its range of depths or splats.
#define SORT_EACH 4
#define SORT_MOST 4096u
#define SORT_BIN_MOST 256u
#define SORT_CLASSES 6u
#define SORT_SLABS 64u
#define SORT_ROUNDS 12u
#define SORT_CROWDED_KIND 6u  // of lists: classes, those with more than SORT_BIN_MOST of nearly one depth,
#define SORT_LONG_KIND 7u     // those that each round parts, and those left then
#define SORT_KINDS 20
#define SORT_GROUPS_MOST 65535u
#define NO_SECOND 0x7FFFFFFFu  // sort_items.glsl

// The transmittance that a frame measures of a Gaussian (docs/method.md 5) never falls below BOUND_FLOOR, or
// a hidden one would divide by zero. While Th leaves a Gaussian out, each frame that measures multiplies its
// bound by BOUND_AGEING, up to 1, until it is drawn and measured again.
#define BOUND_FLOOR 0.01
#define BOUND_AGEING 1.25
// What a blend measures of each splat, over the pixels that it reaches: nothing, the largest transmittance in
// front of it, or a sum. Those from MEASURE_TRANSPOSED on leave the pictures as they are.
#define MEASURE_NONE 0
#define MEASURE_TRANSMITTANCE 1
#define MEASURE_TRANSPOSED 2
#define MEASURE_CHANGES 3
#define MEASURE_VISIBILITY 4
// The transposed blend sums alpha T of a pixel times its picture of 1 at most, times this and rounded: the
// least weight that a pixel can blend, tau times the least T, is more than half of one, and the sum of a tile
// of 1,024 px fits a word with its sign.
#define TRANSPOSED_SCALE 2097152.0
// The squared change of a pixel without a splat is cut off at CHANGE_MOST, multiplied by CHANGE_SCALE and
// rounded.
#define CHANGE_SCALE 67108864.0
#define CHANGE_MOST 0.015625
// Visibility is what a splat shows in a pixel, alpha T^2, times VISIBILITY_SCALE and rounded. A pixel ends
// once its T is below VISIBILITY_LEAST: all that follows would show no more than half of that squared.
#define VISIBILITY_SCALE 1048576.0
#define VISIBILITY_LEAST 0.01
#define VISIBILITY_LOW_BITS 14  // the low bits of a tile's sum, which are summed up apart from those above
// What a blend writes as a pixel's depth: nothing, the mean, the sum of its splats' visibility in place of a
// depth, the median, or the median in every second row at least.
#define DEPTH_NONE 0
#define DEPTH_MEAN 1
#define DEPTH_VISIBILITY 2
#define DEPTH_MEDIAN 3
#define DEPTH_MEDIAN_OF_TWO_ROWS 4

// Boxes of more than TALL_ROWS rows of tiles are asked about the picture's rectangle first.
#define TALL_ROWS 4u
// Splats in many supertiles that a work group bins, an eye's as one each, LARGE_ROW groups along x.
#define LARGE_VIEWS 64u
#define LARGE_ROW 1024u

// Invocations of a work group that handles one thing each.
#define THREADS 256
// Pixels that a work group of `present` writes: each row of them is read as 512 bytes on end.
#define PRESENT_COLUMNS 32u
#define PRESENT_ROWS 8u
// Pixels of a work group that composes foveated pictures.
#define COMPOSE_COLUMNS 32u
#define COMPOSE_ROWS 32u
// Gaussians that one work group compacts: several rounds of THREADS.
#define COMPACT_BLOCK 2048
// Statements that the blend unrolls: llvmpipe ends a loop silently after 65,535 rounds (all loops of a group
// of lanes together), so a tile's list may have some 200,000 entries before it is truncated; and then it is
// reported.
#define BLEND_UNROLL 8
// Side in px of the cells that the blend counts a pixel's place in: that of the largest tiles.
#define BLEND_CELL 32u
// A tile with more pairs than this is drawn by more invocations, of a launch that starts
// before the others'.
#ifndef LONG_LIST
#define LONG_LIST 2048
#endif
#define LONG_ROW 1024u  // groups along x of that launch

#endif
