#include "measure/comparison.h"

#include <cmath>

namespace binosplat::measure {

bool is_see_through(const Image& image) {
  if (image.channels != 4) return false;
  for (std::size_t i = 3; i < image.data.size(); i += 4) {
    if (image.data[i] != 1.0f) return true;
  }
  return false;
}

Image composite_over(const glm::vec3& background, const Image& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  Image rgb(image.width, image.height, 3);
  for (std::size_t i = 0; i < rgb.data.size(); ++i) {
    const float* pixel = &image.data[i / 3 * channels];
    const float v = pixel[channels == 1 ? 0 : i % 3], alpha = channels == 4 ? pixel[3] : 1.0f;
    const float behind = background[static_cast<int>(i % 3)];
    rgb.data[i] = alpha == 1.0f ? v : alpha * v + (1.0f - alpha) * behind;
  }
  return rgb;
}

bool prepare_comparison(Image& a, Image& b, const Background& background) {
  const bool see_through = is_see_through(a) || is_see_through(b);
  const bool keeps_alpha = see_through && !background && a.channels == b.channels;
  const glm::vec3 behind = background.value_or(glm::vec3(0.0f));
  for (Image* image : {&a, &b}) {
    if (image->channels == 4 && !keeps_alpha) *image = composite_over(behind, *image);
  }
  for (Image* image : {&a, &b}) {
    if (image->channels == 1 && a.channels != b.channels) *image = composite_over(behind, *image);
    // Clamps, because an EXR may have values outside 0 to 1, and a PNG of the same picture has none.
    for (float& value : image->data) value = std::isfinite(value) ? value : NAN;
    *image = clamped(*image);
  }
  // Colours count as much as they are seen: a transparent pixel's is arbitrary.
  for (Image* image : {&a, &b})
    for (std::size_t i = 0; keeps_alpha && i < image->data.size(); ++i)
      if (i % 4 != 3) image->data[i] *= image->data[i - i % 4 + 3];
  return see_through && !keeps_alpha;
}

double photo_psnr(const Image& picture, const glm::mat4x3& exposure, const Image& photo) {
  return psnr(quantised(exposed(picture, exposure)), quantised(photo));
}

Comparison compare(const Image& a, const Image& b, double pixels_per_degree) {
  Comparison found{psnr(a, b), ssim(a, b), flip(a, b, pixels_per_degree), largest_difference(a, b)};
  if (std::isinf(found.largest.max)) found.psnr = found.largest.max = NAN;
  return found;
}

}  // namespace binosplat::measure
