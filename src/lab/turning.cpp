#include "lab/turning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/image.h"
#include "lab/fields.h"
#include "measure/flip.h"
#include "measure/rays.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

constexpr float difference_gain = 8.0f;  // of pictures to look at

struct HeadAxis {
  const char* name;
  glm::dvec3 unit;
};
const std::array<HeadAxis, 3> head_axes = {{{"up", {0, 1, 0}}, {"across", {1, 0, 0}}, {"ahead", {0, 0, 1}}}};

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

Turned compare_turned(const std::vector<glm::vec3>& straight, const std::vector<glm::vec3>& turned,
                      const std::vector<std::size_t>& shown, const TurningSettings& s) {
  Turned result;
  result.rays = shown.size();
  Image a(s.columns, s.rows, 3), b(s.columns, s.rows, 3);
  result.difference = Image(s.columns, s.rows, 3);
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
      result.difference.data[3 * shown[k] + static_cast<std::size_t>(c)] =
          static_cast<float>(std::abs(error));
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

/// Of which the page has a picture.
bool is_pictured(const Turned& turn) {
  return turn.about == head_axes.front().name && turn.degrees == 15.0 && turn.rays > 0;
}

std::vector<Figure> pictures_of(const TurningStudy& study) {
  std::vector<Figure> figures;
  if (study.straight) figures.push_back({"The rays, straight ahead", *study.straight});
  for (const Turned& turn : study.turns) {
    if (!is_pictured(turn)) continue;
    Image larger = turn.difference;
    for (float& value : larger.data) value = std::min(1.0f, difference_gain * value);
    figures.push_back(
        {fmt::format("{}: {:g} times the difference after 15 degrees", name_of(turn.seen), difference_gain),
         std::move(larger)});
  }
  return figures;
}

}  // namespace

std::size_t turning_steps(const TurningSettings& settings) {
  return perspectives.size() * (1 + head_axes.size() * settings.degrees.size());
}

void measure_turning(TurningStudy& study, render::Frame& frame, const Camera& camera, double near_plane,
                     const std::function<void()>& progress) {
  const TurningSettings& s = study.settings;
  const std::vector<glm::dvec2> field = field_of(camera, s);
  for (const Perspective& seen : perspectives) {
    // Anchors of Scaffold-GS are culled by the picture, of which a ray by itself has none.
    const render::FrameSettings settings{
        .order = seen.order, .projection = seen.projection, .anchor_cull = false};
    const std::vector<glm::vec3> straight = measure::colours_at(frame, camera, field, settings, near_plane);
    if (!study.straight) {
      study.straight = Image(s.columns, s.rows, 3);
      for (std::size_t k = 0; k < straight.size(); ++k) {
        for (int c = 0; c < 3; ++c)
          study.straight->data[3 * k + static_cast<std::size_t>(c)] = std::clamp(straight[k][c], 0.0f, 1.0f);
      }
    }
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
        Turned& turn = study.turns.emplace_back(compare_turned(
            straight, measure::colours_at(frame, head, there, settings, near_plane), shown, s));
        turn.seen = seen;
        turn.about = axis.name;
        turn.degrees = degrees;
        if (!is_pictured(turn)) turn.difference = {};
        progress();
      }
    }
  }
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
  if (!study.numbers.empty()) json["perspectives"] = to_json(std::span(study.numbers));
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
  Table up{{"degrees", "order, projection", "PSNR dB"}, {}};
  for (const Turned& turn : study.turns) {
    if (turn.about == head_axes.front().name && turn.rays > 0)
      up.rows.push_back(row(turn.degrees, name_of(turn.seen), turn.psnr_db));
  }
  page.sections.push_back(
      {"turning",
       "What a turn changes",
       "About the axis up; 40 dB is where many begin to see it. Equal pictures have no PSNR.",
       turning_table(study),
       Chart{.x = "degrees", .y = {"PSNR dB"}, .by = "order, projection", .log_x = true},
       up,
       {},
       pictures_of(study)});
  if (!study.numbers.empty())
    page.sections.push_back(
        {"perspectives", "What each order and projection is worth",
         "Against photos: 8-bit PSNR, mean over the views. In one eye only: what the eyes do not share of "
         "the difference from distance and tangent. Apart: frames of a head that moves sideways at 1.5 m/s, "
         "90 a "
         "second, warped to one another by depth.",
         perspectives_table(study.numbers)});
  return page;
}

}  // namespace binosplat::lab
