#include "study/level_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "render/frame.h"
#include "scene/camera.h"
#include "scene/reduce.h"

namespace binosplat::study {

namespace {

constexpr int widths = 6;  // of pixels, each twice the one before
// The narrowest pixel, of the distance between Gaussians as it would be if they lay on a square as wide as
// the box's diagonal; they lie denser.
constexpr double narrowest = 0.5;
// Between parts, px: what the low-pass and Gaussians at the edge reach.
constexpr int margin = 8;
constexpr int side_most = 2048;  // px of a picture
// How far away the eye is, in sides of a picture: nothing is seen at more than 5 degrees from the axis.
constexpr double away = 8.0;
// Levels are not drawn where pixels are much narrower than what they are made for; there they lose so many
// times more with each halving, at least.
constexpr double growth = 8.0;
const std::array<glm::dvec3, 2> directions = {glm::normalize(glm::dvec3(1.0, 1.0, 1.0)),
                                              glm::normalize(glm::dvec3(-1.0, 0.8, -0.6))};

struct Box {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
};

/// Around spheres of two standard deviations.
Box box_of(const Model& model) {
  Box box;
  for (std::size_t i = 0; i < model.count(); ++i) {
    const glm::vec3& s = model.scale[i];
    const double reach = 2.0 * std::max({s.x, s.y, s.z});
    box.low = glm::min(box.low, glm::dvec3(model.position[i]) - reach);
    box.high = glm::max(box.high, glm::dvec3(model.position[i]) + reach);
  }
  return box;
}

/// Parts beside one another, each in a square of its own, seen along `direction`.
class Sheet {
 public:
  Sheet(std::span<const std::vector<Model>> parts, std::span<const Box> boxes,
        std::span<const LeafErrors> errors, int width, const glm::dvec3& direction)
      : parts_(parts), boxes_(boxes), errors_(errors), width_(width) {
    double widest = 0.0;
    for (std::size_t i = 0; i < parts.size(); ++i)
      widest = std::max(widest, glm::distance(boxes[i].low, boxes[i].high) / pixel(i));
    square_ = static_cast<int>(std::ceil(widest)) + 2 * margin;
    across_ = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(parts.size()))));
    const int down = (static_cast<int>(parts.size()) + across_ - 1) / across_;
    camera_.width = across_ * square_;
    camera_.height = down * square_;
    camera_.fx = camera_.fy = away * std::max(camera_.width, camera_.height);
    camera_.cx = 0.5 * camera_.width;
    camera_.cy = 0.5 * camera_.height;
    const glm::dvec3 right = glm::normalize(glm::cross(direction, glm::dvec3(0.3, 1.0, 0.2)));
    camera_.rotation = glm::dmat3(right, glm::cross(direction, right), direction);
  }

  Picture draw(gl::Context& context, std::size_t level) const {
    Model all = without_gaussians(parts_[0][0]);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Model& part = parts_[i][level];
      const std::size_t first = all.count();
      append(all, part, 0, part.count());
      // As far away as the focal length has pixels a world unit is one of them.
      const glm::dvec2 centre = glm::dvec2(corner(i)) + 0.5 * square_ - glm::dvec2(camera_.cx, camera_.cy);
      const glm::dvec3 at(centre, camera_.fx);
      const glm::dvec3 to = camera_.rotation * at, middle = 0.5 * (boxes_[i].low + boxes_[i].high);
      for (std::size_t k = first; k < all.count(); ++k) {
        all.position[k] = glm::vec3((glm::dvec3(all.position[k]) - middle) / pixel(i) + to);
        all.scale[k] = glm::vec3(glm::dvec3(all.scale[k]) / pixel(i));
      }
    }
    render::Frame frame(std::make_shared<render::GpuModel>(context, all));
    const shared::View view = make_view(camera_);
    frame.draw({&view, 1}, {.depth = Depth::none});
    return std::move(frame.read_pictures().front());
  }

  /// What a part's square differs by.
  double difference(const Picture& a, const Picture& b, std::size_t i) const {
    const glm::ivec2 first = corner(i);
    double sum = 0.0;
    for (int y = first.y; y < first.y + square_; ++y) {
      for (int x = first.x; x < first.x + square_; ++x) {
        const auto k = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                       static_cast<std::size_t>(x);
        const glm::dvec3 apart = glm::dvec3(glm::clamp(glm::vec3(a.colour[k]), 0.0f, 1.0f)) -
                                 glm::dvec3(glm::clamp(glm::vec3(b.colour[k]), 0.0f, 1.0f));
        sum += glm::dot(apart, apart) / 3.0;
      }
    }
    return sum;
  }

 private:
  glm::ivec2 corner(std::size_t i) const {  // of a part's square
    const int k = static_cast<int>(i);
    return square_ * glm::ivec2(k % across_, k / across_);
  }
  double pixel(std::size_t i) const { return std::ldexp(errors_[i].pixel, width_); }

  std::span<const std::vector<Model>> parts_;
  std::span<const Box> boxes_;
  std::span<const LeafErrors> errors_;
  int width_;
  int square_ = 0, across_ = 0;  // px; squares in a row
  Camera camera_;
};

