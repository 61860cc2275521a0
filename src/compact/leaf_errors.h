#pragma once
// The JSON of the errors of leaves, as errors_N.json and together_N.json keep them.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compact/streamed_sog_writer.h"

namespace binosplat {

/// Numbers times a factor, to three digits: six directions do not determine more.
nlohmann::ordered_json json_of(double number, double factor = 1.0);
template <typename Item>
nlohmann::ordered_json json_of(const std::vector<Item>& list, double factor = 1.0) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Item& item : list) json.push_back(json_of(item, factor));
  return json;
}

/// Of a piece's leaves.
nlohmann::ordered_json json_of(const std::vector<LeafErrors>& leaves);
/// The same again, of so many leaves. Throws Error that names the file where that is not what it has.
std::vector<LeafErrors> leaf_errors(const std::string& name, const std::string& text, std::size_t leaves,
                                    std::size_t levels);

/// Of a scene's pictures.
nlohmann::ordered_json json_of(const std::vector<LossTogether>& pictures);
/// By how much more each loses than predicted, but those that are predicted to lose nothing, or were not
/// drawn.
std::vector<double> loss_shares(const std::string& name, const std::string& text);
/// Whether there are pictures, all of them drawn.
bool all_drawn(const std::string& name, const std::string& text);

}  // namespace binosplat
