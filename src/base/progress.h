#pragma once
// Progress of long work: a line that is rewritten on a terminal, a line every few seconds in a log, nothing
// for work that is over within a second or for a program that is to be quiet. After five seconds it says how
// long the rest will take at this pace.

#include <chrono>
#include <cstdint>
#include <string>

namespace binosplat {

class Progress {
 public:
  /// `label` says what is being done, in the form "reading garden.ply". With `counted`, as in "views", it
  /// also says how many of them are done a second.
  Progress(std::string label, std::uint64_t total, std::string counted = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Reports how much of `total` is done so far. Cheap enough for every few thousand elements; one thread
  /// only.
  void update(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_, counted_;
  std::uint64_t total_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
  Clock::time_point next_line_;  // of a log
};

/// A time as people say it: "40 s", "3 min 20 s", "2 h 5 min".
std::string spoken_time(double seconds);

/// What work that is under way in any thread said last, as "reading garden.ply 43 %"; empty while there is
/// none that takes longer than a second.
std::string latest_progress();

}  // namespace binosplat
