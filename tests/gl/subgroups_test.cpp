// Tests whether subgroups that do not work as shaders assume are detected. llvmpipe has none: the check's
// shader runs on subgroups that its workgroup emulates in shared memory, correct and faulty ones.

#include "gl/subgroups.h"

#include <gtest/gtest.h>

#include "support/gl.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

// A driver's subgroups. Numbers are invocations that communicate in one subgroup, for each kind of function.
struct Driver {
  const char* name;
  int said = 32;         // gl_SubgroupSize
  int ids = 32;          // size that gl_SubgroupID and gl_SubgroupInvocationID imply
  int turned_round = 0;  // lane numbers are XORed with this
  int votes = 32, shuffles = 32, sums = 32;
  const char* found = "";  // part of the check's message
};

// Emulates GL_KHR_shader_subgroup in shared memory.
constexpr const char* played = R"(
shared uint table[INVOCATIONS];
uint tell(uint value) { barrier(); table[gl_LocalInvocationIndex] = value; barrier(); return gl_LocalInvocationIndex; }
#define LANE_OF(self, size) ((self) % size ^ TURNED_ROUND)
#define BEGIN_OF(self, size) ((self) / size * size)
const uint played_SubgroupSize = SAID, played_NumSubgroups = (INVOCATIONS + IDS - 1u) / IDS;
#define played_SubgroupID (gl_LocalInvocationIndex / IDS)
#define played_SubgroupInvocationID LANE_OF(gl_LocalInvocationIndex, IDS)
#define played_SubgroupLtMask uvec4((1u << LANE_OF(gl_LocalInvocationIndex, IDS)) - 1u, 0u, 0u, 0u)
uvec4 subgroupBallot(bool value) {
  uint self = tell(uint(value));
  uvec4 ballot = uvec4(0u);
  for (uint k = 0u; k < VOTES && BEGIN_OF(self, VOTES) + k < INVOCATIONS; ++k)
    ballot[(k ^ TURNED_ROUND) / 32u] |= table[BEGIN_OF(self, VOTES) + k] << ((k ^ TURNED_ROUND) % 32u);
  return ballot;
}
bool subgroupAny(bool value) { return subgroupBallot(value) != uvec4(0u); }
uint subgroupShuffle(uint value, uint lane) {
  uint self = tell(value);
  return table[(BEGIN_OF(self, SHUFFLES) + (lane % SHUFFLES ^ TURNED_ROUND)) % INVOCATIONS];
}
uint sum_up(uint value, bool all) {
  uint self = tell(value), sum = 0u;
  for (uint k = BEGIN_OF(self, SUMS); k < min(BEGIN_OF(self, SUMS) + SUMS, INVOCATIONS); ++k) sum += all || k <= self ? table[k] : 0u;
  return sum;
}
uint subgroupAdd(uint value) { return sum_up(value, true); }
uint subgroupInclusiveAdd(uint value) { return sum_up(value, false); }
)";

std::string check_with(const Driver& driver) {
  std::string shader;
  std::istringstream lines(embedded_shaders().at("subgroups_check.comp"));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#extension")) continue;
    for (std::size_t at = 0; (at = line.find("gl_", at)) != std::string::npos; ++at) {
      if (line.compare(at, 11, "gl_Subgroup") == 0 || line.compare(at, 15, "gl_NumSubgroups") == 0)
        line.replace(at, 3, "played_");
    }
    shader += line + "\n";
    if (line.starts_with("layout(local_size_x")) {
      for (const auto& [define, value] :
           {std::pair("SAID", driver.said), std::pair("IDS", driver.ids),
            std::pair("TURNED_ROUND", driver.turned_round), std::pair("VOTES", driver.votes),
            std::pair("SHUFFLES", driver.shuffles), std::pair("SUMS", driver.sums)})
        shader += "#define " + std::string(define) + " " + std::to_string(value) + "u\n";
      shader += played;
    }
  }
  const test::TempFolder folder;
  test::write_text(folder / "subgroups_check.comp", shader);
  Context& context = test::gl_context();
  context.set_shader_folder(folder.path());
  std::string found = run_subgroup_tests(context);
  context.set_shader_folder({});
  return found;
}

// Injected faults: another size than the reported one, lanes in another order, and functions that reach fewer
// or more invocations.
const std::vector<Driver> drivers = {
    {.name = "right"},
    {.name = "runs 8", .ids = 8, .votes = 8, .shuffles = 8, .sums = 8, .found = "differ in size from the 32"},
    {.name = "runs 64",
     .ids = 64,
     .votes = 64,
     .shuffles = 64,
     .sums = 64,
     .found = "differ in size from the 32"},
    {.name = "says 64", .said = 64, .found = "differ in size from the 32"},
    {.name = "lanes turned round", .turned_round = 31, .found = "another order"},
    {.name = "lanes in pairs", .turned_round = 1, .found = "another order"},
    {.name = "votes of 16", .votes = 16, .found = "vote"},
    {.name = "votes of 64", .votes = 64, .found = "vote"},
    {.name = "shuffles of 16", .shuffles = 16, .found = "shuffle"},
    {.name = "sums of 64", .sums = 64, .found = "sum"}};

TEST(Subgroups, FaultsAreDetected) {
  for (const Driver& driver : drivers) {
    const std::string found = check_with(driver);
    EXPECT_EQ(found.empty(), *driver.found == '\0') << driver.name << ": " << found;
    EXPECT_NE(found.find(driver.found), std::string::npos) << driver.name << ": " << found;
  }
}

TEST(Subgroups, AreUsedWithoutFault) {
  Context& context = test::gl_context();
  EXPECT_EQ(context.limits().subgroups_of_32, context.limits().why_no_subgroups.empty());
  if (context.software()) {
    EXPECT_EQ(context.limits().why_no_subgroups, "it has no GL_KHR_shader_subgroup");
  } else if (context.renderer().find("NVIDIA") != std::string::npos) {
    EXPECT_EQ(context.limits().why_no_subgroups, "");
  }
}

}  // namespace
}  // namespace binosplat::gl
