#include "scene/detected_axes.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scene/axes.h"
#include "scene/framing.h"
#include "scene/ground.h"

namespace binosplat {

namespace {

/// Larger numbers of Gaussians or cameras are sampled.
constexpr std::size_t max_gaussians = 20000, max_cameras = 64;
/// If the cameras see a smaller share of the Gaussians, they look at something else.
constexpr double min_seen = 0.01;
/// In the correct axes, cameras see at least this many times as many Gaussians as in the other axes. Trained
/// scenes have factors of 17 or more: their origin is arbitrary, so the other axes turn the model away.
constexpr double min_visibility_ratio = 2.0;
/// Smallest cosine between the up directions of cameras and model that counts as agreement.
constexpr double along = 0.5;

double mean_in_view(const Model& model, std::span<const Camera> cameras, const ModelAxes& axes) {
  std::vector<double> shares(cameras.size());
  parallel_for(cameras.size(), [&](std::size_t k) {
    const Camera camera = into_axes(cameras[k], axes);
    std::size_t looked_at = 0, seen = 0;
    for (std::size_t i = 0; i < model.count(); i += model.count() / max_gaussians + 1) {
      const ProjectedPoint middle = project_point(camera, model.position[i]);
      ++looked_at;
      if (middle.depth > 0.0 && middle.is_within(0.0)) ++seen;
    }
    shares[k] = static_cast<double>(seen) / static_cast<double>(looked_at);
  });
  return mean(shares);
}

}  // namespace

std::optional<DetectedAxes> detect_axes(const Model& model, const std::string& others,
                                        std::span<const Camera> cameras) {
  if (cameras.empty() || model.count() == 0) return std::nullopt;
  std::vector<Camera> some;
  for (std::size_t i = 0; i < cameras.size(); i += cameras.size() / max_cameras + 1)
    some.push_back(cameras[i]);
  DetectedAxes usual{.axes = model.axes.letters, .cameras = some.size()}, other = usual;
  other.axes = others;
  usual.seen = other.seen_otherwise = mean_in_view(model, some, {usual.axes});
  other.seen = usual.seen_otherwise = mean_in_view(model, some, {other.axes});
  if (std::max(usual.seen, other.seen) < min_seen) return std::nullopt;
  if (usual.seen >= min_visibility_ratio * other.seen) return usual;
  if (other.seen >= min_visibility_ratio * usual.seen) return other;
  usual.by_ground = other.by_ground = true;
  const auto capture = capture_of(cameras);
  const auto ground = capture ? find_ground(CoredModel(model)) : std::nullopt;
  if (!ground) return std::nullopt;
  // Cosine between the model's up and the cameras', in each of the two conventions.
  const glm::dvec3 up = glm::transpose(world_from_axes(usual.axes)) * ground->up;
  const double in_usual = glm::dot(ground->up, capture->up);
  const double in_other = glm::dot(world_from_axes(others) * up, capture->up);
  if (std::max(in_usual, in_other) < along || std::min(in_usual, in_other) > 0.0) return std::nullopt;
  return in_usual > in_other ? usual : other;
}

}  // namespace binosplat
