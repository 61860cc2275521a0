// present_bench: what layouts and the preview's widgets take beyond the frame, on this machine's GPU through
// EGL, at a headset's size. `--shrink 8` tries it where there is no GPU.

#include <fmt/format.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <CLI/CLI.hpp>

#include "base/error.h"
#include "base/statistics.h"
#include "demo/room.h"
#include "preview/panel.h"
#include "stereo/layout.h"

namespace binosplat {
namespace {

// Median GPU time of `draw`, ms.
template <typename Draw>
double time(gl::Dispatcher& dispatcher, int frames, const Draw& draw) {
  std::vector<double> times;
  for (int n = -3; n < frames; ++n) {  // some to warm up
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

  // A texture to draw into, and a framebuffer of it.
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
      const auto print = [&](const stereo::Target& to) {
        fmt::print("| {:.3f} ", time(dispatcher, frames, [&] { presenter.draw(frame, 0, layout, to); }));
      };
      const auto [texture, framebuffer] = target(size);
      print({.texture = texture});
      print({.texture = target(size, GL_SRGB8_ALPHA8).first});
      print({.framebuffer = framebuffer});
      fmt::print("|\n");
    }
  }

  // What a headset's textures take beyond a frame, and what the median of depths does to that.
  void headset(const Model& model, const Camera& head) {
    render::Frame frame(*context, model);
    const auto views = stereo::make_rig(head, {}).views;
    std::array<std::vector<double>, 2> times;  // by depth
    for (int n = -3; n < frames; ++n) {
      for (const Depth depth : {Depth::mean, Depth::median}) {
        const double ms = frame.draw(views, {.depth = depth}).total_ms;
        if (n >= 0) times[static_cast<std::size_t>(depth)].push_back(ms);
      }
    }
    fmt::print("\nBoth eyes for a headset: a frame with the mean depth {:.3f} ms, with the median {:.3f}",
               quantile(times[0], 0.5), quantile(times[1], 0.5));
    stereo::Presenter presenter(*context);
    const glm::ivec2 size(head.width, head.height);
    const auto both = [&](const char* what, const auto& draw) {
      fmt::print("; {} {:.3f}", what, time(dispatcher, frames, [&] {
                   for (std::size_t eye = 0; eye < 2; ++eye) draw(eye);
                 }));
    };
    const std::array colours = {target(size, GL_SRGB8_ALPHA8).first, target(size, GL_SRGB8_ALPHA8).first};
    both("colours",
         [&](std::size_t eye) { presenter.draw(frame, eye, LAYOUT_SEPARATE, {.texture = colours[eye]}); });
    for (const GLenum format : {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT24}) {
      std::array<std::uint32_t, 2> depths{};
      context->gl().CreateTextures(GL_TEXTURE_2D, 2, depths.data());
      for (const std::uint32_t depth : depths)
        context->gl().TextureStorage2D(depth, 1, format, size.x, size.y);
      both(format == GL_DEPTH_COMPONENT24 ? "depths of 24 bits" : "depths of 32 bits",
           [&](std::size_t eye) { presenter.draw_depth(frame, eye, {.texture = depths[eye]}); });
    }
    fmt::print("\n");
  }

  // As into a window of full HD, which no shader can write.
  void copied(const Model& model, const Camera& head) {
    render::Frame frame(*context, model);
    frame.draw(stereo::make_rig(resized(head, 960, 1080), {}).views);
    const std::uint32_t framebuffer = target({1920, 1080}, GL_RGB8).second;  // no image has this format
    stereo::Presenter presenter(*context);
    const double ms = time(dispatcher, frames,
                           [&] { presenter.draw(frame, 0, LAYOUT_PARALLEL, {.framebuffer = framebuffer}); });
    fmt::print("\nparallel into a framebuffer of 1920 x 1080 px, copied: {:.3f} ms\n", ms);
  }

  // The widgets in a window of full HD; the session's frames are small.
  void widgets(Model model, const Camera& head) {
    preview::Choices choices;
    preview::Session session(*context, std::move(model), {head}, {0, -1, 0}, choices, ".");
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

void run(int frames, int shrink) {
  Bench bench{.frames = frames};
  fmt::print("{}, {}, medians in ms\n\n", bench.context->renderer(), bench.context->version());
  Demo demo = demo_room();
  const Camera headset = stereo::apply_preset(demo.cameras.at(0), "headset");
  const Camera head = resized(headset, headset.width / shrink / 2 * 2, headset.height / shrink);
  bench.layouts(demo.model, head);
  bench.headset(demo.model, head);
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
  CLI11_PARSE(app, argc, argv);
  try {
    binosplat::run(frames, shrink);
  } catch (const std::exception& error) {
    fmt::print(stderr, "present_bench: {}\n", error.what());
    return 2;
  }
  return 0;
}
