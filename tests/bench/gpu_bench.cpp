// gpu_bench checks and then times one case of the benchmark on this machine's GPU: the headset's stereo pair,
// each eye alone, and one large picture. bench_gpu runs all cases and stores the output.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstring>
#include <fstream>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/choices.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/statistics.h"
#include "demo/demo.h"
#include "formats/cameras/cameras_file.h"
#include "formats/models/model_file.h"
#include "gl/full_clock.h"
#include "render/frame.h"
#include "render/squared_error.h"
#include "scene/reduce.h"
#include "scene/repeat.h"
#include "scene/transform.h"
#include "stereo/drawing.h"
#include "stereo/present.h"
#include "stereo/rig.h"

namespace binosplat {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Case {
  std::string name;     // scene and number of repetitions
  std::string model;    // path below the folder of scenes; the built-in city if empty
  std::string cameras;  // path below the folder of views
  int repeat = 1;       // repetitions along x and along z
  double spacing = 0;   // distance between repetitions, world units
  std::vector<std::string> views;
  int lod = 0;  // level of detail of a streamed model
};

const std::vector<Case> cases = {
    {"fox", "fox/fox.ply", "fox_bench.json", 1, 0, {"0001", "0042"}},
    {"garden", "garden/garden.ply", "garden_bench.json", 1, 0, {"DSC07956", "DSC08060", "DSC08116"}},
    {"fox 8 x 8", "fox/fox.ply", "fox_bench.json", 8, 10, {"0001", "0042"}},
    {"garden 4 x 4", "garden/garden.ply", "garden_bench.json", 4, 20, {"DSC07956", "DSC08060", "DSC08116"}},
    {"taebak LOD 0", "taebak", "taebak_bench.json", 1, 0, {"air", "walk"}},
    {"taebak 2 x 2", "taebak", "taebak_bench.json", 2, 60, {"air", "walk"}},
    {"lacadiere LOD 1", "lacadiere", "lacadiere_bench.json", 1, 0, {"flat", "flat2"}, 1},
    {"city of 4 million", "", "", 1, 0, {}},
};

// The views of one camera: a stereo pair and a large picture.
struct Shot {
  std::string name;
  std::array<shared::View, 2> eyes;
  shared::View large;
};

struct Loaded {
  Model model;
  std::vector<Shot> shots;
};

// Returns the camera with its picture smaller by a factor.
Camera shrunk(const Camera& camera, int shrink) {
  return resized(camera, camera.width / shrink, camera.height / shrink);
}

Loaded load(const Case& c, const fs::path& scenes, const fs::path& views, int shrink) {
  Loaded loaded;
  if (c.model.empty()) {
    Demo demo = demo_city({.count = 4'000'000});
    loaded.model = std::move(demo.model);
    for (const Camera& head : demo.cameras) {
      const Camera camera = shrunk(stereo::apply_preset(head, "headset"), shrink);
      const Camera large = shrunk(resized(head, 4608, 3456), shrink);
      loaded.shots.push_back({head.name, stereo::make_rig(camera, {.ipd = 0.064}).views, make_view(large)});
    }
    return loaded;
  }
  ModelOptions options;
  if (fs::is_directory(scenes / c.model)) options.lod = c.lod;
  loaded.model = load_model(scenes / c.model, options);
  if (c.repeat > 1) loaded.model = repeat(std::move(loaded.model), c.repeat, c.repeat, c.spacing);
  const std::vector<Camera> cameras = load_cameras(views / c.cameras);
  for (const std::string& name : c.views) {
    const auto pair = stereo::find_eyes(cameras, name + "_avp");
    const auto large = std::find_if(cameras.begin(), cameras.end(),
                                    [&](const Camera& k) { return k.name == name + "_4608"; });
    if (!pair || large == cameras.end())
      fail("{}: no {}_avp_left, _right and {}_4608", c.cameras, name, name);
    loaded.shots.push_back(
        {name, stereo::rig_from_eyes(shrunk((*pair)[0], shrink), shrunk((*pair)[1], shrink)).views,
         make_view(shrunk(*large, shrink))});
  }
  return loaded;
}

// Settings to draw and time a case with.
struct How {
  render::FrameSettings settings;
  fs::path shaders;
  bool subgroups = true;
  int frames = 20;  // number of frames that medians are computed from
  int shrink = 1;   // divisor of picture sizes
  std::optional<stereo::Foveation> foveate;
  gl::FullClock* clock = nullptr;
};

// Draws a frame of the views, foveated or not.
using Draw = std::function<Report()>;

// Fails if half precision is below 60 dB against full precision. Returns the PSNR. Frees the memory that full
// precision needs.
double check_half(render::Frame& frame, const Model& model, const Shot& shot, const How& how) {
  gl::Context& context = frame.model()->context();
  render::FrameSettings full = how.settings;
  full.precision = PRECISION_FULL;
  const std::vector<Picture> expected = [&] {
    render::Frame exact(context, model);
    exact.draw(shot.eyes, full);
    return exact.read_pictures();
  }();
  render::SquaredError error(context, expected);
  frame.draw(shot.eyes, how.settings);
  const double db = error.psnr(frame.colours());
  if (!(db >= 60.0)) fail("{}: half precision is {:.1f} dB from full", shot.name, db);
  fmt::print("  {}: {:.1f} dB from full precision\n", shot.name, db);
  return db;
}

// Fails if an eye differs between the stereo pair and a draw alone, or is empty, or if the pair differs from
// a first frame, which does not know how large and how many its splats are.
void check(render::Frame& frame, const Shot& shot, const How& how) {
  frame.draw(shot.eyes, how.settings);
  const std::vector<Picture> both = frame.read_pictures();
  {
    render::Frame first(frame.model());
    first.draw(shot.eyes, how.settings);
    if (!same_bits(first.read_pictures(), both)) fail("{}: a later frame differs from the first", shot.name);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    frame.draw(std::span(&shot.eyes[eye], 1), how.settings);
    const std::span picture(&both[eye], 1);
    if (!same_bits(frame.read_pictures(), picture))
      fail("{}: eye {} differs from itself alone", shot.name, eye);
    if (same_bits(picture, std::vector{Picture(both[eye].width, both[eye].height)}))
      fail("{}: eye {} is empty", shot.name, eye);
  }
  if (same_bits(std::span(&both[0], 1), std::span(&both[1], 1)))
    fail("{}: both eyes are the same picture", shot.name);
}

// Draws until the GPU's clock is high again: it falls while pictures are read back.
void wake(const Draw& draw) {
  const Clock::time_point start = Clock::now();
  while (ms_since(start) < 200) draw();
}

// Returns medians and quartiles of each stage and of the whole frame, taken at the GPU's full clock if it
// lets us.
Json time(const Draw& draw, const How& how) {
  std::map<std::string, std::vector<double>> stages;
  std::vector<std::string> names;
  Report report;
  if (how.frames > 1) wake(draw);
  const bool full_clock = how.clock->measure([&] {
    stages.clear();
    names.clear();
    for (int n = 0; n < how.frames; ++n) {
      report = draw();
      for (const StageTime& stage : report.stages) {
        if (stages.find(stage.name) == stages.end()) names.push_back(stage.name);
        stages[stage.name].push_back(stage.ms);
      }
      stages["frame"].push_back(report.gpu_ms);
    }
  });
  names.emplace_back("frame");
  Json json;
  for (const std::string& name : names) json[name] = quantile(stages[name], 0.5);
  json["quartiles"] = {quantile(stages["frame"], 0.25), quantile(stages["frame"], 0.75)};
  json["full_clock"] = full_clock;
  json["visible_count"] = report.visible;
  json["pair_count"] = report.pairs;
  json["gpu_mb"] = report.gpu_bytes / 1e6;
  return json;
}

Json time(render::Frame& frame, std::span<const shared::View> views, const How& how) {
  return time([&] { return frame.draw(views, how.settings); }, how);
}

// Textures that frames draw into directly, as an application's do.
class Textures {
 public:
  Textures(gl::Context& context, std::span<const shared::View> views, GLenum format)
      : context_(context), presenter_(context), targets_(views.size()) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      context.gl().CreateTextures(GL_TEXTURE_2D, 1, &targets_[v].texture);
      context.gl().TextureStorage2D(targets_[v].texture, 1, format, static_cast<int>(views[v].width),
                                    static_cast<int>(views[v].height));
    }
    canvases_ = presenter_.canvases(targets_, glm::vec3(0.0f));
    if (canvases_.list.empty()) fail("this driver writes no texture of format {:#x} in place", format);
  }
  ~Textures() {
    for (const Target& target : targets_) context_.gl().DeleteTextures(1, &target.texture);
  }
  Textures(const Textures&) = delete;
  Textures& operator=(const Textures&) = delete;

  std::span<const render::Canvas> canvases() const { return canvases_.list; }

 private:
  gl::Context& context_;
  stereo::Presenter presenter_;
  std::vector<Target> targets_;
  stereo::Canvases canvases_;
};

