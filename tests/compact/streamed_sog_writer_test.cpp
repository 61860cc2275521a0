#include "compact/streamed_sog_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "base/parallel.h"
#include "formats/containers/content.h"
#include "formats/models/streamed_sog.h"
#include "scene/reduce.h"
#include "stream/lod_files.h"
#include "support/models.h"
#include "support/program.h"

namespace binosplat {
namespace {

using nlohmann::json;
using WrittenFiles = std::map<std::string, std::string>;

struct StreamedSogWriter : testing::Test {
  StreamedSogWriter() { model.name = "model"; }

  /// Writes the levels into `files`. After `most` files, writing fails.
  LevelsWritten write(WrittenFiles& files, std::size_t most = SIZE_MAX) const {
    std::mutex one_at_a_time;
    return write_streamed_sog(
        model, settings,
        {[&](const std::string& name) {
           const std::lock_guard lock(one_at_a_time);
           return files.contains(name);
         },
         [&](const std::string& name) {
           const std::lock_guard lock(one_at_a_time);
           return files.at(name);
         },
         [&](const std::string& name, std::span<const std::byte> bytes) {
           const std::lock_guard lock(one_at_a_time);
           if (files.size() == most) throw std::runtime_error("interrupted");
           EXPECT_FALSE(files.contains(name)) << name << " is written twice";
           files[name] = as_text(bytes);
         }},
        {[&](std::span<const std::vector<Model>> chunks) {
           for (const std::vector<Model>& levels : chunks) {
             for (std::size_t k = 0; k < levels.size(); ++k)
               append(measured_levels[k], levels[k], 0, levels[k].count());
           }
           return errors_of(chunks);
         },
         [&](std::span<const std::vector<Model>> chunks, std::span<const LevelErrors> errors, int of_scene) {
           EXPECT_EQ(chunks.size(), errors.size());
           EXPECT_EQ(errors.back().pixels.at(1), 1000.0);
           pictures.push_back(of_scene);
           return joint ? *joint : of_all(chunks, errors);
         }});
  }

  /// Returns errors that identify each chunk in lod-meta.json.
  static std::vector<LevelErrors> errors_of(std::span<const std::vector<Model>> chunks) {
    std::vector<LevelErrors> errors;
    for (const std::vector<Model>& levels : chunks) {
      LevelErrors& chunk = errors.emplace_back();
      chunk.pixels = {levels[0].position[0].x + 100.0, 1000.0};
      chunk.seen.assign(detail_directions, {levels[0].position[0].y + 100.0, 4.0});
      for (std::size_t level = 0; level < levels.size(); ++level)
        chunk.of_level.emplace_back(
            detail_directions,
            std::vector{0.123456 * static_cast<double>(level), static_cast<double>(levels[level].count())});
    }
    return errors;
  }

  /// Returns one joint loss. Its factor in the file depends on all chunks and errors, and so identifies them.
  static std::vector<JointLoss> of_all(std::span<const std::vector<Model>> chunks,
                                       std::span<const LevelErrors> errors) {
    double sum = 0.0;
    for (std::size_t k = 0; k < chunks.size(); ++k) {
      sum = 0.7 * sum + errors[k].seen[0][0];
      for (const Model& level : chunks[k]) sum = 0.7 * sum + level.position[0].x;
    }
    return {{1.0, 1.0 + 0.4 * std::sin(sum)}};
  }

  Model read(const WrittenFiles& files, int lod) const {
    const test::TempFolder folder;
    for (const auto& [name, bytes] : files) {
      std::filesystem::create_directories((folder / name).parent_path());
      test::write_text(folder / name, bytes);
    }
    return load_streamed_sog(folder / "lod-meta.json", json::parse(files.at("lod-meta.json")), lod);
  }

