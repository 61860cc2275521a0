#pragma once
// Progress of long work: a rewritten line on a terminal, a line every few seconds in a log. Silent for work
// under a second and in quiet programs. After five seconds it also estimates the remaining time.

#include <cstdint>
#include <mutex>
#include <string>

#include "base/clock.h"

namespace binosplat {

class Progress {
 public:
  /// `label` describes the work, as in "reading garden.ply". If `counted` names the elements, as in "views",
  /// the line also has the elements per second.
  Progress(std::string label, std::uint64_t total, std::string counted = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Reports how much of `total` is done. Cheap enough for every few thousand elements. For one thread only.
  void update(std::uint64_t done);
  /// Reports that `more` is done, from any thread.
  void add(std::uint64_t more);

 private:
  std::string label_, counted_;
  std::uint64_t total_;
  std::mutex adding_;
  std::uint64_t added_ = 0;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
  Clock::time_point next_line_;  // time of the next line in a log
};

/// A duration in words: "40 s", "3 min 20 s", "2 h 5 min".
std::string spoken_time(double seconds);

/// The latest progress of any thread, as in "reading garden.ply 43 %"; empty without work of over a second.
std::string latest_progress();

}  // namespace binosplat
