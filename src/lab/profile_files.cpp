// Writes frames.csv and trace.json of a profile.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "lab/profile.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;
using render::FrameEvent;
using render::FrameRecord;
using render::Recording;

std::string dumped(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

/// The names of all stages, in order of appearance.
std::vector<std::string> stage_names_of(const Recording& recording) {
  std::vector<std::string> names;
  for (const FrameRecord& frame : recording.frames) {
    for (const StageSpan& span : frame.report.spans) {
      if (std::ranges::find(names, span.name) == names.end()) names.push_back(span.name);
    }
  }
  return names;
}

/// ms of the spans of this name that ended within a frame.
double ms_of_spans(const Recording& recording, const FrameRecord& frame, const std::string& name) {
  double ms = 0.0;
  auto span = std::ranges::lower_bound(recording.spans, frame.begin, {}, &ThreadSpan::end);
  for (; span != recording.spans.end() && span->end <= frame.end; ++span) {
    if (span->name == name) ms += ms_between(span->begin, span->end);
  }
  return ms;
}

std::string text_of(const std::vector<FrameEvent>& events) {
  std::string text;
  for (const FrameEvent& event : events) text += (text.empty() ? "" : "; ") + event.text();
  return text;
}

/// Writes events one by one, because a long run has millions. Times are in microseconds since `start`.
class TraceEvents {
 public:
  TraceEvents(Clock::time_point start, const Write& write) : start_(start), write_(write) {}

  void name(const char* what, int track, const std::string& name) {
    add({{"name", what}, {"ph", "M"}}, track, {{"name", name}});
  }
  void name_track(int track, const std::string& track_name) {
    name("thread_name", track, track_name);
    add({{"name", "thread_sort_index"}, {"ph", "M"}}, track, {{"sort_index", track}});
  }
  void slice(const std::string& name, int track, Clock::time_point begin, Clock::time_point end,
             const ordered_json& args = {}) {
    add({{"name", name}, {"ph", "X"}, {"ts", us(begin)}, {"dur", us_between(begin, end)}}, track, args);
  }
  void counter(const std::string& name, Clock::time_point at, double value) {
    add({{"name", name}, {"ph", "C"}, {"ts", us(at)}}, 0, {{"value", value}});
  }
  void instant(const FrameEvent& event, int track, Clock::time_point at) {
    add({{"name", event.name}, {"ph", "i"}, {"s", "t"}, {"ts", us(at)}}, track, {{"detail", event.detail}});
  }

 private:
  static double us_between(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double, std::micro>(std::max(end, begin) - begin).count();
  }
  double us(Clock::time_point at) const { return us_between(start_, at); }
  void add(ordered_json event, int track, const ordered_json& args) {
    event["pid"] = 1;
    event["tid"] = track;
    if (!args.is_null()) event["args"] = args;
    write_((std::exchange(is_first_, false) ? "" : ",") + dumped(event));
  }

  Clock::time_point start_;
  const Write& write_;
  bool is_first_ = true;
};

constexpr int gpu_track = 1, drawing_track = 2;

void add_gpu(const Recording& recording, std::size_t n, TraceEvents& events) {
  const auto& spans = recording.frames[n].report.spans;
  if (spans.empty() || spans.back().end_ns == 0) return;  // this driver has no timestamps
  const auto at = [&](std::int64_t gpu_ns) { return recording.cpu_time(gpu_ns); };
  events.slice("frame", gpu_track, at(spans.front().begin_ns), at(spans.back().end_ns),
               {{"frame", n}, {"gpu_ms", gpu_ms(recording.frames[n])}});
  for (const StageSpan& span : spans)
    events.slice(span.name, gpu_track, at(span.begin_ns), at(span.end_ns), {{"frame", n}});
}

void add_cpu(const Recording& recording, std::size_t n, double fastest, TraceEvents& events) {
  const FrameRecord& frame = recording.frames[n];
  const std::vector<FrameEvent> happened = events_of(recording, n, fastest);
  events.slice("frame", drawing_track, frame.begin, frame.end,
               {{"frame", n}, {"events", text_of(happened)}, {"missed", is_missed(recording, n)}});
  for (const FrameEvent& event : happened) events.instant(event, drawing_track, frame.begin);
  events.counter("pairs", frame.begin, static_cast<double>(frame.report.pairs));
  events.counter("Gaussians in view", frame.begin, static_cast<double>(frame.report.visible));
  events.counter("Gaussians of the model", frame.begin, static_cast<double>(frame.gaussians));
  events.counter("GPU memory, MB", frame.begin, 1e-6 * static_cast<double>(frame.report.gpu_bytes));
  if (frame.mhz) events.counter("GPU clock, MHz", frame.begin, *frame.mhz);
}

/// The earliest time in a recording, on CPU or GPU.
Clock::time_point start_of(const Recording& recording) {
  Clock::time_point start = recording.first.cpu;
  for (const ThreadSpan& span : recording.spans) start = std::min(start, span.begin);
  for (const FrameRecord& frame : recording.frames) {
    start = std::min(start, frame.begin);
    if (!frame.report.spans.empty() && frame.report.spans.back().end_ns != 0)
      start = std::min(start, recording.cpu_time(frame.report.spans.front().begin_ns));
  }
  return start;
}

}  // namespace

