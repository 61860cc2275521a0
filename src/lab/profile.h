#pragma once
// Analyses a recording of frames: which frames are slow and why, and whether GPU or CPU bounds them.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/page.h"
#include "lab/results.h"
#include "lab/times.h"
#include "render/recorder.h"

namespace binosplat::lab {

struct ProfileFacts {
  std::string scene, motion, drawing;  // such as "fox.ply", "tour walk", "exact"
  std::string device;
  bool is_software = false;  // the CPU draws
};

/// The part of a frame's time, `share`, that `--quality quality_db` saves, by an additional experiment.
struct Saving {
  double quality_db = 0.0, share = 0.0;
};

constexpr int worst_picture_width = 320;  // px

struct Profile {
  ProfileFacts facts;
  render::Recording recording;
  std::vector<std::optional<Image>> pictures;  // left eyes, in the order of ProfileSummary::worst
  std::optional<Saving> saving;
  std::vector<CpuUse> cpu;  // CPU time of each frame, all threads; only with a software renderer
};

struct Quantiles {
  double median = 0.0, p90 = 0.0, p99 = 0.0, max = 0.0;
};

struct ProfileSummary {
  Quantiles wall, gpu, cpu;       // ms
  std::vector<StageTime> stages;  // GPU stages: means over all frames
  std::vector<StageTime> usual;   // GPU stages and CPU work: medians over all frames
  std::size_t missed = 0;         // frames that ended after the next one was due
  std::size_t gpu_bound = 0;      // frames whose GPU time exceeds their CPU time
  std::optional<Quantiles> mhz;
  std::size_t slow_clock = 0;      // frames whose GPU clock was below 95 % of the fastest one
  std::vector<std::size_t> worst;  // up to ten slowest frames, slowest first
};

/// Times of a frame in ms.
double gpu_ms(const render::FrameRecord& frame);  // of all its drawings
double cpu_ms(const render::FrameRecord& frame);  // of the drawing thread, without its waits for the GPU

bool is_missed(const render::Recording& recording, std::size_t n);

/// The fastest clock of all frames, MHz; 0 if unknown.
double fastest_mhz(const render::Recording& recording);

/// Returns render::events_of() of frame `n` with the names of compiled programs. Adds an event if the clock
/// was below 95 % of `fastest` MHz.
std::vector<render::FrameEvent> events_of(const render::Recording& recording, std::size_t n, double fastest);

/// Throws Error for a recording without frames.
ProfileSummary summary_of(const Profile& profile);

/// Explains why frame `n` took long: by its events, and by the stage or CPU work that most exceeds its usual
/// time.
std::string reason_of(const Profile& profile, const ProfileSummary& summary, std::size_t n);

/// The resource that bounds the frames, as in "GPU (blend 61 %)".
std::string bound_of(const Profile& profile, const ProfileSummary& summary);

/// Suggests what to try next to make frames faster; empty if there is nothing.
std::string advice_of(const Profile& profile, const ProfileSummary& summary);

std::vector<std::string> lines_of(const Profile& profile, const ProfileSummary& summary);

/// The columns of frames.csv: a row for each frame, or for `count` frames from `first` on.
Table frames_table(const render::Recording& recording, std::size_t first = 0, std::size_t count = SIZE_MAX);
/// Number of rows to make at once, because all rows of a long run would fill the memory.
constexpr std::size_t rows_at_once = 1000;

/// Receives the next part of a file's text.
using Write = std::function<void(std::string_view)>;

void write_frames(const render::Recording& recording, const Write& write);

/// Writes Trace Event JSON for Perfetto and chrome://tracing, with a track for the GPU and for each thread.
void write_trace(const Profile& profile, const Write& write);

/// `changes` are the lines of a comparison with an older run; empty: no comparison.
Page profile_page(const Profile& profile, const ProfileSummary& summary,
                  const std::vector<std::string>& changes);

/// The frames as a row for comparisons (results.h). Its repeats are medians of up to ten stretches, because
/// neighbouring frames share disturbances. Its details are the worst frames with causes.
Point profile_point(const Profile& profile, const ProfileSummary& summary);

}  // namespace binosplat::lab
