#include "demo/city.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "demo/city_parts.h"

namespace binosplat {

namespace {

using namespace demo;
using namespace demo::city;

std::vector<Surface> surfaces_of(const City& plan, double grain) {
  Builder builder(plan, grain);
  add_houses(builder);
  add_streets(builder);
  add_things(builder);
  add_far_away(builder);
  return std::move(builder.surfaces);
}

/// The surfaces for about `count` Gaussians: the grain that asks for so many.
std::vector<Surface> surfaces_for(const City& plan, std::size_t count) {
  double grain = 0.04 * std::sqrt(1e6 / static_cast<double>(count));
  std::vector<Surface> surfaces;
  for (int round = 0; round < 8; ++round) {
    surfaces = surfaces_of(plan, grain);
    double wanted = 0.0;
    for (const Surface& s : surfaces) wanted += std::max(1.0, s.weight);
    const double share = wanted / static_cast<double>(count);
    // All Gaussians will be given out; this share more or less of them changes no detail.
    if (share > 0.95 && share < 1.05) break;
    grain *= std::sqrt(share);
  }
  return surfaces;
}

/// Gives every surface one Gaussian, and the rest by weight. Returns where each one's Gaussians begin.
std::vector<std::size_t> share_out(std::vector<Surface>& surfaces, std::size_t count) {
  double sum = 0.0;
  for (const Surface& s : surfaces) sum += std::max(0.0, s.weight - 1.0);
  const std::size_t rest = count - surfaces.size();
  std::vector<std::size_t> begins;
  begins.reserve(surfaces.size());
  double reached = 0.0;
  std::size_t given = 0;
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    begins.push_back(k + given);
    reached += std::max(0.0, surfaces[k].weight - 1.0);
    const bool last = k + 1 == surfaces.size();
    const auto due =
        last ? rest : std::min(rest, static_cast<std::size_t>(reached / sum * static_cast<double>(rest)));
    surfaces[k].count = static_cast<std::uint32_t>(1 + due - given);
    given = due;
  }
  return begins;
}

void fill_all(const City& plan, const std::vector<Surface>& surfaces, const std::vector<std::size_t>& begins,
              Model& model) {
  const Light light(plan);
  Progress progress("building demo:city", surfaces.size());
  constexpr std::size_t parts = 64;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = surfaces.size() * part / parts, end = surfaces.size() * (part + 1) / parts;
    parallel_for(
        end - begin, [&](std::size_t k) { fill(light, surfaces[begin + k], begins[begin + k], model); }, 8);
    progress.update(end);
  }
}

Camera camera_of(const Relief& relief, const Head& head) {
  const dvec3 eye = relief.at(head.eye.x, head.eye.z, head.eye.y);
  const dvec3 at = relief.at(head.at.x, head.at.z, head.at.y);
  Camera camera = look_at(eye, at, {0, -1, 0}, head.fov_degrees, 1280, 720);
  camera.name = head.name;
  return camera;
}

}  // namespace

void check(const CitySettings& settings) {
  if (settings.count >= city_count_min && settings.count <= city_count_max) return;
  fail("--count {}: {} is made of {} to {} Gaussians", settings.count, demo_city_name, city_count_min,
       city_count_max);
}

std::vector<Camera> city_cameras(std::uint64_t seed) {
  const Relief relief = plan_city(seed).relief;
  std::vector<Camera> cameras;
  for (const Head& head : heads) cameras.push_back(camera_of(relief, head));
  return cameras;
}

Demo demo_city(const CitySettings& settings) {
  check(settings);
  const City plan = plan_city(settings.seed);
  std::vector<Surface> surfaces = surfaces_for(plan, settings.count);
  const std::vector<std::size_t> begins = share_out(surfaces, settings.count);

  Demo demo;
  demo.model.name = demo_city_name;
  demo.model.degree = 1;
  demo.model.resize(settings.count);
  fill_all(plan, surfaces, begins, demo.model);
  demo.cameras = city_cameras(settings.seed);
  return demo;
}

}  // namespace binosplat
