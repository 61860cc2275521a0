#pragma once
// Models that renderers break on, each with what a right one does. All are for a camera at the origin that
// looks along z (front_camera in support/models.h), and for the eyes of a rig around it; degree 0.

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "shared/limits.h"
#include "support/models.h"

namespace binosplat::test {

/// The largest opacity that draws nothing, and the smallest that draws something: a Gaussian counts where its
/// alpha is not below tau = 1/255. The float nearest to 1/255 is a little larger than 1/255, so it draws in
/// single and in double precision alike.
inline const float tau = 1.0f / 255.0f;
inline const float just_below_tau = std::nextafter(tau, 0.0f);
inline const float just_above_tau = std::nextafter(tau, 1.0f);

/// Where a Gaussian has its mean at a pixel (counted from 0; its centre for whole numbers) and this depth.
inline glm::vec3 behind_pixel(const Camera& camera, double x, double y, double depth) {
  return glm::vec3((x + 0.5 - camera.cx) / camera.fx * depth, (y + 0.5 - camera.cy) / camera.fy * depth,
                   depth);
}

/// `count` faint grey specks in one tile, and one opaque red Gaussian behind them that covers the tile.
///
/// The tile's list is longer than the 65,535 rounds after which llvmpipe ends any loop in silence, than
/// 16-bit counters reach and than a batch in shared memory; other tiles have hardly any. A pixel is met by
/// some 290 specks (none along the tile's border), whose alpha of 1/255 to 0.006 leaves a fifth of the light
/// or more: the red is last in the list and shows in every pixel of the tile. A list cut short has no red; a
/// blend that stops early has too little.
inline Model crowded_tile(const Camera& camera, int tile_x, int tile_y, int tile_size = TILE_SIZE_DEFAULT,
                          int count = 70'000) {
  Uniform uniform(70);
  Model model;
  model.name = "crowded tile";
  for (int i = 0; i < count; ++i) {
    const double depth = 2.0 + 6.0 * i / count;
    // A speck reaches half a pixel far: it stays in the tile.
    const double x = tile_size * tile_x + uniform(0.5, tile_size - 1.5);
    const double y = tile_size * tile_y + uniform(0.5, tile_size - 1.5);
    add(model, behind_pixel(camera, x, y, depth), glm::vec3(1e-4f), 0.006f, glm::vec3(0.5f));
  }
  const double middle = 0.5 * tile_size - 0.5, depth = 9.0;
  const auto reach = static_cast<float>(tile_size * depth / camera.fx);
  add(model, behind_pixel(camera, tile_size * tile_x + middle, tile_size * tile_y + middle, depth),
      {reach, reach, 0.01f}, 0.9f, {1.0f, 0.0f, 0.0f});
  return model;
}

/// One Gaussian over all tiles of any picture up to 120 degrees across, at depth 5: meant for the pair of
/// 2 x 3,660 x 3,200 (2 x 45,800 tiles of 16 px), where it alone makes 91,600 pairs.
///
/// Every tile of every eye lists it once, so that pairs == tiles; every pixel has nearly its opacity of 0.8
/// times its colour (at 100 degrees the corners have 1.3 % less). A splat whose tiles one thread counts or
/// writes in a loop is cut short here too; a screen extent in 16 bits overflows.
inline Model blanket() {
  Model model;
  model.name = "blanket";
  add(model, {0.0f, 0.0f, 5.0f}, {50.0f, 50.0f, 0.01f}, 0.8f, {0.2f, 0.6f, 0.9f});
  return model;
}

/// `count` Gaussians at the very same depth of 3, black and white by turns, that all overlap in the middle.
///
/// Equal depths are drawn by index. The first in order hides what follows (5 % each), so any other order of a
/// tie is another picture: backwards, or ordered within parts of 256, the size of a work group, which 300
/// exceeds. `backwards` makes the same Gaussians in the other order, the fault that a test must see.
inline Model equal_depths(int count = 300, bool backwards = false) {
  Uniform uniform(300);
  Model model;
  model.name = "equal depths";
  struct Place {
    glm::vec3 position;
    float colour;
  };
  std::vector<Place> places;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(-0.4, 0.4), y = uniform(-0.4, 0.4);
    // Blocks of 37 equal ones: neighbours that swap do not hide each other's fault.
    places.push_back({glm::vec3(x, y, 3.0), i / 37 % 2 == 0 ? 1.0f : 0.0f});
  }
  if (backwards) std::reverse(places.begin(), places.end());
  for (const Place& place : places)
    add(model, place.position, glm::vec3(0.5f), 0.05f, glm::vec3(place.colour));
  return model;
}

