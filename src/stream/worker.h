#pragma once
// The thread that chooses levels of detail and reads them while frames are drawn.

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
#include "stream/choice.h"
#include "stream/chooser.h"
#include "stream/lod_files.h"

namespace binosplat {

/// Chooses levels for the last request and reads their pieces, one after another, until another request
/// comes. Its loops use up to half of the cores; the others are for frames.
class StreamWorker {
 public:
  /// A choice that is to be made, for views of one frame in the model's frame of reference.
  struct Request {
    std::vector<shared::View> views;
    DetailRequest detail;
    VisibleChunks visible;
    std::size_t here = 0;       // views where the eyes were; they come first, and others lie ahead
    Clock::time_point at = {};  // when the eyes were there
  };
  /// The last choice.
  struct Chosen {
    std::shared_ptr<RunningError> error;  // what its views lose; none where levels are not chosen by dB
    bool is_limited = false;              // more is needed than the request allowed to read
    std::size_t here = 0;                 // as in the request, like `at`
    Clock::time_point at = {};
    Clock::time_point made_at = {};
  };

  /// The files must outlive it. `there` has the level of each chunk that the model has already.
  StreamWorker(const LodFiles& files, std::vector<std::size_t> there);
  StreamWorker(const StreamWorker&) = delete;
  StreamWorker& operator=(const StreamWorker&) = delete;

  /// Replaces the request before. Does nothing once choosing or reading has thrown.
  void request(Request request);
  /// Takes pieces that were read, until they have `gaussians` Gaussians; none where none were read.
  std::vector<LodFiles::Piece> take(std::size_t gaussians);
  /// Whether all that was requested has been taken.
  bool is_idle() const;
  Chosen chosen() const;
  /// Whether the choice that was requested last is still to be made.
  bool is_choosing() const;
  /// Throws what choosing or reading threw.
  void check() const;

 private:
  void run(const std::stop_token& stop);
  void work(const Request& request, const std::stop_token& stop);
  std::vector<std::size_t> keep_wanted(const LevelChoice& choice);
  void add(LodFiles::Piece piece, const std::stop_token& stop);

  const LodFiles& files_;
  Chooser chooser_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any changed_;
  std::vector<std::size_t> there_;  // the chunks' levels in the model, by what was taken
  std::optional<Request> request_;
  bool is_at_work_ = false, is_choosing_ = false;
  std::deque<LodFiles::Piece> pieces_;
  std::size_t waiting_ = 0;  // their Gaussians
  Chosen chosen_;
  std::exception_ptr trouble_;
  std::jthread thread_;  // last: it ends first
};

}  // namespace binosplat
