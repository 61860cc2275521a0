#include "study/motion_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace binosplat::study {

namespace {

using nlohmann::ordered_json;

std::string text(const ordered_json& value) { return value.get<std::string>(); }

/// Null where the part has no frames.
ordered_json of_part(const ordered_json& part, const char* key) {
  return part["frames"] == 0 ? ordered_json() : part[key];
}

ordered_json millions(const ordered_json& pairs) { return 1e-6 * pairs.get<double>(); }

ordered_json percent(const ordered_json& share) { return 100.0 * share.get<double>(); }

/// The path on which something of a rule is largest; not a number where it is none on any.
struct Worst {
  std::string rule, path;
  double value = -INFINITY;
};

/// By rule, of value(rule).
template <typename Value>
std::vector<Worst> worst_paths(const ordered_json& results, const Value& value) {
  std::vector<Worst> all;
  for (const ordered_json& path : results["paths"]) {
    all.resize(path["rules"].size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double here = value(path["rules"][k]);
      if (here <= all[k].value || std::isnan(all[k].value)) continue;
      all[k] = {text(path["rules"][k]["name"]), text(path["name"]), here};
    }
  }
  return all;
}

bool less(const Worst& a, const Worst& b) { return a.value < b.value; }

/// A column a path of what `value` takes from its rules.
template <typename Value>
void add_columns(const ordered_json& results, const std::string& what, const Value& value, Table& table) {
  for (const ordered_json& path : results["paths"]) {
    table.columns.push_back(fmt::format("{}: {}", text(path["name"]), what));
    for (std::size_t k = 0; k < table.rows.size(); ++k) table.rows[k].push_back(value(path["rules"][k]));
  }
}

Table rules_of(const ordered_json& results) {
  Table table{{"rule"}, {}};
  for (const ordered_json& rule : results["paths"][0]["rules"])
    table.rows.push_back(ordered_json::array({rule["name"]}));
  return table;
}

/// Whether rules keep their word.
Section words_kept(const ordered_json& results) {
  Table table = rules_of(results);
  const auto moving = [](const char* key) {
    return [key](const ordered_json& rule) { return rule["asked"]["moving"][key]; };
  };
  add_columns(results, "true dB", moving("true_db"), table);
  add_columns(results, "worst dB", moving("worst_db"), table);
  add_columns(results, "told minus true dB", moving("told_minus_true_db"), table);
  const auto worst = worst_paths(
      results, [](const ordered_json& rule) { return -rule["asked"]["moving"]["true_db"].get<double>(); });
  const auto [nearest, farthest] = std::minmax_element(worst.begin(), worst.end(), less);
  std::string sentence = fmt::format(
      "Every rule was asked for {:g} dB. “{}” falls least below: moving frames come to {:.1f} dB in the mean "
      "where it "
      "does worst ({})",
      results["quality_db"].get<double>(), nearest->rule, -nearest->value, nearest->path);
  if (farthest->value > nearest->value)
    sentence +=
        fmt::format("; “{}” falls most: {:.1f} dB ({})", farthest->rule, -farthest->value, farthest->path);
  return {"words", "Whether rules keep their word", sentence + ".", {}, table, ""};
}

double number_or_none(const ordered_json& value) { return value.is_number() ? value.get<double>() : NAN; }

/// What rules take at one true quality.
Section gains(const ordered_json& results) {
  Section section{"gains", "What rules take at one true quality", "", {}, {}, ""};
  bool compared = true, problems = false;
  for (const ordered_json& path : results["paths"]) {
    for (const ordered_json& rule : path["rules"]) {
      compared = compared && rule.contains("at_target");
      problems = problems || (rule.contains("at_target") && !text(rule["at_target"]["problem"]).empty());
    }
  }
  if (!compared) {
    section.problem = "This was not measured (--no-equal).";
    return section;
  }
  Table table = rules_of(results);
  const auto at = [](const char* key) {
    return [key](const ordered_json& rule) { return rule["at_target"][key]; };
  };
  add_columns(results, "ms of `one`", at("ms_of_one"), table);
  add_columns(results, "pairs of `one`", at("pairs_of_one"), table);
  add_columns(results, "ms of exact", at("ms_of_exact"), table);
  if (problems) add_columns(results, "why not", at("problem"), table);
  section.sentence = fmt::format(
      "At {:g} dB, the true mean of each path's moving frames: GPU time and pairs in those of the rule that "
      "takes all "
      "the light for granted, with the same threshold",
      results["target_db"].get<double>());
  std::vector<Worst> worst = worst_paths(results, [](const ordered_json& rule) {
    const ordered_json& at_target = rule["at_target"];
    return text(at_target["problem"]).empty() ? number_or_none(at_target["ms_of_exact"]) : NAN;
  });
  std::erase_if(worst, [](const Worst& one) { return std::isnan(one.value); });
  if (!worst.empty()) {
    const Worst best = *std::min_element(worst.begin(), worst.end(), less);
    section.sentence += fmt::format(". The fastest is “{}”: at most {:.2f} of the exact frame's time ({})",
                                    best.rule, best.value, best.path);
  }
  section.sentence += ".";
  section.table = table;
  return section;
}

/// A number of every frame of a path, its segments one after the other.
Series series_of(const std::string& name, const ordered_json& segments, const char* key, double scale,
                 const ordered_json& lengths) {
  Series series{name, {}, true, false, false};
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const ordered_json& values = segments[s][key];
    const std::size_t lead = lengths[s]["lead"], moving = lengths[s]["moving"];
    for (std::size_t n = 0; n < values.size(); ++n) {
      const char* part = n < lead ? "lead" : n < lead + moving ? "moving" : "stop";
      series.points.push_back({static_cast<double>(series.points.size()), scale * values[n].get<double>(),
                               fmt::format("stretch {}, {}", s + 1, part)});
    }
  }
  return series;
}

