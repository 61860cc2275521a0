#include "base/thread_spans.h"

#include <atomic>
#include <mutex>
#include <utility>

namespace binosplat {

namespace {

std::atomic<bool> are_kept = false;
std::mutex spans_mutex;  // guards `kept`
std::vector<ThreadSpan> kept;
thread_local const char* thread_name = "draws";

}  // namespace

void keep_spans() {
  const std::lock_guard lock(spans_mutex);
  kept.clear();
  are_kept = true;
}

std::vector<ThreadSpan> take_thread_spans() {
  const std::lock_guard lock(spans_mutex);
  are_kept = false;
  return std::exchange(kept, {});
}

void name_thread(const char* name) { thread_name = name; }

void add_span(const std::string& name, Clock::time_point begin) {
  if (!are_kept) return;
  const Clock::time_point end = Clock::now();
  const std::lock_guard lock(spans_mutex);
  if (are_kept) kept.push_back({name, thread_name, begin, end});
}

TimedSpan::~TimedSpan() {
  if (ms_ != nullptr) *ms_ += ms_since(begin_);
  if (are_kept) add_span(name_, begin_);
}

}  // namespace binosplat
