#pragma once
// Pictures in memory: what a blend leaves (Picture), and plain images of channels (Image).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace binosplat {

/// Channels of floats, rows from the top, channels interleaved: value (x, y, c) is data[(y * width + x) *
/// channels + c].
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;  // 1 grey, 3 RGB, 4 RGB and straight alpha
  std::vector<float> data;

  Image() = default;
  Image(int w, int h, int c) : width(w), height(h), channels(c), data(static_cast<std::size_t>(w) * h * c) {}
  float& at(int x, int y, int c) { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
  float at(int x, int y, int c) const {
    return data[(static_cast<std::size_t>(y) * width + x) * channels + c];
  }
};

/// What a blend leaves of one view (docs/method.md 3), before any background. Rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::vec4>
      colour;  // C = sum of alpha T c (display-referred) in rgb; T, the transmittance left, in a
  std::vector<float> z_sum;  // Z = sum of alpha T z, world units

  Picture() = default;
  Picture(int w, int h)
      : width(w),
        height(h),
        colour(static_cast<std::size_t>(w) * h, glm::vec4(0, 0, 0, 1)),
        z_sum(static_cast<std::size_t>(w) * h) {}
};

/// A pixel's depth: not asked for, the mean of all that is seen in it, or where T falls below a half.
enum class Depth { none, mean, median };

/// Whether pictures are the same in number, size and every bit.
bool same_bits(std::span<const Picture> a, std::span<const Picture> b);

/// RGB behind the scene, display-referred; none: the picture keeps straight alpha.
using Background = std::optional<glm::vec3>;

/// The display-referred image of a picture: C + T * background as RGB or, without a background, RGBA with
/// straight alpha, colour C/A (0 where A = 0).
Image composite(const Picture& picture, const Background& background);

/// The same over black.
Image on_black(const Picture& picture);

/// A picture of three channels with each colour changed: its red, green and blue times the first three
/// columns, and the last one added. Not clamped.
Image exposed(const Image& rgb, const glm::mat4x3& exposure);

/// What takes an exposure back; nothing where that is lost, as where all becomes grey.
std::optional<glm::mat4x3> inverse_exposure(const glm::mat4x3& exposure);

/// Depth Z/A where A > 0.5, +infinity elsewhere; view-space z in world units; one channel.
Image depth_map(const Picture& picture);

/// The step, 0 to `top`, by which a file of whole numbers keeps a value from 0 to 1: round(top clamp(value));
/// 0 for one that is not a number.
inline int step_of(float value, float top) {
  const float scaled = (value > 0.0f ? std::min(value, 1.0f) : 0.0f) * top;
  const int whole = static_cast<int>(scaled);
  return scaled - static_cast<float>(whole) >= 0.5f ? whole + 1 : whole;  // as std::lround, and fast
}

/// Every value as 8 bits (or, with a `top` of 65535, 16) would keep it.
Image quantised(const Image& image, float top = 255.0f);

}  // namespace binosplat
