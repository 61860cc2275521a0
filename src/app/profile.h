#pragma once
// The folder that a profile leaves: of `binosplat profile`, and of what `view` records.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "lab/profile.h"

namespace binosplat::app {

inline constexpr std::array profile_files = {"report.html", "trace.json", "frames.csv", "profile.json"};

/// Writes them, all or none; `changes` as lab::compare_frames() has it, empty for no comparison. Throws Error
/// where that fails, and for a recording without frames.
void save_profile(const std::filesystem::path& folder, const lab::Profile& profile,
                  const std::vector<std::string>& changes);

/// The same of frames that were recorded while somebody looked: "in the window".
void save_recording(const std::filesystem::path& folder, const lab::ProfileFacts& facts,
                    render::Recording recording);

}  // namespace binosplat::app