// Like time(), but draws into half-float textures of 8 bytes per pixel, as other renderers in half precision
// do.
Json time_in_textures(render::Frame& frame, std::span<const shared::View> views, const How& how) {
  const Textures textures(frame.model()->context(), views, GL_RGBA16F);
  return time([&] { return frame.draw(views, how.settings, {}, {.canvases = textures.canvases()}); }, how);
}

// Times the foveated stereo pair. Fails if its insets differ from the exact pictures.
Json time_foveated(stereo::Drawing& foveated, render::Frame& frame, const Shot& shot, const How& how) {
  render::FrameSettings settings = how.settings;
  settings.foveation = how.foveate;
  foveated.draw(shot.eyes, settings);
  const std::vector<Picture> drawn = foveated.read_pictures();
  render::FrameSettings exact = how.settings;
  exact.threshold = Threshold::exact;
  exact.tolerance.reset();
  frame.draw(shot.eyes, exact);
  const std::vector<Picture> whole = frame.read_pictures();
  Json insets, contexts;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const stereo::FoveatedEye& part = foveated.parts()[eye];
    for (std::uint32_t y = part.inset_begin.y; y < part.inset_end.y; ++y) {
      const std::size_t at = std::size_t{y} * static_cast<std::size_t>(whole[eye].width) + part.inset_begin.x;
      const std::size_t bytes = (part.inset_end.x - part.inset_begin.x) * sizeof(glm::vec4);
      if (std::memcmp(&drawn[eye].colour[at], &whole[eye].colour[at], bytes) != 0)
        fail("{}: eye {}, row {}: the inset is not the exact picture", shot.name, eye, y);
    }
    insets.push_back({part.window.size.x, part.window.size.y});
    contexts.push_back({part.context.width, part.context.height});
  }
  // Both pairs draw into textures, as for a headset.
  const Textures textures(frame.model()->context(), shot.eyes, GL_SRGB8_ALPHA8);
  const auto canvases = textures.canvases();
  Json json = time([&] { return foveated.draw(shot.eyes, settings, {}, {.canvases = canvases}); }, how);
  json["exact"] = time([&] { return frame.draw(shot.eyes, exact, {}, {.canvases = canvases}); }, how);
  json["windows"] = insets;
  json["contexts"] = contexts;
  return json;
}

