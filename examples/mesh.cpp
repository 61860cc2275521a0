// A program that draws its own meshes with OpenGL. binosplat draws a model's splats among them, so that both
// occlude each other. mesh MODEL.ply FOLDER writes FOLDER/left.png and right.png.
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <binosplat/renderer.h>
#include <png.h>

#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>
#include <string>
#include <vector>

constexpr int width = 480, height = 450;
constexpr double near_m = 0.1, far_m = 100.0;  // planes of the meshes' projection, in metres

// Every VR application has a current OpenGL 4.5 core context. This one needs no window.
void make_context() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  eglInitialize(display, nullptr, nullptr);
  eglBindAPI(EGL_OPENGL_API);
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

// The meshes are scaled unit boxes. Their colours are linear; GL_FRAMEBUFFER_SRGB converts them to the sRGB
// values of the texture, in which binosplat blends.
const char* const shaders[] = {R"(#version 450 core
layout(location = 0) uniform mat4 clip_from_box;
layout(location = 1) uniform vec3 colour;
const vec2 corners[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
out vec3 light;
void main() {
  int axis = gl_VertexID / 12;
  vec3 corner = vec3(gl_VertexID % 12 < 6 ? 0.5 : -0.5);
  corner[(axis + 1) % 3] = 0.5 * corners[gl_VertexID % 6].x;
  corner[(axis + 2) % 3] = 0.5 * corners[gl_VertexID % 6].y;
  light = colour * vec3(0.7, 1.0, 0.3)[axis];
  gl_Position = clip_from_box * vec4(corner, 1);
})",
                               R"(#version 450 core
in vec3 light; out vec4 fragment;
void main() { fragment = vec4(light, 1); })"};

void use_program() {
  const GLuint program = glCreateProgram();
  for (int k = 0; k < 2; ++k) {
    const GLuint shader = glCreateShader(k == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &shaders[k], nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  glUseProgram(program);
}

void draw_box(const glm::mat4& clip_from_box, const glm::vec3& colour) {
  glUniformMatrix4fv(0, 1, GL_FALSE, &clip_from_box[0].x);
  glUniform3fv(1, 1, &colour.x);
  glDrawArrays(GL_TRIANGLES, 0, 36);
}

// Transforms from the space of the eyes' poses into the eye's own, and projects by its four angles.
glm::dmat4 clip_from_eyes(const binosplat::Eye& eye) {
  const auto [left, right, up, down] = eye.fov;
  const glm::dvec4 side = near_m * glm::tan(glm::dvec4(left, right, down, up));
  const glm::dmat4 projection = glm::frustum(side.x, side.y, side.z, side.w, near_m, far_m);
  const glm::dquat turn(eye.orientation.w, eye.orientation.x, eye.orientation.y, eye.orientation.z);
  return projection * glm::inverse(glm::translate(glm::dmat4(1), eye.position) * glm::mat4_cast(turn));
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
  if (argc != 3 && argc != 4 && argc != 10)
    return std::fprintf(stderr, "usage: mesh MODEL.ply FOLDER [FRAMES [HEAD_X Y Z CUBE_X Y Z]]\n"), 2;
  const binosplat::SplatModel model(argv[1]);
  // Cube and head, in the model's world. By default the cube is in the middle of the model, the head in front
  // of it.
  binosplat::Placement placement = model.placement();
  const auto [low, high] = model.bounds();
  const glm::dvec3 back = placement.axes[2];
  glm::dvec3 cube = 0.5 * (low + high);
  placement.origin = cube + 1.2 * back * glm::dot(glm::abs(back), glm::dvec3(high - low));
  for (int k = 0; argc == 10 && k < 3; ++k) {
    placement.origin[k] = std::stod(argv[4 + k]);
    cube[k] = std::stod(argv[7 + k]);
  }
  // The cube in the eyes' space, in metres. The head is at the origin and looks at the cube.
  cube = glm::transpose(placement.axes) * (cube - placement.origin) / placement.units_per_metre;
  const glm::dquat q = glm::quatLookAt(glm::normalize(cube), glm::dvec3(0, 1, 0));
  const glm::dmat4 there = glm::scale(glm::translate(glm::dmat4(1), cube), glm::dvec3(0.22 * length(cube)));
  make_context();
  binosplat::Renderer renderer(eglGetProcAddress, model);
  GLuint vertices, colours[2], depths[2], framebuffers[2];
  glCreateVertexArrays(1, &vertices);
  glCreateTextures(GL_TEXTURE_2D, 2, colours);
  glCreateTextures(GL_TEXTURE_2D, 2, depths);
  glCreateFramebuffers(2, framebuffers);
  binosplat::View views[2];
  for (int k = 0; k < 2; ++k) {
    glTextureStorage2D(colours[k], 1, GL_SRGB8_ALPHA8, width, height);
    glTextureStorage2D(depths[k], 1, GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferTexture(framebuffers[k], GL_COLOR_ATTACHMENT0, colours[k], 0);
    glNamedFramebufferTexture(framebuffers[k], GL_DEPTH_ATTACHMENT, depths[k], 0);
    binosplat::Eye eye = {q * glm::dvec3(k == 0 ? -0.0315 : 0.0315, 0, 0), {q.x, q.y, q.z, q.w}};
    eye.fov = {k == 0 ? -0.7 : -0.52, k == 0 ? 0.52 : 0.7, 0.59, -0.59};
    views[k] = {eye, {width, height}, {.texture = colours[k]}};
    views[k].mesh_depth = {.texture = depths[k],  // its planes are in world units
                           .near_plane = near_m * placement.units_per_metre,
                           .far_plane = far_m * placement.units_per_metre};
  }
  use_program();  // set once: binosplat preserves all state
  glBindVertexArray(vertices);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glViewport(0, 0, width, height);
  glClearColor(0.2f, 0.2f, 0.2f, 1);
  double turn = 0.2;  // of the cube, in radians
  for (int frame = argc > 3 ? std::stoi(argv[3]) : 3; frame > 0; --frame) {
    for (int k = 0; k < 2; ++k) {
      glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[k]);
      glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      const glm::dmat4 clip = clip_from_eyes(views[k].eye);
      draw_box(clip * glm::rotate(there, turn, {0, 1, 0}), {0.9f, 0.25f, 0.03f});
      draw_box(clip * glm::scale(glm::translate(there, {0, -0.53, 0}), {1.8, 0.06, 1.8}),
               {0.3f, 0.35f, 0.4f});
    }
    renderer.submit(views, placement);  // the GPU draws the splats among the meshes,
    turn += 0.05;                       // and the CPU meanwhile turns the cube for the next frame
    renderer.finish();
  }
  write_png(std::string(argv[2]) + "/left.png", colours[0]);
  write_png(std::string(argv[2]) + "/right.png", colours[1]);
} catch (const std::exception& error) {  // binosplat::Error also has an exit code
  return std::fprintf(stderr, "mesh: %s\n", error.what()), 2;
}
