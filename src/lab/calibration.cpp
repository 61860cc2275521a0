#include "lab/calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/choices.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/json_file.h"
#include "lab/fields.h"
#include "lab/settings.h"

namespace binosplat::lab {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t table_max = 100000;  // bins: more is no table of depths

/// FNV-1a over words of four bytes.
class Hash {
 public:
  void add(std::uint32_t word) { state_ = (state_ ^ word) * 0x100000001b3ull; }
  void add(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    add(bits);
  }
  std::uint64_t state() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ull;
};

/// An object of the file; errors name the file and the key.
class Reader {
 public:
  Reader(std::string place, const nlohmann::json& object) : place_(std::move(place)), object_(object) {
    if (!object_.is_object()) fail("{}: expected an object in braces", place_);
  }

  const nlohmann::json& need(const char* key) const {
    if (!object_.contains(key)) fail("{}: '{}' is missing", place_, key);
    return object_.at(key);
  }
  double number(const char* key, double low = -std::numeric_limits<double>::infinity()) const {
    const nlohmann::json& value = need(key);
    const double v = value.is_number() ? value.get<double>() : NAN;
    if (!(std::isfinite(v) && v >= low))
      fail("{}: '{}' {}: expected a number of {} or more", place_, key, value.dump(), low);
    return v;
  }
  std::string text(const char* key) const {
    if (!need(key).is_string()) fail("{}: '{}' {}: expected a text", place_, key, need(key).dump());
    return need(key).get<std::string>();
  }
  const nlohmann::json& list(const char* key) const {
    if (!need(key).is_array()) fail("{}: '{}': expected a list", place_, key);
    return need(key);
  }
  int choice(const char* key, std::span<const Choice> choices) const {
    return find_choice(place_ + ", '" + key + "'", text(key), choices);
  }
  Reader object(const char* key) const { return {place_ + ", '" + key + "'", need(key)}; }
  bool has(const char* key) const { return object_.contains(key); }
  const std::string& place() const { return place_; }

 private:
  std::string place_;
  const nlohmann::json& object_;
};

std::uint64_t parse_hash(const Reader& model) {
  const std::string text = model.text("hash");
  const bool good = text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!good) fail("{}: 'hash' {}: expected 16 hexadecimal digits", model.place(), text);
  return std::stoull(text, nullptr, 16);
}

render::DepthTable parse_table(const Reader& table) {
  render::DepthTable out{static_cast<float>(table.number("far", 1e-30)), {}};
  for (const nlohmann::json& value : table.list("upper")) {
    const double v = value.is_number() ? value.get<double>() : NAN;
    if (!(v >= 0.0 && v <= 1.0))
      fail("{}: 'upper' {}: expected numbers from 0 to 1", table.place(), value.dump());
    out.bounds.push_back(static_cast<float>(v));
  }
  if (out.bounds.empty() || out.bounds.size() > table_max || !std::isfinite(out.far))
    fail("{}: expected 1 to {} bins over a finite depth", table.place(), table_max);
  return out;
}

/// Files of earlier versions may hold rules that are gone.
void refuse_gone(const Reader& entry) {
  const auto refuse = [&](const char* key) {
    fail("{}: '{}' '{}': there is no such rule any more: make the file anew with binosplat calibrate",
         entry.place(), key, entry.text(key));
  };
  if (entry.has("contrast") && entry.text("contrast") != "off") refuse("contrast");
  const std::string source = entry.text("transmittance");
  if (source == "other-eye" || source == "both") refuse("transmittance");
}

CalibrationEntry parse_entry(const Reader& entry) {
  refuse_gone(entry);
  CalibrationEntry e;
  e.th = entry.choice("th", th_choices);
  e.transmittance = entry.choice("transmittance", transmittance_choices);
  const char* key = entry.has("tolerance") ? "tolerance" : "loss";  // its name until 2026-11-22
  e.tolerance = entry.number(key, 0.0);
  if (!std::isfinite(static_cast<float>(e.tolerance))) fail("{}: '{}' is too large", entry.place(), key);
  e.reached_db = entry.number("reached_db");
  e.worst_db = entry.number("worst_db");
  e.worst_view = entry.text("worst_view");
  e.pairs_removed = entry.number("pairs_removed");
  e.evaluations = static_cast<int>(std::min(1e9, entry.number("evaluations", 0.0)));
  e.seconds = entry.number("seconds", 0.0);
  return e;
}

CalibratedView parse_view(const Reader& view) {
  const nlohmann::json& p = view.list("position");
  const bool good = p.size() == 3 && p[0].is_number() && p[1].is_number() && p[2].is_number();
  if (!good) fail("{}: 'position' {}: expected three numbers", view.place(), p.dump());
  return {view.text("name"), {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()}};
}

int pixels(const Reader& reader, const char* key) {
  return static_cast<int>(std::min(1e6, reader.number(key, 1.0)));
}

}  // namespace

