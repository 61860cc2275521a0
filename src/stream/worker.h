#pragma once
// The thread that chooses and reads levels of detail while frames are drawn.

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "shared/types.h"
#include "stream/chooser.h"
#include "stream/level_choice.h"
#include "stream/lod_files.h"

namespace binosplat {

/// Chooses levels for the last request and reads their chunks, until another request arrives. The thread's
/// loops use up to half of the cores; the other cores draw frames.
class StreamWorker {
 public:
  /// A request for levels, for views of one frame in the model's coordinates.
  struct Request {
    std::vector<shared::View> views;
    DetailRequest detail;
    VisibleChunks visible;
    std::size_t current_views = 0;  // number of current views, which precede predicted views
    Clock::time_point at = {};      // time of the current views
  };
  /// The last choice.
  struct Chosen {
    std::shared_ptr<RunningError> error;  // of the request's views; null if levels are not chosen by dB
    bool is_limited = false;              // the views need more Gaussians than may be read
    std::size_t current_views = 0;        // from the request, as is `at`
    Clock::time_point at = {};
    Clock::time_point made_at = {};
  };

  /// The files must outlive this object. `present` has the level of each chunk in the model.
  StreamWorker(const LodFiles& files, std::vector<std::size_t> present);
  StreamWorker(const StreamWorker&) = delete;
  StreamWorker& operator=(const StreamWorker&) = delete;

  /// Replaces the previous request. Does nothing after an error.
  void request(Request request);
  /// Returns loaded chunks of at least `gaussians` Gaussians together, or all that are ready.
  std::vector<LodFiles::LoadedChunk> take(std::size_t gaussians);
  /// Returns whether all requested chunks have been taken.
  bool is_idle() const;
  Chosen chosen() const;
  /// Returns whether the last request still waits for its choice.
  bool is_choosing() const;
  /// Rethrows an error of choosing or reading.
  void check() const;

 private:
  void run(const std::stop_token& stop);
  void work(const Request& request, const std::stop_token& stop);
  std::vector<std::size_t> drop_unwanted(const LevelChoice& choice);
  void add(LodFiles::LoadedChunk loaded, const std::stop_token& stop);

  const LodFiles& files_;
  Chooser chooser_;

  mutable std::mutex mutex_;  // guards the following members
  std::condition_variable_any changed_;
  std::vector<std::size_t> present_;  // levels of the chunks taken so far
  std::optional<Request> request_;
  bool is_at_work_ = false, is_choosing_ = false;
  std::deque<LodFiles::LoadedChunk> loaded_;
  std::size_t waiting_gaussians_ = 0;  // Gaussians of loaded_
  Chosen chosen_;
  std::exception_ptr error_;
  std::jthread thread_;  // the last member, so that it is joined first
};

}  // namespace binosplat