  Model model = test::random_model(1, 3000, 1);
  // By level: all Gaussians whose errors were measured.
  mutable std::vector<Model> measured_levels = std::vector(4, without_gaussians(model));
  mutable std::vector<int> pictures;            // pictures that were requested, by scene
  std::optional<std::vector<JointLoss>> joint;  // joint losses of each picture
  LevelSettings settings{.chunk = 200, .levels = 4};
};

/// Calls see(chunk) for each chunk of the tree.
void for_chunks(const json& node, const std::function<void(const json&)>& see) {
  if (node.contains("lods")) see(node);
  for (const json& child : node.value("children", json::array())) for_chunks(child, see);
}

TEST_F(StreamedSogWriter, MeasuresWrittenValues) {
  WrittenFiles files;
  write(files);
  for (int lod = 0; lod < 4; ++lod) {
    const Model drawn = read(files, lod);
    const Model& seen = measured_levels[static_cast<std::size_t>(lod)];
    EXPECT_EQ(seen.position, drawn.position) << lod;
    EXPECT_EQ(seen.scale, drawn.scale) << lod;
    EXPECT_EQ(seen.sh, drawn.sh) << lod;
  }
  EXPECT_NE(measured_levels[0].sh, model.sh) << "injected: what was to be written";
}

bool within(const json& bound, const glm::vec3& p, double slack) {
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    if (p[c] < bound["min"][k].get<double>() - slack || p[c] > bound["max"][k].get<double>() + slack)
      return false;
  }
  return true;
}

/// Returns the number of a level's Gaussians that lie beyond the bounds of their chunk, given by the chunks'
/// offsets. All chunks of a level are in one file.
int outside(const json& meta, const Model& level, int lod) {
  int count = 0;
  for_chunks(meta["tree"], [&](const json& chunk) {
    const json& part = chunk["lods"][std::to_string(lod)];
    const std::size_t first = part["offset"];
    for (std::size_t i = first; i < first + part["count"].get<std::size_t>(); ++i)
      count += i < level.count() && within(chunk["bound"], level.position[i], 1e-3) ? 0 : 1;
  });
  return count;
}

TEST_F(StreamedSogWriter, HalvesEachLevelWithinLeaves) {
  joint.emplace();  // no pictures
  WrittenFiles files;
  const LevelsWritten written = write(files);
  json meta = json::parse(files.at("lod-meta.json"));
  EXPECT_EQ(meta["version"], 1);
  EXPECT_FALSE(meta.contains("environment")) << "LichtFeld Studio refuses null";
  EXPECT_EQ(meta["lodLevels"], 4);
  EXPECT_EQ(meta["counts"], json(written.gaussians));
  EXPECT_EQ(meta["filenames"], json({"0_0/meta.json", "1_0/meta.json", "2_0/meta.json", "3_0/meta.json"}));
  EXPECT_EQ(written.files, 4u);
  EXPECT_EQ(written.kept, 0u);
  std::size_t total = 0;
  for (int lod = 0; lod < 4; ++lod) {
    const Model level = read(files, lod);
    EXPECT_EQ(level.count(), written.gaussians[static_cast<std::size_t>(lod)]);
    total += level.count();
    EXPECT_EQ(outside(meta, level, lod), 0);
  }
  EXPECT_EQ(meta["count"], total);
  int chunks = 0;
  for_chunks(meta["tree"], [&](const json& chunk) {
    ++chunks;
    const std::size_t finest = chunk["lods"]["0"]["count"];
    EXPECT_LE(finest, 200u);
    for (std::size_t lod = 0; lod < 4; ++lod) {
      const json& part = chunk["lods"][std::to_string(lod)];
      EXPECT_EQ(part["count"], (finest + (1u << lod) - 1) >> lod);
      const double error = lod == 1 ? 0.123 : lod == 2 ? 0.247 : lod == 3 ? 0.37 : 0.0;
      EXPECT_EQ(part["errors"],
                json(std::vector(detail_directions, std::vector{error, part["count"].get<double>()})))
          << "three digits";
    }
    EXPECT_EQ(chunk["pixels"][1], 1000.0);
    EXPECT_EQ(chunk["seen"][1][1], 4.0);
    const std::array of_chunk = {chunk["pixels"][0].get<double>(), chunk["seen"][1][0].get<double>()};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      EXPECT_GE(of_chunk[axis] - 100.0, chunk["bound"]["min"][axis].get<double>() - 0.5) << "of this chunk";
      EXPECT_LE(of_chunk[axis] - 100.0, chunk["bound"]["max"][axis].get<double>() + 0.5);
    }
  });
  EXPECT_GT(chunks, 16);
  EXPECT_EQ(written.gaussians[0], model.count());
  EXPECT_THROW(read(files, 4), Error);

