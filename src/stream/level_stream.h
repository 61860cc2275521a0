#pragma once
// Levels of detail that are read while frames are drawn.

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "base/clock.h"
#include "scene/model_parts.h"
#include "stream/head_motion.h"
#include "stream/level_sample.h"
#include "stream/look_bands.h"
#include "stream/streamed_sog.h"

namespace binosplat {

/// A streamed SOG whose levels are chosen by one thread and read by another. The parts of its model that are
/// there stay until others have been read, and then change places with them a few at a time, so that no frame
/// waits for more.
class LevelStream {
 public:
  /// What views of a frame need; called by the thread that chooses.
  using Need = std::function<DetailNeed(const StreamedSog& scene, std::span<const shared::View> views)>;

  /// Where it would go by dB, a scene of `all_up_to` Gaussians or fewer is shown at its finest levels, if
  /// there is room at first. Throws Error as StreamedSog does.
  LevelStream(const std::filesystem::path& path, Need need, std::size_t all_up_to = 0);
  /// Waits for what is being decoded.
  ~LevelStream() = default;
  LevelStream(const LevelStream&) = delete;
  LevelStream& operator=(const LevelStream&) = delete;

  /// The model at its coarsest levels, to begin with, and with room for what these views may need, or a few
  /// million Gaussians; whether it goes by dB is for good, unless it shares them. Throws Error where a file
  /// has become unreadable, or if the file has no errors to go by for such a need.
  Model coarsest(std::span<const shared::View> views = {});

  /// How many dB frames may lose together with levels (FrameSettings::quality), where the need shares that;
  /// 0: nothing. May change at any time.
  void share(double together_db);
  /// What of it is left for a frame with the levels that the model has now: all, where levels are not gone
  /// by.
  double left() const;

  /// Has read what these views need, which are those of one frame in the model's frame, instead of what
  /// others needed. By dB it calls `look` first, which tells what one of them shows of each part: for one
  /// view in each call, since a frame has little time, or for a band of one, where that took longer than
  /// three quarters of give_time() the last time and frames come fast. For all of them no more than ten times
  /// a second; until then what was wanted stays.
  ///
  /// While the views move, the second half of them is looked at where they will be by the time that levels
  /// are there, a single view both here and there: levels come for all. No more is wanted than frames take
  /// until the next choice, or 16,384 Gaussians. Levels that are needed no more stay for a second, or until
  /// all has come, if there is room: much that a moving head's eyes lose behind something comes back.
  using Look =
      std::function<std::vector<SeenPart>(const shared::View& view, Band band, const ModelParts& parts)>;
  void want(std::span<const shared::View> views, const Look& look);

  /// How many ms of a frame are for a look, for what it takes and for uploading that: time_for_levels(), or
  /// as many as it gives at most, until this is called.
  void give_time(double ms) { brings_ms_ = ms; }
  static constexpr double brings_most_ms = 6.0;

  /// Puts what was read meanwhile into the model that coarsest() made: no more than `most` Gaussians, nor
  /// more than a frame has time for with a look that was made for it and with uploading, but one part
  /// at least unless the look took all of it; where something is left after a look, the next frame makes
  /// none. Once take_ahead() was called only what that has put there, and then the frame makes no look.
  /// Throws what choosing or reading it threw; then nothing more is read.
  ModelParts::Changes take(Model& model, std::size_t most);

  /// Goes on putting Gaussians into the model in a thread of its own while a frame is drawn, as many as the
  /// next one has time to upload, unless that is to look: its take() ends that and hands them over. A frame
  /// is then take(), uploading that, want(), try_out(), take_ahead() and drawing. Until the next take(), or
  /// the end of this, which the model must outlive, nobody else may read its Gaussians, nor parts(), nor call
  /// want() or try_out().
  void take_ahead(Model& model, std::size_t most);

  /// By dB: finds on a sample of parts what the levels truly lose, by pictures of the first of the views that
  /// were looked at last, in frames that neither look nor take anything; choices, and what is told, go by it.
  /// To be called in each frame, after take(), of which everything must be on the GPU.
  void try_out(Model& model, const PartsTrial& trial);

  /// Whether the model has all that was wanted, and no more, and nothing is to be looked at again.
  bool settled() const;
  /// Gaussians of the model.
  std::size_t gaussians() const { return gaussians_; }
  const ModelParts& parts() const { return parts_; }
  /// What the views are taken to have now against the finest levels, in dB, with the levels that the model
  /// has now: of those that were looked at last, where they were and ahead of that, by how long ago it was.
  /// None where dB are not gone by, or nothing was looked at yet.
  std::optional<double> predicted_psnr() const;

