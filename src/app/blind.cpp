#include "app/blind.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "app/empty_view.h"
#include "base/error.h"
#include "base/log.h"
#include "lab/bench_case.h"
#include "lab/blind.h"

namespace binosplat::app {

namespace {

/// The names of the views that see nothing, and the reason why the first of them sees nothing.
struct Blind {
  std::vector<std::string> names;
  std::string why;
};

Blind blind_of(const Model& model, const std::vector<Camera>& cameras, const std::vector<bool>& sees,
               double near_plane) {
  Blind blind;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    if (sees[v]) continue;
    blind.names.push_back(cameras[v].name);
    if (blind.names.size() > 1) continue;
    Shot shot;
    shot.name = cameras[v].name;
    shot.eyes = {{"", cameras[v], {}}};
    blind.why = why_empty(model, shot, near_plane, "");
  }
  return blind;
}

std::string some_of(std::vector<std::string> names) {
  constexpr std::size_t most = 4;
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

void warn(const Blind& blind, std::size_t of) {
  log_warning("the model is not visible in {} of {} views, which are skipped ({}): {}", blind.names.size(),
              of, some_of(blind.names), blind.why);
}

[[noreturn]] void fail_blind(const std::string& command, const Blind& blind) {
  fail("{}: the model is visible in none of its views, so all would look equal: {}", command, blind.why);
}

template <typename View>
void keep_those(const std::vector<bool>& sees, std::size_t first, std::vector<View>& views) {
  std::vector<View> kept;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (sees[first + v]) kept.push_back(std::move(views[v]));
  }
  views = std::move(kept);
}

/// Tests each camera, and warns of those that see nothing. If all see nothing, throws Error.
std::vector<bool> seeing_views(const std::string& command, gl::Context& context, const Model& model,
                               const std::vector<Camera>& cameras, double near_plane) {
  std::vector<bool> sees = lab::seeing(context, model, cameras, near_plane);
  const Blind blind = blind_of(model, cameras, sees, near_plane);
  if (blind.names.size() == cameras.size() && !cameras.empty()) fail_blind(command, blind);
  if (!blind.names.empty()) warn(blind, cameras.size());
  return sees;
}

}  // namespace

void refuse_blind(const std::string& command, gl::Context& context, const Model& model,
                  const std::vector<Shot>& shots, double near_plane) {
  constexpr std::size_t most = 16;
  std::vector<Camera> cameras;
  for (const std::size_t k : lab::spread_evenly(shots.size(), most))
    cameras.push_back(shots[k].eyes.front().camera);
  const std::vector<bool> sees = lab::seeing(context, model, cameras, near_plane);
  if (std::find(sees.begin(), sees.end(), true) == sees.end())
    fail_blind(command, blind_of(model, cameras, sees, near_plane));
}

void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<Shot>& shots) {
  std::vector<Camera> cameras;
  for (const Shot& shot : shots) cameras.push_back(shot.eyes.front().camera);
  keep_those(seeing_views(command, context, model, cameras, near_plane), 0, shots);
}

void leave_out_blind(const std::string& command, gl::Context& context, const Model& model, double near_plane,
                     std::vector<lab::CalibrationView>& views) {
  std::vector<Camera> cameras;
  for (const lab::CalibrationView& view : views) cameras.push_back(view.camera);
  keep_those(seeing_views(command, context, model, cameras, near_plane), 0, views);
}

void leave_out_blind(const std::string& command, gl::Context& context, const Model& model,
                     lab::ViewSplit& views) {
  std::vector<Camera> cameras = views.training;
  for (const auto* task : {&views.validation, &views.test}) {
    for (const lab::CalibrationView& view : *task) cameras.push_back(view.camera);
  }
  const std::vector<bool> sees = seeing_views(command, context, model, cameras, views.near_plane);
  const std::size_t validation = views.training.size(), test = validation + views.validation.size();
  keep_those(sees, 0, views.training);
  keep_those(sees, validation, views.validation);
  keep_those(sees, test, views.test);
  if (views.validation.empty())
    fail("{}: the model is visible in none of the validation views: name others with --validation", command);
  if (views.training.empty()) fail("{}: the model is visible in no training view: add cameras", command);
}

}  // namespace binosplat::app
