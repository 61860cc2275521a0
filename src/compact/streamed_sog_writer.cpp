#include "compact/streamed_sog_writer.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/statistics.h"
#include "compact/level_errors_json.h"
#include "formats/containers/json_file.h"
#include "formats/models/model_writers.h"
#include "formats/models/morton.h"
#include "formats/models/sog_source.h"
#include "scene/merge.h"
#include "scene/reduce.h"
#include "scene/space_partition.h"

namespace binosplat {

namespace {

using nlohmann::ordered_json;

// Pixel width that a level is merged for, divided by the level's spacing (stream/level_choice.h). The spacing
// assumes a square as wide as the box's diagonal; true spacings are smaller.
constexpr double pixel_share = 0.2;
// The Gaussians to merge are chosen once for all levels, for the pixel width of this level.
constexpr int merge_level = 3;
// Pictures of many chunks: one for chunks_a_picture chunks, at most max_pictures, at least one per scene.
constexpr std::size_t chunks_a_picture = 4, max_pictures = 12;
constexpr double max_joint_factor = 4.0;  // limit of joint_factor() and of its inverse

struct Chunk {
  std::span<const std::uint32_t> indices;
  Box box;                    // around one-sigma ellipsoids, with the model's origin added
  ordered_json lods;          // files, ranges and errors of its levels
  ordered_json pixels, seen;  // as in LevelErrors

  std::size_t count(int level) const { return ((indices.size() - 1) >> level) + 1; }
  double pixel(int level) const {
    return pixel_share * glm::distance(box.low, box.high) / std::sqrt(static_cast<double>(count(level)));
  }
};

/// A SOG: one level of consecutive chunks.
struct File {
  std::string folder;
  int level = 0;
  std::size_t first_chunk = 0, chunks = 0;
  std::size_t count = 0;
  bool is_there = false;

