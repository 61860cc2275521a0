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
#include "compact/leaf_errors.h"
#include "formats/json_file.h"
#include "formats/model_writers.h"
#include "formats/morton.h"
#include "formats/sog_source.h"
#include "scene/merge.h"
#include "scene/reduce.h"
#include "scene/space_tree.h"

namespace binosplat {

namespace {

using nlohmann::ordered_json;

// A pixel that shows a level, relative to the spacing by which levels are chosen (stream/choice.h). That
// spacing assumes a square as wide as the box's diagonal; true spacings are smaller.
constexpr double pixel_share = 0.2;
// The pairs to merge are chosen once for all levels, by the pixels of this one.
constexpr int judged_level = 3;
// Pictures of many chunks: one for this many chunks, at most pictures_most in all, but at least one for each
// scene.
constexpr std::size_t leaves_a_picture = 4, pictures_most = 12;
constexpr double more_most = 4.0;  // limit of their loss over the prediction, and of its inverse

/// A chunk, a leaf of the tree.
struct Leaf {
  std::span<const std::uint32_t> indices;
  Box box;                    // around one-sigma ellipsoids, from zero
  ordered_json lods;          // files, ranges and errors of its levels
  ordered_json pixels, seen;  // of the measured errors

  std::size_t count(int level) const { return ((indices.size() - 1) >> level) + 1; }
  double pixel(int level) const {
    return pixel_share * glm::distance(box.low, box.high) / std::sqrt(static_cast<double>(count(level)));
  }
};

/// A SOG: one level of consecutive chunks.
struct File {
  std::string folder;
  int level = 0;
  std::size_t first_leaf = 0, leaves = 0;
  std::size_t count = 0;
  bool is_there = false;