void print_row(const std::string& scene, const std::string& view, const char* what, const Json& t) {
  fmt::print("| {} | {} | {}{} |", scene, view, what, t.at("full_clock").get<bool>() ? "" : ", low clock");
  for (const char* stage : {"project", "bin", "sort", "blend", "frame"}) {
    fmt::print(" {:.3f} |", t.at(stage).get<double>());
  }
  fmt::print(" {:.2f} | {:.2f} | {:.0f} |\n", t.at("visible_count").get<double>() * 1e-6,
             t.at("pair_count").get<double>() * 1e-6, t.at("gpu_mb").get<double>());
  std::fflush(stdout);
}

Json run(const Case& c, const fs::path& scenes, const fs::path& views, How how) {
  const Clock::time_point start = Clock::now();
  const auto context = gl::Context::open();
  gl::FullClock clock(*context);
  how.clock = &clock;
  context->set_shader_folder(how.shaders);
  context->use_subgroups(how.subgroups);
  Json json = {{"scene", c.name},
               {"precision", precision_choices[how.settings.precision].name},
               {"order", name_of(*how.settings.order)},
               {"projection", name_of(*how.settings.projection)},
               {"gpu", context->renderer()},
               {"driver", context->version()}};
  json["context_ms"] = ms_since(start);
  Clock::time_point phase = Clock::now();
  const Loaded loaded = load(c, scenes, views, how.shrink);
  json["gaussians"] = loaded.model.count();
  json["load_ms"] = ms_since(phase);
  phase = Clock::now();
  const auto gpu_model = std::make_shared<render::GpuModel>(*context, loaded.model, how.settings.precision);
  render::Frame frame(gpu_model);
  std::optional<stereo::Drawing> foveated;
  if (how.foveate) foveated.emplace(gpu_model);
  frame.draw(loaded.shots.front().eyes, how.settings);
  const std::vector<Picture> first = frame.read_pictures();
  json["upload_draw_read_ms"] = ms_since(phase);
  json["first_picture_ms"] = ms_since(start);
  for (const Shot& shot : loaded.shots) {
    Json row = {{"view", shot.name}};
    if (how.settings.precision == PRECISION_HALF)
      row["psnr_db"] = check_half(frame, loaded.model, shot, how);
    else
      check(frame, shot, how);
    row["pair"] = time(frame, shot.eyes, how);
    row["left"] = time(frame, std::span(&shot.eyes[0], 1), how);
    row["right"] = time(frame, std::span(&shot.eyes[1], 1), how);
    row["large"] = time(frame, std::span(&shot.large, 1), how);
    row["pair, halves"] = time_in_textures(frame, shot.eyes, how);
    row["large, halves"] = time_in_textures(frame, std::span(&shot.large, 1), how);
    for (const char* what : {"pair", "left", "right", "large", "pair, halves", "large, halves"})
      print_row(c.name, shot.name, what, row[what]);
    const auto front = [&](const char* what) { return row[what]["project"].get<double>(); };
    row["front_pair_over_one_eye"] = front("pair") / std::max(front("left"), front("right"));
    row["pair_over_both_alone"] = row["pair"]["frame"].get<double>() /
                                  (row["left"]["frame"].get<double>() + row["right"]["frame"].get<double>());
    fmt::print("  project of the pair over one eye's: {:.2f}; the pair over its two mono frames: {:.2f}\n",
               row["front_pair_over_one_eye"].get<double>(), row["pair_over_both_alone"].get<double>());
    if (foveated) {
      row["foveated"] = time_foveated(*foveated, frame, shot, how);
      print_row(c.name, shot.name, "foveated", row["foveated"]);
      const double exact_ms = row["foveated"]["exact"]["frame"], foveated_ms = row["foveated"]["frame"];
      const double compose_ms = row["foveated"]["compose"];
      fmt::print(
          "  into textures: exact pair {:.3f} ms, foveated {:.3f} ({:.2f} of it), four views alone {:.3f} "
          "({:.2f}), windows {}, contexts {}\n",
          exact_ms, foveated_ms, foveated_ms / exact_ms, foveated_ms - compose_ms,
          (foveated_ms - compose_ms) / exact_ms, row["foveated"]["windows"].dump(),
          row["foveated"]["contexts"].dump());
    }
    json["views"].push_back(row);
  }
  fmt::print(
      "  first picture {:.0f} ms after start: context {:.0f}, model {:.0f}, upload, first pair and read-back "
      "{:.0f}\n",
      json["first_picture_ms"].get<double>(), json["context_ms"].get<double>(), json["load_ms"].get<double>(),
      json["upload_draw_read_ms"].get<double>());
  return json;
}

