#pragma once
// The stages of a frame, in their order.

#include <array>
#include <cstddef>

namespace binosplat::render {

/// `decode` runs for Scaffold-GS only, `probe` in frames that measure their error. Programs, files and tests
/// use the same names of stages.
enum class Stage { decode, project, bin, sort, blend, probe };
constexpr std::array stage_names = {"decode", "project", "bin", "sort", "blend", "probe"};
static_assert(stage_names.size() == static_cast<std::size_t>(Stage::probe) + 1);
constexpr const char* name_of(Stage stage) { return stage_names[static_cast<std::size_t>(stage)]; }

/// How many stages, from the first on, the float64 reference can replace (measure/reference_stages.h).
constexpr int stages_with_reference = static_cast<int>(Stage::blend) + 1;

}  // namespace binosplat::render
