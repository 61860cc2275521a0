#pragma once
// What a recording of frames says: which were bad and why, and what they all wait for.

#include <cstdint>
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

/// What was recorded, for whoever reads of it.
struct ProfileFacts {
  std::string scene, motion, drawing;  // the model; "tour walk"; "exact"
  std::string device;
  bool is_software = false;  // the CPU draws
};

/// What one more try showed: the share of a frame's time that this --quality saves.
struct Saving {
  double quality_db = 0.0, share = 0.0;
};

constexpr int worst_picture_width = 320;  // px

struct Profile {
  ProfileFacts facts;
  render::Recording recording;
  std::vector<std::optional<Image>> pictures;  // of the left eye in the worst frames, in their order
  std::optional<Saving> saving;
  std::vector<CpuUse> cpu;  // where the CPU draws: what each frame took of it, all threads; else empty
};

struct Quantiles {
  double median = 0.0, p90 = 0.0, p99 = 0.0, most = 0.0;
};

struct ProfileSummary {
  Quantiles wall, gpu, cpu;           // ms
  std::vector<gl::StageTime> stages;  // of the GPU: the mean over all frames
  std::vector<gl::StageTime> usual;   // of the GPU's stages and the CPU's work: the median
  std::size_t missed = 0;             // frames that were not done when the next one was due
  std::size_t gpu_bound = 0;          // frames in which the GPU takes longer than the CPU
  std::optional<Quantiles> mhz;
  std::size_t slow_clock = 0;      // frames
  std::vector<std::size_t> worst;  // up to ten frames that took longest, longest first
};

/// ms of a frame.
double gpu_ms(const render::FrameRecord& frame);  // of all its drawings
double cpu_ms(const render::FrameRecord& frame);  // of the thread that draws, without its waiting

bool is_missed(const render::Recording& recording, std::size_t n);

/// The fastest clock of all frames, MHz; 0 where none is known.
double fastest_mhz(const render::Recording& recording);

/// As render::events_of(), with the names of programs, and where the clock was low against `fastest`.
std::vector<render::FrameEvent> events_of(const render::Recording& recording, std::size_t n, double fastest);

/// Throws Error for a recording without frames.
ProfileSummary summary_of(const Profile& profile);

/// Why a frame took longer than others: its events, and what took longer than usual.
std::string reason_of(const Profile& profile, const ProfileSummary& summary, std::size_t n);

/// What bounds frames, as in "GPU (blend 61 %)".
std::string bound_of(const Profile& profile, const ProfileSummary& summary);

/// What to try next; empty where there is nothing.
std::string advice_of(const Profile& profile, const ProfileSummary& summary);

/// The lines that a terminal shows.
std::vector<std::string> lines_of(const Profile& profile, const ProfileSummary& summary);

/// A row for each frame, or for so many from the first on: the columns of frames.csv.
Table frames_table(const render::Recording& recording, std::size_t first = 0, std::size_t count = SIZE_MAX);
/// As many of those rows as are made at once: all of a long run would fill the memory.
constexpr std::size_t rows_at_once = 1000;

/// Takes a file's text, part after part.
using Write = std::function<void(std::string_view)>;

void write_frames(const render::Recording& recording, const Write& write);

/// Writes Trace Event JSON, as Perfetto and chrome://tracing read it: a track for the GPU and one for each
/// thread.
void write_trace(const Profile& profile, const Write& write);

/// `changes` are the lines of a comparison with an older run; none: there was no such.
Page profile_page(const Profile& profile, const ProfileSummary& summary,
                  const std::vector<std::string>& changes);

/// What the frames come to, as a row that others are compared with (results.h): its repeats are the medians
/// of up to ten stretches of frames, since frames beside each other share their disturbances. The details are
/// the worst frames, with their reasons.
Point profile_point(const Profile& profile, const ProfileSummary& summary);

}  // namespace binosplat::lab