  // Injected: the offsets of two chunks are swapped.
  std::vector<json*> parts;
  const std::function<void(json&)> walk = [&](json& node) {
    if (node.contains("lods")) parts.push_back(&node["lods"]["0"]);
    for (json& child : node["children"]) walk(child);
  };
  walk(meta["tree"]);
  std::swap((*parts.front())["offset"], (*parts.back())["offset"]);
  EXPECT_GT(outside(meta, read(files, 0), 0), 100);
}

TEST_F(StreamedSogWriter, ScalesErrorsByJointLoss) {
  settings.batch = 700;
  settings.joint_gaussians = 1500;  // two batches
  joint = {{1e-4, 2e-4}, {1e-4, 9e-4}, {1e-4, 1e-6}, {0.0, 0.0}};
  WrittenFiles files;
  write(files);
  const auto scenes = pictures.size();
  EXPECT_GE(scenes, 2u);
  EXPECT_LE(scenes, 3u);
  for (const int of_scene : pictures) EXPECT_TRUE(of_scene >= 1 && of_scene <= 12 / int(scenes)) << of_scene;
  const auto expect_errors = [&](double expected) {
    for_chunks(json::parse(files.at("lod-meta.json"))["tree"], [&](const json& chunk) {
      EXPECT_EQ(chunk["lods"]["2"]["errors"][0][0], expected);
      EXPECT_EQ(chunk["seen"][1][1], 4.0) << "the finest is as it was";
    });
  };
  expect_errors(0.494);  // twice 0.247
  for (const auto& absurd : {std::vector<JointLoss>{{1e-9, 1e-3}}, std::vector<JointLoss>{{0.0, 0.0}}, {}}) {
    files.clear();
    joint = absurd;
    write(files);
    expect_errors(!absurd.empty() && absurd[0].predicted > 0.0 ? 0.988 : 0.247);
  }
}

TEST_F(StreamedSogWriter, ResumesWithRemainingJointLosses) {
  settings.batch = 700;
  settings.joint_gaussians = 1500;  // two batches, or more
  WrittenFiles files;
  write(files);
  EXPECT_FALSE(files.contains("joint_2.json"));
  WrittenFiles again = files;
  again.erase("lod-meta.json");
  again.erase("joint_1.json");
  pictures.clear();
  write(again);
  EXPECT_EQ(again, files);
  EXPECT_EQ(pictures.size(), 1u);
  again.erase("lod-meta.json");
  again.erase("errors_1.json");
  again.erase("joint_0.json");
  write(again);
  EXPECT_EQ(again, files);
}

/// Returns the Gaussians sorted by x, which rounding hardly changes.
std::vector<std::size_t> by_x(const Model& model) {
  std::vector<std::size_t> order(model.count());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return model.position[a].x < model.position[b].x; });
  return order;
}

TEST_F(StreamedSogWriter, FinestLevelIsModel) {
  for (std::size_t i = 0; i < model.count(); ++i)  // farther apart than a step of the file's quantisation
    model.position[i].x = static_cast<float>((i * 977) % model.count()) / 300.0f;
  WrittenFiles files;
  write(files);
  const Model level = read(files, 0);
  ASSERT_EQ(level.count(), model.count());
  EXPECT_EQ(level.degree, model.degree);
  const auto a = by_x(model), b = by_x(level);
  double opacity = 0.0, colour = 0.0, scale = 0.0, place = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const std::size_t i = a[k], j = b[k];
    place = std::max<double>(place, glm::distance(model.position[i], level.position[j]));
    opacity = std::max<double>(opacity, std::abs(model.opacity[i] - level.opacity[j]));
    scale = std::max<double>(scale, glm::distance(glm::log(model.scale[i]), glm::log(level.scale[j])));
    for (std::size_t c = 0; c < 3; ++c)
      colour = std::max<double>(colour, std::abs(model.sh[12 * i + c] - level.sh[12 * j + c]));
  }
  EXPECT_LT(place, 1e-3);
  EXPECT_LE(opacity, 0.5 / 255.0 + 1e-6);
  EXPECT_LT(scale, 0.1);
  EXPECT_LT(colour, 0.05);
}

