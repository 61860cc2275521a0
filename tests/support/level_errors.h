#pragma once
// A streamed SOG whose file gives the errors of its levels.

#include <nlohmann/json.hpp>
#include <vector>

#include "stream/level_choice.h"
#include "support/broken.h"

namespace binosplat::test {

/// Adds errors of level 1 of each leaf to the lod-meta.json of a copy of sog/st-lod. The errors are equal in
/// all directions.
inline void add_level_errors(const Copy& copy) {
  copy.edit("lod-meta.json", [](nlohmann::json& meta) {
    for (const char* leaf : {"/children/0", "/children/1/children/0", "/children/1/children/1"}) {
      nlohmann::json& node = meta["tree"][nlohmann::json::json_pointer(leaf)];
      const auto from_everywhere = [](double number) {
        return std::vector(detail_directions, std::vector(1, number));
      };
      node["pixels"] = {0.1};
      node["seen"] = from_everywhere(100.0);
      node["lods"]["0"]["errors"] = from_everywhere(0.0);
      node["lods"]["1"]["errors"] = from_everywhere(2.0);
    }
  });
}

}  // namespace binosplat::test
