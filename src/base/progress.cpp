#include "base/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <utility>

#include "base/log.h"

namespace binosplat {

namespace {

std::mutex latest_mutex;
std::string latest;

void say(const std::string& text) {
  const std::lock_guard lock(latest_mutex);
  latest = text;
}

}  // namespace

std::string latest_progress() {
  const std::lock_guard lock(latest_mutex);
  return latest;
}

Progress::Progress(std::string label, std::uint64_t total)
    : label_(std::move(label)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_(Clock::now() + std::chrono::seconds(1)),
      next_line_(next_) {}

Progress::~Progress() {
  if (shown_) say("");
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::uint64_t done) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  const int percent =
      total_ == 0 ? 100 : static_cast<int>(100.0 * static_cast<double>(done) / static_cast<double>(total_));
  const std::string text = fmt::format("{} {} %", label_, percent);
  say(text);
  shown_ = true;
  next_ = now + std::chrono::milliseconds(100);
  if (terminal_) {
    fmt::print(stderr, "\r\033[K{}", text);
    std::fflush(stderr);
  } else if (now >= next_line_) {
    log_info("{}", text);
    next_line_ = now + std::chrono::seconds(5);
  }
}

}  // namespace binosplat
