#pragma once
// binosplat study SCENE: the paper's analyses, and their page.

#include <string>
#include <vector>

#include "app/render_options.h"
#include "base/error.h"

namespace binosplat::app {

struct AnalysisOptions {
  RenderOptions scene;  // the views are those to calibrate on
  std::vector<std::string> test;
  int frames = 24;
  std::string output = "out/study";
};

/// Writes report.html and study.json.
ExitCode analyse_scene(const AnalysisOptions& options);

}  // namespace binosplat::app
