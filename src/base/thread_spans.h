#pragma once
// Records what threads do; `binosplat profile` shows a track for each thread. While recording is off, as by
// default, a span costs only the test of a flag.

#include <string>
#include <vector>

#include "base/clock.h"

namespace binosplat {

/// An interval of a thread's work.
struct ThreadSpan {
  std::string name, thread;
  Clock::time_point begin = {}, end = {};
};

/// Starts recording on all threads, and discards earlier spans.
void keep_spans();
/// Stops recording and returns the spans, in the order of their ends.
std::vector<ThreadSpan> take_thread_spans();

/// Names this thread in spans; the default is "draws".
void name_thread(const char* name);

/// Records a span that ends now, if recording is on.
void add_span(const std::string& name, Clock::time_point begin);

/// A span with the lifetime of this object.
class TimedSpan {
 public:
  /// `name` must outlive this object, as literals do. Adds the span's length to `ms`, if given.
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