  std::string meta_name() const { return folder + "/meta.json"; }
};

/// Chunks that are processed together, and the files of all their levels.
struct Batch {
  std::string errors;  // name of the file with the errors of all levels
  std::size_t first_chunk = 0, chunks = 0;
  std::vector<File> files;
};

using Levels = std::vector<Model>;  // of a chunk, from the finest

/// Batches that are drawn together as one model, in pictures of many chunks.
struct JointScene {
  std::string losses;  // name of the file with the losses of these pictures
  std::size_t first_batch = 0, batches = 0, count = 0;
};

/// The contents of all files, planned before anything is written.
struct Plan {
  SpaceTree tree;
  std::vector<Chunk> chunks;
  std::vector<Batch> batches;
  std::vector<JointScene> scenes;
  std::vector<std::string> filenames;         // of all SOGs; "file" in Chunk::lods is an index of this list
  std::vector<std::size_t> gaussians, files;  // by level
};

/// Collects in order the largest nodes that have at most `most` Gaussians, and the leaves that have more.
void find_nodes(const SpaceNode& node, std::size_t most, std::vector<const SpaceNode*>& nodes) {
  if (node.count <= most || node.children.empty()) return nodes.push_back(&node);
  for (const SpaceNode& child : node.children) find_nodes(child, most, nodes);
}

void add_files(std::size_t level, std::size_t most, Batch& batch, Plan& plan) {
  for (std::size_t i = batch.first_chunk; i < plan.chunks.size(); ++i) {
    Chunk& chunk = plan.chunks[i];
    const std::size_t count = chunk.count(static_cast<int>(level));
    if (i == batch.first_chunk || batch.files.back().count + count > most) {
      batch.files.push_back({fmt::format("{}_{}", level, plan.files[level]++), static_cast<int>(level), i});
      plan.filenames.push_back(batch.files.back().meta_name());
    }
    File& file = batch.files.back();
    chunk.lods[std::to_string(level)] = {
        {"file", plan.filenames.size() - 1}, {"offset", file.count}, {"count", count}};
    ++file.chunks;
    file.count += count;
    plan.gaussians[level] += count;
  }
}

Plan make_plan(const Model& model, const LevelSettings& settings) {
  Plan plan{.tree = make_space_tree(model.position, settings.chunk)};
  for (auto* by_level : {&plan.gaussians, &plan.files})
    by_level->resize(static_cast<std::size_t>(settings.levels));
  std::vector<const SpaceNode*> nodes;
  find_nodes(plan.tree.root, settings.batch, nodes);
  const std::size_t all = model.count(), scenes = (all - 1) / settings.joint_gaussians + 1;
  for (std::size_t i = 0; i < nodes.size();) {
    Batch batch{fmt::format("errors_{}.json", plan.batches.size()), plan.chunks.size(), 0, {}};
    // Consecutive nodes share a batch, since nodes of far outliers have only a few Gaussians.
    std::size_t count = 0;
    std::vector<const SpaceNode*> chunks;
    do {
      find_nodes(*nodes[i], 0, chunks);
      count += nodes[i]->count;
    } while (++i < nodes.size() && count + nodes[i]->count <= settings.batch);
    for (const SpaceNode* chunk : chunks)
      plan.chunks.push_back({std::span(plan.tree.order).subspan(chunk->first, chunk->count), {}, {}});
    batch.chunks = chunks.size();
    for (std::size_t level = 0; level < plan.files.size(); ++level)
      add_files(level, settings.file, batch, plan);
    // Joint scenes have about equal numbers of Gaussians.
    if (plan.scenes.empty() || plan.scenes.back().count * scenes >= all)
      plan.scenes.push_back({fmt::format("joint_{}.json", plan.scenes.size()), plan.batches.size()});
    ++plan.scenes.back().batches;
    plan.scenes.back().count += count;
    plan.batches.push_back(std::move(batch));
  }
  const auto measure = [&](Chunk& chunk) { chunk.box = bounds_of(model, chunk.indices) + model.axes.origin; };
  parallel_for(plan.chunks.size(), [&](std::size_t i) { measure(plan.chunks[i]); });
  return plan;
}

ordered_json box_json(const Box& b) {
  return {{"min", {b.low.x, b.low.y, b.low.z}}, {"max", {b.high.x, b.high.y, b.high.z}}};
}

/// Returns the JSON of a node, and its box. `next` points to the chunk of the next leaf.
std::pair<ordered_json, Box> node_json(const SpaceNode& node, const Chunk*& next) {
  if (node.children.empty()) {
    const Chunk& chunk = *next++;
    return {{{"bound", box_json(chunk.box)},
             {"pixels", chunk.pixels},
             {"seen", chunk.seen},
             {"lods", chunk.lods}},
            chunk.box};
  }
  Box around;
  ordered_json children;
  for (const SpaceNode& child : node.children) {
    auto [json, box] = node_json(child, next);
    children.push_back(std::move(json));
    around.include(box.low, box.high);
  }
  return {{{"bound", box_json(around)}, {"children", std::move(children)}}, around};
}

/// Returns lod-meta.json. The chunks must already have the errors of their levels.
ordered_json meta_json(const Plan& plan) {
  const Chunk* next = plan.chunks.data();
  return {{"version", 1},
          {"asset", {{"generator", "binosplat"}}},
          {"count", std::accumulate(plan.gaussians.begin(), plan.gaussians.end(), std::size_t{0})},
          {"counts", plan.gaussians},
          {"lodLevels", plan.gaussians.size()},
          {"filenames", plan.filenames},
          {"tree", node_json(plan.tree.root, next).first}};
}

/// Returns the finest level in Morton order, whose pictures compress best.
Model finest(const Model& model, const Chunk& chunk) {
  const Model as_it_lies = with_order(model, chunk.indices);
  return with_order(as_it_lies, morton_order(as_it_lies.position));
}

Levels levels_of(const Model& model, const Chunk& chunk, int coarsest) {
  Levels levels{finest(model, chunk)};
  Merger merger(levels[0], chunk.pixel(merge_level));
  std::vector<Model> merged;
  for (int level = 1; level <= coarsest; ++level) {
    merger.merge_to(chunk.count(level));
    merged.push_back(merger.result(chunk.pixel(level)));
  }
  std::move(merged.begin(), merged.end(), std::back_inserter(levels));
  return levels;
}

class LevelsWriter {
 public:
  LevelsWriter(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
               const MeasureLevels& measure)
      : model_(model),
        settings_(settings),
        folder_(folder),
        measure_(measure),
        plan_(make_plan(model, settings)) {}

