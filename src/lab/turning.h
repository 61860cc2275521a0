#pragma once
// Measures how a picture changes when the head turns at its place: colours along the same rays before and
// after.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lab/page.h"
#include "lab/perspectives.h"
#include "render/frame.h"
#include "scene/camera.h"

namespace binosplat::lab {

/// An error that counts as seen, of a colour of 0 to 1.
constexpr double seen_error = 5.0 / 255.0;

struct TurningSettings {
  double field_degrees = 60.0;  // across and down, of the rays
  int columns = 48, rows = 36;  // of rays, evenly spread over the field in the head's picture
  std::vector<double> degrees = {0.25, 1.0, 5.0, 15.0, 45.0};
};

/// One turn of a head, in one perspective.
struct Turned {
  Perspective seen;
  std::string about;  // "up" (yaw), "across" (pitch), "ahead" (roll): the head's own axes
  double degrees = 0.0;
  std::size_t rays = 0;       // in both pictures
  double psnr_db = 0.0;       // against the head that is not turned; infinite for equal colours
  double share_beyond = 0.0;  // of the rays, of which a channel is off by more than seen_error
  double flip = 0.0;          // of rays side by side as a picture of 67 pixels per degree
  Image difference;  // of RGB, a pixel a ray, 0 where one of them is in no picture; by 15 degrees up only
};

struct TurningStudy {
  std::string scene, device, view;
  int width = 0, height = 0;  // of the camera's picture, px
  TurningSettings settings;
  std::optional<Image> straight = {};  // RGB, a pixel a ray, in the first of `perspectives`
  std::vector<Turned> turns = {};
  std::vector<PerspectiveNumbers> numbers = {};  // may be none
};

/// Every one of `perspectives`, turned about each of the camera's axes by each angle. `progress` is called as
/// often as turning_steps() says.
void measure_turning(TurningStudy& study, render::Frame& frame, const Camera& camera, double near_plane,
                     const std::function<void()>& progress);
std::size_t turning_steps(const TurningSettings& settings);

/// A row a perspective and axis, PSNR by angle.
Table turning_table(const TurningStudy& study);

nlohmann::ordered_json to_json(const TurningStudy& study);
Page turning_page(const TurningStudy& study);

}  // namespace binosplat::lab
