#include "gl/dispatch.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

#include "base/error.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

// While this object lives, the shared context reads its shaders from a folder with one additional shader.
class OwnShader {
 public:
  OwnShader(const std::string& name, const std::string& text) {
    std::filesystem::create_directory(folder_ / "shared");
    for (const auto& [file, body] : embedded_shaders()) {
      if (file.rfind("shared/", 0) == 0) test::write_text(folder_ / file, body);
    }
    test::write_text(folder_ / name, text);
    test::gl_context().set_shader_folder(folder_.path());
  }
  ~OwnShader() { test::gl_context().set_shader_folder({}); }

 private:
  test::TempFolder folder_;
};

const char* const count_up = R"(
#include "shared/limits.h"
#include "shared/grid.glsl"
layout(local_size_x = THREADS) in;
layout(std430, binding = 3) buffer Items { uint items[]; };
uniform uint count;
void main() { if (thread_index() < count) items[thread_index()] += 1u + group_index(); }
)";

// Runs count_up over `count` items with at most `groups` workgroups along x.
std::vector<std::uint32_t> counted(std::uint32_t count, std::uint32_t groups) {
  Context& context = test::gl_context();
  const OwnShader shader("count_up.comp", count_up);
  const std::uint32_t before = context.limits().groups;
  context.limit_groups(groups);
  Buffer items(context, "items");
  items.upload(std::vector<std::uint32_t>(count));
  Dispatcher dispatcher(context);
  dispatcher.run(context.program("count_up.comp"), DispatchSize::threads(count, 256), {{"Items", items}},
                 {{"count", count}});
  context.limit_groups(before);
  return items.read<std::uint32_t>(count);
}

TEST(Dispatcher, SplitsDispatchesByGroupLimit) {
  constexpr std::uint32_t count = 256 * 30 - 5;
  std::vector<std::uint32_t> expected(count);
  for (std::uint32_t i = 0; i < count; ++i) expected[i] = 1 + i / 256;
  EXPECT_EQ(counted(count, 65535), expected);
  EXPECT_EQ(counted(count, 30), expected);  // just fits
  EXPECT_EQ(counted(count, 29), expected);  // two rows
  EXPECT_EQ(counted(count, 7), expected);   // five rows, the last one not full
  EXPECT_EQ(counted(count, 1), expected);
}

TEST(Dispatcher, ExceedsDriverGroupLimit) {
  constexpr std::uint32_t count = 65536 * 256 + 1;
  const std::vector<std::uint32_t> items = counted(count, test::gl_context().limits().groups);
  EXPECT_EQ(items.front(), 1u);
  EXPECT_EQ(items[65535 * 256], 65536u);
  EXPECT_EQ(items.back(), 65537u);
}

TEST(Dispatcher, RequiresAllBindings) {
  Context& context = test::gl_context();
  const OwnShader shader("count_up.comp", count_up);
  Buffer items(context, "items");
  Dispatcher dispatcher(context);
  const Program& program = context.program("count_up.comp");
  EXPECT_THROW(dispatcher.run(program, DispatchSize::of_groups(1), {}, {{"count", 1}}), std::logic_error);
  EXPECT_THROW(dispatcher.run(program, DispatchSize::of_groups(1), {{"Items", items}}, {{"count", 1}}),
               std::logic_error);  // has no storage yet
  items.reserve(1024);
  EXPECT_THROW(dispatcher.run(program, DispatchSize::of_groups(1), {{"Items", items}}, {}), std::logic_error);
  EXPECT_NO_THROW(dispatcher.run(program, DispatchSize::of_groups(1), {{"Items", items}}, {{"count", 1}}));
}

TEST(Dispatcher, TimesEachStage) {
  Context& context = test::gl_context();
  const OwnShader shader("count_up.comp", count_up);
  constexpr std::uint32_t count = 1 << 20;
  Buffer items(context, "items");
  items.upload(std::vector<std::uint32_t>(count));
  Dispatcher dispatcher(context);
  const auto work = [&] {
    dispatcher.run(context.program("count_up.comp"), DispatchSize::threads(count, 256), {{"Items", items}},
                   {{"count", count}});
  };
  for (int frame = 0; frame < 2; ++frame) {
    dispatcher.begin_frame();
    dispatcher.begin_stage("much");
    work();
    dispatcher.begin_stage("nothing");
    dispatcher.begin_stage("much");
    work();
    dispatcher.end_frame();
  }
  const std::vector<StageTime> times = dispatcher.wait_and_time();
  ASSERT_EQ(times.size(), 2u);
  EXPECT_EQ(times[0].name, "much");
  EXPECT_EQ(times[1].name, "nothing");
  EXPECT_GT(times[0].ms, times[1].ms);
  EXPECT_GE(times[1].ms, 0.0);
}

