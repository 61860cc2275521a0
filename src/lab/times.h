#pragma once
// GPU times of many frames, and of their stages.

#include <map>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "render/frame.h"

namespace binosplat::lab {

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

/// Frames of one view in a row. Those that measure for the others take longer: both kinds are told by their
/// medians, which a slow frame does not move, weighted by their numbers.
class Run {
 public:
  void add(const render::FrameReport& report) { (report.recorded ? recording_ : plain_).add(report); }

  const std::vector<std::string>& stage_names() const {
    return plain_.frame.empty() ? recording_.stage_names : plain_.stage_names;
  }
  double frame_ms() const { return typical(plain_.frame, recording_.frame); }
  double stage_ms(const std::string& name) const {
    return typical(values(plain_, name), values(recording_, name));
  }
  double pairs() const { return typical(plain_.pairs, recording_.pairs); }

 private:
  static std::vector<double> values(const Times& times, const std::string& name) {
    const auto found = times.stages.find(name);
    return found == times.stages.end() ? std::vector<double>{} : found->second;
  }
  static double typical(const std::vector<double>& plain, const std::vector<double>& recording) {
    double sum = 0.0;
    for (const std::vector<double>* kind : {&plain, &recording}) {
      if (!kind->empty()) sum += quantile(*kind, 0.5) * static_cast<double>(kind->size());
    }
    return sum / static_cast<double>(plain.size() + recording.size());
  }

  Times plain_, recording_;
};

}  // namespace binosplat::lab
