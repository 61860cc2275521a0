#include "compact/level_errors_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/containers/json_file.h"

namespace binosplat {

namespace {

void read(const JsonValue& json, double& number) { number = json.number(); }

template <typename Item>
void read(const JsonValue& json, std::vector<Item>& list) {
  list.resize(json.size());
  for (std::size_t k = 0; k < list.size(); ++k) read(json.at(k), list[k]);
}

}  // namespace

nlohmann::ordered_json json_of(double number, double factor) {
  return std::stod(fmt::format("{:.3g}", factor * number));
}

nlohmann::ordered_json json_of(const std::vector<LevelErrors>& chunks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LevelErrors& chunk : chunks) {
    json.push_back({{"pixels", json_of(chunk.pixels)},
                    {"seen", json_of(chunk.seen)},
                    {"errors", json_of(chunk.of_level)}});
  }
  return json;
}

std::vector<LevelErrors> parse_level_errors(const std::string& name, const std::string& text,
                                            std::size_t chunks, std::size_t levels) {
  const nlohmann::json json = parse_json(name, text);
  const JsonValue list = JsonValue(name, json).list_of(chunks);
  std::vector<LevelErrors> errors(chunks);
  for (std::size_t k = 0; k < chunks; ++k) {
    const JsonValue chunk = list.at(k);
    read(chunk.at("pixels"), errors[k].pixels);
    const auto by_direction = [&](const JsonValue& of) {
      for (std::size_t d = 0; d < detail_directions; ++d)
        of.list_of(detail_directions).at(d).list_of(errors[k].pixels.size());
      std::vector<std::vector<double>> numbers;
      read(of, numbers);
      return numbers;
    };
    errors[k].seen = by_direction(chunk.at("seen"));
    const JsonValue of_levels = chunk.at("errors").list_of(levels);
    for (std::size_t level = 0; level < levels; ++level)
      errors[k].of_level.push_back(by_direction(of_levels.at(level)));
  }
  return errors;
}

nlohmann::ordered_json json_of(const std::vector<JointLoss>& pictures) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const JointLoss& picture : pictures) {
    json.push_back(picture.drawn ? nlohmann::ordered_json{picture.predicted, picture.measured} : nullptr);
  }
  return json;
}

std::vector<double> loss_shares(const std::string& name, const std::string& text) {
  const nlohmann::json json = parse_json(name, text);
  const JsonValue pictures(name, json);
  std::vector<double> shares;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (json[k].is_null()) continue;
    const JsonValue picture = pictures.at(k).list_of(2);
    const double predicted = picture.at(0).number();
    if (predicted > 0.0) shares.push_back(picture.at(1).number() / predicted);
  }
  return shares;
}

bool all_drawn(const std::string& name, const std::string& text) {
  const nlohmann::json json = parse_json(name, text);
  return !json.empty() && std::ranges::none_of(json, [](const nlohmann::json& one) { return one.is_null(); });
}

}  // namespace binosplat
