#include "stream/worker.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/thread_spans.h"

namespace binosplat {

namespace {

// Maximum number of loaded Gaussians that wait for take(): a quarter of a GB with all harmonics.
constexpr std::size_t max_waiting_gaussians = 1 << 20;
constexpr double cores_share = 0.5;  // the other cores draw frames

}  // namespace

StreamWorker::StreamWorker(const LodFiles& files, std::vector<std::size_t> present)
    : files_(files), chooser_(files), present_(std::move(present)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void StreamWorker::request(Request request) {
  const std::lock_guard lock(mutex_);
  request_ = std::move(request);
  changed_.notify_all();
}

std::vector<LodFiles::LoadedChunk> StreamWorker::take(std::size_t gaussians) {
  std::vector<LodFiles::LoadedChunk> taken;
  const std::lock_guard lock(mutex_);
  for (std::size_t count = 0; !loaded_.empty() && count < gaussians;) {
    LodFiles::LoadedChunk& loaded = taken.emplace_back(std::move(loaded_.front()));
    loaded_.pop_front();
    present_[loaded.chunk] = loaded.level;
    count += loaded.model.count();
    waiting_gaussians_ -= loaded.model.count();
  }
  if (!taken.empty()) changed_.notify_all();
  return taken;
}

bool StreamWorker::is_idle() const {
  const std::lock_guard lock(mutex_);
  return !request_ && !is_at_work_ && loaded_.empty() && !error_;
}

StreamWorker::Chosen StreamWorker::chosen() const {
  const std::lock_guard lock(mutex_);
  return chosen_;
}

bool StreamWorker::is_choosing() const {
  const std::lock_guard lock(mutex_);
  return request_ || is_choosing_;
}

void StreamWorker::check() const {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
}

void StreamWorker::run(const std::stop_token& stop) {
  name_thread("reads levels");
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return request_.has_value(); })) {
    const Request request = *std::exchange(request_, std::nullopt);
    is_at_work_ = is_choosing_ = true;
    lock.unlock();
    std::exception_ptr error;
    try {
      on_some_cores(cores_share, [&] { work(request, stop); });
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    is_at_work_ = is_choosing_ = false;
    error_ = error;
    if (error) return;
  }
}

void StreamWorker::work(const Request& request, const std::stop_token& stop) {
  const auto begin = Clock::now();
  const auto choice =
      std::make_shared<const LevelChoice>(chooser_.choose(request.views, request.detail, request.visible));
  add_span("choose levels", begin);
  Chosen chosen{.is_limited = choice->is_limited, .current_views = request.current_views, .at = request.at};
  if (choice->has_errors()) chosen.error = std::make_shared<RunningError>(choice, request.visible.drawn);
  chosen.made_at = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    std::swap(chosen_, chosen);  // frees the previous choice outside the lock, so that no frame waits
    is_choosing_ = false;
  }
  const TimedSpan span("read levels");
  files_.read(
      drop_unwanted(*choice), *choice, [&](LodFiles::LoadedChunk loaded) { add(std::move(loaded), stop); },
      [&] {
        const std::lock_guard lock(mutex_);
        return !stop.stop_requested() && !request_;
      });
}

// Drops loaded chunks that the choice does not need. Returns each chunk's level once the rest is taken.
std::vector<std::size_t> StreamWorker::drop_unwanted(const LevelChoice& choice) {
  const std::lock_guard lock(mutex_);
  std::erase_if(loaded_, [&](const LodFiles::LoadedChunk& loaded) {
    const bool is_wanted = choice.levels[loaded.chunk] == loaded.level;
    if (!is_wanted) waiting_gaussians_ -= loaded.model.count();
    return !is_wanted;
  });
  std::vector<std::size_t> levels = present_;
  for (const LodFiles::LoadedChunk& loaded : loaded_) levels[loaded.chunk] = loaded.level;
  return levels;
}

void StreamWorker::add(LodFiles::LoadedChunk loaded, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop, [&] { return waiting_gaussians_ < max_waiting_gaussians || request_; });
  waiting_gaussians_ += loaded.model.count();
  loaded_.push_back(std::move(loaded));
}

}  // namespace binosplat