// Compares a hundred instances of one model, rotated before every frame, with one model that holds them all.
Json run_crowd(How how) {
  const auto context = gl::Context::open();
  gl::FullClock clock(*context);
  how.clock = &clock;
  const Model model = demo_city({.count = 10'000}).model;
  Model merged = without_gaussians(model);
  std::vector<render::Instance> crowd;
  const auto on_gpu = std::make_shared<render::GpuModel>(*context, model, how.settings.precision);
  const auto turn = [&](double radians) {
    for (int k = 0; k < 100; ++k) {
      render::InstancePlace& place = crowd[static_cast<std::size_t>(k)].place;
      place.rotation = glm::dmat3(glm::rotate(glm::dmat4(1.0), radians + k, glm::dvec3(0, 1, 0)));
      const int row = k / 10;
      place.translation = {3.0 * (k % 10 - 4.5), 0.0, 3.0 * row};
      place.scale = 0.01;
    }
  };
  crowd.assign(100, {on_gpu, {}});
  turn(0.0);
  for (const render::Instance& one : crowd) {
    glm::dmat4 map(one.place.scale * one.place.rotation);
    map[3] = glm::dvec4(one.place.translation, 1.0);
    Model copy = model;
    std::vector<glm::dvec3> places;
    if (!transform(copy, map, places)) fail("a matrix that moves a model beyond floats");
    std::ranges::copy(places, copy.position.begin());
    append(merged, copy, 0, copy.count());
  }
  const Camera head =
      look_at({0, -12, -12}, {0, 0, 12}, {0, -1, 0}, 90, 3660 / how.shrink, 3200 / how.shrink);
  const auto eyes = stereo::make_rig(head, {.ipd = 0.064}).views;
  const auto timed = [&](const char* what, render::Frame& frame, const auto& before) {
    std::vector<double> cpu_ms;
    Json json = time(
        [&] {
          before(frame);
          Report report = frame.draw(eyes, how.settings);
          cpu_ms.push_back(report.plan_ms + report.upload_ms + report.submit_ms);
          return report;
        },
        how);
    json["cpu_ms"] = quantile(cpu_ms, 0.5);
    print_row("crowd", "all", what, json);
    return json;
  };
  Json json = {{"scene", "crowd"}, {"gpu", context->renderer()}};
  {
    render::Frame whole(*context, merged, how.settings.precision);
    json["merged"] = timed("merged", whole, [](render::Frame&) {});
  }
  render::Frame frame(on_gpu);
  frame.place(crowd);
  json["instances"] = timed("instances at rest", frame, [](render::Frame&) {});
  double radians = 0.0;
  json["moving"] = timed("instances", frame, [&](render::Frame& moved) {
    turn(radians += 0.01);
    moved.place(crowd);
  });
  const auto of = [&](const char* what, const char* of_it) { return json[what][of_it].get<double>(); };
  fmt::print("  instances over merged: GPU {:.3f}; CPU {:.3f} ms, {:.3f} moving, merged {:.3f}\n",
             of("instances", "frame") / of("merged", "frame"), of("instances", "cpu_ms"),
             of("moving", "cpu_ms"), of("merged", "cpu_ms"));
  return json;
}

}  // namespace
}  // namespace binosplat

