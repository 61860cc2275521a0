#pragma once
// The caller's textures and framebuffers, into which pictures and depths are drawn. They belong to the
// renderer's context, and the caller may delete them between frames.
//
// Rows are OpenGL's: the top of a picture is the texture's top, t = 1, and y counts from the bottom. Only a
// ViewRegion counts rows from the top.

#include <cstdint>
#include <limits>

#include <binosplat/eyes.h>

namespace binosplat {

/// The arrangement of both eyes. `separate` keeps two pictures; other layouts make one picture in one target.
/// Depths still go into each view's depth target. The layouts from anaglyph on mix colours for red-cyan
/// glasses, with red for the left eye, and need a background. The numbers are those of the program
/// `binosplat`, whose layouts 1 and 2 are for files and windows only.
enum class Layout {
  separate = 0,      // each view in its own target
  parallel = 3,      // side by side, the left eye's on the left: twice as wide
  cross_eyed = 4,    // side by side, swapped: for crossed eyes
  half_width = 5,    // parallel, with each picture squeezed to half its width, which must be even
  over_under = 6,    // the left eye's above the right one's: twice as high
  half_height = 7,   // over_under, with each picture squeezed to half its height, which must be even
  rows = 8,          // rows alternate, the left eye's first
  columns = 9,       // columns alternate, the left eye's first
  anaglyph = 10,     // by least squares (Dubois 2009)
  half_colour = 11,  // grey in the left eye, colour in the right
  grey = 12,         // grey in both eyes
};

/// The destination of a picture: a texture of any colour-renderable format, or a framebuffer. Neither may be
/// multisampled, and the picture must fit from the corner (x, y) on. Target{} is the default framebuffer.
///
/// The renderer writes in place, without a copy, into a 2D texture or a layer of an array of these formats:
/// GL_RGBA8, RGBA16, RGBA16F, RGBA32F, RGB10_A2, and GL_SRGB8_ALPHA8 with immutable storage
/// (glTextureStorage2D and the like). A framebuffer is written in place if its only colour attachment is such
/// a texture. For other targets the renderer draws its own picture first, with 4 bytes per pixel, or 16
/// if the target keeps more than 8 bits of a colour.
///
/// Colours are display-referred, as models are trained: a texture of GL_SRGB8_ALPHA8 holds such values. The
/// caller's GL_FRAMEBUFFER_SRGB, blending, masks and tests do not affect them. All draw buffers of a
/// framebuffer receive the picture. If two pictures of one frame overlap in a target, the result there is
/// undefined; it is no error.
struct Target {
  std::uint32_t texture = 0;      // 2D, or 2D array with a layer; 0: the framebuffer below
  int level = 0;                  // of the texture
  int layer = -1;                 // of an array texture; -1: no array
  std::uint32_t framebuffer = 0;  // 0: the default framebuffer
  int x = 0;                      // px, the lower left corner of the picture in the target, as in glViewport
  int y = 0;
  /// Whether the target stores linear light; if so, the renderer converts colours to linear light. OpenXR
  /// runtimes expect linear light in every format other than sRGB.
  bool linear = false;
  /// Whether colours without a background are premultiplied by alpha as linear light, in which OpenXR
  /// runtimes blend layers over the room or over each other
  /// (XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT). If not, they are premultiplied as display values.
  /// Without effect among meshes.
  bool linear_alpha = false;
  /// Whether shaders may write into the target. Set it to false for an OpenXR swapchain without
  /// XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT, such as Monado's sRGB swapchains. The renderer then draws its
  /// own picture and copies it into the target.
  bool in_place = true;
};

/// The destination of a view's depths: a 2D texture, or a layer of an array, of a depth format without
/// stencil, as XR_KHR_composition_layer_depth takes it. The whole texture is overwritten. The value at z
/// (world units, along the view's axis) is far (1 - near / z) / (far - near), from 0 at `near_plane` to 1 at
/// `far_plane`. Either plane may be infinite. If `near_plane` is the larger one, depths are reversed. Pixels
/// that are at most half covered are infinitely far. The texture may have fewer pixels than the view: server
/// GPUs fill depths slowly, and a headset's runtime needs no more.
struct DepthTarget {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;                                              // of an array texture; -1: no array
  double near_plane = near_default;                            // world units, above 0
  double far_plane = std::numeric_limits<double>::infinity();  // world units, above 0
};

/// The meaning of a number d in a depth texture.
enum class DepthCoding {
  /// OpenGL's depth buffer: d = far (1 - near / z) / (far - near), with the planes of MeshDepth. The value of
  /// the farther plane, as in a cleared buffer, means no mesh.
  planes,
  axis,  // z = d * units_per_number; a d that is not positive and finite means no mesh
};

/// The depths of the meshes that the caller has drawn in a view, so that splats and meshes hide each other.
/// Splats behind a mesh are not drawn. Splats in front are blended over the colours in the view's target,
/// which the caller has cleared or drawn, premultiplied by alpha. A Gaussian has the depth of its centre: a
/// mesh hides it in the pixels where the mesh is nearer. So a mesh that coincides with a surface of splats
/// shows stripes of both.
///
/// A 2D texture or a layer of an array, without multisampling, of GL_DEPTH_COMPONENT32F, DEPTH_COMPONENT24,
/// DEPTH_COMPONENT16, DEPTH24_STENCIL8, DEPTH32F_STENCIL8 or R32F. The renderer only reads the texture. The
/// view's picture must fit from the corner (x, y) on.
struct MeshDepth {
  std::uint32_t texture = 0;
  int level = 0;
  int layer = -1;    // of an array texture; -1: no array
  int x = 0, y = 0;  // px, the lower left corner of the view's picture in the texture
  DepthCoding coding = DepthCoding::planes;
  /// World units, above 0: the planes of the projection that drew the meshes; required with
  /// DepthCoding::planes. Either may be infinite. If `near_plane` is the larger one, depths are reversed.
  double near_plane = 0.0;
  double far_plane = 0.0;
  double units_per_number = 1.0;  // world units per number, above 0; used with DepthCoding::axis
};

}  // namespace binosplat
