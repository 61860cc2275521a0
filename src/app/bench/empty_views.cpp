#include "app/bench/empty_views.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "app/render/empty_view.h"
#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
#include "lab/bench_views.h"
#include "lab/empty_views.h"

namespace binosplat::app {

namespace {

/// The names of the views that see nothing, and the reason why the first of them sees nothing.
struct EmptyViews {
  std::vector<std::string> names;
  std::string why;
};

EmptyViews find_empty_views(const Model& model, const std::vector<Camera>& cameras,
                            const std::vector<bool>& sees, double near_plane) {
  EmptyViews empty;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    if (sees[v]) continue;
    empty.names.push_back(cameras[v].name);
    if (empty.names.size() > 1) continue;
    Shot shot;
    shot.name = cameras[v].name;
    shot.eyes = {{"", cameras[v], {}}};
    empty.why = why_empty(model, shot, near_plane, "");
  }
  return empty;
}

std::string first_names(std::vector<std::string> names) {
  constexpr std::size_t most = 4;
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

void warn(const EmptyViews& empty, std::size_t of) {
  log_warning("the model is not visible in {} of {} views, which are skipped ({}): {}", empty.names.size(),
              of, first_names(empty.names), empty.why);
}

[[noreturn]] void fail_all_empty(const std::string& command, const EmptyViews& empty) {
  fail("{}: the model is visible in none of its views, so all would look equal: {}", command, empty.why);
}

template <typename View>
void keep_visible_views(const std::vector<bool>& sees, std::size_t first, std::vector<View>& views) {
  std::vector<View> kept;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (sees[first + v]) kept.push_back(std::move(views[v]));
  }
  views = std::move(kept);
}

/// Tests each camera, and warns of those that see nothing. If all see nothing, throws Error.
std::vector<bool> check_visibility(const std::string& command, gl::Context& context, const Model& model,
                                   const std::vector<Camera>& cameras, double near_plane) {
  std::vector<bool> sees = lab::which_see_model(context, model, cameras, near_plane);
  const EmptyViews empty = find_empty_views(model, cameras, sees, near_plane);
  if (empty.names.size() == cameras.size() && !cameras.empty()) fail_all_empty(command, empty);
  if (!empty.names.empty()) warn(empty, cameras.size());
  return sees;
}

}  // namespace

void require_visible_view(const std::string& command, gl::Context& context, const Model& model,
                          const std::vector<Shot>& shots, double near_plane) {
  constexpr std::size_t most = 16;
  std::vector<Camera> cameras;
  for (const std::size_t k : spread_evenly(shots.size(), most))
    cameras.push_back(shots[k].eyes.front().camera);
  const std::vector<bool> sees = lab::which_see_model(context, model, cameras, near_plane);
  if (std::find(sees.begin(), sees.end(), true) == sees.end())
    fail_all_empty(command, find_empty_views(model, cameras, sees, near_plane));
}

void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        double near_plane, std::vector<Shot>& shots) {
  std::vector<Camera> cameras;
  for (const Shot& shot : shots) cameras.push_back(shot.eyes.front().camera);
  keep_visible_views(check_visibility(command, context, model, cameras, near_plane), 0, shots);
}

void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        double near_plane, std::vector<adagscale::CalibrationView>& views) {
  std::vector<Camera> cameras;
  for (const adagscale::CalibrationView& view : views) cameras.push_back(view.camera);
  keep_visible_views(check_visibility(command, context, model, cameras, near_plane), 0, views);
}

void remove_empty_views(const std::string& command, gl::Context& context, const Model& model,
                        compact::ViewSplit& views) {
  std::vector<Camera> cameras = views.training;
  for (const auto* task : {&views.validation, &views.test}) {
    for (const adagscale::CalibrationView& view : *task) cameras.push_back(view.camera);
  }
  const std::vector<bool> sees = check_visibility(command, context, model, cameras, views.near_plane);
  const std::size_t validation = views.training.size(), test = validation + views.validation.size();
  keep_visible_views(sees, 0, views.training);
  keep_visible_views(sees, validation, views.validation);
  keep_visible_views(sees, test, views.test);
  if (views.validation.empty())
    fail("{}: the model is visible in none of the validation views: name others with --validation", command);
  if (views.training.empty()) fail("{}: the model is visible in no training view: add cameras", command);
}

}  // namespace binosplat::app
