#pragma once
// binosplat study SCENE: the paper's analyses, and their page.

#include <filesystem>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "base/error.h"

namespace binosplat::app {

/// Calibrates on the options' views and tests on those of `test`, by default on others, timing so many frames
/// of each setting. Writes report.html and study.json into the folder.
ExitCode analyse_scene(const MeasuredOptions& options, const std::vector<std::string>& test, int frames,
                       const std::filesystem::path& folder);

}  // namespace binosplat::app
