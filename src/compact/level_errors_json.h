#pragma once
// Converts the errors of chunks to JSON and back, for errors_N.json and joint_N.json.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compact/streamed_sog_writer.h"

namespace binosplat {

/// Converts numbers times a factor to three significant digits: six directions give no more precision.
nlohmann::ordered_json json_of(double number, double factor = 1.0);
template <typename Item>
nlohmann::ordered_json json_of(const std::vector<Item>& list, double factor = 1.0) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Item& item : list) json.push_back(json_of(item, factor));
  return json;
}

nlohmann::ordered_json json_of(const std::vector<LevelErrors>& chunks);
/// Parses that JSON. Throws Error, which names the file, unless it has `chunks` chunks with `levels` levels.
std::vector<LevelErrors> parse_level_errors(const std::string& name, const std::string& text,
                                            std::size_t chunks, std::size_t levels);

/// The JSON of a joint scene's pictures, for joint_N.json.
nlohmann::ordered_json json_of(const std::vector<JointLoss>& pictures);
/// Returns measured over predicted error for each picture, except those that were not drawn or have a
/// predicted error of 0.
std::vector<double> loss_shares(const std::string& name, const std::string& text);
/// Returns whether there are pictures, and all of them were drawn.
bool all_drawn(const std::string& name, const std::string& text);

}  // namespace binosplat
