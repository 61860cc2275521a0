#pragma once
// The one place that launches work: it splits what exceeds a driver's group count, labels for debuggers,
// times by stage, and refuses a dispatch with a buffer or uniform forgotten (GL would read zeros without a
// word).

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/fence.h"

namespace binosplat::gl {

/// How much to launch. Shaders find their place with group_index() and thread_index() of shared/grid.glsl and
/// leave when it lies beyond their count: a split launch has some groups too many.
struct DispatchSize {
  std::uint64_t groups = 0;           // direct
  const Buffer* arguments = nullptr;  // or indirect: three uints at `offset`, already split
  std::int64_t offset = 0;

  /// One invocation for each of `count` things, at `local_size` a group.
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

/// GPU time of one stage of a frame.
struct StageTime {
  std::string name;
  double ms = 0;
};

/// When the GPU was at a stage, on its own clock (Context::gpu_time_ns).
struct StageSpan {
  std::string name;
  std::int64_t begin_ns = 0, end_ns = 0;

  double ms() const { return static_cast<double>(end_ns - begin_ns) * 1e-6; }
};

/// The time of each stage, in order of first appearance.
std::vector<StageTime> sums_of(const std::vector<StageSpan>& spans);

class Dispatcher {
 public:
  explicit Dispatcher(Context& context) : context_(context), frame_end_(context) {}
  ~Dispatcher();
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  Context& context() { return context_; }

  /// Starts a frame: forgets the last frame's stages.
  void begin_frame() { marks_.clear(); }
  /// What is dispatched from here on belongs to the stage `name`; a name may come again and is summed up.
  void begin_stage(const char* name);
  void end_frame();
  /// Whether the GPU has done all of the frame.
  bool is_done() { return frame_end_.is_done(); }

  /// Runs a program, with a barrier after it so that whatever comes next sees what it wrote.
  /// Throws std::logic_error if a block or uniform of the program is not given.
  void run(const Program& program, const DispatchSize& work, std::initializer_list<Binding> bindings,
           std::initializer_list<Uniform> uniforms = {});

  /// As run(), without the barrier: what comes next may run at the same time.
  void start(const Program& program, const DispatchSize& work, std::initializer_list<Binding> bindings,
             std::initializer_list<Uniform> uniforms = {});

  /// Draws all of the framebuffer that is bound, by a fragment shader (KeptDrawing of gl/state.h).
  void draw_whole(const Program& program, std::initializer_list<Binding> bindings,
                  std::initializer_list<Uniform> uniforms) {
    draw(program, 3, bindings, uniforms);
  }
  /// Draws so many vertices, as triangles, into it.
  void draw(const Program& program, int vertices, std::initializer_list<Binding> bindings,
            std::initializer_list<Uniform> uniforms = {});

  /// The barrier that start() leaves out.
  void wait_for_writes();

  /// Waits for the frame on the GPU.
  void wait() { frame_end_.wait(); }
  /// When the stages of a frame that is done were drawn, one after the other, from timestamps (llvmpipe
  /// reports nothing between a GL_TIME_ELAPSED pair).
  std::vector<StageSpan> read_spans();
  /// Waits, then the time of each stage.
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
