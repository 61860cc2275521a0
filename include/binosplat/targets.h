#pragma once
// Textures and framebuffers of the caller's that pictures and depths are drawn into. They stay the caller's,
// belong to the context that the renderer was made in, and may be deleted between frames.
//
// Rows are OpenGL's: the top of a picture is the texture's top, t = 1, and y counts from the bottom (in a
// ViewRegion, rows count from the top).

#include <cstdint>
#include <limits>

#include <binosplat/eyes.h>

namespace binosplat {

/// How both eyes are shown. In all layouts but `separate` they become one picture, in one target; depths
/// still go into each view's depth target. The layouts from anaglyph on mix colours for red-cyan glasses, red
/// before the left eye, and need a background. Numbers are the program's; its layouts 1 and 2 are for files
/// and windows.
enum class Layout {
  separate = 0,      // each view in a target of its own
  parallel = 3,      // side by side, the left eye's on the left: twice as wide
  cross_eyed = 4,    // side by side, swapped: for eyes that cross
  half_width = 5,    // parallel, each squeezed to half its width, which is even
  over_under = 6,    // the left eye's above the right one's: twice as high
  half_height = 7,   // over_under, each squeezed to half its height
  rows = 8,          // left and right row by row, the left eye's first
  columns = 9,       // the same column by column
  anaglyph = 10,     // by least squares (Dubois 2009)
  half_colour = 11,  // grey in the left eye, colour in the right
  grey = 12,         // grey in both eyes
};

/// Where a picture goes: a texture of any colour-renderable format, or a framebuffer, both without samples
/// and with room for the picture from its corner on; Target{} is the default framebuffer. A 2D texture, or a
/// layer of an array, is written without a copy where its format is GL_RGBA8, RGBA16, RGBA16F, RGBA32F or
/// RGB10_A2, or GL_SRGB8_ALPHA8 with immutable storage (glTextureStorage2D and its like), and so is a
/// framebuffer that has one such texture and no other colours; all else takes a picture of the renderer's
/// own, of 4 bytes a pixel, or of 16 where the target keeps more than 8 bits of a colour.
///
/// Colours are display-referred, as models are trained: numbers as a screen takes them, which is what a
/// texture of GL_SRGB8_ALPHA8 holds. GL_FRAMEBUFFER_SRGB, blending, masks and tests of the caller's do not
/// touch them. All draw buffers of a framebuffer get the picture. Pictures of one frame must not overlap in a
/// target: which of them is seen there is not defined, and it is no error.
struct Target {
  std::uint32_t texture = 0;      // 2D, or 2D array with a layer; 0: the framebuffer below
  int level = 0;                  // of the texture
  int layer = -1;                 // of an array texture; -1: not one
  std::uint32_t framebuffer = 0;  // 0: the default framebuffer
  int x = 0;                      // px, lower left corner of the picture in it, as glViewport counts
  int y = 0;
  /// Its numbers mean linear light, as OpenXR's runtimes have it of every format but sRGB's: colours are
  /// converted.
  bool linear = false;
  /// Whether shaders may write into it. Set false for a swapchain that OpenXR's runtime makes without
  /// XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT, as Monado does of sRGB: the renderer then draws a picture of
  /// its own and copies it into the target.
  bool in_place = true;
};

/// Where a view's depths go: a 2D texture, or a layer of an array, of a depth format without stencil, as
/// XR_KHR_composition_layer_depth takes it. All of the texture is overwritten. The depth at z (world units,
/// along the view's axis) is far (1 - near / z) / (far - near), from 0 at `near_plane` to 1 at
/// `far_plane`; either may be infinite, and `near_plane` may be the larger one, which reverses the depths. A
/// pixel of which half or less is covered is infinitely far. The texture may have fewer pixels than the view:
/// GPUs of servers fill depths slowly, and a headset's runtime needs no more.
struct DepthTarget {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;                                              // of an array texture; -1: not one
  double near_plane = near_default;                            // world units, above 0
  double far_plane = std::numeric_limits<double>::infinity();  // world units, above 0
};

/// How a number d of a depth texture tells how far something is.
enum class DepthCoding {
  /// As OpenGL's depth buffer keeps it: d = far (1 - near / z) / (far - near), near and far being the planes
  /// of MeshDepth. Pixels that have the number of the farther plane, as a cleared buffer does, have no mesh.
  planes,
  axis,  // d times units_per_number is z; pixels whose d is 0, less, infinite or not a number have no mesh
};

/// The depths of the meshes that the caller has drawn in a view, by which splats and meshes hide each other:
/// what lies behind a mesh is not drawn, and splats in front of it are blended over the colours that are in
/// the view's target, premultiplied by the alpha beside them, which the caller has cleared or drawn. A
/// Gaussian lies where its centre does: it is hidden in the pixels where the mesh is nearer than that, so
/// that a mesh within a surface of splats shows some of them in stripes.
///
/// A 2D texture or a layer of an array, without samples, of GL_DEPTH_COMPONENT32F, DEPTH_COMPONENT24,
/// DEPTH_COMPONENT16, DEPTH24_STENCIL8, DEPTH32F_STENCIL8 or R32F. It is only read. It must be as large as
/// the view, from its corner on.
struct MeshDepth {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;    // of an array texture; -1: not one
  int x = 0, y = 0;  // px, lower left corner of the view's picture in it
  DepthCoding coding = DepthCoding::planes;
  /// World units, above 0: those of the projection that the meshes were drawn with, which must be given.
  /// Either may be infinite, and `near_plane` may be the larger one, where depths are reversed.
  double near_plane = 0.0;
  double far_plane = 0.0;
  double units_per_number = 1.0;  // world units, above 0, with DepthCoding::axis
};

}  // namespace binosplat