Table frames_table(const Recording& recording, std::size_t first, std::size_t count) {
  const std::vector<std::string> stages = stage_names_of(recording);
  const double fastest = fastest_mhz(recording);
  Table table{{"frame", "begin_ms", "late_ms", "wall_ms", "missed", "gpu_ms"}, {}};
  for (const std::string& stage : stages) table.columns.push_back("gpu_" + stage + "_ms");
  for (const char* name : {"cpu_ms",  "levels_ms",  "plan_ms",         "upload_ms", "submit_ms",
                           "wait_ms", "read_ms",    "choose_ms",       "pairs",     "visible",
                           "width",   "height",     "gaussians",       "gpu_bytes", "levels_uploaded",
                           "exact",   "redraws",    "new_programs",    "tolerance", "quality_db",
                           "mhz",     "display_ms", "displays_missed", "events"})
    table.columns.emplace_back(name);
  const std::size_t end = first + std::min(count, recording.frames.size() - first);
  for (std::size_t n = first; n < end; ++n) {
    const FrameRecord& frame = recording.frames[n];
    const Report& report = frame.report;
    std::vector<Cell>& cells =
        table.rows.emplace_back(row(n, ms_between(recording.frames.front().begin, frame.begin),
                                    std::max(0.0, ms_between(frame.due, frame.begin)), frame.wall_ms(),
                                    is_missed(recording, n), gpu_ms(frame)));
    std::map<std::string, double> by_stage;
    for (const StageSpan& span : report.spans) by_stage[span.name] += span.ms();
    for (const std::string& stage : stages) cells.emplace_back(by_stage[stage]);
    const Cell display = frame.display ? Cell(frame.display->predicted_ms) : Cell(),
               displays = frame.display ? Cell(frame.display->missed) : Cell();
    for (Cell& cell :
         row(cpu_ms(frame), frame.levels.ms, report.plan_ms, report.upload_ms, report.submit_ms,
             report.wait_ms, report.read_ms, ms_of_spans(recording, frame, "choose levels"), report.pairs,
             report.visible, frame.views.front().width, frame.views.front().height, frame.gaussians,
             report.gpu_bytes, frame.levels.uploaded, name_of(report.exact), report.redraws,
             report.new_programs, static_cast<double>(report.tolerance), render::measured_quality(report),
             frame.mhz, display, displays, text_of(events_of(recording, n, fastest))))
      cells.push_back(std::move(cell));
  }
  return table;
}

void write_frames(const Recording& recording, const Write& write) {
  for (std::size_t n = 0; n < recording.frames.size(); n += rows_at_once) {
    Table rows_table = frames_table(recording, n, rows_at_once);
    if (n > 0) rows_table.columns.clear();
    write(csv(rows_table));
  }
}

void write_trace(const Profile& profile, const Write& write) {
  const Recording& recording = profile.recording;
  const ProfileFacts& facts = profile.facts;
  write("{\"displayTimeUnit\":\"ms\",\"otherData\":" +
        dumped({{"scene", facts.scene}, {"motion", facts.motion}, {"device", facts.device}}) +
        ",\"traceEvents\":[");
  TraceEvents events(start_of(recording), write);
  events.name("process_name", 0, "binosplat: " + facts.scene);
  events.name_track(gpu_track, facts.is_software ? "GPU (the CPU draws)" : "GPU");
  std::map<std::string, int> tracks = {{"draws", drawing_track}};
  for (const ThreadSpan& span : recording.spans)
    tracks.try_emplace(span.thread, static_cast<int>(tracks.size()) + drawing_track);
  for (const auto& [name, track] : tracks) events.name_track(track, "thread that " + name);
  const double fastest = fastest_mhz(recording);
  for (std::size_t n = 0; n < recording.frames.size(); ++n) {
    add_gpu(recording, n, events);
    add_cpu(recording, n, fastest, events);
  }
  for (const ThreadSpan& span : recording.spans)
    events.slice(span.name, tracks.at(span.thread), span.begin, span.end);
  write("]}");
}

}  // namespace binosplat::lab
