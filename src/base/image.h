#pragma once
// Pictures in memory: the result of a blend (Picture), and images with channels (Image).

#include <algorithm>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace binosplat {

/// Floats, rows from the top, channels interleaved: value (x, y, c) is data[(y * width + x) * channels + c].
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

/// The result of blending a view (docs/method.md 3), before any background. Rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::vec4> colour;  // rgb: C = sum of alpha T c, display-referred; a: the remaining T
  std::vector<float> z_sum;       // Z = sum of alpha T z, world units

  Picture() = default;
  Picture(int w, int h)
      : width(w),
        height(h),
        colour(static_cast<std::size_t>(w) * h, glm::vec4(0, 0, 0, 1)),
        z_sum(static_cast<std::size_t>(w) * h) {}
};

bool same_bits(std::span<const Picture> a, std::span<const Picture> b);

/// The display-referred RGB colour behind the scene. Without a background, pictures keep straight alpha.
using Background = std::optional<glm::vec3>;

/// Returns the display-referred image of a picture. With a background it is RGB: C + T * background. Without
/// one it is RGBA with straight alpha: A = 1 - T, and the colour C/A (0 if A = 0).
Image composite(const Picture& picture, const Background& background);

/// Converts a picture of linear light, so that composite() over `background` gives the light's display
/// values.
void display(Picture& picture, const glm::vec3& background);

Image on_black(const Picture& picture);

/// Multiplies each RGB colour by the exposure's first three columns and adds its last. Does not clamp.
Image exposed(const Image& rgb, const glm::mat4x3& exposure);

/// Inverts an exposure; none if it is almost singular, for example one that makes all colours grey.
std::optional<glm::mat4x3> inverse_exposure(const glm::mat4x3& exposure);

/// Returns each pixel's mean view-space depth Z/A in world units; +infinity if A = 1 - T is at most 0.5.
Image depth_map(const Picture& picture);

/// sRGB's transfer function from display values to linear light, and its inverse, extended as odd functions.
double srgb_to_linear(double v);
double linear_to_srgb(double v);

/// Returns the integer that a file stores for a value from 0 to 1: round(top clamp(value)), or 0 for NaN.
inline int step_of(float value, float top) {
  const float scaled = (value > 0.0f ? std::min(value, 1.0f) : 0.0f) * top;
  const int whole = static_cast<int>(scaled);
  return scaled - static_cast<float>(whole) >= 0.5f ? whole + 1 : whole;  // equals std::lround, but faster
}

/// Returns the image with each value rounded to 8 bits, or to 16 bits if `top` is 65535.
Image quantised(const Image& image, float top = 255.0f);

}  // namespace binosplat
