// The choices of options, shader variants and charts. GLSL and C++ include this file. Each choice of --tiles,
// --threshold and --projection has a file NAME.glsl in shaders/tiles/, threshold/ or projection/.
#ifndef BINOSPLAT_SHARED_CHOICES_H
#define BINOSPLAT_SHARED_CHOICES_H

// --tiles: which Gaussian-tile pairs exist (docs/method.md 4).
#define TILES_AABB 0
#define TILES_ELLIPSE 1
#define TILES_ALL 2
#define TILES_OBB 3
#define TILES_SNUG 4

// --threshold: the alpha below which a Gaussian makes no pair (docs/method.md 5).
#define THRESHOLD_EXACT 0
#define THRESHOLD_ADAGSCALE 1
#define THRESHOLD_SQUARED 2

// --transmittance: the source of T_upper, the upper bound of a Gaussian's transmittance.
#define TRANSMITTANCE_ONE 0
#define TRANSMITTANCE_DEPTH 1
#define TRANSMITTANCE_LAST 2  // measured by an earlier frame

// --order: the sort key of Gaussians, front to back (docs/method.md 2).
#define ORDER_DEPTH 0
#define ORDER_DISTANCE 1

// --projection: the projection of a Gaussian (docs/method.md 2).
#define PROJECTION_AFFINE 0
#define PROJECTION_TANGENT 1

// --precision: the number format of stored Gaussians and splats.
#define PRECISION_FULL 0
#define PRECISION_HALF 1

// --layout: the arrangement of both eyes. From LAYOUT_ANAGLYPH on, layouts mix both eyes' colours.
#define LAYOUT_SEPARATE 0
#define LAYOUT_MULTI_VIEW 1
#define LAYOUT_QUAD_BUFFER 2
#define LAYOUT_PARALLEL 3
#define LAYOUT_CROSS_EYED 4
#define LAYOUT_HALF_WIDTH 5
#define LAYOUT_OVER_UNDER 6
#define LAYOUT_HALF_HEIGHT 7
#define LAYOUT_ROWS 8
#define LAYOUT_COLUMNS 9
#define LAYOUT_ANAGLYPH 10
#define LAYOUT_HALF_COLOUR 11
#define LAYOUT_GREY 12

// --show: the picture, or debug views. From SHOW_DIFFERENCE on, they are colour maps. From SHOW_ALPHAS on,
// they are computed from the blend's lists.
#define SHOW_PICTURE 0
#define SHOW_SPLIT 1
#define SHOW_DIFFERENCE 2
#define SHOW_DISAGREEMENT 3
#define SHOW_DISPARITY 4
#define SHOW_DEPTH 5
#define SHOW_ALPHAS 6
#define SHOW_VISIBLE 7
#define SHOW_PAIRS 8
#define SHOW_TRANSMITTANCE 9
#define SHOW_MEDIAN_DEPTH 10
#define SHOW_LEFT_OUT 11

#ifdef __cplusplus
namespace binosplat {

/// A choice of an option, in the order of the numbers above.
struct Choice {
  const char* name;
  const char* help;
};

inline constexpr Choice tiles_choices[] = {
    {"aabb", "3D-GS's square of three standard deviations; clips visible tails"},
    {"ellipse", "exact: the tiles in which alpha reaches the threshold (FlashGS, AdR-Gaussian)"},
    {"all", "every Gaussian to every tile: slow, for tests"},
    {"obb", "GSCore's oriented box of three standard deviations; clips visible tails, too"},
    {"snug", "exact: the box around all alphas that reach the threshold (Speedy-Splat)"},
};

inline constexpr Choice threshold_choices[] = {
    {"exact", "1/255: every visible pair"},
    {"adagscale", "AdaGScale: the alpha * px^2, K, that a Gaussian may lose outside its tiles"},
    {"squared", "the squared error that a dropped pair may cost, in px * squared colour"},
};

inline constexpr Choice transmittance_choices[] = {
    {"one", "T_upper = 1 for every Gaussian"},
    {"depth", "AdaGScale's table: the largest transmittance at each depth"},
    {"last", "measured by an earlier frame: for a head at rest"},
};

inline constexpr Choice order_choices[] = {
    {"depth", "along the view's axis, as 3D-GS is trained; turns with the head"},
    {"distance", "distance from the eye; for an eye pair, from its midpoint"},
};

inline constexpr Choice projection_choices[] = {
    {"affine", "as in 3D-GS: stretches Gaussians far from the view's axis"},
    {"tangent", "onto the plane that touches the unit sphere: independent of the head's rotation"},
};

inline constexpr Choice precision_choices[] = {
    {"full", "fp32: 68 dB and more against float64"},
    {"half", "mostly fp16, at 60 dB or more: less memory, faster"},
};

inline constexpr Choice layout_choices[] = {
    {"separate", "a file for each eye"},
    {"multi-view", "both eyes as the views of one OpenEXR file"},
    {"quad-buffer", "a framebuffer for each eye: only in `view`, if the driver has stereo windows"},
    {"parallel", "side by side, the left eye's picture on the left"},
    {"cross-eyed", "side by side, swapped: for crossed eyes"},
    {"half-width", "parallel, each squeezed to half its width: 3D televisions"},
    {"over-under", "the left eye's picture above the right one's"},
    {"half-height", "over-under, each squeezed to half its height: 3D televisions"},
    {"rows", "left and right row by row, the left eye's first: polarised screens"},
    {"columns", "left and right column by column, the left eye's first"},
    {"anaglyph", "for red-cyan glasses, by Dubois's least squares"},
    {"half-colour", "for red-cyan glasses: grey in the left eye, colour in the right"},
    {"grey", "for red-cyan glasses: grey in both eyes"},
};

inline constexpr Choice show_choices[] = {
    {"picture", "the picture"},
    {"split", "the picture on the left, the exact one on the right"},
    {"difference", "largest difference of a channel from the exact picture, in 1/255"},
    {"disagreement", "the part of the difference that the two eyes do not share, in 1/255"},
    {"disparity", "error of the disparity between the eyes that the depth gives, px"},
    {"depth", "view depth, world units"},
    {"alphas", "alphas that a pixel evaluates until it ends"},
    {"visible", "alphas that a pixel blends"},
    {"pairs", "Gaussians in the list of the pixel's tile"},
    {"transmittance", "max(T), a Gaussian's largest transmittance: mean over visible Gaussians"},
    {"median-depth", "view depth at which transmittance falls below a half, world units"},
    {"left-out", "Gaussians that the threshold drops from the pixel's tile"},
};

}  // namespace binosplat
#endif

#endif
