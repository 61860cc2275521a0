#include "adagscale/calibration_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/choices.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "formats/containers/content.h"
#include "formats/containers/json_file.h"

namespace binosplat::adagscale {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t table_max = 100000;  // maximum number of bins; more are implausible

double at_least(double low, const JsonValue& value) {
  const double number = value.number();
  if (number < low) value.fail_here("{}: expected a number of {} or more", number, low);
  return number;
}

int pixels_of(const JsonValue& value) { return static_cast<int>(std::min(1e6, at_least(1.0, value))); }

std::uint64_t parse_hash(const JsonValue& value) {
  const std::string text = value.text();
  const bool good = text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!good) value.fail_here("{}: expected 16 hexadecimal digits", text);
  return std::stoull(text, nullptr, 16);
}

DepthTable parse_table(const JsonValue& table) {
  DepthTable out{static_cast<float>(at_least(1e-30, table.at("far"))), {}};
  const JsonValue upper = table.at("upper");
  if (upper.size() == 0 || upper.size() > table_max || !std::isfinite(out.far))
    table.fail_here("expected 1 to {} bins over a finite depth", table_max);
  for (const JsonValue& value : upper.items()) {
    const double bound = at_least(0.0, value);
    if (bound > 1.0) value.fail_here("{}: expected a number from 0 to 1", bound);
    out.bounds.push_back(static_cast<float>(bound));
  }
  return out;
}

template <typename Value>
Value parse_choice(const JsonValue& entry, const char* key, std::span<const Choice> choices) {
  return find_choice<Value>(fmt::format("{}, '{}'", entry.source(), key), entry.at(key).text(), choices);
}

CalibrationEntry parse_entry(const JsonValue& entry) {
  CalibrationEntry e;
  e.threshold = parse_choice<Threshold>(entry, "threshold", threshold_choices);
  e.transmittance = parse_choice<Transmittance>(entry, "transmittance", transmittance_choices);
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

}  // namespace

ordered_json json_of(const ThresholdCalibration& c) {
  const char* const target = c.target.kind == CalibrationTarget::Kind::drop ? "drop_db" : "psnr_db";
  ordered_json json = {
      {"format", "binosplat calibration"},
      {"version", 4},
      {"model",
       {{"name", c.model_name}, {"gaussians", c.gaussians}, {"hash", fmt::format("{:016x}", c.hash)}}},
      {"order", name_of(c.perspective.order)},
      {"projection", name_of(c.perspective.projection)},
      {"kernel_px2", c.kernel_px2},
      {"antialiased", c.antialiased},
      {"width", c.width},
      {"height", c.height},
      {"focal_px", c.focal},
      {"near", c.near_plane},
      {"target", {{target, c.target.db}}},
      {"depth_table",
       {{"far", c.depth_table.far}, {"upper", c.depth_table.bounds}, {"seconds", c.depth_table_seconds}}},
      {"views", ordered_json::array()},
      {"entries", ordered_json::array()}};
  for (const CalibratedView& view : c.views) {
    json["views"].push_back(
        {{"name", view.name}, {"position", {view.position.x, view.position.y, view.position.z}}});
  }
  if (std::isfinite(c.reach)) json["reach"] = c.reach;
  for (const CalibrationEntry& e : c.entries) {
    json["entries"].push_back({{"threshold", name_of(e.threshold)},
                               {"transmittance", name_of(e.transmittance)},
                               {"tolerance", e.tolerance},
                               {"reached_db", e.reached_db},
                               {"worst_db", e.worst_db},
                               {"worst_view", e.worst_view},
                               {"pairs_removed", e.pairs_removed},
                               {"evaluations", e.evaluations},
                               {"seconds", e.seconds}});
  }
  return json;
}

ThresholdCalibration parse_calibration(const std::string& name, const std::string& text) {
  const nlohmann::json root = parse_json(name, text);
  const JsonValue top(name, root);
  if (top.at("format").text() != "binosplat calibration" || top.at("version").number() != 4)
    fail("{}: not a calibration of this version: make it with binosplat calibrate", name);
  ThresholdCalibration c;
  const JsonValue model = top.at("model"), target = top.at("target"), table = top.at("depth_table");
  c.model_name = model.at("name").text();
  c.gaussians = static_cast<std::size_t>(std::min(1e12, at_least(0.0, model.at("gaussians"))));
  c.hash = parse_hash(model.at("hash"));
  c.perspective = {parse_choice<Order>(top, "order", order_choices),
                   parse_choice<Projection>(top, "projection", projection_choices)};
  c.kernel_px2 = at_least(0.0, top.at("kernel_px2"));
  const JsonValue antialiased = top.at("antialiased");
  if (!antialiased.value().is_boolean()) antialiased.fail_here("expected true or false");
  c.antialiased = antialiased.value();
  c.width = pixels_of(top.at("width"));
  c.height = pixels_of(top.at("height"));
  c.focal = at_least(1e-9, top.at("focal_px"));
  c.near_plane = at_least(0.0, top.at("near"));
  const bool drop = target.has("drop_db");
  c.target = {drop ? CalibrationTarget::Kind::drop : CalibrationTarget::Kind::quality,
              target.at(drop ? "drop_db" : "psnr_db").number()};
  c.depth_table = parse_table(table);
  c.depth_table_seconds = at_least(0.0, table.at("seconds"));
  if (top.has("reach")) c.reach = at_least(0.0, top.at("reach"));
  for (const JsonValue& view : top.at("views").items())
    c.views.push_back({view.at("name").text(), view.at("position").vector<3>()});
  for (const JsonValue& entry : top.at("entries").items()) c.entries.push_back(parse_entry(entry));
  return c;
}

ThresholdCalibration load_calibration(const std::filesystem::path& path) {
  return parse_calibration(path.string(), std::string(as_text(MappedFile(path).bytes())));
}

}  // namespace binosplat::adagscale
