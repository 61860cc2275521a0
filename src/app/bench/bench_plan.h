#pragma once
// The plan of `binosplat bench`: its points, and which of them a folder already holds.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/bench/photos.h"
#include "app/options/options.h"
#include "app/render/resume.h"
#include "app/render/shots.h"
#include "lab/bench_views.h"
#include "lab/results.h"
#include "lab/suite.h"
#include "stream/picture_stream.h"

namespace binosplat::app {

/// One scene of the run and its cameras. The model is read when a point needs it.
struct BenchScene {
  std::string name;  // name of its file, without folders and ending
  SceneOptions options;
  CameraList list;
  PhotoSource photos = {};
};

/// The points of one chart. They share a model, views, and the pictures to compare with.
struct CasePlan {
  std::size_t scene = 0;
  int eyes = 1;
  std::string size, along;
  std::size_t first = 0, count = 0;  // its points in the plan: `count` points from `first` on
};

struct BenchPlan {
  lab::Suite suite;
  std::vector<BenchScene> scenes;
  std::vector<CasePlan> cases;
  std::vector<lab::Row> points;  // the fixed columns of each: scene, case, settings

  /// The settings of a case's point; null for the point that measures contributions.
  const lab::BenchSettings* settings_of(const CasePlan& which, std::size_t point) const {
    const std::size_t k = point - which.first;
    return k < suite.settings.size() ? &suite.settings[k] : nullptr;
  }
};

/// Throws Error for unusable scenes, cameras or suites. Reads no model.
BenchPlan make_plan(const Options& options);

/// Values of `along`: the frames of --path, or of --tour.
constexpr const char *along_path = "path", *along_tour = "tour";

/// A folder of results: a file for each measured point, named by the point's number in the plan.
class BenchFolder {
 public:
  /// Resumes the run in the folder, or starts one at the first save, so that a refused run leaves nothing
  /// behind. Throws Error if the folder has points of another run, or if another process writes there.
  BenchFolder(const Options& options, const BenchPlan& plan);

  bool has(std::size_t point) const;  // whether its result is complete
  lab::Point load(std::size_t point) const;
  void save(std::size_t point, const lab::Point& measured) const;
  /// All points, with the columns that compare them (add_relative_columns).
  lab::Results results() const;
  /// Writes report.html, results.json, results.csv and details.csv.
  void save_results(const lab::Results& results) const;
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path file(std::size_t point) const;

  std::filesystem::path folder_, run_file_;
  const BenchPlan& plan_;
  nlohmann::ordered_json run_;  // identifies the run
  FolderLock lock_;
};

/// An opened scene: its model, and the cases to measure on it.
class MeasuredScene {
 public:
  MeasuredScene(gl::Context& context, const Options& options, const BenchPlan& plan, std::size_t scene);

  /// Opens the views, frames or turn in which the points of a case are measured.
  lab::BenchCase open(const CasePlan& which);
  /// The model at its finest levels; read at first use.
  const Model& model();

 private:
  const Model& any_model();
  void open_views(const CasePlan& which, const CameraList& list, lab::BenchCase& opened);
  std::vector<lab::Stretch> stretches_of(const CasePlan& which, const CameraList& list, const Lens& lens,
                                         const RigOptions& rig);

  gl::Context& context_;
  const Options& options_;
  const BenchPlan& plan_;
  const BenchScene& scene_;
  std::unique_ptr<PictureStream> stream_;  // only with levels; its model also provides axes and visibility
  std::optional<Model> model_;
};

/// Throws Error if a case cannot be opened, as far as can be known before a model is read.
void check_cases(const BenchPlan& plan, const Options& options);

}  // namespace binosplat::app