Section asked(const ordered_json& results, const ordered_json& path) {
  Plot plot{{"frame", ""}, {"PSNR", "dB"}, {}};
  for (const ordered_json& rule : path["rules"]) {
    const ordered_json& segments = rule["asked"]["segments"];
    plot.series.push_back(series_of(text(rule["name"]), segments, "true_db", 1.0, path["lengths"]));
    plot.series.push_back(
        series_of(text(rule["name"]) + ": told", segments, "told_db", 1.0, path["lengths"]));
  }
  const std::string name = text(path["name"]);
  return {
      "asked-" + name,
      fmt::format("{}: true and told", name),
      fmt::format(
          "{}; {}. Asked for {:g} dB; the worse eye's PSNR against the exact frame, of 8-bit pictures, and "
          "what the program told of itself. Means are over moving frames; {:g} dB are equal pictures.",
          text(path["motion"]), lengths_of(path), results["quality_db"].get<double>(),
          results["equal_pictures_db"].get<double>()),
      plot,
      asked_table(path),
      ""};
}

/// With `key` of the frames where all were asked for the same; the exact frame's beside them.
Plot costs(const ordered_json& path, const Axis& axis, const char* key, double scale) {
  Plot plot{{"frame", ""}, axis, {}};
  plot.series.push_back(series_of("exact", path["exact"]["segments"], key, scale, path["lengths"]));
  for (const ordered_json& rule : path["rules"])
    plot.series.push_back(
        series_of(text(rule["name"]), rule["asked"]["segments"], key, scale, path["lengths"]));
  return plot;
}

Section pairs(const ordered_json& results, const ordered_json& path) {
  const std::string name = text(path["name"]);
  Section section{"pairs-" + name,
                  fmt::format("{}: pairs", name),
                  fmt::format("Gaussian-tile pairs of a frame, a probe's included, asked for {:g} dB.",
                              results["quality_db"].get<double>()),
                  costs(path, {"pairs", "M"}, "pairs", 1e-6),
                  {},
                  ""};
  const Table table = target_table(path);
  if (table.rows.empty()) return section;
  section.table = table;
  section.sentence +=
      fmt::format(" The table is of the requests at which moving frames come to {:g} dB in the mean.",
                  results["target_db"].get<double>());
  return section;
}

