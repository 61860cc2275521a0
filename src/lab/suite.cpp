#include "lab/suite.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>

#include "adagscale/calibrate.h"
#include "base/choices.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/numbers.h"
#include "formats/containers/content.h"
#include "formats/containers/json_file.h"
#include "lab/embedded.h"
#include "lab/fields.h"
#include "scene/tour.h"

namespace binosplat::lab {

namespace {

/// A JSON object, with its name for errors. Refuses unknown keys.
class Block {
 public:
  Block(std::string place, const nlohmann::json& object, const std::set<std::string>& known)
      : place_(std::move(place)), object_(object) {
    if (!object_.is_object()) fail("{}: expected an object in braces", place_);
    for (const auto& [key, value] : object_.items()) {
      if (known.count(key) == 0) fail("{}: unknown key '{}'", place_, key);
    }
  }

  /// The key's values: its list, its single value, or `otherwise`.
  std::vector<nlohmann::json> values(const std::string& key, const nlohmann::json& otherwise) const {
    const nlohmann::json value = object_.contains(key) ? object_.at(key) : otherwise;
    if (!value.is_array()) return {value};
    if (value.empty()) fail("{}: '{}' is an empty list", place_, key);
    return {value.begin(), value.end()};
  }

  int whole(const std::string& key, const nlohmann::json& value, int low, int high) const {
    const bool good =
        value.is_number_integer() && value.get<std::int64_t>() >= low && value.get<std::int64_t>() <= high;
    if (!good)
      fail("{}: '{}' {}: expected a whole number from {} to {}", place_, key, value.dump(), low, high);
    return value.get<int>();
  }

  int one(const std::string& key, int otherwise, int low, int high) const {
    return object_.contains(key) ? whole(key, object_.at(key), low, high) : otherwise;
  }

  double number(const std::string& key, const nlohmann::json& value) const {
    const double number = value.is_number() ? value.get<double>() : -1.0;
    const bool good = number >= 0.0 && std::isfinite(static_cast<float>(number));
    if (!good) fail("{}: '{}' {}: expected a number of 0 or more", place_, key, value.dump());
    return number;
  }

  bool yes(const std::string& key, bool otherwise) const {
    const nlohmann::json value = object_.contains(key) ? object_.at(key) : nlohmann::json(otherwise);
    if (!value.is_boolean()) fail("{}: '{}' {}: expected true or false", place_, key, value.dump());
    return value.get<bool>();
  }

  bool has(const std::string& key) const { return object_.contains(key); }

  int choice(const std::string& key, const nlohmann::json& value, std::span<const Choice> choices) const {
    return find_choice(place_ + ", '" + key + "'",
                       value.is_string() ? value.get<std::string>() : value.dump(), choices);
  }

  const std::string& place() const { return place_; }

