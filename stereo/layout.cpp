#include "stereo/layout.h"

#include <array>
#include <stdexcept>

#include "base/error.h"
#include "shared/layout.h"

namespace binosplat::stereo {

namespace {

glm::vec3 shown(const glm::vec4& colour, const glm::vec3& background) {
  return glm::vec3(colour) + colour.a * background;
}

}  // namespace

glm::ivec2 layout_size(int layout, const glm::ivec2& eye) {
  if (layout == LAYOUT_PARALLEL || layout == LAYOUT_CROSS_EYED) return {2 * eye.x, eye.y};
  if (layout == LAYOUT_OVER_UNDER) return {eye.x, 2 * eye.y};
  if (layout == LAYOUT_HALF_WIDTH && eye.x % 2 != 0) {
    fail("`layout` half-width: pictures {} px wide cannot be halved: choose an even width", eye.x);
  }
  if (layout == LAYOUT_HALF_HEIGHT && eye.y % 2 != 0) {
    fail("`layout` half-height: pictures {} px high cannot be halved: choose an even height", eye.y);
  }
  return eye;
}

Picture lay_out(int layout, const Picture& left, const Picture& right, const Background& background) {
  if (layout < LAYOUT_PARALLEL) throw std::logic_error("this layout has no single picture");
  if (left.width != right.width || left.height != right.height) {
    fail("`layout` {}: the eyes' pictures differ in size, {} x {} and {} x {} px: use separate",
         layout_choices[layout].name, left.width, left.height, right.width, right.height);
  }
  if (mixes_colours(layout) && !background) {
    fail("`layout` {} mixes both eyes' colours and leaves no alpha: give a background",
         layout_choices[layout].name);
  }
  const glm::ivec2 size = layout_size(layout, {left.width, left.height});
  const std::array<const Picture*, 2> eyes = {&left, &right};
  const auto width = static_cast<shared::uint>(left.width);
  const auto height = static_cast<shared::uint>(left.height);
  Picture out(size.x, size.y);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const std::size_t to = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + x;
      const shared::LayoutSource from =
          shared::layout_source(static_cast<shared::uint>(layout), static_cast<shared::uint>(x),
                                static_cast<shared::uint>(y), width, height);
      const std::size_t at = static_cast<std::size_t>(from.y) * width + from.x;
      if (from.eye == EYE_BOTH) {
        out.colour[to] = glm::vec4(
            shared::layout_mix(static_cast<shared::uint>(layout), shown(left.colour[at], *background),
                               shown(right.colour[at], *background)),
            0.0f);
        continue;
      }
      glm::vec4 colour(0.0f);
      float z_sum = 0.0f;
      for (std::size_t row = at; row < at + std::size_t{from.rows} * width; row += width) {
        for (std::size_t k = row; k < row + from.columns; ++k) {
          colour += eyes[from.eye]->colour[k];
          z_sum += eyes[from.eye]->z_sum[k];
        }
      }
      const auto of = static_cast<float>(from.columns * from.rows);
      out.colour[to] = colour / of;
      out.z_sum[to] = z_sum / of;
    }
  }
  return out;
}

}  // namespace binosplat::stereo