  LevelsWritten write() {
    LevelsWritten written{plan_.gaussians, plan_.filenames.size(), 0, sog_losses(model_)};
    std::size_t work = 0;
    for (Batch& batch : plan_.batches) {
      for (File& file : batch.files) {
        file.is_there = folder_.has(file.meta_name());
        (file.is_there ? written.kept : work) += file.is_there ? 1 : file.count;
      }
      for (std::size_t i = 0; i < batch.chunks && !std::ranges::all_of(batch.files, &File::is_there); ++i)
        work += plan_.chunks[batch.first_chunk + i].count(0);
    }
    Progress progress("writing levels of detail", work);
    write_batches(progress);
    add_errors();
    write("lod-meta.json", meta_json(plan_));
    return written;
  }

 private:
  /// Measures batches in this thread, which may leave cores idle. During a measurement, other threads write
  /// the next batch and merge the one after it.
  void write_batches(Progress& progress) {
    std::vector<const Batch*> left;
    for (const Batch& batch : plan_.batches) {
      if (!is_measured(batch)) left.push_back(&batch);
    }
    const auto merge = [&](const Batch& batch) {
      return std::async(std::launch::async, [&] { return merged(batch, progress); });
    };
    std::future<std::vector<Levels>> merging;
    if (!left.empty()) merging = merge(*left[0]);
    std::future<void> writing;
    for (std::size_t k = 0; k <= left.size(); ++k) {
      if (writing.valid()) writing.get();
      if (k < left.size()) {
        writing = std::async(
            std::launch::async,
            [this, &progress, &batch = *left[k], levels = merging.get()] { write(batch, levels, progress); });
      }
      if (k + 1 < left.size()) merging = merge(*left[k + 1]);
      if (k == 0) continue;
      if (!folder_.has(left[k - 1]->errors)) measure(*left[k - 1]);
      measure_scenes();
    }
    measure_scenes();
  }

  void count(Progress& progress, std::size_t gaussians) {
    const std::lock_guard lock(counting_);
    progress.update(done_ += gaussians);
  }

  /// Merges and returns the levels of the batch's chunks; empty if all its files exist.
  std::vector<Levels> merged(const Batch& batch, Progress& progress) {
    int coarsest = -1;
    for (const File& file : batch.files) {
      if (!file.is_there) coarsest = std::max(coarsest, file.level);
    }
    std::vector<Levels> levels(coarsest < 0 ? 0 : batch.chunks);
    parallel_for(levels.size(), [&](std::size_t i) {
      const Chunk& chunk = plan_.chunks[batch.first_chunk + i];
      levels[i] = levels_of(model_, chunk, coarsest);
      count(progress, chunk.count(0));
    });
    return levels;
  }

  /// Measures the levels as read back: rounding colours, scales and rotations may cost as much as a level.
  void measure(const Batch& batch) {
    write(batch.errors, json_of(measure_.alone(decoded_[&batch] = written(batch))));
  }

  bool is_measured(const Batch& batch) const {
    return folder_.has(batch.errors) &&
           std::ranges::all_of(batch.files, [&](const File& file) { return folder_.has(file.meta_name()); });
  }

  /// Measures joint scenes whose batches are all measured.
  void measure_scenes() {
    for (const JointScene& scene : plan_.scenes) {
      const auto batches = std::span(plan_.batches).subspan(scene.first_batch, scene.batches);
      if (folder_.has(scene.losses) ||
          !std::ranges::all_of(batches, [&](const Batch& p) { return is_measured(p); }))
        continue;
      std::vector<Levels> chunks;
      std::vector<LevelErrors> errors;
      for (const Batch& batch : batches) {
        const auto kept = decoded_.extract(&batch);
        std::ranges::move(kept ? std::move(kept.mapped()) : written(batch), std::back_inserter(chunks));
        std::ranges::move(errors_of(batch), std::back_inserter(errors));
      }
      const auto all = std::min(max_pictures, plan_.chunks.size() / chunks_a_picture) / plan_.scenes.size();
      const int pictures = std::max(1, static_cast<int>(all));
      write(scene.losses, json_of(settings_.levels > 1 ? measure_.joint(chunks, errors, pictures)
                                                       : std::vector<JointLoss>()));
    }
  }

