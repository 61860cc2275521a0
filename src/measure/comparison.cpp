#include "measure/comparison.h"

namespace binosplat::measure {

namespace {

Image as_colour(const Image& grey) {
  Image colour(grey.width, grey.height, 3);
  for (std::size_t k = 0; k < colour.data.size(); ++k) colour.data[k] = grey.data[k / 3];
  return colour;
}

}  // namespace

void make_shown(Image& a, Image& b) {
  // An EXR may hold values outside 0 to 1 that a PNG of the same picture cannot.
  a = clamped(a);
  b = clamped(b);
  if (a.channels == 1 && b.channels == 3) a = as_colour(a);
  if (b.channels == 1 && a.channels == 3) b = as_colour(b);
}

Comparison compare(const Image& a, const Image& b, double pixels_per_degree) {
  return {psnr(a, b), ssim(a, b), flip(a, b, pixels_per_degree), largest_difference(a, b)};
}

}  // namespace binosplat::measure
