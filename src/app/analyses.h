#pragma once
// binosplat study SCENE...: the paper's analyses, and their page.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "base/error.h"
#include "lab/analyses.h"

namespace binosplat::app {

struct AnalysesOptions {
  std::vector<std::string> test;  // views by name; empty: those held out
  std::optional<int> hold_out;    // every which view; none: as hold_out() finds them
  float far = lab::paper_far;     // where AdaGScale's table by depth ends, world units
  int frames = 24;                // timed of each setting in each round
  std::filesystem::path folder = "out/study";
};

/// Calibrates on the options' views, by default training views, and tests on others. Writes report.html and
/// study.json into the folder; of several scenes into one folder each, and beside these their means.
ExitCode analyse_scenes(const MeasuredOptions& options, const std::vector<std::string>& scenes,
                        const AnalysesOptions& analyses);

}  // namespace binosplat::app