/// Each level has half of the Gaussians, which lie apart by a root of two more.
int first_width(std::size_t level) { return std::min(static_cast<int>(level / 2), widths - 1); }

void judge(gl::Context& context, std::span<const std::vector<Model>> parts, std::span<const Box> boxes,
           std::span<LeafErrors> errors) {
  const std::size_t levels = parts[0].size();
  const double share = 1.0 / static_cast<double>(directions.size());
  for (const glm::dvec3& direction : directions) {
    for (int width = 0; width < widths; ++width) {
      const Sheet sheet(parts, boxes, errors, width, direction);
      const Picture finest = sheet.draw(context, 0);
      for (std::size_t level = 1; level < levels && first_width(level) <= width; ++level) {
        const Picture drawn = sheet.draw(context, level);
        for (std::size_t i = 0; i < parts.size(); ++i)
          errors[i].of_level[level][static_cast<std::size_t>(width)] +=
              share * sheet.difference(drawn, finest, i);
      }
    }
  }
  for (LeafErrors& leaf : errors) {
    for (std::size_t level = 1; level < levels; ++level) {
      std::vector<double>& of = leaf.of_level[level];
      for (auto k = static_cast<std::size_t>(first_width(level)); k-- > 0;) of[k] = growth * of[k + 1];
    }
  }
}

}  // namespace

std::vector<LeafErrors> level_errors(gl::Context& context, std::span<const std::vector<Model>> parts) {
  std::vector<LeafErrors> errors(parts.size());
  std::vector<Box> boxes(parts.size());
  std::vector<int> squares(parts.size());  // px of the narrowest
  for (std::size_t i = 0; i < parts.size(); ++i) {
    boxes[i] = box_of(parts[i].front());
    const double diagonal = glm::distance(boxes[i].low, boxes[i].high);
    const double across = std::ceil(std::sqrt(static_cast<double>(parts[i].front().count())) / narrowest);
    errors[i].pixel = diagonal > 0.0 ? diagonal / across : 1.0;
    squares[i] = static_cast<int>(across) + 2 * margin;
    errors[i].of_level.assign(parts[i].size(), std::vector<double>(widths));
  }
  for (std::size_t first = 0, count = 0; first < parts.size(); first += count) {
    const int row = std::max(
        1,
        side_most / *std::max_element(squares.begin() + static_cast<std::ptrdiff_t>(first), squares.end()));
    count = std::min(parts.size() - first, static_cast<std::size_t>(row) * static_cast<std::size_t>(row));
    judge(context, parts.subspan(first, count), std::span(boxes).subspan(first, count),
          std::span(errors).subspan(first, count));
  }
  return errors;
}

}  // namespace binosplat::study