  std::string meta_name() const { return folder + "/meta.json"; }
};

/// Chunks that are processed together, and the files of all their levels.
struct Piece {
  std::string errors;  // the file with the errors of its levels
  std::size_t first_leaf = 0, leaves = 0;
  std::vector<File> files;
};

using Levels = std::vector<Model>;  // of a chunk, from the finest

/// Pieces that are drawn together as one model.
struct Scene {
  std::string losses;  // the file with the losses of its pictures
  std::size_t first_piece = 0, pieces = 0, count = 0;
};

/// The contents of all files, planned before anything is written.
struct Plan {
  SpaceTree tree;
  std::vector<Leaf> leaves;
  std::vector<Piece> pieces;
  std::vector<Scene> scenes;
  std::vector<std::string> filenames;         // of all SOGs, by the chunks' file numbers
  std::vector<std::size_t> gaussians, files;  // by level
};

/// Collects, in order, the largest nodes of at most `most` Gaussians, and larger leaves.
void find_nodes(const SpaceNode& node, std::size_t most, std::vector<const SpaceNode*>& nodes) {
  if (node.count <= most || node.children.empty()) return nodes.push_back(&node);
  for (const SpaceNode& child : node.children) find_nodes(child, most, nodes);
}

void add_files(std::size_t level, std::size_t most, Piece& piece, Plan& plan) {
  for (std::size_t i = piece.first_leaf; i < plan.leaves.size(); ++i) {
    Leaf& leaf = plan.leaves[i];
    const std::size_t count = leaf.count(static_cast<int>(level));
    if (i == piece.first_leaf || piece.files.back().count + count > most) {
      piece.files.push_back({fmt::format("{}_{}", level, plan.files[level]++), static_cast<int>(level), i});
      plan.filenames.push_back(piece.files.back().meta_name());
    }
    File& file = piece.files.back();
    leaf.lods[std::to_string(level)] = {
        {"file", plan.filenames.size() - 1}, {"offset", file.count}, {"count", count}};
    ++file.leaves;
    file.count += count;
    plan.gaussians[level] += count;
  }
}

Plan make_plan(const Model& model, const LevelSettings& settings) {
  Plan plan{.tree = make_space_tree(model.position, settings.leaf)};
  for (auto* by_level : {&plan.gaussians, &plan.files})
    by_level->resize(static_cast<std::size_t>(settings.levels));
  std::vector<const SpaceNode*> nodes;
  find_nodes(plan.tree.root, settings.piece, nodes);
  const std::size_t all = model.count(), scenes = (all - 1) / settings.together + 1;
  for (std::size_t i = 0; i < nodes.size();) {
    Piece piece{fmt::format("errors_{}.json", plan.pieces.size()), plan.leaves.size(), 0, {}};
    // Consecutive nodes share a piece, since far outliers are nodes of a few Gaussians.
    std::size_t count = 0;
    std::vector<const SpaceNode*> leaves;
    do {
      find_nodes(*nodes[i], 0, leaves);
      count += nodes[i]->count;
    } while (++i < nodes.size() && count + nodes[i]->count <= settings.piece);
    for (const SpaceNode* leaf : leaves)
      plan.leaves.push_back({std::span(plan.tree.order).subspan(leaf->first, leaf->count), {}, {}});
    piece.leaves = leaves.size();
    for (std::size_t level = 0; level < plan.files.size(); ++level)
      add_files(level, settings.file, piece, plan);
    // Scenes have about equal numbers of Gaussians.
    if (plan.scenes.empty() || plan.scenes.back().count * scenes >= all)
      plan.scenes.push_back({fmt::format("together_{}.json", plan.scenes.size()), plan.pieces.size()});
    ++plan.scenes.back().pieces;
    plan.scenes.back().count += count;
    plan.pieces.push_back(std::move(piece));
  }
  const auto measure = [&](Leaf& leaf) { leaf.box = reach_of(model, leaf.indices) + model.axes.origin; };
  parallel_for(plan.leaves.size(), [&](std::size_t i) { measure(plan.leaves[i]); });
  return plan;
}

ordered_json box_json(const Box& b) {
  return {{"min", {b.low.x, b.low.y, b.low.z}}, {"max", {b.high.x, b.high.y, b.high.z}}};
}

/// Returns the JSON of a node, and its box. `next` is the next chunk.
std::pair<ordered_json, Box> node_json(const SpaceNode& node, const Leaf*& next) {
  if (node.children.empty()) {
    const Leaf& leaf = *next++;
    return {
        {{"bound", box_json(leaf.box)}, {"pixels", leaf.pixels}, {"seen", leaf.seen}, {"lods", leaf.lods}},
        leaf.box};
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

/// Returns lod-meta.json, once the chunks have the errors of their levels.
ordered_json meta_json(const Plan& plan) {
  const Leaf* next = plan.leaves.data();
  return {{"version", 1},
          {"asset", {{"generator", "binosplat"}}},
          {"count", std::accumulate(plan.gaussians.begin(), plan.gaussians.end(), std::size_t{0})},
          {"counts", plan.gaussians},
          {"lodLevels", plan.gaussians.size()},
          {"environment", nullptr},
          {"filenames", plan.filenames},
          {"tree", node_json(plan.tree.root, next).first}};
}

/// Returns the finest level in Morton order, whose pictures compress best.
Model finest(const Model& model, const Leaf& leaf) {
  const Model as_it_lies = with_order(model, leaf.indices);
  return with_order(as_it_lies, morton_order(as_it_lies.position));
}

Levels levels_of(const Model& model, const Leaf& leaf, int coarsest) {
  Levels levels{finest(model, leaf)};
  Merger merger(levels[0], leaf.pixel(judged_level));
  std::vector<Model> merged;
  for (int level = 1; level <= coarsest; ++level) {
    merger.bring_to(leaf.count(level));
    merged.push_back(merger.result(leaf.pixel(level)));
  }
  std::move(merged.begin(), merged.end(), std::back_inserter(levels));
  return levels;
}

class LevelsWriter {
 public:
  LevelsWriter(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
               const JudgeLevels& judge)
      : model_(model),
        settings_(settings),
        folder_(folder),
        judge_(judge),
        plan_(make_plan(model, settings)) {}

  LevelsWritten write() {
    LevelsWritten written{plan_.gaussians, plan_.filenames.size(), 0, sog_losses(model_)};
    std::size_t work = 0;
    for (Piece& piece : plan_.pieces) {
      for (File& file : piece.files) {
        file.is_there = folder_.has(file.meta_name());
        (file.is_there ? written.kept : work) += file.is_there ? 1 : file.count;
      }
      for (std::size_t i = 0; i < piece.leaves && !std::ranges::all_of(piece.files, &File::is_there); ++i)
        work += plan_.leaves[piece.first_leaf + i].count(0);
    }
    Progress progress("writing levels of detail", work);
    write_pieces(progress);
    add_errors();
    write("lod-meta.json", meta_json(plan_));
    return written;
  }

 private:
  /// Measures a piece in one thread, which may leave cores idle. Meanwhile the next one is written and the
  /// one after it is merged.
  void write_pieces(Progress& progress) {
    std::vector<const Piece*> left;
    for (const Piece& piece : plan_.pieces) {
      if (!is_judged(piece)) left.push_back(&piece);
    }
    const auto merge = [&](const Piece& piece) {
      return std::async(std::launch::async, [&] { return merged(piece, progress); });
    };
    std::future<std::vector<Levels>> merging;
    if (!left.empty()) merging = merge(*left[0]);
    std::future<void> writing;
    for (std::size_t k = 0; k <= left.size(); ++k) {
      if (writing.valid()) writing.get();
      if (k < left.size()) {
        writing = std::async(
            std::launch::async,
            [this, &progress, &piece = *left[k], levels = merging.get()] { write(piece, levels, progress); });
      }
      if (k + 1 < left.size()) merging = merge(*left[k + 1]);
      if (k == 0) continue;
      if (!folder_.has(left[k - 1]->errors)) judge(*left[k - 1]);
      judge_scenes();
    }
    judge_scenes();
  }

  void count(Progress& progress, std::size_t gaussians) {
    const std::lock_guard lock(counting_);
    progress.update(done_ += gaussians);
  }

  /// Returns the levels to write; empty if nothing is left.
  std::vector<Levels> merged(const Piece& piece, Progress& progress) {
    int coarsest = -1;
    for (const File& file : piece.files) {
      if (!file.is_there) coarsest = std::max(coarsest, file.level);
    }
    std::vector<Levels> levels(coarsest < 0 ? 0 : piece.leaves);
    parallel_for(levels.size(), [&](std::size_t i) {
      const Leaf& leaf = plan_.leaves[piece.first_leaf + i];
      levels[i] = levels_of(model_, leaf, coarsest);
      count(progress, leaf.count(0));
    });
    return levels;
  }

  /// Measures the written files: rounded colours, scales and rotations cost as much as a level may.
  void judge(const Piece& piece) {
    write(piece.errors, json_of(judge_.alone(decoded_[&piece] = written(piece))));
  }

  /// Returns whether the folder has the piece's files and errors.
  bool is_judged(const Piece& piece) const {
    return folder_.has(piece.errors) &&
           std::ranges::all_of(piece.files, [&](const File& file) { return folder_.has(file.meta_name()); });
  }

  /// Measures the scenes whose pieces are complete.
  void judge_scenes() {
    for (const Scene& scene : plan_.scenes) {
      const auto pieces = std::span(plan_.pieces).subspan(scene.first_piece, scene.pieces);
      if (folder_.has(scene.losses) ||
          !std::ranges::all_of(pieces, [&](const Piece& p) { return is_judged(p); }))
        continue;
      std::vector<Levels> leaves;
      std::vector<LeafErrors> errors;
      for (const Piece& piece : pieces) {
        const auto kept = decoded_.extract(&piece);
        std::ranges::move(kept ? std::move(kept.mapped()) : written(piece), std::back_inserter(leaves));
        std::ranges::move(errors_of(piece), std::back_inserter(errors));
      }
      const auto all = std::min(pictures_most, plan_.leaves.size() / leaves_a_picture) / plan_.scenes.size();
      const int pictures = std::max(1, static_cast<int>(all));
      write(scene.losses, json_of(settings_.levels > 1 ? judge_.together(leaves, errors, pictures)
                                                       : std::vector<LossTogether>()));
    }
  }

  void write(const std::string& name, const ordered_json& json) const {
    const std::string text = json.dump() + "\n";
    folder_.write(name, std::as_bytes(std::span(text)));
  }

  std::vector<Levels> written(const Piece& piece) const {
    std::vector<Levels> levels(piece.leaves, Levels(plan_.gaussians.size()));
    parallel_for(piece.files.size(), [&](std::size_t i) {
      const File& file = piece.files[i];
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
      for (std::size_t k = 0; k < file.leaves; ++k) {
        const std::size_t of_leaf = plan_.leaves[file.first_leaf + k].count(file.level);
        ranges.push_back({std::exchange(at, at + of_leaf), of_leaf, 0});
      }
      std::vector<Model> models = sog.decode_each(model_, ranges, *sog.textures());
      for (std::size_t k = 0; k < file.leaves; ++k)
        levels[file.first_leaf - piece.first_leaf + k][level] = std::move(models[k]);
    });
    return levels;
  }

  void write(const Piece& piece, std::span<const Levels> levels, Progress& progress) {
    parallel_for(piece.files.size(), [&](std::size_t i) {
      const File& file = piece.files[i];
      if (file.is_there) return;
      Model all = without_gaussians(model_);
      for (std::size_t k = 0; k < file.leaves; ++k) {
        const Levels& of_leaf = levels[file.first_leaf - piece.first_leaf + k];
        const Model& level = of_leaf[static_cast<std::size_t>(file.level)];
        append(all, level, 0, level.count());
      }
      const ZipEntries entries = sog_files(all);
      for (std::size_t k = entries.size(); k-- > 0;)  // meta.json last
        folder_.write(file.folder + "/" + entries[k].first, entries[k].second);
      count(progress, file.count);
    });
  }

  void add_errors() {
    const double more = lost_together();
    for (const Piece& piece : plan_.pieces) {
      const std::vector<LeafErrors> errors = errors_of(piece);
      for (std::size_t i = 0; i < piece.leaves; ++i) {
        Leaf& leaf = plan_.leaves[piece.first_leaf + i];
        leaf.pixels = json_of(errors[i].pixels);
        leaf.seen = json_of(errors[i].seen);
        for (std::size_t level = 0; level < plan_.gaussians.size(); ++level)
          leaf.lods[std::to_string(level)]["errors"] = json_of(errors[i].of_level[level], more);
      }
    }
  }

  std::vector<LeafErrors> errors_of(const Piece& piece) const {
    return leaf_errors(piece.errors, folder_.read(piece.errors), piece.leaves, plan_.gaussians.size());
  }

  /// Returns the ratio of measured to predicted loss in pictures of many chunks. It is the median, since eyes
  /// that see hardly anything are far off.
  double lost_together() const {
    std::vector<double> shares;
    for (const Scene& scene : plan_.scenes)
      std::ranges::copy(loss_shares(scene.losses, folder_.read(scene.losses)), std::back_inserter(shares));
    return shares.empty() ? 1.0 : std::clamp(quantile(shares, 0.5), 1.0 / more_most, more_most);
  }

  const Model& model_;
  const LevelSettings& settings_;
  const LevelFolder& folder_;
  const JudgeLevels& judge_;
  Plan plan_;
  std::map<const Piece*, std::vector<Levels>> decoded_;  // kept for the pictures of many chunks
  std::mutex counting_;
  std::size_t done_ = 0;
};

}  // namespace

LevelsWritten write_streamed_sog(const Model& model, const LevelSettings& settings, const LevelFolder& folder,
                                 const JudgeLevels& judge) {
  return LevelsWriter(model, settings, folder, judge).write();
}

}  // namespace binosplat
