// library_bench: what a program that embeds binosplat spends on a headset pair. CPU time of submit() with an
// idle and with a busy GPU, of submit() and finish() together beside draw(), and frames among meshes: checked
// against the float64 twin first, then timed with an empty depth texture and with one that covers half.

#include <binosplat/renderer.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "measure/metrics.h"
#include "reference/render.h"
#include "stereo/eyes.h"
#include "stereo/rig.h"
#include "support/caller.h"

namespace binosplat {
namespace {

/// Both eyes of a pair of cameras, in a space whose origin and axes are the left one's.
struct Head {
  Placement placement;
  std::array<Eye, 2> eyes;
};

Head head_of(const std::array<Camera, 2>& pair) {
  Head head;
  const glm::dmat3& rows = pair[0].rotation;
  head.placement.origin = pair[0].position;
  head.placement.axes = glm::dmat3(rows[0], -rows[1], -rows[2]);
  for (std::size_t k = 0; k < 2; ++k) {
    const Camera& c = pair[k];
    head.eyes[k].position = glm::transpose(head.placement.axes) * (c.position - pair[0].position);
    head.eyes[k].fov = {std::atan(-c.cx / c.fx), std::atan((c.width - c.cx) / c.fx), std::atan(c.cy / c.fy),
                        std::atan((c.cy - c.height) / c.fy)};
  }
  return head;
}

struct Bench {
  test::Caller caller;
  std::shared_ptr<const Model> model;
  Head head;
  glm::ivec2 size{0};
  int frames = 300;

  std::uint32_t texture(GLenum format, const glm::ivec2& of) const {
    return caller.texture(format, of.x, of.y);
  }

  std::vector<View> views(const glm::ivec2& of, GLenum format = GL_SRGB8_ALPHA8) const {
    std::vector<View> pair;
    for (const Eye& eye : head.eyes) pair.push_back({eye, of, {.texture = texture(format, of)}});
    return pair;
  }

  /// Gives each view a texture of z along the axis, which `depth` tells by pixel from OpenGL's lower left.
  template <typename Depth>
  void add_meshes(std::vector<View>& pair, const Depth& depth) const {
    for (View& view : pair) {
      std::vector<float> z;
      for (int y = 0; y < view.size.y; ++y) {
        for (int x = 0; x < view.size.x; ++x) z.push_back(depth(x, y));
      }
      const std::uint32_t id = texture(GL_R32F, view.size);
      upload(id, view.size, GL_RED, z);
      view.mesh_depth = {.texture = id, .coding = DepthCoding::axis};
    }
  }
  void upload(std::uint32_t id, const glm::ivec2& of, GLenum layout,
              const std::vector<float>& numbers) const {
    caller.TextureSubImage2D(id, 0, 0, 0, of.x, of.y, layout, GL_FLOAT, numbers.data());
  }

  /// The lower PSNR of both eyes against the twin, of small pictures with a wall with a hole, at the depth
  /// that half of the picture lies behind.
  double against_twin(const Settings& settings) const {
    const glm::ivec2 small(180, 160);
    std::vector<View> pair = views(small, GL_RGBA32F);
    const auto wall = [&](int x, int y) {
      const bool hole = std::abs(x - 90) + std::abs(y - 80) < 45;
      return hole ? 0.0f : middle() * (0.5f + static_cast<float>(x) / static_cast<float>(small.x));
    };
    add_meshes(pair, wall);
    const std::vector<float> grey(4 * static_cast<std::size_t>(small.x * small.y), 0.5f);
    for (const View& view : pair) upload(view.target.texture, small, GL_RGBA, grey);
    Renderer renderer(caller.get_proc_address(), SplatModel(model));
    renderer.draw(pair, head.placement, settings);
    const auto drawn = stereo::views_from_xr(head.eyes, head.placement, std::array{small, small}).views;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 2; ++k) {
      reference::Settings twin;
      if (settings.projection) twin.perspective = Perspective{ORDER_DISTANCE, PROJECTION_TANGENT};
      for (int y = small.y - 1; y >= 0; --y) {
        for (int x = 0; x < small.x; ++x) {
          const float z = wall(x, y);
          twin.mesh_depths.push_back(z > 0.0f ? z : std::numeric_limits<float>::infinity());
        }
      }
      const Picture expected = reference::render(*model, drawn[k], twin);
      Image a(small.x, small.y, 3), b = a;
      const std::vector<float> is = caller.read<float>(pair[k].target.texture, small.x, small.y);
      for (int y = 0; y < small.y; ++y) {
        for (int x = 0; x < small.x; ++x) {
          const glm::vec4 c = expected.colour[static_cast<std::size_t>(y) * small.x + x];
          for (int n = 0; n < 3; ++n) {
            a.at(x, y, n) = is[4 * static_cast<std::size_t>((small.y - 1 - y) * small.x + x) +
                               static_cast<std::size_t>(n)];
            b.at(x, y, n) = c[n] + 0.5f * c.a;
          }
        }
      }
      least = std::min(least, measure::psnr(a, b));
    }
    return least;
  }

