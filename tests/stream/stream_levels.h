#pragma once
// Writes a streamed SOG of any size, for tests that follow its levels.

#include <filesystem>
#include <string>
#include <vector>

#include "compact/streamed_sog_writer.h"
#include "formats/containers/content.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat::test {

/// Writes `count` Gaussians in chunks of 200, with three levels of increasing error, the same in all
/// directions.
inline void write_levels(const TempFolder& folder, std::size_t count) {
  const auto path = [&](const std::string& name) { return folder / name; };
  const auto learn = [](std::span<const std::vector<Model>> chunks) {
    std::vector<LevelErrors> errors;
    for (const std::vector<Model>& levels : chunks) {
      LevelErrors& chunk = errors.emplace_back();
      chunk.pixels = {0.1};
      chunk.seen.assign(detail_directions, {100.0});
      for (std::size_t level = 0; level < levels.size(); ++level)
        chunk.of_level.emplace_back(detail_directions, std::vector{2.0 * static_cast<double>(level)});
    }
    return errors;
  };
  const auto joint = [](std::span<const std::vector<Model>>, std::span<const LevelErrors>, int) {
    return std::vector<JointLoss>{{1.0, 1.0}};
  };
  Model model = random_model(1, static_cast<int>(count), 0);
  model.name = "model";
  write_streamed_sog(model, {.chunk = 200, .levels = 3},
                     {[&](const std::string& name) { return std::filesystem::exists(path(name)); },
                      [&](const std::string& name) { return read_text(path(name)); },
                      [&](const std::string& name, std::span<const std::byte> bytes) {
                        std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
                        write_text(path(name), std::string(as_text(bytes)));
                      }},
                     {learn, joint});
}

}  // namespace binosplat::test