std::uint64_t model_hash(const Model& model) {
  Hash hash;
  hash.add(static_cast<std::uint32_t>(model.count()));
  hash.add(static_cast<std::uint32_t>(model.degree));
  for (const auto* values : {&model.position, &model.scale}) {
    for (const glm::vec3& v : *values) {
      for (int i = 0; i < 3; ++i) hash.add(v[i]);
    }
  }
  for (const glm::vec4& v : model.rotation) {
    for (int i = 0; i < 4; ++i) hash.add(v[i]);
  }
  for (const float v : model.opacity) hash.add(v);
  for (const float v : model.sh) hash.add(v);
  return hash.state();
}

ordered_json to_json(const Calibration& c) {
  const char* const target = c.target.kind == CalibrationTarget::Kind::drop ? "drop_db" : "psnr_db";
  ordered_json json = object(
      "format", "binosplat calibration", "version", 1, "model",
      object("name", c.model_name, "gaussians", c.gaussians, "hash", fmt::format("{:016x}", c.hash)), "width",
      c.width, "height", c.height, "focal_px", c.focal, "near", c.near_plane, "target",
      object(target, c.target.db), "depth_table",
      object("far", c.depth_table.far, "upper", c.depth_table.bounds, "seconds", c.depth_table_seconds),
      "views", ordered_json::array(), "entries", ordered_json::array());
  for (const CalibratedView& view : c.views)
    json["views"].push_back(
        object("name", view.name, "position", std::array{view.position.x, view.position.y, view.position.z}));
  for (const CalibrationEntry& e : c.entries)
    json["entries"].push_back(object(
        "th", th_choices[e.th].name, "transmittance", transmittance_choices[e.transmittance].name,
        "tolerance", e.tolerance, "reached_db", e.reached_db, "worst_db", e.worst_db, "worst_view",
        e.worst_view, "pairs_removed", e.pairs_removed, "evaluations", e.evaluations, "seconds", e.seconds));
  return json;
}

Calibration parse_calibration(const std::string& name, const std::string& text) {
  const nlohmann::json root = parse_json(name, text);
  const Reader top(name, root);
  if (top.text("format") != "binosplat calibration" || top.number("version") != 1)
    fail("{}: not a calibration of this version: make it with binosplat calibrate", name);
  Calibration c;
  const Reader model = top.object("model");
  c.model_name = model.text("name");
  c.gaussians = static_cast<std::size_t>(std::min(1e12, model.number("gaussians", 0.0)));
  c.hash = parse_hash(model);
  c.width = pixels(top, "width");
  c.height = pixels(top, "height");
  c.focal = top.number("focal_px", 1e-9);
  c.near_plane = top.number("near", 0.0);
  const Reader target = top.object("target");
  const bool drop = top.need("target").contains("drop_db");
  c.target = {drop ? CalibrationTarget::Kind::drop : CalibrationTarget::Kind::quality,
              target.number(drop ? "drop_db" : "psnr_db")};
  const Reader table = top.object("depth_table");
  c.depth_table = parse_table(table);
  c.depth_table_seconds = table.number("seconds", 0.0);
  int number = 0;
  for (const nlohmann::json& view : top.list("views"))
    c.views.push_back(parse_view({fmt::format("{}, view {}", name, ++number), view}));
  number = 0;
  for (const nlohmann::json& entry : top.list("entries"))
    c.entries.push_back(parse_entry({fmt::format("{}, entry {}", name, ++number), entry}));
  return c;
}

Calibration load_calibration(const std::filesystem::path& path) {
  return parse_calibration(path.string(), std::string(as_text(MappedFile(path).bytes())));
}

bool is_of(const Calibration& calibration, const Model& model) {
  return calibration.gaussians == model.count() && calibration.hash == model_hash(model);
}

bool covers(const Calibration& calibration, const glm::dvec3& position) {
  const auto nearest = [&](const glm::dvec3& p, const CalibratedView* but) {
    double distance = std::numeric_limits<double>::infinity();
    for (const CalibratedView& view : calibration.views) {
      if (&view != but) distance = std::min(distance, glm::length(view.position - p));
    }
    return distance;
  };
  if (calibration.views.size() < 2) return true;
  double reach = 0.0;
  for (const CalibratedView& view : calibration.views) reach = std::max(reach, nearest(view.position, &view));
  return nearest(position, nullptr) <= 2.0 * reach;
}

std::optional<render::FrameSettings> calibrated(const Calibration& calibration,
                                                render::FrameSettings settings, double focal) {
  for (const CalibrationEntry& e : calibration.entries) {
    if (e.th != settings.th || e.transmittance != settings.transmittance) continue;
    settings.tolerance =
        static_cast<float>(e.tolerance * std::pow(focal / calibration.focal, tolerance_power));
    settings.depth_table = calibration.depth_table;
    return settings;
  }
  return std::nullopt;
}

}  // namespace binosplat::lab