  void write(const std::string& name, const ordered_json& json) const {
    const std::string text = json.dump() + "\n";
    folder_.write(name, std::as_bytes(std::span(text)));
  }

  std::vector<Levels> written(const Batch& batch) const {
    std::vector<Levels> levels(batch.chunks, Levels(plan_.gaussians.size()));
    parallel_for(batch.files.size(), [&](std::size_t i) {
      const File& file = batch.files[i];
      const auto level = static_cast<std::size_t>(file.level);
      const std::string meta = file.meta_name();
      const SogSource sog(meta, parse_json(meta, folder_.read(meta)), [&](const std::string& name) {
        const std::string text = folder_.read(file.folder + "/" + name);
        const auto bytes = std::as_bytes(std::span(text));
        return std::vector(bytes.begin(), bytes.end());
      });
      if (sog.count() != file.count) {
        fail("{}: it has {} Gaussians, but {} were written: remove its folder, and start again", meta,
             sog.count(), file.count);
      }
      std::vector<SogSource::Range> ranges;
      std::size_t at = 0;
      for (std::size_t k = 0; k < file.chunks; ++k) {
        const std::size_t of_chunk = plan_.chunks[file.first_chunk + k].count(file.level);
        ranges.push_back({std::exchange(at, at + of_chunk), of_chunk, 0});
      }
      std::vector<Model> models = sog.decode_each(model_, ranges, *sog.textures());
      for (std::size_t k = 0; k < file.chunks; ++k)
        levels[file.first_chunk - batch.first_chunk + k][level] = std::move(models[k]);
    });
    return levels;
  }

  void write(const Batch& batch, std::span<const Levels> levels, Progress& progress) {
    parallel_for(batch.files.size(), [&](std::size_t i) {
      const File& file = batch.files[i];
      if (file.is_there) return;
      Model all = without_gaussians(model_);
      for (std::size_t k = 0; k < file.chunks; ++k) {
        const Levels& of_chunk = levels[file.first_chunk - batch.first_chunk + k];
        const Model& level = of_chunk[static_cast<std::size_t>(file.level)];
        append(all, level, 0, level.count());
      }
      const ZipEntries entries = sog_files(all);
      for (std::size_t k = entries.size(); k-- > 0;)  // meta.json last
        folder_.write(file.folder + "/" + entries[k].first, entries[k].second);
      count(progress, file.count);
    });
  }

  void add_errors() {
    const double more = joint_factor();
    for (const Batch& batch : plan_.batches) {
      const std::vector<LevelErrors> errors = errors_of(batch);
      for (std::size_t i = 0; i < batch.chunks; ++i) {
        Chunk& chunk = plan_.chunks[batch.first_chunk + i];
        chunk.pixels = json_of(errors[i].pixels);
        chunk.seen = json_of(errors[i].seen);
        for (std::size_t level = 0; level < plan_.gaussians.size(); ++level)
          chunk.lods[std::to_string(level)]["errors"] = json_of(errors[i].of_level[level], more);
      }
    }
  }

  std::vector<LevelErrors> errors_of(const Batch& batch) const {
    return parse_level_errors(batch.errors, folder_.read(batch.errors), batch.chunks, plan_.gaussians.size());
  }

  /// Returns measured over predicted loss in pictures of many chunks: the median, since pictures that show
  /// hardly anything have extreme ratios.
  double joint_factor() const {
    std::vector<double> shares;
    for (const JointScene& scene : plan_.scenes)
      std::ranges::copy(loss_shares(scene.losses, folder_.read(scene.losses)), std::back_inserter(shares));
    return shares.empty() ? 1.0 : std::clamp(quantile(shares, 0.5), 1.0 / max_joint_factor, max_joint_factor);
  }

  const Model& model_;
  const LevelSettings& settings_;
  const LevelFolder& folder_;
  const MeasureLevels& measure_;
  Plan plan_;
  std::map<const Batch*, std::vector<Levels>> decoded_;  // kept for the pictures of many chunks
  std::mutex counting_;
  std::size_t done_ = 0;
};

}  // namespace

LevelsWritten write_streamed_sog(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
                                 const MeasureLevels& measure) {
  return LevelsWriter(model, settings, folder, measure).write();
}

}  // namespace binosplat
