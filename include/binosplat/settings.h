#pragma once
// How to draw a frame. Settings{} draws the exact picture over a transparent background.

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <binosplat/eyes.h>
#include <binosplat/targets.h>

namespace binosplat {

/// The rule that drops a Gaussian from a tile of 16 x 16 px that it hardly changes. It drops the Gaussian:
enum class Threshold {
  exact,      // if its alpha is below 1/255 in the whole tile, as 3D Gaussian Splatting blends
  adagscale,  // if its loss in the whole view stays below the tolerance, AdaGScale's K, in alpha * px^2
  squared,    // if the squared error in the tile stays below the tolerance, in px * squared colour
};

/// The source of the upper bound of a Gaussian's transmittance, which a Threshold assumes.
enum class Transmittance {
  one,    // 1, as if nothing stood in front of the Gaussian
  depth,  // the largest transmittance at the Gaussian's depth, from Settings::depth_table (AdaGScale)
  last,   // measured by earlier frames: faster if the head stands still
};

/// The largest transmittance of any Gaussian whose view depth lies in a bin (AdaGScale's T_upper, sections
/// 3.2 and 3.4 of the paper). The bins divide [0, far) equally. With Projection::tangent, the depth is the
/// distance from the eye. The number 0 marks a bin without Gaussians: there, and beyond `far`, T_upper is 1.
/// Calibration reads a table from a file (binosplat/renderer.h).
struct DepthTable {
  float far = 0.0f;                // world units
  std::vector<float> bounds = {};  // from 0 to 1, one per bin
};

/// The key by which Gaussians are sorted, front to back.
enum class Order {
  depth,     // along the view's axis, as 3D Gaussian Splatting trains; changes when the head turns
  distance,  // from the point between the eyes
};

/// The projection of a Gaussian. With Order::distance and Projection::tangent, pictures do not depend on the
/// direction of the head.
enum class Projection {
  affine,   // 3D Gaussian Splatting's, which stretches Gaussians far off the view's axis
  tangent,  // onto the plane that touches the unit sphere at the Gaussian's ray (docs/method.md, 2)
};

/// The precision of the model and the frames in the GPU's memory.
enum class Precision {
  full,  // 32 bits
  half,  // mostly 16 bits: half the memory, at least 60 dB against full precision. On NVIDIA's GPUs since
         // Turing, exact frames without depths and meshes take 0.84 to 0.89 of the time of full precision,
         // and other frames 0.95. On other GPUs the time hardly changes
};

/// The depth of a pixel, if more than half of it is covered.
enum class DepthKind {
  mean,    // of everything visible in the pixel; at edges it lies between an object and its background
  median,  // the depth at which half of the light is blocked; it lies on a surface, as compositors need
};

/// Foveated pictures: each eye has an inset around its gaze. The context around the inset has fewer pixels
/// and is scaled up. The inset is exact; in full precision to the bit. All degrees are angles at the eye.
struct Foveation {
  double inset_degrees = 20.0;  // width of the inset, from 1 to 120
  double context_scale = 0.4;   // ratio of the context's to the picture's pixels along each axis, 0.05 to 1
  /// Degrees to the right of the eye's forward axis and above it, at most 80. One per eye, or one for all;
  /// empty: along the axis, which in an asymmetric frustum misses the picture's middle.
  std::vector<glm::dvec2> gaze = {};
  /// Width of the border in which the inset fades into the context, divided by the inset's width. 0: no
  /// border.
  double seam = 0.1;
};

/// The drawn part of a view, and its accuracy. By default the whole view is drawn, as accurately as the
/// settings request. Rows count from the top of the picture.
struct ViewRegion {
  static constexpr int tile = 16;  // px, the side of a tile
  /// For each row of tiles, the range [x, y) of tile columns to draw. Use this, for example, to skip tiles
  /// that no lens shows. Empty: all tiles.
  std::vector<glm::uvec2> columns = {};
  /// px. Tiles inside the rectangle [hole_begin, hole_end) are not drawn, because an inset covers them.
  glm::uvec2 hole_begin{0}, hole_end{0};
  float tolerance_share = 1.0f;  // the view's tolerance divided by the frame's; 0: exact
  /// Set this for a picture with fewer pixels per degree than another picture, such as the context around an
  /// inset. The value is the squared ratio of their pixels per degree, at most 1. The low-pass has the same
  /// width in px in every picture, so thin Gaussians would be too bright in the coarser picture. The renderer
  /// dims them, by at most this factor. Anti-aliased models ignore it.
  float low_pass_share = 1.0f;

  bool operator==(const ViewRegion&) const = default;
};

struct Settings {
  /// Settings for a headset: with Order::distance and Projection::tangent, splats do not turn with the head.
  /// This takes 3 to 12 % of the frame's time. A model that was trained for Order::depth and
  /// Projection::affine loses 0.5 to 1 dB against its photos, unless `binosplat refit` has adapted it. For a
  /// model whose file records another order or projection, use Settings{}.
  static Settings headset() { return {.order = Order::distance, .projection = Projection::tangent}; }

  /// RGB behind the scene, from 0 to 1, display-referred; the target's alpha is then 1. None: colours are
  /// premultiplied by alpha.
  std::optional<glm::vec3> background = {};

  /// Set a quality, a tolerance, or neither for exact frames.
  ///
  /// Quality: the PSNR in dB, from 10 to 100, that the worst view should have against the exact picture, both
  /// rounded to 8 bits. The renderer measures the error in parts of some frames, and draws frames exactly
  /// whose error is unknown or which would save little (Report::exact). Single frames may miss the quality by
  /// some tenths of a dB.
  std::optional<float> quality = {};
  /// Tolerance: the largest loss that the threshold rule accepts, in the rule's unit; at least 0. The loss is
  /// that of a dropped pair of Gaussian and tile (`squared`), or of a Gaussian in a view (`adagscale`).
  ///
  /// `adagscale` with neither: a Renderer of one SplatModel, drawn without a World, finds the tolerance K for
  /// 40 dB in up to 16 training views: of the cameras beside the model's file, or else one view that frames
  /// the model. It logs K and the worst view's dB on standard error. A Calibration holds such a K in a file.
  std::optional<float> tolerance = {};
  /// None: with a quality each frame chooses the faster rule by its counts: `adagscale` where many Gaussians
  /// lie behind one another in each tile, else `squared` (Report::threshold). With a tolerance alone
  /// `adagscale`, since it is stable in scenes where nothing was measured. Else `exact`, which permits
  /// neither.
  std::optional<Threshold> threshold = {};
  std::optional<Transmittance> transmittance = {};  // none: `depth` with adagscale and a table, else `one`
  DepthTable depth_table = {};                      // for Transmittance::depth

  std::optional<Order> order = {};            // none: as the model was trained
  std::optional<Projection> projection = {};  // none: as the model was trained
  DepthKind depth = DepthKind::mean;          // the depth written into depth targets
  Layout layout = Layout::separate;
  /// Foveates both eyes' pictures. A tolerance then applies to the contexts. A quality, depth targets and
  /// regions are then errors. Mesh depths require targets that are written in place; outside the inset,
  /// meshes then hide splats at the context's resolution.
  std::optional<Foveation> foveation = {};
  /// World units, above 0; none: that of the model's training (of several models, of the first instance), or
  /// near_default if no file says it. A Gaussian is not drawn if the depth of its centre along the view's
  /// axis is smaller. With Order::distance and Projection::tangent, its distance from the eye counts instead
  /// of the depth. DepthTarget::near_plane drops nothing: it defines the depth that is stored as 0.
  std::optional<double> near_plane = {};
};

}  // namespace binosplat
