// present_bench measures the GPU time of layouts and of the preview's widgets without the frame itself,
// through EGL, at a headset's resolution. `--shrink 8` makes it fast enough for software rendering.

#include <fmt/format.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/statistics.h"
#include "demo/demo.h"
#include "formats/cameras_file.h"
#include "formats/model_file.h"
#include "preview/panel.h"
#include "stereo/layout.h"

namespace binosplat {
namespace {

// Returns the median GPU time of `draw`, ms.
template <typename Draw>
double time(gl::Dispatcher& dispatcher, int frames, const Draw& draw) {
  std::vector<double> times;
  for (int n = -3; n < frames; ++n) {  // The first three draws warm up.
    dispatcher.begin_frame();
    dispatcher.begin_stage("present");
    draw();
    dispatcher.end_frame();
    const double ms = dispatcher.wait_and_time().front().ms;
    if (n >= 0) times.push_back(ms);
  }
  return quantile(times, 0.5);
}

struct Bench {
  std::unique_ptr<gl::Context> context = gl::Context::open();
  gl::Dispatcher dispatcher{*context};
  int frames;

  // Returns a new texture and a framebuffer that draws into it.
  std::pair<std::uint32_t, std::uint32_t> target(const glm::ivec2& size, GLenum format = GL_RGBA8) {
    std::uint32_t texture = 0, framebuffer = 0;
    context->gl().CreateTextures(GL_TEXTURE_2D, 1, &texture);
    context->gl().TextureStorage2D(texture, 1, format, size.x, size.y);
    context->gl().CreateFramebuffers(1, &framebuffer);
    context->gl().NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
    return {texture, framebuffer};
  }

  void layouts(const Model& model, const Camera& head) {
    render::Frame frame(*context, model);
    const auto report = frame.draw(stereo::make_rig(head, {}).views);
    fmt::print("A frame of {} x {} px an eye: {:.3f} ms\n\n", head.width, head.height, report.total_ms);
    fmt::print("| layout | into a texture | into one of sRGB | into a framebuffer |\n|---|---|---|---|\n");
    stereo::Presenter presenter(*context);
    for (int layout = LAYOUT_PARALLEL; layout <= LAYOUT_GREY; ++layout) {
      const glm::ivec2 size = stereo::layout_size(layout, {head.width, head.height});
      fmt::print("| {} ", layout_choices[layout].name);
      const auto print = [&](const Target& to) {
        fmt::print("| {:.3f} ", time(dispatcher, frames, [&] { presenter.draw(frame, 0, layout, to); }));
      };
      const auto [texture, framebuffer] = target(size);
      print({.texture = texture});
      print({.texture = target(size, GL_SRGB8_ALPHA8).first});
      print({.framebuffer = framebuffer});
      fmt::print("|\n");
    }
  }

  // Measures a headset's frame: GPU times with and without textures for colours and depths, measured in turn.
  void headset(const std::string& name, const Model& model, const Camera& head) {
    render::Frame frame(*context, model);
    const auto views = stereo::make_rig(head, {}).views;
    stereo::Presenter presenter(*context);
    const glm::ivec2 size(head.width, head.height), few = (size + 3) / 4, fewest = (size + 7) / 8;
    std::array<Target, 2> colours;
    std::array<DepthTarget, 2> depths, eighth, whole;
    const auto depth_texture = [&](const glm::ivec2& of) {
      std::uint32_t texture = 0;
      context->gl().CreateTextures(GL_TEXTURE_2D, 1, &texture);
      context->gl().TextureStorage2D(texture, 1, GL_DEPTH_COMPONENT32F, of.x, of.y);
      return texture;
    };
    for (std::size_t eye = 0; eye < 2; ++eye) {
      colours[eye].texture = target(size, GL_SRGB8_ALPHA8).first;
      depths[eye].texture = depth_texture(few);
      eighth[eye].texture = depth_texture(fewest);
      whole[eye].texture = depth_texture(size);
    }
    // The three kinds of frames draw into the frame's own buffers, or into the headset's textures with the
    // mean or the median depth.
    std::array<std::vector<double>, 3> times;
    for (int n = -3; n < frames; ++n) {
      for (std::size_t kind = 0; kind < 3; ++kind) {
        const stereo::Canvases canvases = presenter.canvases(colours, glm::vec3(0.0f));
        const std::span<const render::Canvas> list =
            kind == 0 ? std::span<const render::Canvas>() : std::span<const render::Canvas>(canvases.list);
        const double ms = frame
                              .draw(views, {.depth = kind == 2 ? Depth::median : Depth::mean}, {},
                                    {.canvases = list, .depth_rows = 2})
                              .total_ms;
        if (n >= 0) times[kind].push_back(ms);
      }
    }
    const auto of_depths = [&](std::span<const DepthTarget> to) {
      return time(dispatcher, frames, [&] {
        for (std::size_t eye = 0; eye < 2; ++eye) presenter.draw_depth(frame, eye, to[eye]);
      });
    };
    const double alone = quantile(times[0], 0.5), mean = quantile(times[1], 0.5),
                 median = quantile(times[2], 0.5);
    const double quarter = of_depths(depths), least = of_depths(eighth), all = of_depths(whole);
    frame.draw(views);
    const double presented = time(dispatcher, frames, [&] {
      for (std::size_t eye = 0; eye < 2; ++eye) presenter.draw(frame, eye, LAYOUT_SEPARATE, colours[eye]);
    });
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:+.3f} |\n", name,
               alone, presented, mean, median, quarter, least, all, median + least - alone);
  }

