// levels_program FOLDER uses only the installed headers. It draws a stream's levels with an inset and a mesh,
// within a budget. It prints the number of Gaussians at first and at last, then how many pixels splats
// changed in the half that the mesh leaves open, and in the half that the mesh covers, without its edge.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <binosplat/stream.h>

#include <array>
#include <cstdio>
#include <vector>

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);

  constexpr int width = 64, height = 60;
  GLuint colours[2], depths[2];
  glCreateTextures(GL_TEXTURE_2D, 2, colours);
  glCreateTextures(GL_TEXTURE_2D, 2, depths);
  for (int k = 0; k < 2; ++k) {
    glTextureStorage2D(colours[k], 1, GL_RGBA8, width, height);
    glTextureStorage2D(depths[k], 1, GL_DEPTH_COMPONENT32F, width, height);
    std::vector<float> wall;  // depths of a wall at the near plane that covers the left half
    for (int n = 0; n < width * height; ++n) wall.push_back(n % width < width / 2 ? 0.0f : 1.0f);
    glTextureSubImage2D(depths[k], 0, 0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, wall.data());
  }

  binosplat::SplatStream stream(argv[1], {.quality = 38.0});
  binosplat::Renderer renderer(eglGetProcAddress, stream);
  const binosplat::Placement placement = stream.placement({0.0, -1.6, 0.0});
  binosplat::FrameBudget budget(1e6);
  binosplat::Settings settings;
  settings.foveation = binosplat::Foveation{.inset_degrees = 20.0, .gaze = {{3.0, 2.0}}};
  const std::size_t at_first = stream.count();
  std::array<binosplat::View, 2> views;
  for (int n = 0; n < 500 && (n < 2 || !stream.settled()); ++n) {
    settings.quality = budget.effort().quality;
    for (std::size_t k = 0; k < 2; ++k) {
      const float grey[] = {0.5f, 0.5f, 0.5f, 1.0f};
      glClearTexImage(colours[k], 0, GL_RGBA, GL_FLOAT, grey);
      const double x = k == 0 ? -0.032 : 0.032;
      views[k] = {{.position = {x, 0.0, 0.0}, .fov = {-0.7, 0.7, 0.65, -0.65}},
                  {width, height},
                  {.texture = colours[k]}};
      views[k].mesh_depth = {.texture = depths[k], .near_plane = 0.1, .far_plane = 1000.0};
    }
    stream.begin_frame(views, placement, settings, 2.5);
    renderer.submit(views, placement, settings);
    budget.took(renderer.finish(), 11.1);
  }
  std::vector<unsigned char> bytes(4 * width * height);
  glGetTextureImage(colours[1], 0, GL_RGBA, GL_UNSIGNED_BYTE, 4 * width * height, bytes.data());
  int open = 0, covered = 0;
  for (int n = 0; n < width * height; ++n) {
    const bool is_changed = bytes[4 * n] != 128 || bytes[4 * n + 1] != 128 || bytes[4 * n + 2] != 128;
    // Outside the inset, edges have the resolution of the context, so a few pixels next to the edge do not
    // count.
    if (n % width < width / 2 - 4) covered += is_changed ? 1 : 0;
    if (n % width >= width / 2) open += is_changed ? 1 : 0;
  }
  std::printf("%zu %zu %d %d\n", at_first, stream.count(), open, covered);
} catch (const std::exception& error) {
  std::fprintf(stderr, "levels_program: %s\n", error.what());
  return 2;
}
