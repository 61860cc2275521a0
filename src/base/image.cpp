#include "base/image.h"

#include <cstring>
#include <limits>

#include "shared/layout.h"
#include "shared/limits.h"

namespace binosplat {

namespace {

template <typename T>
bool same_bits_of(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace

bool same_bits(std::span<const Picture> a, std::span<const Picture> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Picture& p, const Picture& q) {
    return p.width == q.width && p.height == q.height && same_bits_of(p.colour, q.colour) &&
           same_bits_of(p.z_sum, q.z_sum);
  });
}

Image composite(const Picture& picture, const Background& background) {
  Image image(picture.width, picture.height, background ? 3 : 4);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const glm::vec4 c = picture.colour[k];
    float* out = &image.data[k * static_cast<std::size_t>(image.channels)];
    const float coverage = 1.0f - c.a;
    for (int i = 0; i < 3; ++i) {
      if (background) {
        out[i] = c[i] + c.a * (*background)[i];
      } else {
        out[i] = coverage > 0.0f ? c[i] / coverage : 0.0f;
      }
    }
    if (!background) out[3] = coverage;
  }
  return image;
}

void display(Picture& picture, const glm::vec3& background) {
  for (glm::vec4& c : picture.colour) {
    for (int i = 0; i < 3; ++i)
      c[i] = shared::layout_to_display(c[i] + c.a * shared::layout_to_linear(background[i])) -
             c.a * background[i];
  }
}

Image on_black(const Picture& picture) { return composite(picture, glm::vec3(0.0f)); }

Image depth_map(const Picture& picture) {
  Image image(picture.width, picture.height, 1);
  for (std::size_t k = 0; k < picture.colour.size(); ++k) {
    const float coverage = 1.0f - picture.colour[k].a;
    image.data[k] = coverage > static_cast<float>(COVERAGE_FOR_DEPTH)
                        ? picture.z_sum[k] / coverage
                        : std::numeric_limits<float>::infinity();
  }
  return image;
}

double srgb_to_linear(double v) {
  const double size = std::abs(v);
  const double linear = size <= 0.04045 ? size / 12.92 : std::pow((size + 0.055) / 1.055, 2.4);
  return std::copysign(linear, v);
}

double linear_to_srgb(double v) {
  const double size = std::abs(v);
  const double display = size <= 0.0031308 ? size * 12.92 : 1.055 * std::pow(size, 1.0 / 2.4) - 0.055;
  return std::copysign(display, v);
}

Image quantised(const Image& image, float top) {
  Image out = image;
  for (float& v : out.data) v = static_cast<float>(step_of(v, top)) / top;
  return out;
}

Image exposed(const Image& rgb, const glm::mat4x3& exposure) {
  Image image(rgb.width, rgb.height, 3);
  for (std::size_t i = 0; i < rgb.data.size(); i += 3) {
    const glm::vec3 colour = exposure * glm::vec4(rgb.data[i], rgb.data[i + 1], rgb.data[i + 2], 1.0f);
    for (int c = 0; c < 3; ++c) image.data[i + static_cast<std::size_t>(c)] = colour[c];
  }
  return image;
}

std::optional<glm::mat4x3> inverse_exposure(const glm::mat4x3& exposure) {
  const glm::dmat3 mixed{glm::dmat4x3(exposure)};
  // Useful exposures are near the identity, so their determinants are far above this threshold.
  constexpr double least = 1e-3;
  if (!(std::abs(glm::determinant(mixed)) >= least)) return std::nullopt;
  const glm::dmat3 back = glm::inverse(mixed);
  return glm::mat4x3(glm::dmat4x3(back[0], back[1], back[2], -(back * glm::dvec3(exposure[3]))));
}

}  // namespace binosplat
