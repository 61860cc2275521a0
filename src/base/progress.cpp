#include "base/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
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

std::string spoken_time(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string latest_progress() {
  const std::lock_guard lock(latest_mutex);
  return latest;
}

Progress::Progress(std::string label, std::uint64_t total, std::string counted)
    : label_(std::move(label)),
      counted_(std::move(counted)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      next_(Clock::now() + std::chrono::seconds(1)),
      next_line_(next_) {}

Progress::~Progress() {
  if (shown_) say("");
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::add(std::uint64_t more) {
  const std::lock_guard lock(adding_);
  update(added_ += more);
}

void Progress::update(std::uint64_t done) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  // A search may take more steps than it expected.
  const double share = total_ == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(total_);
  const int percent = static_cast<int>(100.0 * std::min(1.0, share));
  std::string text = fmt::format("{} {} %", label_, percent);
  const double spent = std::chrono::duration<double>(now - start_).count();
  constexpr double seconds_to_estimate = 5.0;
  if (spent > seconds_to_estimate && !counted_.empty())
    text += fmt::format(", {:.3g} {} a second", static_cast<double>(done) / spent, counted_);
  if (spent > seconds_to_estimate && done > 0 && done < total_)
    text += fmt::format(", {} left",
                        spoken_time(spent * static_cast<double>(total_ - done) / static_cast<double>(done)));
  say(text);
  if (is_quiet()) return;
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
