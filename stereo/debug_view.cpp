#include "stereo/debug_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"
#include "stereo/disagreement.h"

namespace binosplat::stereo {

namespace {

constexpr float none = -1.0f;  // marks pixels without a number

// The largest channel of each pixel, in 255ths.
Image largest_channel(const Image& colours) {
  Image map(colours.width, colours.height, 1);
  for (std::size_t k = 0; k < map.data.size(); ++k) {
    const float* rgb = &colours.data[k * static_cast<std::size_t>(colours.channels)];
    map.data[k] = 255.0f * std::max({rgb[0], rgb[1], rgb[2]});
  }
  return map;
}

Image difference(const Picture& a, const Picture& b, const Background& background) {
  const glm::vec3 behind = background.value_or(glm::vec3(0.0f));
  Image image = composite(a, behind);
  const Image other = composite(b, behind);
  for (std::size_t k = 0; k < image.data.size(); ++k) image.data[k] = std::abs(image.data[k] - other.data[k]);
  return largest_channel(image);
}

Image depth(const Picture& picture) {
  Image map = depth_map(picture);
  for (float& z : map.data) {
    if (!std::isfinite(z)) z = none;
  }
  return map;
}

// The first of 1, 2, 5, 10 ... that this share of the numbers does not exceed. If all numbers in this share
// are 0, the first that no number exceeds.
double range_of(const std::vector<Image>& maps, double share) {
  std::vector<float> numbers;
  for (const Image& map : maps) {
    for (const float number : map.data) {
      if (number >= 0.0f) numbers.push_back(number);
    }
  }
  if (numbers.empty()) return 0.0;
  const auto at =
      numbers.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(numbers.size() - 1));
  std::nth_element(numbers.begin(), at, numbers.end());
  const double most = *at > 0.0f ? *at : *std::max_element(numbers.begin(), numbers.end());
  if (most == 0.0) return 0.0;
  return round_up(most);
}

Picture coloured(const Image& map, double most) {
  Picture picture(map.width, map.height);
  for (std::size_t k = 0; k < map.data.size(); ++k) {
    const float number = map.data[k];
    if (number < 0.0f) continue;
    const auto share = most > 0.0 ? static_cast<float>(number / most) : 0.0f;
    picture.colour[k] = glm::vec4(map_colour(share), 0.0f);
  }
  return picture;
}

Picture split_at(double share, const Picture& left, const Picture& right) {
  Picture both = left;
  const auto middle = static_cast<int>(std::lround(share * left.width));
  for (int y = 0; y < both.height; ++y) {
    for (int x = middle; x < both.width; ++x) {
      const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(both.width) + x;
      both.colour[k] = right.colour[k];
      both.z_sum[k] = right.z_sum[k];
    }
  }
  return both;
}

}  // namespace

// A polynomial of degree 6 through matplotlib's viridis (Smith and van der Walt), within 0.02 of it.
glm::vec3 map_colour(float number) {
  constexpr std::array<glm::vec3, 7> c = {
      glm::vec3(0.27773f, 0.00541f, 0.33410f),   glm::vec3(0.10509f, 1.40461f, 1.38459f),
      glm::vec3(-0.33086f, 0.21485f, 0.09510f),  glm::vec3(-4.63423f, -5.79910f, -19.33244f),
      glm::vec3(6.22827f, 14.17993f, 56.69055f), glm::vec3(4.77638f, -13.74515f, -65.35303f),
      glm::vec3(-5.43546f, 4.64585f, 26.31244f),
  };
  const float t = std::clamp(number, 0.0f, 1.0f);
  glm::vec3 colour = c[6];
  for (std::size_t k = 6; k-- > 0;) colour = c[k] + t * colour;
  return glm::clamp(colour, 0.0f, 1.0f);
}

void DebugView::draw_exact(std::span<const shared::View> views, const render::FrameSettings& settings) {
  if (!exact_) exact_ = std::make_unique<render::Frame>(model_);
  exact_report_ = exact_->draw(views, render::exact_of(settings));
}

std::vector<Picture> DebugView::exact(std::span<const shared::View> views,
                                      const render::FrameSettings& settings) {
  draw_exact(views, settings);
  return exact_->read_pictures();
}

std::vector<Image> DebugView::map(int what, const DrawnFrame& drawn, const Background& background) {
  const auto& [frame, views, pictures, settings] = drawn;
  if (what == SHOW_LEFT_OUT) {
    draw_exact(views, settings);
    std::vector<Image> all = exact_->read_debug_view(SHOW_PAIRS);
    const std::vector<Image> drawn_pairs = frame.read_debug_view(SHOW_PAIRS);
    for (std::size_t v = 0; v < all.size(); ++v) {
      for (std::size_t k = 0; k < all[v].data.size(); ++k)
        all[v].data[k] = std::max(0.0f, all[v].data[k] - drawn_pairs[v].data[k]);
    }
    return all;
  }
  if (what >= SHOW_ALPHAS) return frame.read_debug_view(what);
  std::vector<Image> maps;
  if (what == SHOW_DEPTH) {
    for (const Picture& picture : pictures) maps.push_back(depth(picture));
    return maps;
  }
  const std::vector<Picture> right = exact(views, settings);
  if (what == SHOW_DIFFERENCE) {
    for (std::size_t v = 0; v < pictures.size(); ++v)
      maps.push_back(difference(pictures[v], right[v], background));
    return maps;
  }
  if (pictures.size() != 2) fail("{} needs both eyes", show_choices[what].name);
  for (const std::size_t eye : {0, 1}) {
    const std::array from = {right[eye], right[1 - eye]}, to = {pictures[eye], pictures[1 - eye]};
    const Disagreement found = disagreement({views[eye], views[1 - eye]}, from, to);
    maps.push_back(what == SHOW_DISPARITY ? found.disparity : largest_channel(found.picture));
  }
  return maps;
}

DebugPictures DebugView::make(int what, const DrawnFrame& drawn, const Background& background, double split) {
  const std::span<const Picture> pictures = drawn.pictures;
  DebugPictures shown;
  if (what == SHOW_PICTURE) {
    shown.pictures.assign(pictures.begin(), pictures.end());
  } else if (what == SHOW_SPLIT) {
    const std::vector<Picture> right = exact(drawn.views, drawn.settings);
    for (std::size_t v = 0; v < pictures.size(); ++v)
      shown.pictures.push_back(split_at(split, pictures[v], right[v]));
  } else {
    const std::vector<Image> maps = map(what, drawn, background);
    // The range fits the nearer depths: if it included the sky, the whole scene would have one colour.
    shown.max = range_of(maps, what == SHOW_DEPTH || what == SHOW_MEDIAN_DEPTH ? 0.8 : 0.99);
    for (const Image& map : maps) shown.pictures.push_back(coloured(map, *shown.max));
  }
  return shown;
}

}  // namespace binosplat::stereo
