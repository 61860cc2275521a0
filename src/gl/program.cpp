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

std::string vertex_shader_of(const std::string& fragment_shader) {
  const std::string own = fragment_shader.substr(0, fragment_shader.size() - 4) + "vert";
  return embedded_shaders().contains(own) ? own : "fullscreen.vert";
}

/// Runs the program with 0 work groups. Drivers such as llvmpipe compile a program at its first run, which
/// would otherwise happen in a timed stage.
void run_nothing(const Functions& gl, std::uint32_t program) {
  constexpr std::array<std::uint32_t, 3> groups{};
  std::uint32_t buffer = 0;
  gl.CreateBuffers(1, &buffer);
  gl.NamedBufferStorage(buffer, sizeof(groups), groups.data(), 0);
  gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, buffer);
  gl.UseProgram(program);
  gl.DispatchComputeIndirect(0);
  gl.DeleteBuffers(1, &buffer);
}

}  // namespace

Program::Program(const Functions& gl, const std::string& name, const Defines& defines,
                 const std::filesystem::path& folder, const ProgramCache& cache)
    : gl_(&gl), name_(name), id_(gl.CreateProgram()) {
  std::vector<std::pair<GLenum, ShaderSource>> sources;
  const bool draws = name.ends_with(".frag");
  if (draws) sources.emplace_back(GL_VERTEX_SHADER, ShaderSource(vertex_shader_of(name), {}, folder));
  sources.emplace_back(draws ? GL_FRAGMENT_SHADER : GL_COMPUTE_SHADER, ShaderSource(name, defines, folder));
  for (const auto& [kind, source] : sources) text_ += source.text();
  if (cache.load(gl, id_, text_)) return;
  for (auto& [kind, source] : sources) {
    const std::uint32_t shader = gl.CreateShader(kind);
    const char* text = source.text().c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(id_, shader);
    shaders_.push_back({shader, std::move(source)});
  }
  gl.ProgramParameteri(id_, GL_PROGRAM_BINARY_RETRIEVABLE_HINT, GL_TRUE);
  gl.LinkProgram(id_);
}

void Program::complete(const ProgramCache& cache) {
  if (is_complete_) return;
  if (!shaders_.empty()) {
    for (const Shader& shader : shaders_) check_compiled(shader);
    check_linked();
    for (const Shader& shader : shaders_) gl_->DeleteShader(shader.id);
    shaders_.clear();
    cache.store(*gl_, id_, text_);
  }
  text_.clear();
  gl_->ObjectLabel(GL_PROGRAM, id_, -1, name_.c_str());
  if (!name_.ends_with(".frag")) {
    read_local_size();
    run_nothing(*gl_, id_);
  }
  reflect();
  is_complete_ = true;
}

Program::~Program() {
  for (const Shader& shader : shaders_) gl_->DeleteShader(shader.id);
  if (id_ != 0) gl_->DeleteProgram(id_);
}

Program::Program(Program&& other) noexcept
    : gl_(other.gl_),
      name_(std::move(other.name_)),
      text_(std::move(other.text_)),
      id_(std::exchange(other.id_, 0)),
      shaders_(std::exchange(other.shaders_, {})),
      is_complete_(other.is_complete_),
      local_size_(other.local_size_),
      blocks_(std::move(other.blocks_)),
      uniforms_(std::move(other.uniforms_)) {}

void Program::check_compiled(const Shader& shader) {
  std::int32_t compiled = 0;
  gl_->GetShaderiv(shader.id, GL_COMPILE_STATUS, &compiled);
  if (compiled != 0) return;
  std::string log(1 << 16, '\0');
  std::int32_t length = 0;
  gl_->GetShaderInfoLog(shader.id, static_cast<int>(log.size()), &length, log.data());
  refuse("compile", log.substr(0, static_cast<std::size_t>(length)), shader.source);
}

void Program::check_linked() {
  std::int32_t linked = 0;
  gl_->GetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked != 0) return;
  std::string log(1 << 16, '\0');
  std::int32_t length = 0;
  gl_->GetProgramInfoLog(id_, static_cast<int>(log.size()), &length, log.data());
  refuse("link", log.substr(0, static_cast<std::size_t>(length)), shaders_.back().source);
}

void Program::refuse(const char* what, const std::string& log, const ShaderSource& source) {
  throw Error(ExitCode::no_gl,
              fmt::format("shader {} failed to {}:\n{}", name_, what, source.with_file_names(log)));
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
  // Keeps only values: images and samplers are bound to units instead, and members of a block have no
  // location.
  for_each_resource(*gl_, id_, GL_UNIFORM, GL_TYPE, [&](const char* name, std::int32_t type) {
    const std::int32_t location = gl_->GetUniformLocation(id_, name);
    if (type == GL_UNSIGNED_INT && location >= 0) uniforms_.push_back({name, location});
  });
}

}  // namespace binosplat::gl
