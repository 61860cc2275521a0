#pragma once
// The folder that a profile leaves: of `binosplat profile`, and of what `view` records.

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/profile.h"

namespace binosplat::app {

inline constexpr std::array profile_files = {"report.html", "trace.json", "frames.csv", "results.json",
                                             "results.csv"};

/// Writes them, all or none; `changes` as RunComparison has its lines, empty for no comparison. Throws Error
/// where that fails, and for a recording without frames.
void save_profile(const std::filesystem::path& folder, const lab::Profile& profile,
                  const std::vector<std::string>& changes);

/// Draws what a view of a frame showed once more.
using DrawAgain = std::function<Image(const shared::View& view)>;

/// The same of frames that were recorded while somebody looked: "in the window". Of the worst, worst first,
/// it has as many pictures as `draw` makes in a second, for which somebody may wait.
void save_recording(const std::filesystem::path& folder, const lab::ProfileFacts& facts,
                    render::Recording recording, const DrawAgain& draw = {});

}  // namespace binosplat::app
