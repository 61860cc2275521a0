#pragma once
// What each order and projection is worth besides turning the head: against photos, to two eyes, and to a
// head that moves.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lab/calibrate.h"
#include "lab/page.h"
#include "render/frame.h"

namespace binosplat::lab {

/// Every order with every projection; the last is by distance and tangent, which turning does not change.
constexpr std::array<Perspective, 4> perspectives = {{{ORDER_DEPTH, PROJECTION_AFFINE},
                                                      {ORDER_DISTANCE, PROJECTION_AFFINE},
                                                      {ORDER_DEPTH, PROJECTION_TANGENT},
                                                      {ORDER_DISTANCE, PROJECTION_TANGENT}}};

std::string name_of(const Perspective& seen);

/// Frames of a head that moves and does not turn, so many apart: what one shows, warped to the other by the
/// depth that is drawn (stereo/disagreement.h), against what that shows. As StopThePop measures popping
/// (Radl et al. 2024, section 5), but by depth and poses where they estimate the flow.
struct Popping {
  int apart = 1;         // frames
  double mse = 0.0;      // of colours over black, of the pixels that both show; mean over the pairs
  double flip = 0.0;     // likewise; what one alone shows counts as equal
  double counted = 0.0;  // share of the pixels that both show
};

struct PerspectiveNumbers {
  Perspective seen;
  std::optional<double> photos_db;  // 8-bit PSNR, mean over the views
  std::optional<double> eyes_db;    // disagreement of the eyes' differences from the last perspective
  std::vector<Popping> popping;
};

struct PerspectiveViews {
  std::vector<shared::View> path;  // frames that follow one another; none: no popping
  std::vector<shared::View> eyes;  // left and right, or none
  struct Photographed {
    shared::View view;
    Image photo;                 // RGB in the view's size
    glm::mat4x3 exposure{1.0f};  // of pictures, before they are compared with it
  };
  std::vector<Photographed> photos;
};

/// Each of `perspectives`. `progress` is called as often as perspective_steps() says.
std::vector<PerspectiveNumbers> measure_perspectives(render::Frame& frame, const PerspectiveViews& views,
                                                     const std::function<void()>& progress);
std::size_t perspective_steps(const PerspectiveViews& views);

Table perspectives_table(std::span<const PerspectiveNumbers> numbers);
nlohmann::ordered_json to_json(std::span<const PerspectiveNumbers> numbers);

}  // namespace binosplat::lab