TEST_F(StreamedSogWriter, ResumesAfterInterrupt) {
  WrittenFiles whole;
  write(whole);
  ASSERT_EQ(whole.size(), 4u * 8 + 3);  // seven pictures and meta.json each
  for (const std::size_t most : {0, 1, 8, 9, 20, 32, 33, 34}) {
    WrittenFiles files;
    EXPECT_THROW(write(files, most), std::runtime_error);
    ASSERT_EQ(files.size(), most);
    EXPECT_FALSE(files.contains("lod-meta.json"));
    std::size_t complete = 0;
    for (int lod = 0; lod < 4; ++lod) {
      const std::string folder = std::to_string(lod) + "_0/";
      complete += files.contains(folder + "meta.json") ? 1 : 0;
      // Level folders without meta.json are written again.
      if (!files.contains(folder + "meta.json"))
        std::erase_if(files, [&](const auto& file) { return file.first.starts_with(folder); });
    }
    EXPECT_EQ(files.size(), 8 * complete + files.count("errors_0.json") + files.count("joint_0.json"))
        << "meta.json is written last";
    EXPECT_EQ(write(files).kept, complete);
    EXPECT_EQ(files, whole) << most;
  }
  WrittenFiles again = whole;
  again.erase("lod-meta.json");
  EXPECT_EQ(write(again).kept, 4u);
  EXPECT_EQ(again, whole);
  again.erase("lod-meta.json");
  again.erase("errors_0.json");
  EXPECT_EQ(write(again).kept, 4u);
  EXPECT_EQ(again, whole);
}

TEST_F(StreamedSogWriter, GroupsLeavesIntoFiles) {
  settings.file = 1000;   // five chunks of the finest level, or more
  settings.batch = 1500;  // seven chunks, or more
  WrittenFiles files;
  const std::size_t count = write(files).files;
  EXPECT_GT(count, 4u * 2);
  const json meta = json::parse(files.at("lod-meta.json"));
  std::map<std::string, std::size_t> ends;
  for_chunks(meta["tree"], [&](const json& chunk) {
    for (const auto& [lod, part] : chunk["lods"].items()) {
      const std::string file = meta["filenames"][part["file"].get<std::size_t>()];
      EXPECT_EQ(file[0], lod[0]);
      EXPECT_EQ(part["offset"], ends[file]);
      ends[file] += part["count"].get<std::size_t>();
    }
  });
  EXPECT_EQ(ends.size(), count);
  for (const auto& [file, end] : ends) {
    EXPECT_LE(end, 1000u) << file;
    EXPECT_EQ(json::parse(files.at(file))["count"], end) << file;
  }
  for (int lod = 0; lod < 4; ++lod)
    EXPECT_EQ(read(files, lod).count(), meta["counts"][static_cast<std::size_t>(lod)]);
  // After an interruption, only the missing half is written.
  WrittenFiles half = files;
  half.erase("lod-meta.json");
  std::erase_if(half, [](const auto& file) { return file.first.starts_with("1_1/"); });
  EXPECT_EQ(write(half).kept, count - 1);
  EXPECT_EQ(half, files);
}

TEST_F(StreamedSogWriter, AcceptsOneGaussian) {
  model = test::random_model(1, 1, 0);
  WrittenFiles files;
  EXPECT_EQ(write(files).gaussians, std::vector<std::size_t>(4, 1));
  for (int lod = 0; lod < 4; ++lod) EXPECT_EQ(read(files, lod).count(), 1u);
}

// Positions and scales near the limits of fp32.
TEST_F(StreamedSogWriter, AcceptsHugeValues) {
  for (std::size_t i = 0; i < model.count(); i += 100) {
    model.position[i] *= 3e37f;
    model.scale[i] = glm::vec3(3e38f);
  }
  WrittenFiles files;
  const LevelsWritten written = write(files);
  ASSERT_EQ(written.losses.size(), 1u);
  EXPECT_NE(written.losses[0].find("30 of 3000 Gaussians have scales beyond e^-20 to e^20"),
            std::string::npos);
  for (int lod = 0; lod < 4; ++lod)
    EXPECT_EQ(read(files, lod).count(), written.gaussians[static_cast<std::size_t>(lod)]);
}

TEST_F(StreamedSogWriter, DoesNotDependOnThreadCount) {
  settings.file = 1000;
  WrittenFiles many, one;
  write(many);
  const auto alone = without_helpers();
  write(one);
  EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace binosplat