  /// z of about the middle of what is seen.
  float middle() const {
    std::vector<double> z;
    const glm::dvec3 ahead = -head.placement.axes[2];
    for (std::size_t i = 0; i < model->count(); i += 16) {
      const double depth = glm::dot(ahead, glm::dvec3(model->position[i]) - head.placement.origin);
      if (depth > 0.2) z.push_back(depth);
    }
    return static_cast<float>(quantile(z, 0.3));
  }

  void run(const std::string& name, bool checks) const {
    fmt::print("{}: {} x {} px an eye, {} frames of each\n", name, size.x, size.y, frames);
    if (checks)
      fmt::print("  among meshes, against the twin: {:.1f} dB, tangent by distance {:.1f} dB\n",
                 against_twin({}),
                 against_twin({.order = Order::distance, .projection = Projection::tangent}));
    Renderer renderer(caller.get_proc_address(), SplatModel(model)),
        other(caller.get_proc_address(), SplatModel(model));
    const Settings black{.background = glm::vec3(0.0f)};
    const std::vector<View> plain = views(size), elsewhere = views(size);
    std::vector<View> empty = views(size), half = views(size);
    add_meshes(empty, [](int, int) { return 0.0f; });
    add_meshes(half, [&](int x, int) { return x < size.x / 2 ? 0.21f : 0.0f; });
    std::vector<double> idle, busy, whole, drawn, gpu, with_empty, with_half, between;
    for (int n = -30; n < frames; ++n) {
      const auto keep = [n](std::vector<double>& times, double ms) {
        if (n >= 0) times.push_back(ms);
      };
      auto start = Clock::now();
      renderer.submit(plain, head.placement, black);
      keep(idle, ms_since(start));
      keep(gpu, renderer.finish().gpu_ms);
      keep(whole, ms_since(start));
      start = Clock::now();
      renderer.draw(plain, head.placement, black);
      keep(drawn, ms_since(start));
      other.submit(elsewhere, head.placement, black);
      start = Clock::now();
      renderer.submit(plain, head.placement, black);
      const double ms = ms_since(start);
      if (!other.is_done()) keep(busy, ms);
      other.finish();
      renderer.finish();
      keep(with_empty, renderer.draw(empty, head.placement).gpu_ms);
      keep(with_half, renderer.draw(half, head.placement).gpu_ms);
      keep(between, renderer.draw(plain, head.placement, black).gpu_ms);
    }
    const auto tell = [](const char* what, const std::vector<double>& ms) {
      if (!ms.empty())
        fmt::print("  {:34} median {:.3f}, mean {:.3f}, p99 {:.3f} ms ({})\n", what, quantile(ms, 0.5),
                   mean(ms), quantile(ms, 0.99), ms.size());
    };
    tell("submit(), GPU idle", idle);
    tell("submit(), GPU busy", busy);
    tell("submit() and finish()", whole);
    tell("draw()", drawn);
    tell("GPU", gpu);
    tell("GPU, without meshes, in turn", between);
    tell("GPU, empty depth texture", with_empty);
    tell("GPU, half covered", with_half);
    fmt::print("  empty {:.3f}, half covered {:.3f} of without\n", mean(with_empty) / mean(between),
               mean(with_half) / mean(between));
  }
};

}  // namespace
}  // namespace binosplat

int main(int argc, char** argv) try {
  using namespace binosplat;
  std::string model, cameras, view;
  int frames = 300, shrink = 1;
  bool checks = false;
  CLI::App app("library_bench: what a program that embeds binosplat spends on a headset pair");
  app.add_option("model", model)->required();
  app.add_option("cameras", cameras, "with VIEW_avp_left and VIEW_avp_right")->required();
  app.add_option("view", view)->required();
  app.add_option("--frames", frames);
  app.add_option("--shrink", shrink, "pictures so many times smaller");
  app.add_flag("--check", checks, "compare with the float64 twin first, which takes a minute");
  CLI11_PARSE(app, argc, argv);
  Bench bench;
  bench.frames = frames;
  bench.model = std::make_shared<const Model>(load_model(model, {}));
  auto pair = stereo::find_eyes(load_cameras(cameras), view + "_avp");
  if (!pair) fail("{}: no {}_avp_left and _right", cameras, view);
  for (Camera& camera : *pair) camera = resized(camera, camera.width / shrink, camera.height / shrink);
  bench.head = head_of({(*pair)[0], (*pair)[1]});
  bench.size = {(*pair)[0].width, (*pair)[0].height};
  fmt::print("{}\n", bench.caller.context->renderer());
  bench.run(model + " " + view, checks);
} catch (const std::exception& error) {
  std::fprintf(stderr, "library_bench: %s\n", error.what());
  return 2;
}