/// Collects what debuggers show: the names of groups that begin.
void APIENTRY note_group(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* name,
                         const void* names) {
  if (type == GL_DEBUG_TYPE_PUSH_GROUP)
    static_cast<std::vector<std::string>*>(const_cast<void*>(names))->emplace_back(name);
}

TEST(Dispatcher, NamesStagesForDebuggers) {
  Context& context = test::gl_context();
  std::vector<std::string> names;
  context.gl().Enable(GL_DEBUG_OUTPUT);
  context.gl().Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  context.gl().DebugMessageCallback(note_group, &names);
  Dispatcher dispatcher(context);
  dispatcher.begin_frame();
  for (const char* const stage : {"one", "two", "one"}) dispatcher.begin_stage(stage);
  dispatcher.end_frame();
  context.gl().DebugMessageCallback(nullptr, nullptr);
  EXPECT_EQ(names, (std::vector<std::string>{"one", "two", "one"}));
  const std::vector<StageSpan> spans = dispatcher.read_spans();
  ASSERT_EQ(spans.size(), 3u);
  for (std::size_t k = 0; k < spans.size(); ++k) {
    EXPECT_EQ(spans[k].name, names[k]) << "and times have the same";
    EXPECT_GE(spans[k].end_ns, spans[k].begin_ns);
    EXPECT_GE(spans[k].begin_ns, spans[0].begin_ns);
  }
  EXPECT_GE(context.gpu_time_ns(), spans.back().end_ns);
}

TEST(Buffer, KeepsChunkedUploads) {
  Context& context = test::gl_context();
  const std::int64_t before = context.allocated_bytes();
  {
    Buffer buffer(context, "big");
    std::vector<std::uint32_t> data((std::size_t{130} << 20) / 4);  // uploads in more than two pieces
    std::iota(data.begin(), data.end(), 0u);
    buffer.upload(data);
    EXPECT_EQ(buffer.read<std::uint32_t>(data.size()), data);
    EXPECT_EQ(context.allocated_bytes(), before + buffer.bytes());
  }
  EXPECT_EQ(context.allocated_bytes(), before);
}

TEST(Buffer, RejectsExcessiveSize) {
  Context& context = test::gl_context();
  Buffer buffer(context, "enormous");
  try {
    buffer.reserve(context.limits().storage_block_bytes + 1);
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::out_of_memory);
    EXPECT_NE(std::string(error.what()).find("enormous"), std::string::npos);
  }
}

TEST(Dispatcher, PreparesProgramsWithoutRunning) {
  Context& context = test::gl_context();
  const OwnShader shader("count_up.comp", count_up);
  Buffer items(context, "items");
  items.upload(std::vector<std::uint32_t>(10));
  Dispatcher dispatcher(context);
  const auto record = [&] {
    dispatcher.run(context.program("count_up.comp"), DispatchSize::threads(10, 256), {{"Items", items}},
                   {{"count", 10}});
  };
  context.prepare(record);
  EXPECT_EQ(items.read<std::uint32_t>(10), std::vector<std::uint32_t>(10));
  record();
  EXPECT_EQ(items.read<std::uint32_t>(10), std::vector<std::uint32_t>(10, 1));
}

TEST(Dispatcher, PreparedProgramReportsErrorOnUse) {
  Context& context = test::gl_context();
  const OwnShader shader("wrong.comp", "layout(local_size_x = 1) in;\nvoid main() { missing = 1; }\n");
  context.prepare([&] { context.program("wrong.comp"); });
  EXPECT_THROW(context.program("wrong.comp"), Error);
  EXPECT_THROW(context.program("wrong.comp"), Error);
}

}  // namespace
}  // namespace binosplat::gl
