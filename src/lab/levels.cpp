#include "lab/levels.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "base/error.h"
#include "base/statistics.h"
#include "lab/fields.h"
#include "lab/timed_rounds.h"
#include "measure/flip.h"
#include "measure/metrics.h"
#include "stereo/disagreement.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

struct Finest {
  Finest(gl::Context& context, Model loaded) : model(std::move(loaded)), frame(context, model) {}

  Model model;
  render::Frame frame;
};

/// Why there was no room for what is drawn; empty: there was.
template <typename Draw>
std::string lack_of_room(const Draw& draw) {
  try {
    draw();
  } catch (const Error& error) {
    if (error.code() != ExitCode::out_of_memory) throw;
    return error.what();
  } catch (const std::bad_alloc&) {
    return "out of memory";
  }
  return "";
}

std::vector<Picture> drawn(render::Frame& frame, const LevelsShot& shot) {
  frame.draw(shot.views);
  return frame.read_pictures();
}

void judge_levels(const LevelsShot& shot, std::span<const Picture> finest, std::span<const Picture> coarser,
                  LevelsNumbers& numbers) {
  numbers.psnr_db = measure::psnr(finest, coarser, glm::vec3(0.0f));
  if (shot.views.size() == 2) {
    const double db = stereo::disagreement({shot.views[0], shot.views[1]}, finest, coarser).db;
    if (!std::isnan(db)) numbers.disagreement_db = db;
  }
  std::vector<double> flips;
  for (std::size_t eye = 0; eye < finest.size(); ++eye)
    flips.push_back(measure::flip(on_black(finest[eye]), on_black(coarser[eye])));
  numbers.flip = mean(flips);
}

/// Of one number of the shots that have it, by `mean_of`; none where none has.
template <typename MeanOf>
std::optional<double> mean_number(const LevelsRow& row, std::optional<double> LevelsNumbers::*number,
                                  const MeanOf& mean_of) {
  std::vector<double> values;
  for (const LevelsNumbers& shot : row.shots) {
    if (shot.*number) values.push_back(*(shot.*number));
  }
  return values.empty() ? std::nullopt : std::optional<double>(mean_of(values));
}

double pooled_db(std::vector<double> all) {
  for (double& db : all) db = std::pow(10.0, -0.1 * db);
  return -10.0 * std::log10(mean(all));
}

void fields(const auto& io, const LevelsNumbers& n) {
  io("gaussians", n.gaussians, "predicted_psnr_db", n.predicted_db, "psnr_db", n.psnr_db, "flip", n.flip,
     "disagreement_db", n.disagreement_db, "frame_ms", n.frame_ms);
}

ordered_json numbers_json(const LevelsNumbers& numbers) {
  ordered_json json;
  fields(FieldWriter{json}, numbers);
  return json;
}

ordered_json scene_json(const LevelsScene& scene) {
  ordered_json json = object("name", scene.name, "finest_gaussians", scene.finest, "eyes", scene.eyes,
                             "width", scene.width, "height", scene.height, "problem", scene.problem);
  for (const LevelsRow& row : scene.rows) {
    ordered_json& into =
        json["rows"].emplace_back(object("detail", row.detail, "worst_psnr_db", worst_db(row)));
    into["mean"] = numbers_json(mean_of(row));
    for (std::size_t k = 0; k < row.shots.size(); ++k) {
      into["views"].push_back(object("name", scene.shots[k]));
      into["views"].back().update(numbers_json(row.shots[k]));
    }
  }
  return json;
}

}  // namespace

LevelsNumbers mean_of(const LevelsRow& row) {
  LevelsNumbers all;
  for (const LevelsNumbers& shot : row.shots) {
    all.gaussians += shot.gaussians / static_cast<double>(row.shots.size());
    all.frame_ms += shot.frame_ms / static_cast<double>(row.shots.size());
  }
  for (const auto number :
       {&LevelsNumbers::predicted_db, &LevelsNumbers::psnr_db, &LevelsNumbers::disagreement_db})
    all.*number = mean_number(row, number, pooled_db);
  all.flip = mean_number(row, &LevelsNumbers::flip, mean);
  return all;
}

std::optional<double> worst_db(const LevelsRow& row) {
  return mean_number(row, &LevelsNumbers::psnr_db, [](const std::vector<double>& all) {
    return *std::min_element(all.begin(), all.end());
  });
}

void measure_levels(LevelsScene& scene, std::span<const LevelsShot> shots,
                    std::span<const FollowingModel> models, const std::function<Model()>& load_finest,
                    int frames, const std::function<void()>& progress) {
  gl::Context& context = models.front().model->context();
  std::vector<std::unique_ptr<render::Frame>> of_models;
  for (const FollowingModel& one : models) {
    of_models.push_back(std::make_unique<render::Frame>(one.model));
    scene.rows.push_back({one.detail, {}});
  }
  LevelsRow of_finest;
  std::unique_ptr<Finest> finest;
  for (const LevelsShot& shot : shots) {
    scene.shots.push_back(shot.name);
    // Before the finest come, which may take the room that is left.
    for (std::size_t k = 0; k < models.size(); ++k) {
      const LevelsBrought brought = models[k].bring(shot.views);
      scene.rows[k].shots.push_back(
          {.gaussians = static_cast<double>(brought.gaussians), .predicted_db = brought.predicted_db});
    }
    std::vector<Picture> pictures;
    if (scene.problem.empty()) {
      scene.problem = lack_of_room([&] {
        if (!finest) finest = std::make_unique<Finest>(context, load_finest());
        pictures = drawn(finest->frame, shot);
      });
      if (!scene.problem.empty()) finest.reset();
    }
    std::vector<Timed> timed;
    std::vector<LevelsNumbers*> into;
    const auto time = [&](render::Frame& of, LevelsNumbers& numbers) {
      const auto draw = [&](int) { return of.draw(shot.views); };
      timed.push_back({frames, draw, draw});
      into.push_back(&numbers);
    };
    for (std::size_t k = 0; k < models.size(); ++k) {
      LevelsNumbers& numbers = scene.rows[k].shots.back();
      if (finest) judge_levels(shot, pictures, drawn(*of_models[k], shot), numbers);
      time(*of_models[k], numbers);
    }
    if (finest) {
      of_finest.shots.push_back({.gaussians = static_cast<double>(finest->model.count())});
      time(finest->frame, of_finest.shots.back());
    }
    const auto rounds = timed_rounds(context, turn_rounds, timed, [] {});
    for (std::size_t k = 0; k < into.size(); ++k) {
      for (const Reports& turn : rounds[k]) into[k]->frame_ms += typical_of(turn).frame_ms / turn_rounds;
    }
    progress();
  }
  const std::vector<shared::View>& views = shots.front().views;
  scene.eyes = views.size();
  scene.width = views.front().width;
  scene.height = views.front().height;
  if (!of_finest.shots.empty()) scene.rows.push_back(std::move(of_finest));
}

ordered_json to_json(const LevelsStudy& study) {
  ordered_json json =
      object("format", "binosplat levels of detail", "version", 1, "device", study.device, "detail_unit",
             study.in_db ? "dB" : "px", "frames", study.frames, "rounds", turn_rounds);
  for (const LevelsScene& scene : study.scenes) json["scenes"].push_back(scene_json(scene));
  return json;
}

}  // namespace binosplat::lab
