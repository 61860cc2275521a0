#include "study/level_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "render/frame.h"
#include "scene/camera.h"
#include "scene/reduce.h"

namespace binosplat::study {

namespace {

constexpr int widths = 2;      // of pixels,
constexpr double wider = 8.0;  // each so many times the one before
// The narrowest pixel, of the distance between Gaussians as it would be if they lay on a square as wide as
// the box's diagonal; they lie denser.
constexpr double narrowest = 0.625;
// Between parts, px: what the low-pass and Gaussians at the edge reach.
constexpr int margin = 8;
// px of a picture. Reading larger ones allocates them anew each time, which took longer than drawing them.
constexpr int side_most = 1280;
// By how much what lies behind a part differs from its mean colour, as a deviation.
constexpr double contrast = 0.15;
// How far away the eye is, in sides of a picture: nothing is seen at more than 5 degrees from the axis.
constexpr double away = 8.0;

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

/// A part that is judged.
struct Part {
  std::span<const Model> levels;
  Box box;
  LeafErrors* errors;
  int square;  // px, of its narrowest picture
};

/// Draws models one after the other, in the same buffers: making new ones takes as long as drawing.
class Drawer {
 public:
  explicit Drawer(gl::Context& context) : context_(context) {}

  Picture draw(Model model, const shared::View& view, Depth depth) {
    model_ = std::move(model);
    if (frame_) {
      frame_->model()->reload();
    } else {
      frame_.emplace(context_, model_);
    }
    frame_->draw({&view, 1}, {.depth = depth});
    return std::move(frame_->read_pictures().front());
  }

 private:
  gl::Context& context_;
  Model model_;
  std::optional<render::Frame> frame_;
};

/// Parts beside one another, each in a square of its own, seen along `direction`.
class Sheet {
 public:
  Sheet(std::span<const Part> parts, std::size_t width, const glm::dvec3& direction)
      : parts_(parts), width_(width) {
    double widest = 0.0;
    for (const Part& part : parts)
      widest = std::max(widest, glm::distance(part.box.low, part.box.high) / pixel(part));
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

  Picture draw(Drawer& drawer, std::size_t level) const {
    return drawer.draw(model(level), make_view(camera_), level == 0 ? Depth::seen : Depth::none);
  }

  /// How much of a picture of the finest levels shows a part, px.
  double seen(const Picture& finest, std::size_t i) const {
    double sum = 0.0;
    each_pixel(i, [&](std::size_t k) { sum += double{finest.z_sum[k]}; });
    return sum;
  }

  /// What a part's square differs by, over what looks much like the mean colour of the part.
  double difference(const Picture& a, const Picture& b, std::size_t i) const {
    glm::dvec4 sum(0.0);
    each_pixel(
        i, [&](std::size_t k) { sum += glm::dvec4(glm::dvec3(b.colour[k]), 1.0 - double{b.colour[k].a}); });
    const glm::vec3 behind = sum.a > 0.0 ? glm::vec3(glm::dvec3(sum) / sum.a) : glm::vec3(0.0f);
    double error = 0.0;
    const auto shown = [&](const glm::vec4& c) {
      return glm::dvec3(glm::clamp(glm::vec3(c) + c.a * behind, 0.0f, 1.0f));
    };
    each_pixel(i, [&](std::size_t k) {
      const glm::dvec3 apart = shown(a.colour[k]) - shown(b.colour[k]);
      const double covers = double{a.colour[k].a} - double{b.colour[k].a};
      error += glm::dot(apart, apart) / 3.0 + contrast * contrast * covers * covers;
    });
    return error;
  }

 private:
  template <typename See>
  void each_pixel(std::size_t i, const See& see) const {
    const glm::ivec2 first = corner(i);
    for (int y = first.y; y < first.y + square_; ++y) {
      for (int x = first.x; x < first.x + square_; ++x)
        see(static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
            static_cast<std::size_t>(x));
    }
  }

  /// One level of all parts, in their places.
  Model model(std::size_t level) const {
    Model all = without_gaussians(parts_.front().levels[level]);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      const Model& of_part = part.levels[level];
      const std::size_t first = all.count();
      append(all, of_part, 0, of_part.count());
      // As far away as the focal length has pixels a world unit is one of them.
      const glm::dvec2 centre = glm::dvec2(corner(i)) + 0.5 * square_ - glm::dvec2(camera_.cx, camera_.cy);
      const glm::dvec3 at(centre, camera_.fx);
      const glm::dvec3 to = camera_.rotation * at, middle = 0.5 * (part.box.low + part.box.high);
      for (std::size_t k = first; k < all.count(); ++k) {
        all.position[k] = glm::vec3((glm::dvec3(all.position[k]) - middle) / pixel(part) + to);
        all.scale[k] = glm::vec3(glm::dvec3(all.scale[k]) / pixel(part));
      }
    }
    return all;
  }