  // Measures a layout for a framebuffer that no compute shader can write, as for a window of 1920 x 1080 px.
  void copied(const Model& model, const Camera& head) {
    render::Frame frame(*context, model);
    frame.draw(stereo::make_rig(resized(head, 960, 1080), {}).views);
    // Images cannot have the format GL_RGB8.
    const std::uint32_t framebuffer = target({1920, 1080}, GL_RGB8).second;
    stereo::Presenter presenter(*context);
    const double ms = time(dispatcher, frames,
                           [&] { presenter.draw(frame, 0, LAYOUT_PARALLEL, {.framebuffer = framebuffer}); });
    fmt::print("\nparallel into a framebuffer of 1920 x 1080 px, copied: {:.3f} ms\n", ms);
  }

  // Measures the widgets in a window of 1920 x 1080 px. The session's frames are small.
  void widgets(Model model, const Camera& head) {
    preview::Choices choices;
    choices.grid = choices.cameras = true;
    preview::Session session(*context, std::move(model), {{head}, {0, -1, 0}}, choices, ".");
    session.resize({64, 64});
    for (int n = 0; n < 130; ++n) {
      session.change();
      session.draw();
    }
    const glm::ivec2 size(1920, 1080);
    context->gl().BindFramebuffer(GL_DRAW_FRAMEBUFFER, target(size).second);
    ImGui::CreateContext();
    ImGui::GetIO().DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplOpenGL3_Init("#version 450 core");
    preview::Panel panel;
    const double ms = time(dispatcher, frames, [&] {
      ImGui_ImplOpenGL3_NewFrame();
      ImGui::NewFrame();
      panel.draw(session);
      ImGui::Render();
      ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    });
    if (ImGui::GetDrawData()->TotalVtxCount == 0) fail("the widgets were not drawn");
    fmt::print("\nThe widgets in {} x {} px: {:.3f} ms\n", size.x, size.y, ms);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
  }
};

namespace fs = std::filesystem;

void run(int frames, int shrink, const std::vector<std::string>& models, const std::string& shaders) {
  Bench bench{.frames = frames};
  if (!shaders.empty()) bench.context->set_shader_folder(shaders);
  fmt::print("{}, {}, medians in ms\n\n", bench.context->renderer(), bench.context->version());
  Demo demo = demo_room();
  const Camera headset = stereo::apply_preset(demo.cameras.at(0), "headset");
  const Camera head = resized(headset, headset.width / shrink / 2 * 2, headset.height / shrink);
  bench.layouts(demo.model, head);
  fmt::print(
      "\n| both eyes for a headset | frame alone | then presented | into textures, mean depth | median | "
      "depths, 1/4 of the sides | 1/8 | whole | the headset adds |\n|---|---|---|---|---|---|---|---|---|\n");
  bench.headset("demo:room", demo.model, head);
  for (const std::string& file : models) {
    const Model model = load_model(file);
    const Camera camera = load_cameras(fs::path(file).parent_path() / "cameras.json").at(0);
    const Camera whole = stereo::apply_preset(camera, "headset");
    bench.headset(fs::path(file).filename().string(), model, resized(whole, head.width, head.height));
  }
  bench.copied(demo.model, headset);
  bench.widgets(std::move(demo.model), head);
}

}  // namespace
}  // namespace binosplat

int main(int argc, char** argv) {
  CLI::App app("What layouts and the preview's widgets take beyond the frame.");
  int frames = 50, shrink = 1;
  app.add_option("--frames", frames, "Frames that the medians are of")->check(CLI::Range(1, 10000));
  app.add_option("--shrink", shrink, "Pictures so many times smaller")->check(CLI::Range(1, 64));
  std::vector<std::string> models;
  app.add_option("MODEL", models, "Models to draw for a headset, too, each beside its cameras.json");
  std::string shaders;
  app.add_option("--shader-dir", shaders, "Read the shaders there");
  CLI11_PARSE(app, argc, argv);
  try {
    binosplat::run(frames, shrink, models, shaders);
  } catch (const std::exception& error) {
    fmt::print(stderr, "present_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
