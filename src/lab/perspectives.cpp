#include "lab/perspectives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/fields.h"
#include "measure/comparison.h"
#include "measure/flip.h"
#include "stereo/disagreement.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

constexpr std::array apart_frames = {1, 7};

std::vector<Picture> draw(render::Frame& frame, std::span<const shared::View> views,
                          const Perspective& seen) {
  frame.draw(views, {.order = seen.order, .projection = seen.projection});
  return frame.read_pictures();
}

/// Its depth, in black.
Picture uncoloured(Picture picture) {
  for (glm::vec4& colour : picture.colour) colour = {0.0f, 0.0f, 0.0f, colour.a};
  return picture;
}

double against_photos(render::Frame& frame, const PerspectiveViews& views, const Perspective& seen,
                      const std::function<void()>& progress) {
  double sum = 0.0;
  for (const auto& [view, photo, exposure] : views.photos) {
    const Image drawn = on_black(draw(frame, std::span(&view, 1), seen).front());
    sum += measure::photo_psnr(drawn, exposure, photo);
    progress();
  }
  return sum / static_cast<double>(views.photos.size());
}

/// Frames of a path, and what they show.
struct ShownView {
  const shared::View& view;
  const Picture& picture;
};

/// Adds what `now` shows against what was shown earlier, warped to it. False where they share nothing.
bool add_pair(Popping& popping, const ShownView& now, const ShownView& earlier) {
  const std::array black = {uncoloured(now.picture), uncoloured(earlier.picture)};
  const std::array coloured = {now.picture, earlier.picture};
  const stereo::Disagreement warped = stereo::disagreement({now.view, earlier.view}, black, coloured);
  if (warped.counted == 0.0) return false;
  popping.mse += std::pow(10.0, -0.1 * warped.db);
  popping.flip += measure::flip(on_black(now.picture), warped.right) / warped.counted;
  popping.counted += warped.counted;
  return true;
}

std::vector<Popping> measure_popping(render::Frame& frame, std::span<const shared::View> path,
                                     const Perspective& seen, const std::function<void()>& progress) {
  std::vector<Popping> found;
  std::vector<Picture> pictures;
  for (const shared::View& view : path) pictures.push_back(draw(frame, std::span(&view, 1), seen).front());
  for (const int apart : apart_frames) {
    const auto step = static_cast<std::size_t>(apart);
    Popping popping{.apart = apart};
    double pairs = 0.0;
    for (std::size_t n = 0; n + step < path.size(); ++n) {
      pairs += add_pair(popping, {path[n + step], pictures[n + step]}, {path[n], pictures[n]}) ? 1.0 : 0.0;
      progress();
    }
    if (pairs == 0.0) continue;
    for (double* sum : {&popping.mse, &popping.flip, &popping.counted}) *sum /= pairs;
    found.push_back(popping);
  }
  return found;
}

}  // namespace

std::string name_of(const Perspective& seen) {
  return fmt::format("{}, {}", order_choices[seen.order].name, projection_choices[seen.projection].name);
}

std::size_t perspective_steps(const PerspectiveViews& views) {
  std::size_t pairs = 0;
  for (const int apart : apart_frames)
    pairs += views.path.size() - std::min(views.path.size(), static_cast<std::size_t>(apart));
  return perspectives.size() * (views.photos.size() + pairs);
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
  for (const int apart : apart_frames) {
    table.columns.push_back(fmt::format("{} apart, dB", apart));
    table.columns.push_back(fmt::format("{} apart, FLIP", apart));
  }
  for (const PerspectiveNumbers& of : numbers) {
    std::vector<Cell>& cells = table.rows.emplace_back(row(name_of(of.seen), of.photos_db, of.eyes_db));
    for (const int apart : apart_frames) {
      const auto found = std::find_if(of.popping.begin(), of.popping.end(),
                                      [&](const Popping& popping) { return popping.apart == apart; });
      std::optional<double> db, flip;
      if (found != of.popping.end()) {
        db = -10.0 * std::log10(found->mse);
        flip = found->flip;
      }
      cells.emplace_back(db);
      cells.emplace_back(flip);
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

}  // namespace binosplat::lab
