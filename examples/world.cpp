// A program that draws two models in one world: a room, and a knot that stands in it three times and turns
// from frame to frame. world ROOM.ply FOLDER [FRAMES] writes FOLDER/left.png and right.png.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <binosplat/renderer.h>
#include <png.h>

#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

constexpr int width = 480, height = 450;

// Every VR application has a current OpenGL 4.5 core context. This one needs no window.
void make_context() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

// A trefoil knot about the origin, 1 unit wide, of round Gaussians whose colour goes around the rainbow.
binosplat::SplatModel knot() {
  constexpr std::size_t count = 900;
  std::vector<glm::vec3> means, colours;
  for (std::size_t k = 0; k < count; ++k) {
    const float t = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / count;
    means.push_back(
        glm::vec3(std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -std::sin(3 * t)) /
        6.0f);
    colours.push_back(1.6f * glm::cos(t + glm::vec3(0.0f, 2.1f, 4.2f)));  // coefficients of degree 0
  }
  const std::vector<glm::vec4> quats(count, {1, 0, 0, 0});
  const std::vector<glm::vec3> scales(count, glm::vec3(0.022f));
  const std::vector<float> opacities(count, 0.95f);
  return binosplat::SplatModel({means, quats, scales, opacities, colours}, "knot");
}

void write_png(const std::string& path, GLuint texture) {
  std::vector<unsigned char> bytes(3 * width * height);
  glGetTextureImage(texture, 0, GL_RGB, GL_UNSIGNED_BYTE, 3 * width * height, bytes.data());
  png_image image = {
      .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGB};
  // Negative stride: OpenGL's rows start at the bottom.
  if (png_image_write_to_file(&image, path.c_str(), 0, bytes.data(), -3 * width, nullptr) == 0)
    throw std::runtime_error(path + ": " + image.message);
  std::printf("%s: %d x %d px\n", path.c_str(), width, height);
}

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 4) return std::fprintf(stderr, "usage: world ROOM.ply FOLDER [FRAMES]\n"), 2;
  make_context();
  GLuint textures[2];
  glCreateTextures(GL_TEXTURE_2D, 2, textures);
  binosplat::View views[2];
  for (int k = 0; k < 2; ++k) {
    glTextureStorage2D(textures[k], 1, GL_SRGB8_ALPHA8, width, height);
    binosplat::Eye eye = {.position = {k == 0 ? -0.0315 : 0.0315, 0.0, 0.0}};
    eye.fov = {k == 0 ? -0.7 : -0.52, k == 0 ? 0.52 : 0.7, 0.59, -0.59};
    views[k] = {eye, {width, height}, {.texture = textures[k]}};
  }
  binosplat::Renderer renderer(eglGetProcAddress);
  const binosplat::ModelId room = renderer.add(binosplat::SplatModel(argv[1])), ring = renderer.add(knot());
  // A head that stands in the room, 1.3 world units above its floor.
  const binosplat::Placement head = {.origin = {0.0, -1.3, -1.4}};
  std::vector<binosplat::Instance> instances = {
      {.model = room},
      {.model = ring, .translation = {-0.55, -1.35, 0.5}, .scale = 0.8},
      {.model = ring, .translation = {0.3, -1.15, -0.3}, .scale = 0.25},  // small, as in a hand
      {.model = ring, .translation = {0.1, -0.75, 0.4}, .scale = 0.7, .opacity = 0.1f}};
  double turn = 0.4;  // radians
  for (int frame = argc > 3 ? std::stoi(argv[3]) : 3; frame > 0; --frame) {
    for (std::size_t k = 1; k < instances.size(); ++k) {
      instances[k].rotation =
          glm::dmat3(glm::rotate(glm::dmat4(1), turn * static_cast<double>(k), {0.2, 1, 0}));
    }
    renderer.submit(views, binosplat::World{head, instances}, {.background = glm::vec3(0.0f)});
    turn += 0.05;  // for the next frame, while the GPU draws
    renderer.finish();
  }
  write_png(std::string(argv[2]) + "/left.png", textures[0]);
  write_png(std::string(argv[2]) + "/right.png", textures[1]);
} catch (const std::exception& error) {  // binosplat::Error also has an exit code
  return std::fprintf(stderr, "world: %s\n", error.what()), 2;
}
