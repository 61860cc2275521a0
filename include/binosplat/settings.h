#pragma once
// How a frame is drawn. Settings{} draws the exact picture over a transparent background.

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <binosplat/eyes.h>
#include <binosplat/targets.h>

namespace binosplat {

/// The rule by which a Gaussian is left out of a tile of 16 x 16 px that it hardly changes.
enum class Threshold {
  exact,       // where its alpha is below 1/255 in all of the tile, as 3D Gaussian Splatting blends
  squared,     // where the squared error stays below the tolerance, in px * squared colour
  peripheral,  // where what it would lose beyond its tiles stays below the tolerance, in alpha * px^2
               // (AdaGScale)
};

/// How much light the rules of Threshold take to reach a Gaussian.
enum class Transmittance {
  all,       // as if nothing stood before it
  measured,  // what earlier frames measured: faster, for heads that stand still
  by_depth,  // the most that reaches its depth, by Settings::depth_table (AdaGScale)
};

/// The most light that reaches any Gaussian whose view depth lies in a bin (AdaGScale's T_upper, sections 3.2
/// and 3.4 of the paper), in equal bins over [0, far) world units; Projection::tangent counts the distance
/// from the eye. A bin of 0 is one in which no Gaussian was seen: there, and beyond `far`, all light counts.
/// Calibration reads one from a file (binosplat/renderer.h).
struct DepthTable {
  float far = 0.0f;                // world units
  std::vector<float> bounds = {};  // from 0 to 1, by bin
};

/// The key by which Gaussians are sorted, front to back.
enum class Order {
  depth,     // along the view's axis, as 3D Gaussian Splatting is trained; turns with the head
  distance,  // from the point between the eyes
};

/// How a Gaussian is projected. With Order::distance and Projection::tangent pictures do not depend on where
/// the head is turned.
enum class Projection {
  affine,   // 3D Gaussian Splatting's, which stretches what is far off the view's axis
  tangent,  // onto the plane that touches the unit sphere where the ray goes through (docs/method.md, 2)
};

/// How exactly a renderer keeps its model and its frames.
enum class Precision {
  full,  // in 32 bits
  half,  // mostly in 16 bits: half the memory, at 60 dB or more from full. On NVIDIA's GPUs since Turing
         // exact frames without depths and meshes take 0.84 to 0.89 of the time, others 0.95; elsewhere it
         // hardly changes
};

/// The depth of a pixel of which more than half is covered.
enum class DepthKind {
  mean,    // of all that is seen in it: between a thing and what is behind it
  median,  // by which half of the light is gone: on the one or on the other, as compositors need it
};

/// The sharp part of a picture: for each eye an inset about its gaze, exact (in full precision to the bit),
/// and around it the same picture in fewer pixels, brought to one size. Degrees are those of the eye: its
/// picture's middle is where its axis meets it, wherever that lies in an asymmetric frustum.
struct Foveation {
  double inset_degrees = 20.0;  // across what is exact, all around the gaze, from 1 to 120
  double context_scale = 0.4;   // the context's pixels along each axis over the picture's, from 0.05 to 1
  /// Degrees to the right of the eye's axis and above it, at most 80, by eye or one for all; empty: along the
  /// axis.
  std::vector<glm::dvec2> gaze = {};
  /// The width of the border around the inset in which the window fades into the context, over the inset's.
  /// 0: no border.
  double seam = 0.1;
};

struct Settings {
  /// RGB behind the scene, from 0 to 1, display-referred; the target's alpha is then 1. None: colours are
  /// premultiplied by the alpha beside them.
  std::optional<glm::vec3> background = {};

  /// Give a quality or a tolerance, or neither: then frames are exact.
  ///
  /// Quality: the PSNR in dB, from 10 to 100, that the view that errs most should have against the exact
  /// picture, both as 8 bits would keep them. The renderer finds the tolerance, measures the error of a part
  /// of some frames, and draws those again that miss by far. Single frames may miss by some tenths of a dB,
  /// in fast turns by more.
  std::optional<float> quality = {};
  /// Tolerance: what leaving a Gaussian out of a tile may cost by the rule below, zero or more.
  std::optional<float> tolerance = {};
  /// None: `squared` with a quality or a tolerance, else `exact`, which takes neither.
  std::optional<Threshold> threshold = {};
  Transmittance transmittance = Transmittance::all;
  DepthTable depth_table = {};  // with Transmittance::by_depth

  std::optional<Order> order = {};            // none: as the model was trained
  std::optional<Projection> projection = {};  // likewise
  DepthKind depth = DepthKind::mean;          // what is written into depth targets
  Layout layout = Layout::separate;
  /// Both eyes' pictures are foveated; a tolerance or a quality is then the contexts'. Without depth targets
  /// and regions; with mesh depths only into targets that are written in place, and around the inset splats
  /// then end at meshes as coarsely as the context is.
  std::optional<Foveation> foveation = {};
  /// World units, above 0. Gaussians whose middle has no larger depth along the view's axis are not drawn; by
  /// Order::distance with Projection::tangent, no larger distance from the eye. DepthTarget::near_plane
  /// leaves nothing out: it says which depth is written as 0.
  double near_plane = near_default;
  /// For Scaffold-GS models only: the Gaussians of views 2k and 2k + 1 are made once, for the point between
  /// their eyes. Faster, and not exact. Give the left and the right eye's view; of four views first both wide
  /// ones, then both insets.
  bool cyclopean = false;
};

}  // namespace binosplat
