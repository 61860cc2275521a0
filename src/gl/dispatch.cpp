#include "gl/dispatch.h"

#include <algorithm>
#include <stdexcept>

namespace binosplat::gl {

Dispatcher::~Dispatcher() {
  if (!queries_.empty()) context_.gl().DeleteQueries(static_cast<int>(queries_.size()), queries_.data());
}

void Dispatcher::mark(const std::string& stage) {
  if (marks_.size() == queries_.size()) {
    queries_.push_back(0);
    context_.gl().CreateQueries(GL_TIMESTAMP, 1, &queries_.back());
  }
  marks_.push_back({stage, queries_[marks_.size()]});
  context_.gl().QueryCounter(marks_.back().query, GL_TIMESTAMP);
}

void Dispatcher::begin_stage(const char* name) {
  if (context_.is_preparing()) return;
  if (!marks_.empty()) context_.gl().PopDebugGroup();
  mark(name);
  context_.gl().PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name);
}

void Dispatcher::end_frame() {
  if (!marks_.empty()) context_.gl().PopDebugGroup();
  mark("");
  frame_end_.set();
}

void Dispatcher::bind(const Program& program, std::initializer_list<Binding> bindings,
                      std::initializer_list<Uniform> uniforms) {
  const Functions& gl = context_.gl();
  for (const Program::Block& block : program.blocks()) {
    const auto* found = std::find_if(bindings.begin(), bindings.end(),
                                     [&](const Binding& b) { return block.name == b.block; });
    if (found == bindings.end() || found->buffer.id() == 0) {
      throw std::logic_error(program.name() + ": no buffer is bound to the block " + block.name);
    }
    gl.BindBufferRange(block.target, block.binding, found->buffer.id(), 0, found->buffer.bytes());
  }
  for (const Program::Uniform& uniform : program.uniforms()) {
    const auto* found = std::find_if(uniforms.begin(), uniforms.end(),
                                     [&](const Uniform& u) { return uniform.name == u.name; });
    if (found == uniforms.end())
      throw std::logic_error(program.name() + ": no value for the uniform " + uniform.name);
    gl.ProgramUniform1ui(program.id(), uniform.location, found->value);
  }
}

void Dispatcher::run(const Program& program, const DispatchSize& work,
                     std::initializer_list<Binding> bindings, std::initializer_list<Uniform> uniforms) {
  start(program, work, bindings, uniforms);
  wait_for_writes();
}

void Dispatcher::draw(const Program& program, int vertices, std::initializer_list<Binding> bindings,
                      std::initializer_list<Uniform> uniforms) {
  if (context_.is_preparing() || vertices == 0) return;
  bind(program, bindings, uniforms);
  context_.gl().UseProgram(program.id());
  context_.gl().DrawArrays(GL_TRIANGLES, 0, vertices);
}

void Dispatcher::wait_for_writes() {
  context_.gl().MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
}

void Dispatcher::start(const Program& program, const DispatchSize& work,
                       std::initializer_list<Binding> bindings, std::initializer_list<Uniform> uniforms) {
  if ((work.arguments == nullptr && work.groups == 0) || context_.is_preparing()) return;
  const Functions& gl = context_.gl();
  bind(program, bindings, uniforms);
  gl.UseProgram(program.id());
  if (work.arguments != nullptr) {
    gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, work.arguments->id());
    gl.DispatchComputeIndirect(work.offset);
  } else {
    const std::uint64_t rows = (work.groups + context_.limits().groups - 1) / context_.limits().groups;
    const std::uint64_t columns = (work.groups + rows - 1) / rows;
    if (rows > 65535) throw std::logic_error(program.name() + ": more work groups than any driver supports");
    gl.DispatchCompute(static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), 1);
  }
  context_.check(program.name());
}

std::vector<StageSpan> Dispatcher::read_spans() {
  std::vector<StageSpan> spans;
  GLint callers = 0;  // OpenGL writes results into a bound query buffer instead
  context_.gl().GetIntegerv(GL_QUERY_BUFFER_BINDING, &callers);
  context_.gl().BindBuffer(GL_QUERY_BUFFER, 0);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    std::uint64_t ns = 0;
    context_.gl().GetQueryObjectui64v(marks_[i].query, GL_QUERY_RESULT, &ns);
    const auto at = static_cast<std::int64_t>(ns);
    // Drivers without timestamps report 0: then all times are 0.
    if (i > 0) spans.back().end_ns = std::max(at, spans.back().begin_ns);
    if (i + 1 < marks_.size()) spans.push_back({marks_[i].stage, at, at});
  }
  context_.gl().BindBuffer(GL_QUERY_BUFFER, static_cast<GLuint>(callers));
  return spans;
}

std::vector<StageTime> sums_of(const std::vector<StageSpan>& spans) {
  std::vector<StageTime> times;
  for (const StageSpan& span : spans) {
    auto found = std::ranges::find(times, span.name, &StageTime::name);
    if (found == times.end()) found = times.insert(times.end(), {span.name, 0.0});
    found->ms += span.ms();
  }
  return times;
}

double time_of(const std::vector<StageTime>& stages, const std::string& name) {
  const auto found = std::ranges::find(stages, name, &StageTime::name);
  return found == stages.end() ? 0.0 : found->ms;
}

}  // namespace binosplat::gl
