#include "formats/cameras/distortion.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"

namespace binosplat {

void LensReport::add(bool distorted) {
  ++drawn_;
  distorted_ |= distorted;
}

void LensReport::add_skipped(std::string why) {
  if (left_out_++ == 0) first_left_out_ = std::move(why);
}

void LensReport::report() const {
  if (left_out_ > 0 && drawn_ == 0) fail("{}", first_left_out_);
  if (left_out_ > 0)
    log_warning("{}: {} of {} cameras are skipped, because their lenses cannot be drawn. The first: {}",
                file_, left_out_, left_out_ + drawn_, first_left_out_);
  if (distorted_) log_warning("{}: has distortion: compare with undistorted photos{}", file_, remedy_);
}

bool has_distortion(const KeyOf& key) {
  if (const auto list = key("distortion_params")) return list->numbers(6) != std::vector(6, 0.0);
  return std::ranges::any_of(std::array{"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"},
                             [&](const char* name) {
                               const auto found = key(name);
                               return found && found->number() != 0.0;
                             });
}

std::string undrawable_lens(const KeyOf& key) {
  constexpr const char* what = "only pinhole lenses can be drawn; undistort the pictures first";
  for (const char* name : {"camera_model", "camera_type"}) {
    const auto value = key(name);
    const std::string model = value ? lowered(value->text()) : "";
    const auto is_named = [&](const char* part) { return model.find(part) != std::string::npos; };
    constexpr std::array pinholes = {"pinhole", "perspective", "opencv", "radial", "brown"};
    if (!model.empty() && (is_named("fisheye") || std::ranges::none_of(pinholes, is_named)))
      return fmt::format("key '{}' ({}): {}", name, value->text(), what);
  }
  for (const char* name : {"is_fisheye", "ftheta_p0", "latlong", "equirectangular"}) {
    const auto value = key(name);
    if (value && value->value() != false && value->value() != 0)
      return fmt::format("key '{}': {}", name, what);
  }
  return "";
}

}  // namespace binosplat
