// A program with its own OpenGL context and textures. binosplat draws both eyes into them, from poses and
// angles as OpenXR gives them. embed MODEL.ply FOLDER writes FOLDER/left.png and right.png.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <binosplat/renderer.h>
#include <png.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

// Every VR application has a current OpenGL 4.5 core context. This one needs no window.
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
  GLuint textures[2];  // in place of the images of an OpenXR swapchain
  glCreateTextures(GL_TEXTURE_2D, 2, textures);
  for (const GLuint texture : textures) glTextureStorage2D(texture, 1, GL_SRGB8_ALPHA8, width, height);

  const binosplat::SplatModel model(argv[1]);
  binosplat::Renderer renderer(eglGetProcAddress, model);
  // Set these in each frame: poses and angles from xrLocateViews, here 49 degrees outwards and 37 inwards,
  // and this frame's textures.
  const binosplat::Eye left = {.position = {-0.0315, 1.6, 0.0}, .fov = {-0.855, 0.646, 0.7, -0.7}};
  const binosplat::Eye right = {.position = {0.0315, 1.6, 0.0}, .fov = {-0.646, 0.855, 0.7, -0.7}};
  const std::array views = {binosplat::View{left, {width, height}, {.texture = textures[0]}},
                            binosplat::View{right, {width, height}, {.texture = textures[1]}}};
  // The whole model before a head at rest. Use placement() to put it elsewhere.
  const binosplat::Placement placement = model.framing(left.fov, {0.0, 1.6, 0.0});
  // Without a threshold, pictures are exact. AdaGScale leaves out what 40 dB allow, and is faster.
  renderer.draw(views, placement,
                {.background = glm::vec3(0.0f), .threshold = binosplat::Threshold::adagscale});

  for (int eye = 0; eye < 2; ++eye) {
    std::vector<unsigned char> bytes(3 * width * height);
    glGetTextureImage(textures[eye], 0, GL_RGB, GL_UNSIGNED_BYTE, 3 * width * height, bytes.data());
    const std::string path = std::string(argv[2]) + (eye == 0 ? "/left.png" : "/right.png");
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGB};
    // Negative stride: OpenGL's rows start at the bottom.
    if (png_image_write_to_file(&image, path.c_str(), 0, bytes.data(), -3 * width, nullptr) == 0)
      throw std::runtime_error(path + ": " + image.message);
    std::printf("%s: %d x %d px\n", path.c_str(), width, height);
  }
} catch (const std::exception& error) {  // binosplat::Error also has an exit code
  std::fprintf(stderr, "embed: %s\n", error.what());
  return 2;
}
