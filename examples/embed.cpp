// A program with an OpenGL context and textures of its own that has binosplat draw both eyes into them, from
// the poses and angles that OpenXR gives: embed MODEL.ply FOLDER leaves FOLDER/left.png and right.png.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <cstdio>

#include "binosplat/formats/image_file.h"
#include "binosplat/formats/model_file.h"
#include "binosplat/stereo/embed.h"

using namespace binosplat;

// What a VR application has anyway: an OpenGL 4.5 core context that is current. Here without a window.
void make_context() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: embed MODEL.ply FOLDER\n"), 2;
  make_context();
  constexpr int width = 320, height = 300;
  GLuint textures[2];  // as the images of an OpenXR swapchain
  glCreateTextures(GL_TEXTURE_2D, 2, textures);
  for (const GLuint texture : textures) glTextureStorage2D(texture, 1, GL_SRGB8_ALPHA8, width, height);

  const Model model = load_model(argv[1]);
  stereo::EmbeddedRenderer renderer(eglGetProcAddress, model);
  // Each frame: xrLocateViews' poses and angles, 49 degrees outwards and 37 inwards, into this frame's
  // textures.
  const stereo::Fov left = {-0.855, 0.646, 0.7, -0.7}, right = {-0.646, 0.855, 0.7, -0.7};
  const std::array<stereo::XrEye, 2> eyes = {stereo::XrEye{.position = {-0.0315, 1.6, 0.0}, .fov = left},
                                             stereo::XrEye{.position = {0.0315, 1.6, 0.0}, .fov = right}};
  const stereo::Stage stage = stereo::stage_of(model, {0.0, 1.6, 0.0});  // the floor lies 1.6 below the origin
  const glm::ivec2 size(width, height);
  const stereo::EyePair pair = stereo::eyes_from_xr(eyes, stage, {size, size});
  const stereo::Target targets[] = {{.texture = textures[0]}, {.texture = textures[1]}};
  renderer.draw(pair.views, targets, LAYOUT_SEPARATE, glm::vec3(0.0f));

  for (int eye = 0; eye < 2; ++eye) {
    std::vector<unsigned char> bytes(4 * width * height);
    glGetTextureImage(textures[eye], 0, GL_RGBA, GL_UNSIGNED_BYTE, 4 * width * height, bytes.data());
    Image image(width, height, 3);
    for (int k = 0; k < 3 * width * height; ++k) {  // OpenGL's rows begin below
      const int pixel = k / 3, row = height - 1 - pixel / width;
      image.data[k] = bytes[4 * (row * width + pixel % width) + k % 3] / 255.0f;
    }
    save_png(std::string(argv[2]) + (eye == 0 ? "/left.png" : "/right.png"), image);
  }
} catch (const std::exception& error) {  // binosplat::Error tells which kind, too
  std::fprintf(stderr, "embed: %s\n", error.what());
  return 2;
}