  glm::ivec2 corner(std::size_t i) const {  // of a part's square
    const int k = static_cast<int>(i);
    return square_ * glm::ivec2(k % across_, k / across_);
  }
  double pixel(const Part& part) const { return part.errors->pixels[width_]; }

  std::span<const Part> parts_;
  std::size_t width_;
  int square_ = 0, across_ = 0;  // px; squares in a row
  Camera camera_;
};

/// Levels that are drawn in the narrowest pixels, too. Others lose as much of each area there as in wider
/// ones, or less.
constexpr std::size_t fine_levels = 3;

/// In wide pixels both sides look much alike: only those directions are drawn that come first.
bool is_drawn(std::size_t direction, std::size_t width) { return width == 0 || direction % 2 == 0; }

void fill_in(LeafErrors& leaf) {
  for (std::size_t d = 0; d < detail_directions; ++d) {
    for (std::size_t width = 1; width < widths; ++width) {
      const std::size_t drawn = is_drawn(d, width) ? d : d - 1;
      leaf.seen[d][width] = leaf.seen[drawn][width];
      for (auto& of : leaf.of_level) of[d][width] = of[drawn][width];
    }
    const double larger = leaf.seen[d][1] > 0.0 ? leaf.seen[d][0] / leaf.seen[d][1] : 0.0;
    for (std::size_t level = fine_levels; level < leaf.of_level.size(); ++level)
      leaf.of_level[level][d][0] = larger * leaf.of_level[level][d][1];
  }
}

void judge(Drawer& drawer, std::span<const Part> parts) {
  const std::size_t levels = parts.front().levels.size();
  for (const Part& part : parts) {
    part.errors->seen.assign(detail_directions, std::vector<double>(widths));
    part.errors->of_level.assign(levels, part.errors->seen);
  }
  for (std::size_t d = 0; d < detail_directions; ++d) {
    for (std::size_t width = 0; width < widths; ++width) {
      if (!is_drawn(d, width)) continue;
      const Sheet sheet(parts, width, detail_direction(d));
      const Picture finest = sheet.draw(drawer, 0);
      parallel_for(parts.size(),
                   [&](std::size_t i) { parts[i].errors->seen[d][width] = sheet.seen(finest, i); });
      for (std::size_t level = 1; level < (width == 0 ? std::min(levels, fine_levels) : levels); ++level) {
        const Picture drawn = sheet.draw(drawer, level);
        parallel_for(parts.size(), [&](std::size_t i) {
          parts[i].errors->of_level[level][d][width] = sheet.difference(drawn, finest, i);
        });
      }
    }
  }
  for (const Part& part : parts) fill_in(*part.errors);
}

}  // namespace

std::vector<LeafErrors> level_errors(gl::Context& context, std::span<const std::vector<Model>> leaves) {
  std::vector<LeafErrors> errors(leaves.size());
  std::vector<Part> parts;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Model& finest = leaves[i].front();
    const Box box = box_of(finest);
    const double diagonal = glm::distance(box.low, box.high);
    const double across = std::ceil(std::sqrt(static_cast<double>(finest.count())) / narrowest);
    for (int k = 0; k < widths; ++k)
      errors[i].pixels.push_back((diagonal > 0.0 ? diagonal / across : 1.0) * std::pow(wider, k));
    parts.push_back({leaves[i], box, &errors[i], static_cast<int>(across) + 2 * margin});
  }
  Drawer drawer(context);
  // The squares of a sheet are all as large as its largest.
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& a, const Part& b) { return a.square > b.square; });
  for (std::size_t first = 0, count = 0; first < parts.size(); first += count) {
    const auto row = static_cast<std::size_t>(std::max(1, side_most / parts[first].square));
    count = std::min(parts.size() - first, row * row);
    judge(drawer, std::span(parts).subspan(first, count));
  }
  return errors;
}

}  // namespace binosplat::study