 private:
  std::string place_;
  const nlohmann::json& object_;
};

struct Key {
  const char* name;
  nlohmann::json otherwise;
  std::function<void(BenchSettings&, const nlohmann::json&)> set;
};

// The views on which the tolerance is found: the measured views, or training views.
constexpr Choice found_on_choices[] = {{"test", "the views that are measured"}, {"training", "others"}};

constexpr std::size_t max_settings = 10000;  // limit for all blocks together

/// Appends all combinations of a block's lists. The last key varies fastest.
void add_settings(const Block& block, std::vector<BenchSettings>& settings) {
  using S = BenchSettings;
  const auto choice = [&block]<typename Of, typename Value>(const char* key, Value Of::*member,
                                                            std::span<const Choice> choices) {
    return Key{key, choices[static_cast<std::size_t>(S{}.*member)].name,
               [&block, key, member, choices](S& s, const nlohmann::json& v) {
                 s.*member = static_cast<Value>(block.choice(key, v, choices));
               }};
  };
  const auto chosen = [&block]<typename Value>(const char* key, std::optional<Value> Settings::*member,
                                               std::span<const Choice> choices) {
    return Key{key, nullptr, [&block, key, member, choices](S& s, const nlohmann::json& v) {
                 if (!v.is_null()) s.*member = static_cast<Value>(block.choice(key, v, choices));
               }};
  };
  const auto positive = [&block](const char* key, const auto& set) {
    return Key{key, nullptr, [&block, key, set](S& s, const nlohmann::json& v) {
                 if (!v.is_null()) set(s, block.number(key, v));
               }};
  };
  const Key keys[] = {
      chosen("threshold", &S::threshold, threshold_choices),
      chosen("transmittance", &S::transmittance, transmittance_choices),
      positive("far", [](S& s, double v) { s.far = static_cast<float>(v); }),
      choice("tiles", &S::tiles, tiles_choices),
      choice("precision", &S::precision, precision_choices),
      positive("inset", [](S& s, double v) { s.foveation = stereo::Foveation{.inset_degrees = v}; }),
      positive("context",
               [](S& s, double v) {
                 if (s.foveation) s.foveation->context_scale = v;
               }),
      chosen("order", &S::order, order_choices),
      chosen("projection", &S::projection, projection_choices),
      {"detail", nullptr,
       [&block](S& s, const nlohmann::json& v) {
         if (!v.is_null())
           s.detail =
               parse_detail(v.is_string() ? v.get<std::string>() : v.dump(), block.place() + ", 'detail'");
       }},
      {"found_on", "test",
       [&block](S& s, const nlohmann::json& v) {
         s.found_on_training = block.choice("found_on", v, found_on_choices) == 1;
       }},
      positive("max_drop", [](S& s, double v) { s.max_drop = v; }),
      positive("min_psnr", [](S& s, double v) { s.min_psnr = v; }),
      positive("quality", [](S& s, double v) { s.quality = static_cast<float>(v); }),
      positive("tolerance", [](S& s, double v) { s.tolerance = static_cast<float>(v); }),
  };
  if (block.has("context") && !block.has("inset"))
    fail("{}: 'context' has no effect without 'inset' (the inset's width in degrees)", block.place());
  std::vector<S> all(1);
  for (const Key& key : keys) {
    const std::vector<nlohmann::json> values = block.values(key.name, key.otherwise);
    if (settings.size() + all.size() * values.size() > max_settings)
      fail("{}: with this block there are more than {} combinations", block.place(), max_settings);
    std::vector<S> next;
    for (const S& before : all) {
      for (const nlohmann::json& value : values) key.set(next.emplace_back(before), value);
    }
    all = std::move(next);
  }
  for (S& s : all) {
    if (!s.quality) s.threshold = render::chosen_threshold(s);
    if (!s.transmittance) s.transmittance = render::usual_source(render::chosen_threshold(s));
    if (s.transmittance != Transmittance::depth) s.far.reset();
    if (s.threshold == Threshold::adagscale && !s.tolerance && !s.quality && !s.max_drop && !s.min_psnr)
      s.min_psnr = adagscale::default_quality;
    s.found_on_training = s.found_on_training && s.finds_tolerance();
  }
  settings.insert(settings.end(), all.begin(), all.end());
}

void remove_repeated(std::vector<BenchSettings>& settings) {
  std::set<std::string> seen;
  std::erase_if(settings, [&](const auto& s) { return !seen.insert(row_of_settings(s).dump()).second; });
}

std::vector<std::string> along_of(const Block& top) {
  std::vector<std::string> along;
  for (const nlohmann::json& value : top.values("along", "views")) {
    const std::vector<std::string> choices = along_choices();
    along.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    if (std::ranges::find(choices, along.back()) == choices.end())
      fail("{}: 'along' {}: expected one of {}", top.place(), value.dump(), fmt::join(choices, ", "));
  }
  return along;
}

std::vector<std::string> sizes_of(const Block& top) {
  std::vector<std::string> sizes;
  for (const nlohmann::json& value : top.values("sizes", "own")) {
    if (!value.is_string() || !is_size(value.get<std::string>()))
      fail("{}: 'sizes' {}: expected own, WxH in px, preview or headset", top.place(), value.dump());
    sizes.push_back(value.get<std::string>());
  }
  return sizes;
}

}  // namespace

bool is_size(const std::string& text) {
  const auto two = two_numbers(text, 'x');
  const auto side = [](unsigned px) { return px >= 1 && px <= 99999; };
  if (text.starts_with('0') || text.find("x0") != std::string::npos) return false;
  return text == "own" || text == "preview" || text == "headset" ||
         (two && side(two->first) && side(two->second));
}

std::vector<std::string> along_choices() {
  std::vector<std::string> names = {"views", "still"};
  for (const Motion& motion : head_motions()) names.push_back(motion.name);
  return names;
}

Suite parse_suite(const std::string& name, const std::string& text) {
  const nlohmann::json root = parse_json(name, text);
  const Block top(name, root,
                  {"views", "training", "frames", "repeats", "perception", "contributions", "eyes", "sizes",
                   "along", "settings"});
  Suite suite;
  suite.name = name;
  suite.views = top.one("views", suite.views, 1, 100000);
  suite.training = top.one("training", suite.training, 0, 100000);
  suite.perception = top.yes("perception", suite.perception);
  suite.contributions = top.yes("contributions", suite.contributions);
  suite.frames = top.one("frames", suite.frames, 1, 100000);
  suite.repeats = top.one("repeats", suite.repeats, 1, 1000);
  suite.eyes.clear();
  for (const nlohmann::json& value : top.values("eyes", 1))
    suite.eyes.push_back(top.whole("eyes", value, 1, 2));
  suite.sizes = sizes_of(top);
  suite.along = along_of(top);
  if (!root.contains("settings") || !root["settings"].is_array() || root["settings"].empty())
    fail("{}: expected a list 'settings' of blocks", name);
  int number = 0;
  for (const nlohmann::json& object : root["settings"]) {
    const Block block(fmt::format("{}, settings, block {} (counted from 1)", name, ++number), object,
                      {"tiles", "threshold", "precision", "transmittance", "far", "inset", "context", "order",
                       "projection", "detail", "found_on", "max_drop", "min_psnr", "quality", "tolerance"});
    const std::size_t before = suite.settings.size();
    add_settings(block, suite.settings);
    for (std::size_t i = before; i < suite.settings.size(); ++i) check(block.place(), suite.settings[i]);
  }
  remove_repeated(suite.settings);
  return suite;
}

std::vector<std::string> suite_presets() {
  std::vector<std::string> names;
  for (const auto& [file, text] : preset_files()) names.push_back(file.substr(0, file.rfind(".json")));
  return names;
}

Suite load_suite(const std::string& preset_or_file) {
  const auto preset = preset_files().find(preset_or_file + ".json");
  if (preset != preset_files().end()) return parse_suite(preset_or_file, preset->second);
  std::error_code ignored;
  if (!std::filesystem::exists(preset_or_file, ignored))
    fail("`suite` {}: neither a preset ({}) nor a file", preset_or_file, fmt::join(suite_presets(), ", "));
  return parse_suite(preset_or_file, std::string(as_text(MappedFile(preset_or_file).bytes())));
}

nlohmann::ordered_json to_json(const Suite& suite) {
  std::vector<Row> settings;
  for (const BenchSettings& s : suite.settings) settings.push_back(row_of_settings(s));
  return object("views", suite.views, "training", suite.training, "frames", suite.frames, "repeats",
                suite.repeats, "perception", suite.perception, "contributions", suite.contributions, "eyes",
                suite.eyes, "sizes", suite.sizes, "along", suite.along, "settings", settings);
}

}  // namespace binosplat::lab
