#include "formats/distortion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"

namespace binosplat {

Distortion distortion_of(const BrownDistortion& b) {
  const auto is_zero = [](double value) { return value == 0.0; };
  if (std::all_of(b.k.begin(), b.k.end(), is_zero) && std::all_of(b.below.begin(), b.below.end(), is_zero) &&
      b.p1 == 0.0 && b.p2 == 0.0)
    return {};
  return [b](const glm::dvec2& at) {
    const double r2 = glm::dot(at, at);
    const double radial = (1 + r2 * (b.k[0] + r2 * (b.k[1] + r2 * (b.k[2] + r2 * b.k[3])))) /
                          (1 + r2 * (b.below[0] + r2 * (b.below[1] + r2 * b.below[2])));
    const glm::dvec2 askew(2 * b.p1 * at.x * at.y + b.p2 * (r2 + 2 * at.x * at.x),
                           2 * b.p2 * at.x * at.y + b.p1 * (r2 + 2 * at.y * at.y));
    return radial * at + askew;
  };
}

double corner_shift(const Camera& camera, const Distortion& distortion) {
  if (!distortion) return 0.0;
  const glm::dvec2 focal(camera.fx, camera.fy), principal(camera.cx, camera.cy);
  double farthest = 0.0;
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(camera.width, 0), glm::dvec2(0, camera.height),
                                  glm::dvec2(camera.width, camera.height)}) {
    const glm::dvec2 at = (corner - principal) / focal;
    const double shift = glm::length(focal * (distortion(at) - at));
    if (!std::isfinite(shift)) return std::numeric_limits<double>::infinity();
    farthest = std::max(farthest, shift);
  }
  return farthest;
}

void LensReport::add(const Camera& camera, const Distortion& distortion) {
  ++drawn_;
  if (!distortion) return;
  const double shift = corner_shift(camera, distortion);
  if (farthest_ && *farthest_ >= shift) return;
  farthest_ = shift;
  farthest_camera_ = camera.name;
}

void LensReport::add_skipped(std::string why) {
  if (left_out_++ == 0) first_left_out_ = std::move(why);
}

void LensReport::report() const {
  if (left_out_ > 0 && drawn_ == 0) fail("{}", first_left_out_);
  if (left_out_ > 0)
    log_warning("{}: {} of {} cameras are skipped, because their lenses cannot be drawn. The first: {}",
                file_, left_out_, left_out_ + drawn_, first_left_out_);
  if (!farthest_) return;
  const std::string shift = std::isinf(*farthest_) ? "infinite" : fmt::format("{:.3g} px", *farthest_);
  log_warning(
      "{}: lens distortion is not drawn, so pictures match only undistorted photos. The largest shift of a "
      "picture's corner is {} ({}){}",
      file_, shift, farthest_camera_, remedy_);
}

Distortion read_distortion(const KeyOf& key) {
  if (const auto list = key("distortion_params")) {
    list->list_of(6);
    const auto at = [&](std::size_t i) { return list->at(i).number(); };
    return distortion_of({.k = {at(0), at(1), at(2), at(3)}, .p1 = at(4), .p2 = at(5)});
  }
  const auto number = [&](const char* name) {
    const auto found = key(name);
    return found ? found->number() : 0.0;
  };
  BrownDistortion brown{
      .k = {number("k1"), number("k2"), number("k3"), number("k4")}, .p1 = number("p1"), .p2 = number("p2")};
  // In OpenCV's full model k4 to k6 are in the denominator.
  if (key("k5") || key("k6")) {
    brown.below = {std::exchange(brown.k[3], 0.0), number("k5"), number("k6")};
  }
  return distortion_of(brown);
}

std::string undrawable_lens(const KeyOf& key) {
  constexpr const char* what = "only pinhole lenses can be drawn; undistort the pictures first";
  for (const char* name : {"camera_model", "camera_type"}) {
    const auto value = key(name);
    const std::string model = value ? lowered(value->text()) : "";
    for (const char* other :
         {"fisheye", "equirect", "ortho", "omnidirectional", "vr180", "spherical", "panorama"}) {
      if (model.find(other) != std::string::npos)
        return fmt::format("key '{}' ({}): {}", name, value->text(), what);
    }
  }
  for (const char* name : {"is_fisheye", "ftheta_p0", "latlong", "equirectangular"}) {
    const auto value = key(name);
    if (value && value->value() != false && value->value() != 0)
      return fmt::format("key '{}': {}", name, what);
  }
  return "";
}

}  // namespace binosplat
