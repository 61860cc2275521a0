#pragma once
// Writes the folder of a profile, for `binosplat profile` and for recordings of `view`.

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lab/profile.h"

namespace binosplat::app {

inline constexpr std::array profile_files = {"report.html", "trace.json", "frames.csv", "results.json",
                                             "results.csv"};

/// Writes all files or none. `changes` are the lines of a RunComparison; empty: no comparison. Throws Error
/// for a failed write, and for a recording without frames.
void save_profile(const std::filesystem::path& folder, const lab::Profile& profile,
                  const std::vector<std::string>& changes);

/// Draws a view of a recorded frame again.
using DrawAgain = std::function<Image(const shared::View& view)>;

/// Writes a recording of the window. It adds pictures of the worst frames, worst first, as many as `draw`
/// makes in a second, because a user may be waiting.
void save_recording(const std::filesystem::path& folder, const lab::ProfileFacts& facts,
                    render::Recording recording, const DrawAgain& draw = {});

}  // namespace binosplat::app
