#include "gl/subgroups.h"

#include <fmt/core.h>

#include <array>
#include <optional>
#include <vector>

#include "base/error.h"
#include "gl/buffer.h"
#include "gl/dispatch.h"
#include "gl/state.h"

namespace binosplat::gl {

namespace {

constexpr const char* check_shader = "subgroups_check.comp";

struct GroupShape {
  std::uint32_t columns, rows;
};

/// The work groups of all shaders with subgroups: sorts and scans, then blend_subgroups.comp.
constexpr std::array group_shapes = {GroupShape{256, 1}, GroupShape{1024, 1}, GroupShape{32, 1},
                                     GroupShape{32, 2},  GroupShape{32, 4},   GroupShape{32, 8}};

struct Fault {
  const char* define;
  const char* text;
};

/// The faults that subgroups_check.comp detects, worst first.
constexpr std::array subgroup_faults = {
    Fault{"SUBGROUPS_OF_OTHER_SIZE", "differ in size from the 32 invocations that the driver reports"},
    Fault{"SUBGROUPS_IN_OTHER_ORDER", "have their invocations in another order"},
    Fault{"SUBGROUPS_VOTE_WITH_OTHERS", "vote across invocations of other subgroups"},
    Fault{"SUBGROUPS_SHUFFLE_OTHERS", "shuffle across invocations of other subgroups"},
    Fault{"SUBGROUPS_ADD_OTHERS", "sum over invocations of other subgroups"}};

std::vector<Number> numbers_of(const GroupShape& shape) {
  std::vector<Number> numbers = {{"COLUMNS", shape.columns, 1025}, {"ROWS", shape.rows, 1025}};
  for (std::size_t k = 0; k < subgroup_faults.size(); ++k)
    numbers.push_back({subgroup_faults[k].define, 1u << k, 1u << subgroup_faults.size()});
  return numbers;
}

}  // namespace

std::string run_subgroup_tests(Context& context) {
  const SavedState saved(context);
  Dispatcher dispatcher(context);
  Buffer wrong(context, "faults of subgroups");
  wrong.upload(std::vector<std::uint32_t>{0});
  for (const GroupShape& shape : group_shapes)
    dispatcher.start(context.program(check_shader, numbers_of(shape)), DispatchSize::of_groups(1),
                     {{"Wrong", wrong}});
  dispatcher.wait_for_writes();
  const std::uint32_t found = wrong.read<std::uint32_t>(1).front();
  for (std::size_t k = 0; k < subgroup_faults.size(); ++k) {
    if ((found >> k & 1u) != 0) return fmt::format("its subgroups {}", subgroup_faults[k].text);
  }
  return "";
}

std::string why_no_subgroups(Context& context) {
  const Functions& gl = context.gl();
  const auto integer = [&](GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
  };
  constexpr GLint needed = GL_SUBGROUP_FEATURE_BALLOT_BIT_KHR | GL_SUBGROUP_FEATURE_SHUFFLE_BIT_KHR |
                           GL_SUBGROUP_FEATURE_VOTE_BIT_KHR | GL_SUBGROUP_FEATURE_ARITHMETIC_BIT_KHR;
  if (!has_extension(gl, "GL_KHR_shader_subgroup")) return "it has no GL_KHR_shader_subgroup";
  if (const GLint size = integer(GL_SUBGROUP_SIZE_KHR); size != 32)
    return fmt::format("its subgroups have {} invocations", size);
  if ((integer(GL_SUBGROUP_SUPPORTED_STAGES_KHR) & GL_COMPUTE_SHADER_BIT) == 0)
    return "its compute shaders have no subgroups";
  if ((integer(GL_SUBGROUP_SUPPORTED_FEATURES_KHR) & needed) != needed)
    return "its subgroups lack votes, sums, ballots or shuffles";
  std::string test_name;
  for (const GroupShape& shape : group_shapes)
    test_name += ShaderSource(check_shader, defines_of(numbers_of(shape)), {}).text();
  if (const std::optional<std::string> known = context.program_cache().load_result(test_name)) return *known;
  try {
    std::string found = run_subgroup_tests(context);
    context.program_cache().store_result(test_name, found);
    return found;
  } catch (const Error& error) {  // the driver reports a feature that its compiler lacks
    if (error.code() != ExitCode::no_gl) throw;
    return fmt::format("its shaders with subgroups do not compile: {}", error.what());
  }
}

}  // namespace binosplat::gl
