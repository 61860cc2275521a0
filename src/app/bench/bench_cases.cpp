// Opens the cases of bench: views of a scene, or frames along a path.

#include <algorithm>
#include <cmath>

#include "app/bench/bench_plan.h"
#include "app/bench/empty_views.h"
#include "app/models/level_options.h"
#include "app/models/load_scene.h"
#include "app/render/tour.h"
#include "base/error.h"
#include "base/log.h"
#include "base/numbers.h"
#include "formats/models/streamed_sog.h"
#include "scene/axes.h"
#include "scene/tour.h"

namespace binosplat::app {

namespace {

constexpr std::size_t stretches_of_a_tour = 3, frames_at_rest = 15;

bool is_along_frames(const std::string& along) { return along != "views"; }

RigOptions rig_of(const Options& options, const CasePlan& which) {
  RigOptions rig = options.rig;
  rig.mono = which.eyes == 1;
  return rig;
}

Lens lens_of(const std::string& size) {
  if (size == "own") return {};
  if (const auto two = two_numbers(size, 'x')) return {.size = glm::ivec2(two->first, two->second)};
  return {.preset = size};
}

/// Photos are compared only with single views in the cameras' own size.
bool has_photos(const BenchScene& scene, const CasePlan& which) {
  return !scene.photos.folder.empty() && which.eyes == 1 && which.size == "own" && which.along == "views";
}

struct ChosenViews {
  ViewChoice tested, training;
};

ChosenViews choose_views(const Options& options, const lab::Suite& suite, const CameraList& list) {
  ChosenViews chosen{{options.camera.views, static_cast<std::size_t>(suite.views)}, {}};
  if (suite.training == 0) return chosen;
  const TestSplit split = test_split(list, options.split.test_every);
  if (chosen.tested.views.empty()) chosen.tested.views = options.split.tests;
  if (chosen.tested.views.empty()) chosen.tested.without = split.training;
  chosen.training = {{}, static_cast<std::size_t>(suite.training), split.test};
  chosen.training.without.insert(chosen.training.without.end(), chosen.tested.views.begin(),
                                 chosen.tested.views.end());
  return chosen;
}

}  // namespace

void check_cases(const BenchPlan& plan, const Options& options) {
  const auto any = [&](const auto& is_so) { return std::ranges::any_of(plan.suite.settings, is_so); };
  const bool levels = any([](const lab::BenchSettings& s) { return s.detail.has_value(); });
  const bool finds = any([](const lab::BenchSettings& s) { return s.finds_tolerance(); });
  const bool foveated = any([](const lab::BenchSettings& s) { return s.foveation.has_value(); });
  const bool compares = std::ranges::any_of(
      plan.cases, [&](const CasePlan& which) { return has_photos(plan.scenes[which.scene], which); });
  if (plan.suite.training == 0 && (!options.split.tests.empty() || options.split.test_every))
    fail("--test and --test-every have no effect here: suite {} keeps no views for training",
         plan.suite.name);
  if (!options.photos.empty() && !compares)
    fail(
        "--photos {}: photos are compared only with single views in their own size: leave --size "
        "and pairs of eyes out, or give the suite \"sizes\": [\"own\"] and \"eyes\": [1]",
        options.photos);
  for (const CasePlan& which : plan.cases) {
    const BenchScene& scene = plan.scenes[which.scene];
    const CameraList& list = scene.list;
    check_cameras_of(scene.photos.folder, list);
    if (levels) {
      if (!is_streamed_sog(scene.options.name))
        fail(
            "'detail': {} is not a folder with levels of detail (a lod-meta.json): `binosplat levels MODEL "
            "-o DIR` makes one",
            scene.options.name);
      const LodFiles files(scene.options.name);
      for (const lab::BenchSettings& settings : plan.suite.settings) {
        if (settings.detail) files.check(*settings.detail);
      }
    }
    if ((levels || is_along_frames(which.along)) && !list.listed)
      fail("{}: {}; name their file with --cameras", levels ? "'detail'" : "along " + which.along,
           why_no_cameras(scene.options, list.hints));
    if (is_along_frames(which.along) && list.cameras.size() < 2)
      fail("along {}: expected two cameras or more, and {} has one", which.along, list.source);
    if (foveated && is_along_frames(which.along))
      fail("'inset': foveated pictures are measured only with \"along\": \"views\"");
    if (finds && (which.eyes == 2 || which.along != "views"))
      fail("'max_drop' and 'min_psnr' find tolerances in single views: \"eyes\": 1, \"along\": \"views\"");
    if (list.listed) check_views(options.camera.views, which.eyes == 1, list);
    if (!has_photos(scene, which) || !list.listed) continue;
    const ViewChoice tested = choose_views(options, plan.suite, list).tested;
    const std::vector<Camera> cameras = photographed_cameras(tested, scene.photos.folder, {}, list);
    if (cameras.empty())
      fail("--photos {}: there is no photo of any view for tests: {}", scene.photos.folder,
           test_split(list, options.split.test_every).how);
    check_photos(scene.photos.folder, cameras);
  }
}

MeasuredScene::MeasuredScene(gl::Context& context, const Options& options, const BenchPlan& plan,
                             std::size_t scene)
    : context_(context), options_(options), plan_(plan), scene_(plan.scenes[scene]) {
  for (const lab::BenchSettings& settings : plan.suite.settings) {
    if (!settings.detail) continue;
    SceneOptions own_options = scene_.options;
    own_options.detail = settings.detail;
    stream_ = open_for_shots(own_options, {}, false);
    break;
  }
}

const Model& MeasuredScene::model() {
  if (!model_) model_ = load_scene(scene_.options, {}, scene_.list.cameras);
  return *model_;
}

// Any model of the scene: for its axes, or to test whether views show anything. Its levels do not matter.
const Model& MeasuredScene::any_model() { return stream_ ? stream_->model() : model(); }

lab::BenchCase MeasuredScene::open(const CasePlan& which) {
  const CameraList list = scene_.list.listed ? scene_.list
                                             : generate_cameras(scene_.options, options_.camera, options_.rig,
                                                                scene_.list.hints, any_model());
  const ModelAxes& axes = any_model().axes;
  lab::BenchCase opened;
  opened.near_plane = near_plane_of(options_.camera, list, any_model());
  if (stream_)
    opened.follow = [this](const DetailRequest& detail) {
      SceneOptions scene = scene_.options;
      scene.detail = detail;
      const std::shared_ptr<PictureStream> stream = open_for_shots(scene, {}, false);
      return lab::FollowingModel{stream->gpu_model(context_, PRECISION_FULL),
                                 [stream](std::span<const shared::View> views) {
                                   stream->settle(views, {});
                                   return lab::LoadedLevels{stream->gaussians(), stream->reported_db()};
                                 }};
    };
  const Lens lens = lens_of(which.size);
  const RigOptions rig = rig_of(options_, which);
  if (is_along_frames(which.along))
    opened.stretches = stretches_of(which, list, lens, rig);
  else
    open_views(which, list, opened);
  constexpr int small_width = 160;
  const Camera camera = sized(lens, list.cameras.front());
  const int width = std::min(small_width, camera.width);
  const int height = std::max(1, static_cast<int>(std::int64_t{camera.height} * width / camera.width));
  opened.small = make_view(into_axes(resized(camera, width, height), axes), opened.near_plane);
  return opened;
}

void MeasuredScene::open_views(const CasePlan& which, const CameraList& list, lab::BenchCase& opened) {
  const bool photos = has_photos(scene_, which);
  const PhotoSource source = photos ? scene_.photos : PhotoSource{};
  const Lens lens = lens_of(which.size);
  const ChosenViews chosen = choose_views(options_, plan_.suite, list);
  std::vector<std::string> names;
  for (const Camera& camera : photographed_cameras(chosen.tested, source.folder, lens, list))
    names.push_back(camera.name);
  std::vector<Shot> shots = make_shots(names.empty() ? all_views : names, lens, rig_of(options_, which), list,
                                       opened.near_plane, any_model().axes);
  remove_empty_views("bench", context_, any_model(), opened.near_plane, shots);
  for (const Shot& shot : shots) {
    lab::BenchView& view = opened.views.emplace_back(lab::BenchView{shot.name, views_of(shot)});
    if (which.eyes == 1) opened.tested.push_back(with_photo(source, shot.eyes.front().camera));
    if (!photos) continue;
    view.photo = opened.tested.back().photo;
    view.exposure = opened.tested.back().exposure;
  }
  if (plan_.suite.training == 0) return;
  opened.training = photographed_views(chosen.training, source, lens, list);
  remove_empty_views("bench", context_, any_model(), opened.near_plane, opened.training);
  if (opened.training.empty()) {
    log_warning("no training views are left: tolerances are found on the test views, too");
    opened.training = opened.tested;
  }
  log_info("{} views for tests{}; {} others for training", opened.views.size(),
           options_.split.tests.empty() && options_.camera.views.empty()
               ? ": " + test_split(list, options_.split.test_every).how
               : "",
           opened.training.size());
}

std::vector<lab::Stretch> MeasuredScene::stretches_of(const CasePlan& which, const CameraList& list,
                                                      const Lens& lens, const RigOptions& rig) {
  const double near_plane = near_plane_of(options_.camera, list, any_model()),
               metre = rig_settings(options_.rig, list.hints).units_per_metre;
  const auto moving = [&](const std::vector<Camera>& cameras) {
    const CameraList path{
        .cameras = cameras, .path = true, .hints = {.units_per_metre = metre, .ipd = list.hints.ipd}};
    lab::Stretch stretch{{}, cameras.size()};
    for (const Shot& shot : make_shots({}, lens, rig, path, near_plane, any_model().axes))
      stretch.frames.push_back(views_of(shot));
    stretch.frames.insert(stretch.frames.end(), frames_at_rest, std::vector(stretch.frames.back()));
    return stretch;
  };
  require_visible_view("bench", context_, any_model(),
                       make_shots(all_views, lens, no_rig, list, near_plane, any_model().axes), near_plane);
  if (which.along == along_path) {
    const CameraList path = go_along_path(options_.camera, headset_fps, true, list);
    return {moving(path.cameras)};
  }
  if (which.along == along_tour)
    return {moving(go_on_tour(scene_.options, options_.camera, options_.rig, headset_fps, list).cameras)};
  const bool still = which.along == "still";
  const auto motion =
      std::ranges::find(head_motions(), still ? head_motions().front().name : which.along, &Motion::name);
  const std::vector<Camera> tour = binosplat::tour(list.cameras, {*motion, headset_fps, metre});
  const std::size_t length = std::min(tour.size(), static_cast<std::size_t>(plan_.suite.frames));
  std::vector<lab::Stretch> stretches;
  for (const std::size_t start : lab::stretch_starts(tour.size(), length, stretches_of_a_tour)) {
    const auto first = tour.begin() + static_cast<std::ptrdiff_t>(start);
    stretches.push_back(moving({first, first + static_cast<std::ptrdiff_t>(still ? 1 : length)}));
    if (!still) continue;
    stretches.back().frames.resize(length, std::vector(stretches.back().frames.front()));
    stretches.back().moving = length;
  }
  return stretches;
}

}  // namespace binosplat::app
