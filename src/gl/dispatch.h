#pragma once
// Dispatches all work. Splits dispatches that exceed the driver's limit of work groups, labels stages for
// debuggers, and times them. Refuses a dispatch that lacks a buffer or uniform: GL would silently read zeros.

#include <binosplat/report.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/fence.h"

namespace binosplat::gl {

/// The size of a dispatch. Shaders get their index from group_index() or thread_index() of shared/grid.glsl.
/// They must return if the index is beyond their count: a split dispatch may have more groups than requested.
struct DispatchSize {
  std::uint64_t groups = 0;           // of a direct dispatch
  const Buffer* arguments = nullptr;  // of an indirect one: group counts x, y, z as uints at byte `offset`
  std::int64_t offset = 0;

  /// One invocation for each of `count` objects, `local_size` per group.
  static DispatchSize threads(std::uint64_t count, std::uint32_t local_size) {
    return {(count + local_size - 1) / local_size};
  }
  static DispatchSize of_groups(std::uint64_t count) { return {count}; }
  static DispatchSize indirect(const Buffer& arguments, std::int64_t offset) {
    return {0, &arguments, offset};
  }
};

struct Binding {
  const char* block;  // the name of a storage or uniform block in the shader
  const Buffer& buffer;
};

struct Uniform {
  const char* name;
  std::uint32_t value;
};

/// The time of each stage. Sums spans of equal name; stages are in the order of their first spans.
std::vector<StageTime> sums_of(const std::vector<StageSpan>& spans);
/// The ms of the stage of this name; 0 if there is none.
double time_of(const std::vector<StageTime>& stages, const std::string& name);

class Dispatcher {
 public:
  explicit Dispatcher(Context& context) : context_(context), frame_end_(context) {}
  ~Dispatcher();
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  Context& context() { return context_; }

  /// Starts a frame, and discards the stages of the previous frame.
  void begin_frame() { marks_.clear(); }
  /// Later dispatches belong to the stage `name`. The times of a repeated name are summed.
  void begin_stage(const char* name);
  void end_frame();
  bool is_done() { return frame_end_.is_done(); }

  /// Runs a program, then a barrier, so that later commands see its writes. Throws std::logic_error if a
  /// block or uniform of the program is missing.
  void run(const Program& program, const DispatchSize& work, std::initializer_list<Binding> bindings,
           std::initializer_list<Uniform> uniforms = {});

  /// Same as run(), without the barrier: later commands may run at the same time.
  void start(const Program& program, const DispatchSize& work, std::initializer_list<Binding> bindings,
             std::initializer_list<Uniform> uniforms = {});

  /// Runs a fragment shader for every pixel of the bound framebuffer, in the state of SavedDrawing (state.h).
  void draw_whole(const Program& program, std::initializer_list<Binding> bindings,
                  std::initializer_list<Uniform> uniforms) {
    draw(program, 3, bindings, uniforms);
  }
  /// Draws `vertices` vertices as triangles into the bound framebuffer.
  void draw(const Program& program, int vertices, std::initializer_list<Binding> bindings,
            std::initializer_list<Uniform> uniforms = {});

  /// The barrier that start() omits.
  void wait_for_writes();

  void wait() { frame_end_.wait(); }
  /// The times of a completed frame's stages, in order. They come from timestamps, because GL_TIME_ELAPSED
  /// queries report nothing on llvmpipe.
  std::vector<StageSpan> read_spans();
  std::vector<StageTime> wait_and_time() {
    wait();
    return sums_of(read_spans());
  }

 private:
  struct Mark {
    std::string stage;
    std::uint32_t query;
  };
  void mark(const std::string& stage);
  void bind(const Program& program, std::initializer_list<Binding> bindings,
            std::initializer_list<Uniform> uniforms);

  Context& context_;
  std::vector<std::uint32_t> queries_;
  std::vector<Mark> marks_;
  Fence frame_end_;
};

}  // namespace binosplat::gl
