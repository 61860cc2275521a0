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

double at_least(double low, const JsonValue& value) {
  const double number = value.number();
  if (number < low) value.fail_here("{}: expected a number of {} or more", number, low);
  return number;
}

int pixels(const JsonValue& value) { return static_cast<int>(std::min(1e6, at_least(1.0, value))); }

std::uint64_t parse_hash(const JsonValue& value) {
  const std::string text = value.text();
  const bool good = text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!good) value.fail_here("{}: expected 16 hexadecimal digits", text);
  return std::stoull(text, nullptr, 16);
}

render::DepthTable parse_table(const JsonValue& table) {
  render::DepthTable out{static_cast<float>(at_least(1e-30, table.at("far"))), {}};
  const JsonValue upper = table.at("upper");
  if (upper.size() == 0 || upper.size() > table_max || !std::isfinite(out.far))
    table.fail_here("expected 1 to {} bins over a finite depth", table_max);
  for (std::size_t k = 0; k < upper.size(); ++k) {
    const double bound = at_least(0.0, upper.at(k));
    if (bound > 1.0) upper.at(k).fail_here("{}: expected a number from 0 to 1", bound);
    out.bounds.push_back(static_cast<float>(bound));
  }
  return out;
}

int parse_choice(const JsonValue& entry, const char* key, std::span<const Choice> choices) {
  return find_choice(fmt::format("{}, '{}'", entry.source(), key), entry.at(key).text(), choices);
}

CalibrationEntry parse_entry(const JsonValue& entry) {
  CalibrationEntry e;
  e.th = parse_choice(entry, "th", th_choices);
  e.transmittance = parse_choice(entry, "transmittance", transmittance_choices);
  e.tolerance = at_least(0.0, entry.at("tolerance"));
  if (!std::isfinite(static_cast<float>(e.tolerance))) entry.at("tolerance").fail_here("is too large");
  e.reached_db = entry.at("reached_db").number();
  e.worst_db = entry.at("worst_db").number();
  e.worst_view = entry.at("worst_view").text();
  e.pairs_removed = entry.at("pairs_removed").number();
  e.evaluations = static_cast<int>(std::min(1e9, at_least(0.0, entry.at("evaluations"))));
  e.seconds = at_least(0.0, entry.at("seconds"));
  return e;
}

CalibratedView parse_view(const JsonValue& view) {
  return {view.at("name").text(), view.at("position").vector<3>()};
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
      object("name", c.model_name, "gaussians", c.gaussians, "hash", fmt::format("{:016x}", c.hash)), "order",
      order_choices[c.perspective.order].name, "projection",
      projection_choices[c.perspective.projection].name, "width", c.width, "height", c.height, "focal_px",
      c.focal, "near", c.near_plane, "target", object(target, c.target.db), "depth_table",
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
  const JsonValue top(name, root);
  if (top.at("format").text() != "binosplat calibration" || top.at("version").number() != 1)
    fail("{}: not a calibration of this version: make it with binosplat calibrate", name);
  Calibration c;
  const JsonValue model = top.at("model"), target = top.at("target"), table = top.at("depth_table");
  c.model_name = model.at("name").text();
  c.gaussians = static_cast<std::size_t>(std::min(1e12, at_least(0.0, model.at("gaussians"))));
  c.hash = parse_hash(model.at("hash"));
  // Files of earlier versions are of models' usual ones.
  if (top.has("order")) c.perspective.order = parse_choice(top, "order", order_choices);
  if (top.has("projection")) c.perspective.projection = parse_choice(top, "projection", projection_choices);
  c.width = pixels(top.at("width"));
  c.height = pixels(top.at("height"));
  c.focal = at_least(1e-9, top.at("focal_px"));
  c.near_plane = at_least(0.0, top.at("near"));
  const bool drop = target.has("drop_db");
  c.target = {drop ? CalibrationTarget::Kind::drop : CalibrationTarget::Kind::quality,
              target.at(drop ? "drop_db" : "psnr_db").number()};
  c.depth_table = parse_table(table);
  c.depth_table_seconds = at_least(0.0, table.at("seconds"));
  const JsonValue views = top.at("views"), entries = top.at("entries");
  for (std::size_t k = 0; k < views.size(); ++k) c.views.push_back(parse_view(views.at(k)));
  for (std::size_t k = 0; k < entries.size(); ++k) c.entries.push_back(parse_entry(entries.at(k)));
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
