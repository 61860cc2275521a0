#pragma once
// What threads do, and when: `binosplat profile` shows it as a track for each thread. Nothing is kept until
// somebody asks for it, so that a span costs a test of one flag.

#include <string>
#include <vector>

#include "base/clock.h"

namespace binosplat {

/// Something that a thread did from `begin` to `end`.
struct Span {
  std::string name, thread;
  Clock::time_point begin = {}, end = {};
};

/// From now on the spans of all threads are kept. Those of before are forgotten.
void keep_spans();
/// Returns those that were kept, in the order of their ends, and keeps no more.
std::vector<Span> take_spans();

/// How spans of this thread name it; "draws" until it is called.
void name_thread(const char* name);

/// Keeps a span that ends now, if spans are kept.
void add_span(const std::string& name, Clock::time_point begin);

/// A span of as long as this lives.
class TimedSpan {
 public:
  /// The name, a literal, must outlive it. `ms`: a sum that the span's length is added to.
  explicit TimedSpan(const char* name, double* ms = nullptr) : name_(name), ms_(ms) {}
  ~TimedSpan();
  TimedSpan(const TimedSpan&) = delete;
  TimedSpan& operator=(const TimedSpan&) = delete;

 private:
  const char* name_;
  double* ms_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace binosplat
