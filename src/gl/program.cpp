#include "gl/program.h"

#include <array>
#include <utility>

#include "base/error.h"

namespace binosplat::gl {

namespace {

template <typename Visit>
void for_each_resource(const Functions& gl, std::uint32_t program, GLenum kind, GLenum property,
                       const Visit& visit) {
  std::int32_t count = 0;
  gl.GetProgramInterfaceiv(program, kind, GL_ACTIVE_RESOURCES, &count);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    std::array<char, 64> name{};
    std::int32_t value = 0;
    gl.GetProgramResourceName(program, kind, i, name.size(), nullptr, name.data());
    gl.GetProgramResourceiv(program, kind, i, 1, &property, 1, nullptr, &value);
    visit(name.data(), value);
  }
}

}  // namespace

Program::Program(const Functions& gl, const std::string& name, const Defines& defines,
                 const std::filesystem::path& folder, const ProgramCache& cache)
    : gl_(&gl), name_(name), id_(gl.CreateProgram()) {
  std::vector<std::pair<GLenum, ShaderSource>> shaders;
  const bool draws = name.ends_with(".frag");
  if (draws) shaders.emplace_back(GL_VERTEX_SHADER, ShaderSource("whole.vert", {}, folder));
  shaders.emplace_back(draws ? GL_FRAGMENT_SHADER : GL_COMPUTE_SHADER, ShaderSource(name, defines, folder));
  std::string text;
  for (const auto& [kind, source] : shaders) text += source.text();
  if (!cache.load(gl, id_, text)) {
    for (const auto& [kind, source] : shaders) compile(kind, source);
    link(shaders.back().second);
    cache.store(gl, id_, text);
  }
  gl.ObjectLabel(GL_PROGRAM, id_, -1, name_.c_str());
  if (!draws) read_local_size();
  reflect();
}

Program::~Program() {
  if (id_ != 0) gl_->DeleteProgram(id_);
}

Program::Program(Program&& other) noexcept
    : gl_(other.gl_),
      name_(std::move(other.name_)),
      id_(std::exchange(other.id_, 0)),
      local_size_(other.local_size_),
      blocks_(std::move(other.blocks_)),
      uniforms_(std::move(other.uniforms_)) {}

void Program::compile(GLenum kind, const ShaderSource& source) {
  const std::uint32_t shader = gl_->CreateShader(kind);
  const char* text = source.text().c_str();
  gl_->ShaderSource(shader, 1, &text, nullptr);
  gl_->CompileShader(shader);
  gl_->AttachShader(id_, shader);
  std::int32_t compiled = 0;
  gl_->GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  std::string log(1 << 16, '\0');
  std::int32_t length = 0;
  if (compiled == 0) gl_->GetShaderInfoLog(shader, static_cast<int>(log.size()), &length, log.data());
  gl_->DeleteShader(shader);
  if (compiled == 0) refuse("compile", log.substr(0, static_cast<std::size_t>(length)), source);
}

void Program::link(const ShaderSource& source) {
  gl_->ProgramParameteri(id_, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  gl_->LinkProgram(id_);
  std::int32_t linked = 0;
  gl_->GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked != 0) return;
  std::string log(1 << 16, '\0');
  std::int32_t length = 0;
  gl_->GetProgramInfoLog(id_, static_cast<int>(log.size()), &length, log.data());
  refuse("link", log.substr(0, static_cast<std::size_t>(length)), source);
}

void Program::refuse(const char* what, const std::string& log, const ShaderSource& source) {
  gl_->DeleteProgram(std::exchange(id_, 0));
  throw Error(ExitCode::no_gl,
              fmt::format("shader {} does not {}:\n{}", name_, what, source.with_file_names(log)));
}

void Program::read_local_size() {
  std::array<std::int32_t, 3> size{};
  gl_->GetProgramiv(id_, GL_COMPUTE_WORK_GROUP_SIZE, size.data());
  local_size_ = static_cast<std::uint32_t>(size[0] * size[1] * size[2]);
}

void Program::reflect() {
  const auto add_blocks = [&](GLenum kind, GLenum target) {
    for_each_resource(*gl_, id_, kind, GL_BUFFER_BINDING, [&](const char* name, std::int32_t binding) {
      blocks_.push_back({name, static_cast<std::uint32_t>(binding), target});
    });
  };
  add_blocks(GL_SHADER_STORAGE_BLOCK, GL_SHADER_STORAGE_BUFFER);
  add_blocks(GL_UNIFORM_BLOCK, GL_UNIFORM_BUFFER);
  // Images are bound to units, not given values, and a block's members have no location.
  for_each_resource(*gl_, id_, GL_UNIFORM, GL_TYPE, [&](const char* name, std::int32_t type) {
    const std::int32_t location = gl_->GetUniformLocation(id_, name);
    if (type != GL_IMAGE_2D && location >= 0) uniforms_.push_back({name, location});
  });
}

}  // namespace binosplat::gl
