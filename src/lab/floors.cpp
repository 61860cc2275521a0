#include "lab/floors.h"

#include <algorithm>
#include <limits>
#include <map>

#include "render/halves.h"
#include "scene/model.h"
#include "shared/axes.h"
#include "shared/limits.h"
#include "shared/types.h"

namespace binosplat::lab {

namespace {

constexpr double shortest_ms = 2.0;  // shorter runs are repeated with more work
constexpr int runs = 5;

/// The seconds of the fastest run.
double seconds(gl::Context& context, int floor, std::uint32_t count, std::uint32_t rounds,
               const gl::Buffer& from, const gl::Buffer& to) {
  gl::Dispatcher dispatcher(context);
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) {
    dispatcher.begin_frame();
    dispatcher.begin_stage("floor");
    dispatcher.run(context.program("floors.comp", gl::Number{"FLOOR", static_cast<std::uint64_t>(floor), 3}),
                   gl::DispatchSize::threads(count, THREADS), {{"From", from}, {"To", to}},
                   {{"count", count}, {"rounds", rounds}});
    dispatcher.end_frame();
    best = std::min(best, dispatcher.wait_and_time().front().ms);
  }
  return best / 1000.0;
}

/// Operations per second, if an invocation makes `operations` of them per round.
double rate(gl::Context& context, int floor, double operations, const gl::Buffer& from,
            const gl::Buffer& to) {
  const auto count = static_cast<std::uint32_t>(to.bytes() / 16);
  for (std::uint32_t rounds = 1;; rounds *= 4) {
    const double s = seconds(context, floor, count, rounds, from, to);
    if (1000.0 * s >= shortest_ms || rounds >= 1024) return operations * rounds * count / s;
  }
}

// Multiply-adds of a Gaussian in a view (docs/method.md 2): axes 21, view space 9, J R M 30, C2 and conic 15,
// tile box 15. Its colour adds 20 for the basis of the harmonics, and one per coefficient.
constexpr double projection_fmas = 90.0, basis_fmas = 20.0;

struct Least {
  double bytes = 0.0, operations = 0.0, seconds = 0.0;
};

}  // namespace

Peaks measure_peaks(gl::Context& context) {
  // Each of the two buffers is larger than any cache, except on llvmpipe, which takes long for half a GiB.
  const std::int64_t bytes = context.software() ? std::int64_t{16} << 20 : std::int64_t{256} << 20;
  Peaks peaks;
  gl::Buffer from(context, "floor: from"), to(context, "floor: to");
  {
    from.upload(std::vector<glm::vec4>(static_cast<std::size_t>(bytes / 16), glm::vec4(0.5f)));
    to.reserve(bytes);
    const double s = seconds(context, FLOOR_BYTES, static_cast<std::uint32_t>(bytes / 16), 1, from, to);
    peaks.bytes = 2.0 * static_cast<double>(bytes) / s;
  }
  // Splats that cover all pixels and are too faint to end a pixel's blend.
  std::vector<glm::vec4> splats;
  for (int n = 0; n < 256; ++n) {
    splats.emplace_back(n % 16, n / 16, 0.0f, 0.02f);
    splats.emplace_back(0.001f, 0.0f, 0.001f, 1.0f);
  }
  gl::Buffer some(context, "floor: splats"), pixels(context, "floor: pixels");
  some.upload(splats);
  pixels.reserve(context.software() ? std::int64_t{1} << 16 : std::int64_t{1} << 24);
  peaks.alphas = rate(context, FLOOR_ALPHAS, 256.0 * 4.0, some, pixels);
  peaks.fmas = rate(context, FLOOR_FMAS, 256.0 * 4.0, some, pixels);
  return peaks;
}

std::vector<StageFloor> profile(const FrameWork& work, const Peaks& peaks) {
  const double harmonics = 3.0 * sh_count(work.degree);
  const bool half = work.precision == PRECISION_HALF;
  const double gaussian_bytes = half ? sizeof(render::Halves) : sizeof(shared::Gaussian);
  const double splat_bytes = half ? sizeof(render::Halves) : sizeof(shared::Splat);
  std::map<std::string, Least> least;
  // Reads every Gaussian and writes its key. Reads the harmonics of Gaussians in view. Writes splats and
  // coverages.
  least["project"] = {work.gaussians * (gaussian_bytes + 4) + work.in_view * (half ? 2 : 4) * harmonics +
                          work.splats * (splat_bytes + 4),
                      work.gaussians * projection_fmas + work.splats * (basis_fmas + harmonics)};
  least["project"].seconds = least["project"].operations / peaks.fmas;
  // Reads coverages twice (to count and to place entries), and depths once for both eyes.
  least["bin"] = {work.splats * 10 + work.supertile_pairs * 8};
  least["sort"] = {work.supertile_pairs * 8 + work.pairs * 4 + work.tiles * 8};
  least["blend"] = {work.pairs * (splat_bytes + 4) + work.pixels * 20, work.alphas};
  least["blend"].seconds = least["blend"].operations / peaks.alphas;
  std::vector<StageFloor> stages;
  for (const gl::StageTime& stage : work.stages) {
    StageFloor& one = stages.emplace_back(StageFloor{stage.name, stage.ms});
    const auto found = least.find(stage.name);
    if (found == least.end()) continue;
    const Least& floor = found->second;
    one.bytes = floor.bytes;
    if (floor.operations > 0.0) one.operations = floor.operations;
    one.floor_ms = 1000.0 * std::max(floor.bytes / peaks.bytes, floor.seconds);
    if (stage.ms > 0.0) one.share = one.floor_ms / stage.ms;
  }
  return stages;
}

}  // namespace binosplat::lab
