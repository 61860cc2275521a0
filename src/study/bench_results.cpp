#include "study/bench_results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

/// What points of one chart have in common.
std::string chart_of(const ordered_json& point) {
  return fmt::format("{}, {}, {}", point["scene"].get<std::string>(),
                     point["eyes"] == 2 ? "both eyes" : "one eye", point["size"].get<std::string>());
}

std::string identity(const ordered_json& point) { return chart_of(point) + " " + point["settings"].dump(); }

double psnr_of(const ordered_json& point) {
  const ordered_json& db = point["exact"]["psnr_db"];
  return db.is_number() ? std::min(db.get<double>(), equal_db) : equal_db;
}

double frame_ms(const ordered_json& point) { return point["frame_ms"].get<double>(); }

/// A member by a path such as "exact/psnr_db", or null.
ordered_json at(const ordered_json& point, const std::string& path) {
  const ordered_json::json_pointer pointer("/" + path);
  return point.contains(pointer) ? point.at(pointer) : ordered_json();
}

const char* const csv_columns[] = {"scene",
                                   "eyes",
                                   "size",
                                   "name",
                                   "settings/tiles",
                                   "settings/tile",
                                   "settings/precision",
                                   "settings/th",
                                   "settings/transmittance",
                                   "settings/loss",
                                   "device",
                                   "frame_ms",
                                   "p99_ms",
                                   "noise_ms",
                                   "settled",
                                   "submit_ms",
                                   "pairs",
                                   "visible",
                                   "gpu_bytes",
                                   "alphas",
                                   "alphas_visible",
                                   "exact/psnr_db",
                                   "exact/worst_psnr_db",
                                   "exact/ssim",
                                   "exact/flip",
                                   "exact/signed",
                                   "exact/disagreement_db",
                                   "photos/psnr_db",
                                   "photos/drop_db",
                                   "photos/ssim",
                                   "photos/flip",
                                   "stages_ms/project",
                                   "stages_ms/order",
                                   "stages_ms/pairs",
                                   "stages_ms/tile_sort",
                                   "stages_ms/ranges",
                                   "stages_ms/blend",
                                   "problem"};

std::string csv_field(const ordered_json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string text = "\"";
  for (const char c : value.get<std::string>()) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

}  // namespace

bool is_measured(const ordered_json& point) { return point.contains("frame_ms"); }

std::vector<bool> pareto_front(const ordered_json& points) {
  std::vector<bool> front(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_measured(points[i])) continue;
    front[i] = std::none_of(points.begin(), points.end(), [&](const ordered_json& other) {
      if (!is_measured(other) || chart_of(other) != chart_of(points[i])) return false;
      const double quicker = frame_ms(points[i]) - frame_ms(other),
                   nearer = psnr_of(other) - psnr_of(points[i]);
      return quicker >= 0 && nearer >= 0 && (quicker > 0 || nearer > 0);
    });
  }
  return front;
}

std::string csv(const ordered_json& results) {
  std::string text;
  for (const char* column : csv_columns) {
    std::string name = column;
    std::replace(name.begin(), name.end(), '/', '_');
    text += name + ",";
  }
  text += "pareto\n";
  const std::vector<bool> front = pareto_front(results["points"]);
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (const char* column : csv_columns) text += csv_field(at(results["points"][i], column)) + ",";
    text += front[i] ? "true\n" : "false\n";
  }
  return text;
}

std::vector<std::string> compare_results(const ordered_json& before, const ordered_json& now) {
  std::map<std::string, const ordered_json*> old;
  for (const ordered_json& point : before["points"]) {
    if (is_measured(point)) old[identity(point)] = &point;
  }
  std::vector<std::string> lines;
  int matched = 0, changed = 0;
  for (const ordered_json& point : now["points"]) {
    const auto found = old.find(identity(point));
    if (!is_measured(point) || found == old.end()) continue;
    ++matched;
    const ordered_json& was = *found->second;
    std::string line;
    const auto tell = [&](const std::string& text) { line += (line.empty() ? "" : "; ") + text; };
    const auto noise = [](const ordered_json& p) {
      return p["noise_ms"].is_number() ? p["noise_ms"].get<double>() : 0.0;
    };
    const double ms = frame_ms(point), old_ms = frame_ms(was);
    if (std::abs(ms - old_ms) > std::max(noise(point) + noise(was), 0.02 * old_ms))
      tell(fmt::format("{:.3f} ms -> {:.3f} ms ({:+.1f} %)", old_ms, ms, 100 * (ms / old_ms - 1)));
    if (std::abs(psnr_of(point) - psnr_of(was)) > 0.01)
      tell(fmt::format("{:.2f} dB -> {:.2f} dB", psnr_of(was), psnr_of(point)));
    const double pairs = point["pairs"].get<double>(), old_pairs = was["pairs"].get<double>();
    if (std::abs(pairs - old_pairs) > 1e-3 * old_pairs)
      tell(fmt::format("{:.0f} pairs -> {:.0f}", old_pairs, pairs));
    if (line.empty()) continue;
    ++changed;
    lines.push_back(fmt::format("{}, {}: {}", chart_of(point), point["name"].get<std::string>(), line));
  }
  lines.push_back(
      fmt::format("{} of {} points in both runs changed beyond noise; {} are new, {} are gone", changed,
                  matched, std::count_if(now["points"].begin(), now["points"].end(), is_measured) - matched,
                  static_cast<int>(old.size()) - matched));
  return lines;
}

}  // namespace binosplat::study
