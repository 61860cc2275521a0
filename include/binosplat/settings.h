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

/// How a Gaussian is projected. With Order::distance and Projection::tangent pictures do not depend on where
/// the head is turned.
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
  /// RGB behind the scene, from 0 to 1, display-referred; the target's alpha is then 1. None: colours are
  /// premultiplied by the alpha beside them.
  std::optional<glm::vec3> background = {};

  /// Give a quality or a tolerance, or neither: then frames are exact.
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
  DepthKind depth = DepthKind::mean;          // what is written into depth targets
  Layout layout = Layout::separate;
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
