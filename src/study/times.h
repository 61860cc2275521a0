#pragma once
// GPU times of many frames, and of their stages.

#include <map>
#include <string>
#include <vector>

#include "render/frame.h"

namespace binosplat::study {

struct Times {
  std::vector<double> frame, submit;     // ms
  std::vector<double> pairs;             // Gaussian-tile pairs
  std::vector<std::string> stage_names;  // in order
  std::map<std::string, std::vector<double>> stages;

  void add(const render::FrameReport& report) {
    frame.push_back(report.total_ms);
    submit.push_back(report.submit_ms);
    pairs.push_back(static_cast<double>(report.pairs));
    for (const gl::StageTime& stage : report.stages) {
      if (stages.count(stage.name) == 0) stage_names.push_back(stage.name);
      stages[stage.name].push_back(stage.ms);
    }
  }
};

}  // namespace binosplat::study
