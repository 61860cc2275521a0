#include "study/perspectives.h"

#include <fmt/format.h>

#include <cmath>

#include "measure/flip.h"
#include "measure/metrics.h"
#include "stereo/disagreement.h"
#include "study/fields.h"

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

constexpr std::array apart_frames = {1, 7};

std::vector<Picture> draw(render::Frame& frame, std::span<const shared::View> views,
                          const Perspective& seen) {
  frame.draw(views, {.order = seen.order, .projection = seen.projection});
  return frame.read_pictures();
}

Image on_black(const Picture& picture) { return composite(picture, glm::vec3(0.0f)); }

/// Its depth, in black.
Picture uncoloured(Picture picture) {
  for (glm::vec4& colour : picture.colour) colour = {0.0f, 0.0f, 0.0f, colour.a};
  return picture;
}

double against_photos(render::Frame& frame, const PerspectiveViews& views, const Perspective& seen,
                      const std::function<void()>& progress) {
  double sum = 0.0;
  for (const auto& [view, photo] : views.photos) {
    const Image drawn = on_black(draw(frame, std::span(&view, 1), seen).front());
    sum += measure::psnr(quantised(drawn), quantised(photo));
    progress();
  }
  return sum / static_cast<double>(views.photos.size());
}

/// The frames `now` and `then` of a path.
void add_pair(Popping& popping, const shared::View& now, const Picture& shown, const shared::View& then,
              const Picture& before) {
  const std::array black = {uncoloured(shown), uncoloured(before)}, coloured = {shown, before};
  const stereo::Disagreement warped = stereo::disagreement({now, then}, black, coloured);
  popping.mse += std::isfinite(warped.db) ? std::pow(10.0, -0.1 * warped.db) : 0.0;
  popping.flip += measure::flip(on_black(shown), warped.right);
  popping.counted += warped.counted;
}

std::vector<Popping> measure_popping(render::Frame& frame, std::span<const shared::View> path,
                                     const Perspective& seen, const std::function<void()>& progress) {
  std::vector<Popping> found;
  std::vector<Picture> pictures;
  for (const shared::View& view : path) {
    pictures.push_back(draw(frame, std::span(&view, 1), seen).front());
    progress();
  }
  for (const int apart : apart_frames) {
    const auto step = static_cast<std::size_t>(apart);
    if (path.size() <= step) continue;
    Popping popping{.apart = apart};
    const std::size_t pairs = path.size() - step;
    for (std::size_t n = 0; n < pairs; ++n)
      add_pair(popping, path[n + step], pictures[n + step], path[n], pictures[n]);
    for (double* sum : {&popping.mse, &popping.flip, &popping.counted}) *sum /= static_cast<double>(pairs);
    found.push_back(popping);
  }
  return found;
}

}  // namespace

std::string name_of(const Perspective& seen) {
  return fmt::format("{}, {}", order_choices[seen.order].name, projection_choices[seen.projection].name);
}

std::size_t perspective_steps(const PerspectiveViews& views) {
  return perspectives.size() * (views.photos.size() + views.path.size());
}

std::vector<PerspectiveNumbers> measure_perspectives(render::Frame& frame, const PerspectiveViews& views,
                                                     const std::function<void()>& progress) {
  std::vector<PerspectiveNumbers> numbers;
  const std::vector<Picture> steady =
      views.eyes.empty() ? std::vector<Picture>() : draw(frame, views.eyes, perspectives.back());
  for (const Perspective& seen : perspectives) {
    PerspectiveNumbers& of = numbers.emplace_back(PerspectiveNumbers{seen, {}, {}, {}});
    if (!views.photos.empty()) of.photos_db = against_photos(frame, views, seen, progress);
    if (!views.eyes.empty() && seen != perspectives.back())
      of.eyes_db =
          stereo::disagreement({views.eyes[0], views.eyes[1]}, steady, draw(frame, views.eyes, seen)).db;
    of.popping = measure_popping(frame, views.path, seen, progress);
  }
  return numbers;
}

Table perspectives_table(std::span<const PerspectiveNumbers> numbers) {
  Table table{{"order, projection", "against photos, dB", "in one eye only, dB"}, {}};
  if (!numbers.empty()) {
    for (const Popping& popping : numbers.front().popping) {
      table.columns.push_back(fmt::format("{} apart, dB", popping.apart));
      table.columns.push_back(fmt::format("{} apart, FLIP", popping.apart));
    }
  }
  for (const PerspectiveNumbers& of : numbers) {
    std::vector<Cell>& cells = table.rows.emplace_back(row(name_of(of.seen), of.photos_db, of.eyes_db));
    for (const Popping& popping : of.popping) {
      cells.emplace_back(-10.0 * std::log10(popping.mse));
      cells.emplace_back(popping.flip);
    }
  }
  return table;
}

ordered_json to_json(std::span<const PerspectiveNumbers> numbers) {
  ordered_json json = ordered_json::array();
  for (const PerspectiveNumbers& of : numbers) {
    json.push_back(object("order", order_choices[of.seen.order].name, "projection",
                          projection_choices[of.seen.projection].name, "photos_db", of.photos_db,
                          "disagreement_db", of.eyes_db));
    for (const Popping& popping : of.popping)
      json.back()["popping"].push_back(object("apart", popping.apart, "mse", popping.mse, "flip",
                                              popping.flip, "counted", popping.counted));
  }
  return json;
}

}  // namespace binosplat::study
