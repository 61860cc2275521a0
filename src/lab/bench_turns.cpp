// Measures how much the colours along fixed rays change when a head turns at one place: ideally not at all.

#include <algorithm>
#include <array>
#include <cmath>

#include "lab/bench.h"
#include "measure/flip.h"
#include "measure/turn_stability.h"

namespace binosplat::lab {

namespace {

constexpr float difference_gain = 8.0f;     // brightens the picture of differences
constexpr double seen_error = 5.0 / 255.0;  // visible change of a colour from 0 to 1
constexpr double field_degrees = 60.0;      // width and height of the field of rays
constexpr double turns_degrees[] = {0.25, 1.0, 5.0, 15.0, 45.0};
constexpr double summary_degrees = 15.0;  // the turn of the point's means and picture

/// Columns and rows of rays in the field; fewer if the CPU draws.
glm::ivec2 rays_of(const gl::Context& context) {
  return context.software() ? glm::ivec2(16, 12) : glm::ivec2(48, 36);
}

struct HeadAxis {
  const char* name;
  glm::dvec3 unit;
};
const std::array<HeadAxis, 3> head_axes = {{{"up", {0, 1, 0}}, {"across", {1, 0, 0}}, {"ahead", {0, 0, 1}}}};

/// The point of each ray in the camera's picture, row by row. Some may lie outside the picture.
std::vector<glm::dvec2> field_of(const Camera& camera, const glm::ivec2& rays) {
  const double reach = std::tan(glm::radians(0.5 * field_degrees));
  std::vector<glm::dvec2> points;
  for (int row = 0; row < rays.y; ++row) {
    for (int column = 0; column < rays.x; ++column) {
      const glm::dvec2 slope =
          reach * glm::dvec2((2.0 * column + 1.0) / rays.x - 1.0, (2.0 * row + 1.0) / rays.y - 1.0);
      // Rays go through pixel centres, as in a picture.
      points.push_back(
          glm::floor(glm::dvec2(camera.fx, camera.fy) * slope + glm::dvec2(camera.cx, camera.cy)));
    }
  }
  return points;
}

/// The colours of rays as a picture with one pixel per ray. Pixels of rays that `shown` lacks are black.
Image rays_picture(const std::vector<glm::vec3>& colours, const std::vector<std::size_t>& shown,
                   const glm::ivec2& rays) {
  Image image(rays.x, rays.y, 3);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    for (int c = 0; c < 3; ++c)
      image.data[3 * shown[k] + static_cast<std::size_t>(c)] = std::clamp(colours[k][c], 0.0f, 1.0f);
  }
  return image;
}

/// Compares the heads' colours for rays that both pictures show; `difference` gets amplified differences.
Row compare_turned(const Image& straight, const Image& turned, const std::vector<std::size_t>& shown,
                   Image& difference) {
  if (shown.empty()) return Row::object();
  difference = Image(straight.width, straight.height, 3);
  double sum = 0.0, off = 0.0, flip = 0.0;
  const Image map = measure::flip_map(straight, turned);
  for (const std::size_t ray : shown) {
    double largest = 0.0;
    for (std::size_t k = 3 * ray; k < 3 * ray + 3; ++k) {
      const double error = static_cast<double>(turned.data[k]) - static_cast<double>(straight.data[k]);
      difference.data[k] = std::min(1.0f, difference_gain * static_cast<float>(std::abs(error)));
      sum += error * error / 3.0;
      largest = std::max(largest, std::abs(error));
    }
    off += largest > seen_error ? 1.0 : 0.0;
    flip += static_cast<double>(map.data[ray]);
  }
  const auto count = static_cast<double>(shown.size());
  return object("rays", shown.size(), "psnr_db", capped(-10.0 * std::log10(sum / count)), "flip",
                flip / count, "rays_off", 100.0 * off / count);
}

}  // namespace

void Bench::measure_turns(const BenchSettings& settings, Point& point) {
  const Camera& camera = *what_.turned;
  const glm::ivec2 rays = rays_of(context_);
  const std::vector<glm::dvec2> field = field_of(camera, rays);
  // Scaffold-GS culls anchors outside the picture, but single rays have no picture.
  render::FrameSettings drawn = render::exact_of(settings);
  drawn.anchor_cull = false;
  render::Frame frame(gpu_model());
  const auto colours = measure::colours_at(frame, camera, field, drawn, what_.near_plane);
  std::vector<Row> summary_rows;
  for (const HeadAxis& axis : head_axes) {
    for (const double degrees : turns_degrees) {
      const Camera head = measure::turned(camera, axis.unit, glm::radians(degrees));
      std::vector<std::size_t> shown;
      std::vector<glm::dvec2> there;
      std::vector<glm::vec3> before;
      for (std::size_t k = 0; k < field.size(); ++k) {
        const glm::dvec2 at = measure::pixel_of(head, ray_through(camera, field[k] + 0.5));
        if (!measure::is_inside(camera, field[k]) || !measure::is_inside(head, at)) continue;
        shown.push_back(k);
        there.push_back(at);
        before.push_back(colours[k]);
      }
      const auto after = measure::colours_at(frame, head, there, drawn, what_.near_plane);
      Image difference;
      Row& row = point.details.emplace_back(object("kind", "turn", "axis", axis.name, "degrees", degrees));
      row.update(compare_turned(rays_picture(before, shown, rays), rays_picture(after, shown, rays), shown,
                                difference));
      if (degrees != summary_degrees) continue;
      summary_rows.push_back(row);
      if (&axis == head_axes.data() && !shown.empty()) point.picture = std::move(difference);
    }
  }
  put(point.row, "psnr_db", pooled_db(numbers(summary_rows, "psnr_db")));
  for (const char* name : {"flip", "rays_off", "rays"}) put(point.row, name, mean_number(summary_rows, name));
  const auto psnr = [](const Row& row) { return row.value("psnr_db", equal_db); };
  const Row& worst = *std::ranges::min_element(summary_rows, {}, psnr);
  put(point.row, "worst_psnr_db", number(worst, "psnr_db"), "worst_view", text(worst, "axis"));
}

}  // namespace binosplat::lab
