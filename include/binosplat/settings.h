#pragma once
// How a frame is drawn. Settings{} draws the exact picture over a transparent background.

#include <glm/glm.hpp>
#include <optional>

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
};

/// What Gaussians are sorted by, front to back.
enum class Order {
  depth,     // along the view's axis, as 3D Gaussian Splatting is trained; turns with the head
  distance,  // from the point between the eyes
};

/// What a ray sees of a Gaussian. With Order::distance and Projection::tangent pictures do not depend on
/// where the head is turned.
enum class Projection {
  affine,   // 3D Gaussian Splatting's, which stretches what is far off the view's axis
  tangent,  // onto the plane that touches the unit sphere where the ray goes through (docs/method.md, 2)
};

/// What a pixel's depth is, where more than half of the pixel is covered.
enum class DepthKind {
  mean,    // of all that is seen in it: between a thing and what is behind it
  median,  // where half of the light is gone: on the one or on the other. What a compositor needs
};

struct Settings {
  /// RGB behind the scene, from 0 to 1, display-referred. None: colours are premultiplied by the alpha beside
  /// them.
  std::optional<glm::vec3> background = {};

  /// Exact unless one of these is given, and never both.
  ///
  /// Quality: the PSNR in dB, from 10 to 100, that the view that errs most should have against the exact
  /// picture, both as 8 bits would keep them. The renderer finds the tolerance, measures the error of a part
  /// of some frames, and draws those again that miss.
  std::optional<float> quality = {};
  /// Tolerance: what leaving a Gaussian out of a tile may cost by the rule below, zero or more.
  std::optional<float> tolerance = {};
  /// None: `squared` with a quality or a tolerance, else `exact`, which takes neither.
  std::optional<Threshold> threshold = {};
  Transmittance transmittance = Transmittance::all;

  std::optional<Order> order = {};            // none: as the model was trained
  std::optional<Projection> projection = {};  // likewise
  DepthKind depth = DepthKind::mean;          // of views with a depth target
  Layout layout = Layout::separate;
  double near_plane = near_default;  // world units, above 0: what is nearer to an eye is not drawn
  /// Of Scaffold-GS models only: the Gaussians of both eyes are made for a point between them. Faster, and
  /// not exact. Views come in pairs, the eyes of one at 2k and 2k + 1.
  bool cyclopean = false;
};

}  // namespace binosplat