int main(int argc, char** argv) {
  using namespace binosplat;
  CLI::App app("One case of the benchmark on this machine's GPU.");
  std::string name;
  std::string scenes;
  std::string views;
  std::string json;
  std::string precision = "full", order = "depth", projection = "affine";
  How how;
  how.settings.has_depths = false;
  bool list = false;
  app.add_flag("--list", list, "Print the names of the cases and end");
  app.add_option("case", name, "A name from --list");
  app.add_option("--scenes", scenes, "Folder of the unpacked scenes");
  app.add_option("--views", views, "Folder of the bench views (SCENE_bench.json)");
  app.add_option("--shader-dir", how.shaders, "Read shaders from this folder, not the built-in ones");
  app.add_flag("!--no-subgroups", how.subgroups, "Draw as GPUs do whose subgroups have not 32 invocations");
  app.add_option("--json", json, "Append the result to this file, one line");
  app.add_option("--frames", how.frames, "Frames that the medians are of");
  app.add_option("--shrink", how.shrink,
                 "Pictures so many times smaller: tries the benchmark itself where there is no GPU");
  app.add_option("--precision", precision, "full or half")->check(CLI::IsMember({"full", "half"}));
  app.add_option("--order", order, "depth or distance")->check(CLI::IsMember({"depth", "distance"}));
  app.add_option("--projection", projection, "affine or tangent")
      ->check(CLI::IsMember({"affine", "tangent"}));
  std::vector<double> foveate;
  app.add_option(
         "--foveate", foveate,
         "Time the pair foveated, too: degrees of the inset and the context's share of the pixels along "
         "each axis, as in 20,0.4; then, if at all, the gaze, degrees to the right and up")
      ->delimiter(',')
      ->expected(2, 4);
  app.add_option("--tolerance", how.settings.tolerance,
                 "Of --threshold squared, for all but insets: the pair is timed by it, too");
  CLI11_PARSE(app, argc, argv);
  if (how.settings.tolerance) how.settings.threshold = Threshold::squared;
  if (foveate.size() > 1) how.foveate = {.inset_degrees = foveate[0], .context_scale = foveate[1]};
  if (foveate.size() > 3) how.foveate->gaze = {{foveate[2], foveate[3]}};
  how.settings.precision = find_choice("--precision", precision, precision_choices);
  how.settings.order = find_choice<Order>("--order", order, order_choices);
  how.settings.projection = find_choice<Projection>("--projection", projection, projection_choices);
  try {
    if (list) fmt::print("crowd\n");
    if (name == "crowd") {
      const Json result = run_crowd(how);
      if (!json.empty()) std::ofstream(json, std::ios::app) << result.dump() << "\n";
      return 0;
    }
    for (const Case& c : cases) {
      if (list) fmt::print("{}\n", c.name);
      if (list || c.name != name) continue;
      if (!c.model.empty() && !fs::exists(fs::path(scenes) / c.model)) {
        fmt::print("{} left out: there is no {}\n", c.name, (fs::path(scenes) / c.model).string());
        return 0;
      }
      const Json result = run(c, scenes, views, how);
      if (!json.empty()) std::ofstream(json, std::ios::app) << result.dump() << "\n";
      return 0;
    }
    if (!list) fail("no case named '{}': see --list", name);
  } catch (const std::exception& error) {
    fmt::print(stderr, "gpu_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
