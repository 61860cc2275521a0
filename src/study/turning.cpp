#include "study/turning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/image.h"
#include "measure/flip.h"
#include "measure/rays.h"
#include "study/fields.h"

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

constexpr std::array<Perspective, 4> perspectives = {{{ORDER_DEPTH, PROJECTION_AFFINE},
                                                      {ORDER_DISTANCE, PROJECTION_AFFINE},
                                                      {ORDER_DEPTH, PROJECTION_TANGENT},
                                                      {ORDER_DISTANCE, PROJECTION_TANGENT}}};

struct HeadAxis {
  const char* name;
  glm::dvec3 unit;
};
const std::array<HeadAxis, 3> head_axes = {{{"up", {0, 1, 0}}, {"across", {1, 0, 0}}, {"ahead", {0, 0, 1}}}};

std::string name_of(const Perspective& seen) {
  return fmt::format("{}, {}", order_choices[seen.order].name, projection_choices[seen.projection].name);
}

/// Points of the camera's picture, row by row; some may lie outside it.
std::vector<glm::dvec2> field_of(const Camera& camera, const TurningSettings& s) {
  const double reach = std::tan(glm::radians(0.5 * s.field_degrees));
  std::vector<glm::dvec2> points;
  for (int row = 0; row < s.rows; ++row) {
    for (int column = 0; column < s.columns; ++column) {
      const glm::dvec2 slope =
          reach * glm::dvec2((2.0 * column + 1.0) / s.columns - 1.0, (2.0 * row + 1.0) / s.rows - 1.0);
      // On the centre of a pixel, as a picture has it.
      points.push_back(
          glm::floor(glm::dvec2(camera.fx, camera.fy) * slope + glm::dvec2(camera.cx, camera.cy)));
    }
  }
  return points;
}

Turned compare(const std::vector<glm::vec3>& straight, const std::vector<glm::vec3>& turned,
               const std::vector<std::size_t>& shown, const TurningSettings& s) {
  Turned result;
  result.rays = shown.size();
  Image a(s.columns, s.rows, 3), b(s.columns, s.rows, 3);
  double sum = 0.0;
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
      const float before = std::clamp(straight[shown[k]][c], 0.0f, 1.0f),
                  after = std::clamp(turned[k][c], 0.0f, 1.0f);
      a.data[3 * shown[k] + static_cast<std::size_t>(c)] = before;
      b.data[3 * shown[k] + static_cast<std::size_t>(c)] = after;
      const double error = static_cast<double>(after) - before;
      sum += error * error / 3.0;
      largest = std::max(largest, std::abs(error));
    }
    beyond += largest > seen_error ? 1 : 0;
  }
  if (shown.empty()) return result;
  const auto count = static_cast<double>(shown.size());
  result.psnr_db = -10.0 * std::log10(sum / count);
  result.share_beyond = static_cast<double>(beyond) / count;
  const Image map = measure::flip_map(a, b);
  for (const std::size_t k : shown) result.flip += static_cast<double>(map.data[k]) / count;
  return result;
}

}  // namespace

std::size_t turning_steps(const TurningSettings& settings) {
  return perspectives.size() * (1 + head_axes.size() * settings.degrees.size());
}

std::vector<Turned> measure_turning(render::Frame& frame, const Camera& camera, double near_plane,
                                    const TurningSettings& s, const std::function<void()>& progress) {
  const std::vector<glm::dvec2> field = field_of(camera, s);
  std::vector<Turned> turns;
  for (const Perspective& seen : perspectives) {
    // Anchors of Scaffold-GS are culled by the picture, of which a ray by itself has none.
    const render::FrameSettings settings{
        .order = seen.order, .projection = seen.projection, .anchor_cull = false};
    const std::vector<glm::vec3> straight = measure::colours_at(frame, camera, field, settings, near_plane);
    progress();
    for (const HeadAxis& axis : head_axes) {
      for (const double degrees : s.degrees) {
        const Camera head = measure::turned(camera, axis.unit, glm::radians(degrees));
        std::vector<std::size_t> shown;
        std::vector<glm::dvec2> there;
        for (std::size_t k = 0; k < field.size(); ++k) {
          const glm::dvec2 at = measure::pixel_of(head, measure::ray_through(camera, field[k]));
          if (!measure::is_inside(camera, field[k]) || !measure::is_inside(head, at)) continue;
          shown.push_back(k);
          there.push_back(at);
        }
        turns.push_back(
            compare(straight, measure::colours_at(frame, head, there, settings, near_plane), shown, s));
        turns.back().seen = seen;
        turns.back().about = axis.name;
        turns.back().degrees = degrees;
        progress();
      }
    }
  }
  return turns;
}

Table turning_table(const TurningStudy& study) {
  Table table{{"order, projection", "about"}, {}};
  for (const double degrees : study.settings.degrees)
    table.columns.push_back(fmt::format("{:g} degrees, dB", degrees));
  for (const char* what : {"rays off by over 5/255 at 15 degrees, %", "FLIP at 15 degrees"})
    table.columns.emplace_back(what);
  std::vector<std::vector<Cell>>& rows = table.rows;
  for (std::size_t k = 0; k < study.turns.size(); ++k) {
    const Turned& turn = study.turns[k];
    if (k % study.settings.degrees.size() == 0) {
      rows.push_back(row(name_of(turn.seen), turn.about));
      rows.back().resize(table.columns.size());
    }
    rows.back()[2 + k % study.settings.degrees.size()] = turn.rays == 0 ? Cell() : Cell(turn.psnr_db);
    if (turn.degrees != 15.0 || turn.rays == 0) continue;
    rows.back()[table.columns.size() - 2] = 100.0 * turn.share_beyond;
    rows.back()[table.columns.size() - 1] = turn.flip;
  }
  return table;
}

ordered_json to_json(const TurningStudy& study) {
  ordered_json json =
      object("scene", study.scene, "device", study.device, "view", study.view, "width", study.width, "height",
             study.height, "field_degrees", study.settings.field_degrees, "columns", study.settings.columns,
             "rows", study.settings.rows);
  for (const Turned& turn : study.turns) {
    json["turns"].push_back(object("order", order_choices[turn.seen.order].name, "projection",
                                   projection_choices[turn.seen.projection].name, "about", turn.about,
                                   "degrees", turn.degrees, "rays", turn.rays, "psnr_db", turn.psnr_db,
                                   "share_beyond", turn.share_beyond, "flip", turn.flip));
  }
  return json;
}

Page turning_page(const TurningStudy& study) {
  Page page;
  page.title = "Turn the head";
  page.sentence =
      "How much a picture changes when the head turns at its place, along the same rays: nothing should.";
  page.facts = {{"scene", study.scene},
                {"view", study.view},
                {"device", study.device},
                {"picture", fmt::format("{} x {} px", study.width, study.height)},
                {"rays", fmt::format("{} x {} over {:g} degrees", study.settings.columns, study.settings.rows,
                                     study.settings.field_degrees)}};
  Plot plot{{"turn", "degrees", true}, {"PSNR against the head that is not turned", "dB"}, {}};
  for (const Turned& turn : study.turns) {
    if (turn.about != head_axes.front().name || turn.rays == 0) continue;
    Series& series = series_of(plot, name_of(turn.seen));
    series.line = true;
    series.add(turn.degrees, turn.psnr_db);
  }
  page.sections.push_back(
      {"turning", "What a turn changes",
       "About the axis up; 40 dB is where many begin to see it. Equal pictures have no PSNR.", plot,
       turning_table(study)});
  return page;
}

}  // namespace binosplat::study
