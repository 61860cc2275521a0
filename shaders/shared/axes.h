// The choices that options, shader variants and charts name. GLSL and C++ include this file; a choice's file
// is shaders/tiles/NAME.glsl or shaders/threshold/NAME.glsl.
#ifndef BINOSPLAT_SHARED_AXES_H
#define BINOSPLAT_SHARED_AXES_H

// --tiles: which Gaussian-tile pairs are made (METHOD 4).
#define TILES_AABB 0
#define TILES_ELLIPSE 1
#define TILES_ALL 2
#define TILES_OBB 3
#define TILES_SNUG 4

// --th: the alpha below which a Gaussian makes no pair (METHOD 5).
#define TH_TAU 0
#define TH_PERIPHERAL 1
#define TH_SQUARED 2

#ifdef __cplusplus
namespace binosplat {

/// A choice as options and charts name it, in the order of the numbers above.
struct Choice {
  const char* name;
  const char* help;
};

inline constexpr Choice tiles_choices[] = {
    {"aabb", "3D-GS's square of three standard deviations; cuts tails that can be seen"},
    {"ellipse", "exact: where alpha reaches the threshold (FlashGS, AdR-Gaussian)"},
    {"all", "every Gaussian to every tile: slow, for tests"},
    {"obb", "GSCore's oriented box of three standard deviations; cuts tails, too"},
    {"snug", "exact: the box around where alpha reaches the threshold (Speedy-Splat)"},
};

inline constexpr Choice th_choices[] = {
    {"tau", "1/255: exact"},
    {"peripheral", "AdaGScale: the alpha that a Gaussian may lose beyond its tiles"},
    {"squared", "the squared error that a pair may cost"},
};

}  // namespace binosplat
#endif

#endif
