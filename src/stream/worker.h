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

/// Reads what was requested last, a piece after the other, until another request comes. Decoding is done on
/// several cores, the rest of which are for frames.
class StreamWorker {
 public:
  /// A choice that is to be made: the views are those of one frame in the model's frame.
  struct Request {
    std::vector<shared::View> views;
    DetailRequest detail;
    VisibleChunks visible;
    std::size_t here = 0;       // of the views: they come first, and others lie ahead
    Clock::time_point at = {};  // when the eyes were there
  };
  /// The last choice.
  struct Chosen {
    std::shared_ptr<RunningError> error;  // that its views lose; none where it is not by dB
    bool is_limited = false;              // more is needed than it was allowed to have read
    std::size_t here = 0;                 // as the request says
    Clock::time_point at = {};
    Clock::time_point made_at = {};
  };

  /// Of files, which must outlive it, whose chunks are `there` at these levels.
  StreamWorker(const LodFiles& files, std::vector<std::size_t> there);
  StreamWorker(const StreamWorker&) = delete;
  StreamWorker& operator=(const StreamWorker&) = delete;

  /// Has this chosen and read instead of what was requested before; nothing, once something was thrown.
  void request(Request request);
  /// Some of the pieces that were read, until they have so many Gaussians; none where there are none.
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

  mutable std::mutex mutex_;  // of what follows
  std::condition_variable_any changed_;
  std::vector<std::size_t> there_;  // levels, of chunks that were taken
  std::optional<Request> request_;
  bool is_at_work_ = false, is_choosing_ = false;
  std::deque<LodFiles::Piece> pieces_;
  std::size_t waiting_ = 0;  // their Gaussians
  Chosen chosen_;
  std::exception_ptr trouble_;
  std::jthread thread_;  // last: it ends first
};

}  // namespace binosplat