Section times(const ordered_json& results, const ordered_json& path) {
  const std::string name = text(path["name"]);
  return {"times-" + name,
          fmt::format("{}: time", name),
          fmt::format("GPU time of a frame, the median of {} rounds in which rules took turns.",
                      results["rounds"].dump()),
          costs(path, {"GPU time", "ms"}, "frame_ms", 1.0),
          {},
          ""};
}

}  // namespace

Table asked_table(const ordered_json& path) {
  Table table{
      {"rule", "true dB", "tenth dB", "worst dB", "told minus true dB", "farthest dB", "lead, worst dB",
       "stop dB", "stop, worst dB", "pairs, M", "removed %", "drawn", "frame ms", "of exact", "of `one`"},
      {}};
  const ordered_json& exact = path["exact"]["moving"];
  table.rows.push_back({"exact", nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                        millions(exact["pairs"]), 0.0, 1.0, exact["frame_ms"], 1.0, nullptr});
  for (const ordered_json& rule : path["rules"]) {
    const ordered_json& one = rule["asked"];
    const ordered_json &moving = one["moving"], &lead = one["lead"], &stop = one["stop"];
    table.rows.push_back({rule["name"], moving["true_db"], moving["tenth_percentile_db"], moving["worst_db"],
                          moving["told_minus_true_db"], moving["told_minus_true_farthest_db"],
                          of_part(lead, "worst_db"), of_part(stop, "true_db"), of_part(stop, "worst_db"),
                          millions(moving["pairs"]), percent(moving["pairs_removed"]), moving["drawn"],
                          moving["frame_ms"], one["ms_of_exact"], one["ms_of_one"]});
  }
  return table;
}

Table target_table(const ordered_json& path) {
  Table table{{"rule", "asked for dB", "true dB", "tenth dB", "worst dB", "pairs, M", "pairs of `one`",
               "removed %", "drawn", "frame ms", "of exact", "of `one`", "why not"},
              {}};
  for (const ordered_json& rule : path["rules"]) {
    if (!rule.contains("at_target")) continue;
    const ordered_json& one = rule["at_target"];
    const ordered_json& moving = one["moving"];
    table.rows.push_back({rule["name"], one["request_db"], moving["true_db"], moving["tenth_percentile_db"],
                          moving["worst_db"], millions(moving["pairs"]), one["pairs_of_one"],
                          percent(moving["pairs_removed"]), moving["drawn"], moving["frame_ms"],
                          one["ms_of_exact"], one["ms_of_one"], one["problem"]});
  }
  return table;
}

std::string lengths_of(const ordered_json& path) {
  std::set<std::string> kinds;
  for (const ordered_json& one : path["lengths"]) {
    std::string kind =
        fmt::format("{} frames, after {} to find a loss", one["moving"].dump(), one["lead"].dump());
    if (one["stop"] != 0) kind += fmt::format(", then a stop of {}", one["stop"].dump());
    kinds.insert(std::move(kind));
  }
  const std::size_t count = path["lengths"].size();
  return fmt::format("{} of {}", count == 1 ? "one stretch" : fmt::format("{} stretches", count),
                     fmt::join(kinds, ", or of "));
}

Page motion_page(const ordered_json& results) {
  Page page;
  page.title = "Rules along moving heads on " + text(results["scene"]);
  page.data = results;
  page.facts = {{"device", results["device"]},
                {"scene", results["scene"]},
                {"Gaussians", results["gaussians"]},
                {"pictures", fmt::format("{} x {} x {} px", results["eyes"].dump(), results["width"].dump(),
                                         results["height"].dump())},
                {"frames a second", results["frames_per_second"]},
                {"a metre", fmt::format("{:.4g} world units ({})", results["units_per_metre"].get<double>(),
                                        text(results["metre_source"]))}};
  page.sections = {words_kept(results), gains(results)};
  page.sentence = page.sections.front().sentence;
  for (const ordered_json& path : results["paths"]) {
    page.sections.push_back(asked(results, path));
    page.sections.push_back(pairs(results, path));
    page.sections.push_back(times(results, path));
  }
  return page;
}

}  // namespace binosplat::study