/// 60 ordinary Gaussians, and outliers as captures have them: positions 2e7 away in all directions, and
/// scales up to 2e7 ahead.
///
/// The outliers beside and behind the camera leave no mark, whatever their size; the one ahead is a sky
/// behind everything. No sum, square or sort key overflows, nothing is NaN, and the ordinary ones look as
/// they do by themselves before that sky. `outliers` false leaves the outliers out.
inline Model far_outliers(bool outliers = true) {
  Uniform uniform(20);
  Model model;
  model.name = "far outliers";
  constexpr float far = 2e7f;
  if (outliers) {
    for (const float size : {1e-3f, 1.0f, 1e5f}) {
      for (const float side : {-far, far}) {
        add(model, {side, 0.0f, 3.0f}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
        add(model, {0.0f, side, 3.0f}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
      }
      add(model, {0.0f, 0.0f, -far}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
      add(model, {far, far, 0.2f * far}, glm::vec3(size), 0.9f, {1.0f, 0.0f, 1.0f});
    }
    add(model, {0.0f, 0.0f, -far}, glm::vec3(far), 0.9f, {1.0f, 0.0f, 1.0f});
  }
  for (int i = 0; i < 60; ++i) {
    const double z = uniform(2.0, 6.0);
    const double x = uniform(-0.4, 0.4) * z, y = uniform(-0.4, 0.4) * z;
    const glm::vec3 colour(uniform(0, 1), uniform(0, 1), uniform(0, 1));
    add(model, glm::vec3(x, y, z), glm::vec3(0.12f), 0.8f, colour);
  }
  if (outliers) add(model, {0.0f, 0.0f, far}, glm::vec3(far), 0.9f, {0.4f, 0.6f, 0.9f});
  return model;
}

/// `count` Gaussians with their means at centres of pixels, all of one opacity: just_below_tau,
/// just_above_tau, tau or 0.
///
/// Of just_below_tau and of 0 nothing is drawn at all: no pairs, transmittance 1 everywhere (and no stage
/// minds that there is nothing). Of tau and just_above_tau each marks the one pixel in which its mean lies,
/// and that by 1/255. Logarithms of opacity / tau are 0 or below here, and of 0 infinite.
inline Model transparent(const Camera& camera, float opacity, int count = 200) {
  Uniform uniform(255);
  Model model;
  model.name = "transparent";
  for (int i = 0; i < count; ++i) {
    const double x = std::floor(uniform(0, camera.width)), y = std::floor(uniform(0, camera.height));
    add(model, behind_pixel(camera, x, y, uniform(2.0, 6.0)), glm::vec3(0.1f), opacity, glm::vec3(1.0f));
  }
  return model;
}

/// One white Gaussian of opacity exactly tau whose mean lies exactly in the middle of a pixel: (width / 2,
/// height / 2) of a front_camera whose width and height are even and whose focal length is a power of two, so
/// that no step rounds.
///
/// Alpha is tau in that pixel and below it everywhere else: the pixel is 1/255, all others 0, and there is
/// one pair. With TILES_ELLIPSE its ellipse is a single point, which must not be lost.
inline Model exactly_tau(const Camera& camera) {
  Model model;
  model.name = "exactly tau";
  add(model, behind_pixel(camera, 0.5 * camera.width, 0.5 * camera.height, 2.0), glm::vec3(0.25f), tau,
      glm::vec3(1.0f));
  return model;
}

}  // namespace binosplat::test
