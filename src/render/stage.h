#pragma once
// The stages of a frame, in their order.

#include <array>
#include <cstddef>

namespace binosplat::render {

/// `decode` is run for Scaffold-GS only, `probe` by frames that measure their error. A stage is a file here,
/// programs and a test of one name.
enum class Stage { decode, project, bin, sort, blend, probe };
constexpr std::array stage_names = {"decode", "project", "bin", "sort", "blend", "probe"};
static_assert(stage_names.size() == static_cast<std::size_t>(Stage::probe) + 1);
constexpr const char* name_of(Stage stage) { return stage_names[static_cast<std::size_t>(stage)]; }

/// The number of stages, from the first on, that the float64 reference can stand in for (measure/twins.h).
constexpr int stages_with_twins = static_cast<int>(Stage::blend) + 1;

}  // namespace binosplat::render
