#pragma once
// The rules of the Trace Event format that viewers require, and those that a profile guarantees in addition.

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "lab/profile.h"

namespace binosplat::test {

inline nlohmann::json trace_of(const lab::Profile& profile) {
  std::string text;
  lab::write_trace(profile, [&](std::string_view part) { text += part; });
  return nlohmann::json::parse(text);
}

/// Returns a trace's faults: missing keys of an event's kind, times below 0, slices of a track that overlap
/// without nesting, tracks without a name, stages outside their frame.
inline std::vector<std::string> faults_of_trace(const nlohmann::json& trace) {
  std::vector<std::string> faults;
  struct Slice {
    double begin, end;
    std::string name;
  };
  std::map<int, std::vector<Slice>> tracks;
  std::set<int> named;
  int processes = 0;
  for (const nlohmann::json& event : trace.at("traceEvents")) {
    const std::string kind = event.value("ph", ""), name = event.value("name", "");
    const auto fault = [&](const std::string& what) { faults.push_back(name + ": " + what); };
    if (name.empty() || !event.contains("pid") || !event.contains("tid")) fault("no name, pid or tid");
    if (kind == "M") {
      if (name == "process_name") ++processes;
      if (name == "thread_name") named.insert(event.at("tid").get<int>());
      continue;
    }
    if (!event.contains("ts") || !(event.at("ts").get<double>() >= 0.0)) fault("no ts, or one below 0");
    if (kind == "X") {
      const double begin = event.value("ts", -1.0), length = event.value("dur", -1.0);
      if (!(length >= 0.0)) fault("no dur, or one below 0");
      tracks[event.at("tid").get<int>()].push_back({begin, begin + length, name});
    } else if (kind == "C") {
      if (!event.contains("args") || !event.at("args").begin()->is_number())
        fault("a counter without a number");
    } else if (kind == "i") {
      if (event.value("s", "") != "t") fault("an instant that is no thread's");
    } else {
      fault("a kind of event that nobody writes: " + kind);
    }
  }
  if (processes != 1) faults.emplace_back("the process has no name, or many");
  constexpr double rounding = 0.01;  // us
  for (auto& [track, slices] : tracks) {
    if (!named.contains(track)) faults.push_back(fmt::format("track {} has no name", track));
    std::ranges::stable_sort(slices, [](const Slice& a, const Slice& b) {
      return a.begin < b.begin || (a.begin == b.begin && a.end > b.end);
    });
    std::vector<Slice> open;
    for (const Slice& slice : slices) {
      while (!open.empty() && open.back().end <= slice.begin + rounding) open.pop_back();
      if (!open.empty() && slice.end > open.back().end + rounding)
        faults.push_back(fmt::format("{} begins in {} and ends after it", slice.name, open.back().name));
      const bool is_frame = slice.name == "frame";
      if (track == 1 && is_frame != open.empty())
        faults.push_back(slice.name + " lies in no frame of the GPU");
      open.push_back(slice);
    }
  }
  return faults;
}

/// Parses frames.csv: numbers, yes and no, and texts without commas.
inline lab::Table frames_of(const std::string& csv) {
  lab::Table table;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::vector<lab::Cell> cells;
    std::istringstream in(line + ",");
    for (std::string text; std::getline(in, text, ',');) {
      if (table.columns.empty()) continue;
      const nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
      cells.push_back(value.is_number() ? lab::Cell(value.get<double>()) : lab::Cell(text));
    }
    if (table.columns.empty()) {
      std::istringstream names(line);
      for (std::string name; std::getline(names, name, ',');) table.columns.push_back(name);
    } else {
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

/// Returns the differences between the stages' sums in a trace and frames.csv.
inline std::vector<std::string> differences_of(const nlohmann::json& trace, const lab::Table& frames) {
  std::map<std::string, double> sums;  // ms by column and frame
  for (const nlohmann::json& event : trace.at("traceEvents")) {
    if (event.at("tid") != 1 || event.at("ph") != "X" || !event.at("args").contains("frame")) continue;
    const std::string column = "gpu_" + event.at("name").get<std::string>() + "_ms";
    sums[fmt::format("{} {}", column, event.at("args").at("frame").get<int>())] +=
        1e-3 * event.at("dur").get<double>();
  }
  std::vector<std::string> differences;
  for (std::size_t n = 0; n < frames.rows.size(); ++n) {
    double all = 0.0, gpu = 0.0;
    for (std::size_t k = 0; k < frames.columns.size(); ++k) {
      const std::string& name = frames.columns[k];
      if (name == "gpu_ms") gpu = frames.rows[n][k].get<double>();
      if (!name.starts_with("gpu_") || !name.ends_with("_ms") || name == "gpu_ms") continue;
      const double in_csv = frames.rows[n][k].get<double>();
      const double in_trace = sums[fmt::format("{} {}", name, n)];
      all += in_csv;
      if (std::abs(in_csv - in_trace) > 1e-4 + 1e-3 * in_csv)
        differences.push_back(
            fmt::format("frame {}: {} is {} there, and {} in the trace", n, name, in_csv, in_trace));
    }
    if (std::abs(all - gpu) > 1e-6)
      differences.push_back(fmt::format("frame {}: gpu_ms is not its stages' sum", n));
  }
  return differences;
}

}  // namespace binosplat::test