 private:
  static constexpr double between_looks_ms = 100.0;
  /// Of a frame's time, that a look or uploading is expected to take: either may take longer.
  static constexpr double expected_share = 0.75;
  struct Wish {
    std::vector<shared::View> views;
    DetailSeen seen;
    std::size_t here = 0;            // of the views: they come first, and others lie ahead
    Clock::time_point at, ahead_at;  // when eyes are there
    double together_db = 0.0, found = 1.0;
    std::optional<unsigned> sample = {};  // is wanted, and which
    bool rests = false;                   // the head
  };
  /// The finest levels of parts of a choice, and the view that they are tried out in, in four frames.
  struct Sample {
    std::shared_ptr<LevelsLost> lost;
    shared::View view;
    PartModels models;           // then those that were there
    bool waits_for_all = false;  // that was chosen, before it is tried out
  };
  /// What take_ahead() asked for, and what came of it.
  struct Ahead {
    Model* model = nullptr;
    std::size_t most = 0;
    Clock::time_point begin;
    std::size_t taken = 0;
    double took_ms = 0.0;
    bool is_at_work = false, ends = false;
  };
  bool look_on(const Look& look);
  std::size_t here() const;
  void choose_on(const std::stop_token& stop);
  void choose(const Wish& wish);
  void read_on(const std::stop_token& stop);
  void read(std::shared_ptr<const LevelsChosen> chosen, const std::stop_token& stop);
  void read(Sample sample);
  bool works(double share_of_cores, const std::function<void()>& work);
  void sort_pieces();
  void free_used();
  void take_now(Model& model, std::size_t most, double ms);
  void take_on(const std::stop_token& stop);
  void end_ahead();
  bool looks_next() const;
  void note_taken(std::size_t taken, double ms);
  void note_uploaded();
  std::optional<std::size_t> take_some(Model& model, std::size_t most, bool is_first);
  bool has_pieces() const { return !pieces_.empty() || !taken_.empty(); }
  bool is_idle() const {
    return !wish_ && !chooses_ && !next_ && !next_sample_ && !reads_ && !sample_ && !has_pieces();
  }
  bool looks_again() const;
  bool tries_out() const;  // in this frame; under the lock
  std::optional<unsigned> next_sample();
  std::size_t to_come();

  StreamedSog scene_;  // the reading thread's, once there is one, and its chooser that of the other
  Need need_;
  ModelParts parts_;
  std::size_t all_up_to_;
  bool shows_all_ = false;                     // the finest levels
  bool asked_by_db_ = false, shares_ = false;  // as the need says, but then
  double together_db_ = 0.0;
  bool by_db_ = false;
  std::vector<shared::View> wanted_;
  HeadMotion motion_;
  bool is_due_ = false;             // to be wished
  std::vector<std::size_t> drawn_;  // places of the parts' levels, in the model,
  std::size_t gaussians_ = 0;       // which has so many, but for those taken ahead
  double brings_ms_ = brings_most_ms;
  double look_ms_ = 0.0;         // since the last take(),
  bool take_is_due_ = false;     // instead of a look: in this frame, or of what one had left no time for
  double taken_a_ms_ = 1 << 14;  // Gaussians, by the last ones,
  double uploaded_a_ms_ = 1 << 15;
  std::size_t could_take_ = 0;  // since the last choice was wished, if one
  std::size_t new_ = 0;         // Gaussians of the last take(),
  Clock::time_point taken_at_;  // which ended then
  bool has_wished_ = false;
  // By dB:
  LevelsFound found_;
  bool is_tried_out_ = false;  // by somebody
  unsigned samples_ = 0;
  int frames_since_sample_ = 0;  // was wanted
  bool may_try_ = false;         // in this frame
  bool found_other_ = false;     // than before, since the last look
  enum class Trial { keeps, exchanges, compares, puts_back } trial_ = Trial::keeps;
  int looks_ = 0;                            // at these views, all of them
  std::vector<shared::View> looked_;         // a look at some of the views, each as it was then,
  std::vector<std::vector<SeenPart>> seen_;  // and what it showed
  bool moves_ = false;                       // while these are looked at
  std::size_t to_look_at_ = 0;               // so many views
  LookBands bands_;                          // of the last of them
  int bands_looked_at_ = 0;                  // of all
  bool changed_since_look_ = false;
  std::optional<Clock::time_point> looked_at_;
  Clock::time_point ahead_at_;  // when eyes will be where the first look ahead was

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::condition_variable_any came_;  // pieces, or somebody to take them, or the end of that
  std::optional<Wish> wish_;
  std::shared_ptr<const LevelsChosen> next_;    // to be read for
  std::optional<Sample> next_sample_, sample_;  // to be read, and to be tried out
  bool chooses_ = false, reads_ = false;
  std::deque<StreamedSog::Piece> pieces_;
  std::vector<StreamedSog::Piece> used_;  // freed by the reader, since frames must not wait for that
  std::size_t gaussians_read_ = 0;        // of these
  std::optional<Ahead> ahead_;
  struct Taken {
    std::size_t part = 0;
    std::optional<std::size_t> level;
    std::size_t count = 0;
  };
  std::vector<Taken> taken_;                       // since the last take()
  std::shared_ptr<LevelsLost> lost_;               // by the last choice; what it follows is the frames'
  std::size_t here_ = 0;                           // of its views (Wish)
  Clock::time_point chosen_at_, chosen_ahead_at_;  // Wish.at, ahead_at
  double asked_db_ = 0.0;                          // that it is for,
  double asked_of_ = 0.0;                          // of what is shared
  bool lingers_ = false;                           // LevelsChosen
  bool is_limited_ = false;                        // likewise
  std::exception_ptr trouble_;
  std::jthread chooser_, reader_, taker_;  // last: they end first
};

/// What is left for levels of a frame that is due after so many ms, where drawing takes so long: 2.5 ms at
/// least, or a head would wait for levels forever, and 6 at most.
double time_for_levels(double frame_ms, double drawn_ms);

}  // namespace binosplat
