#pragma once
// What `binosplat bench` is to measure, point by point, and which of it lies in a folder already.

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "app/photos.h"
#include "app/rig_options.h"
#include "app/shard.h"
#include "app/shots.h"
#include "lab/axes.h"
#include "lab/bench_case.h"
#include "lab/results.h"
#include "stream/picture_stream.h"

namespace binosplat::app {

/// The cameras, photos and the rest are those of every scene.
struct BenchOptions : MeasuredOptions {
  std::vector<std::string> scenes;
  std::string axes;  // empty: what fits the options below
  std::vector<std::string> motions;
  bool turn = false;
  std::vector<std::string> details;
  std::optional<int> frames;      // in the place of the axes'
  std::string size;               // likewise
  RigOptions rig;                 // mono: one eye
  std::vector<std::string> test;  // views by name, where the axes have views for training
  std::optional<int> hold_out;    // every which view is for tests
  std::string output = "out/bench";
  Shard shard;                           // of the points
  std::vector<std::string> merge;        // folders, instead of scenes
  std::string compare;                   // results.json of an older run
  std::optional<double> fail_if_slower;  // percent
  std::string calibration;               // a file whose settings are measured, too
  double ppd = 67.0;
  bool floors = false;
};

/// One scene of the run, and its cameras; the model is read when a point needs it.
struct BenchScene {
  std::string name;  // the file's, without folders and ending
  SceneOptions options;
  CameraList list;
  PhotoSource photos = {};
};

/// What tells a scene, its cameras and its photos from others of the same names.
nlohmann::ordered_json scene_identity(const MeasuredOptions& options, const BenchScene& scene);

/// Points that share a model and what they are measured on: a chart.
struct CasePlan {
  std::size_t scene = 0;
  int eyes = 1;
  std::string size, along;
  std::size_t first = 0, count = 0;  // points of the plan
};

struct BenchPlan {
  lab::Axes axes;
  std::vector<BenchScene> scenes;
  std::vector<CasePlan> cases;
  std::vector<lab::Row> points;                        // what is known of each
  std::shared_ptr<const nlohmann::ordered_json> json;  // what two runs must have in common to be one

  /// The settings of a case's point; none: its contributions.
  const lab::BenchSettings* settings_of(const CasePlan& which, std::size_t point) const {
    const std::size_t k = point - which.first;
    return k < axes.settings.size() ? &axes.settings[k] : nullptr;
  }
};

/// Throws Error for scenes, cameras or axes that cannot be used. Reads no model.
BenchPlan make_plan(const BenchOptions& options);

/// In `along`: the frames of --path or of --tour.
constexpr const char *along_path = "path", *along_tour = "tour";

/// The points of a folder: what was measured, by number of the plan.
class BenchFolder {
 public:
  /// Goes on with the folder, or starts it once something is saved, so that a run that is refused leaves
  /// nothing behind. Throws Error if it holds another plan; so do save() and save_results().
  BenchFolder(std::filesystem::path folder, std::shared_ptr<const nlohmann::ordered_json> plan);
  /// A folder that is there, with whatever plan it has. Throws Error if it has none.
  explicit BenchFolder(std::filesystem::path folder);

  const std::shared_ptr<const nlohmann::ordered_json>& plan() const { return plan_; }
  bool same_plan(const BenchFolder& other) const;
  std::size_t size() const;           // points of the plan
  bool has(std::size_t point) const;  // whole
  lab::Point load(std::size_t point) const;
  void save(std::size_t point, const lab::Point& measured) const;
  /// All points, measured or not, each beside the others.
  lab::Results results() const;
  /// Writes report.html, results.json, results.csv and details.csv.
  void save_results(const lab::Results& results) const;
  const std::filesystem::path& path() const { return folder_; }

 private:
  void claim() const;
  std::filesystem::path file(std::size_t point) const;

  std::filesystem::path folder_;
  std::shared_ptr<const nlohmann::ordered_json> plan_;
};

/// A scene that is measured: its model, and what the cases of it are drawn from.
class MeasuredScene {
 public:
  MeasuredScene(gl::Context& context, const BenchOptions& options, const BenchPlan& plan, std::size_t scene);

  /// What the points of a case are measured on.
  lab::BenchCase open(const CasePlan& which);
  /// At its finest levels; read at first use.
  const Model& model();

 private:
  const Model& some_model();
  void open_views(const CasePlan& which, const CameraList& list, lab::BenchCase& opened);
  std::vector<lab::Stretch> stretches_of(const CasePlan& which, const CameraList& list, const Lens& lens,
                                         const RigOptions& rig);

  gl::Context& context_;
  const BenchOptions& options_;
  const BenchPlan& plan_;
  const BenchScene& scene_;
  std::unique_ptr<PictureStream> stream_;  // of a scene with levels: its axes, and what can be seen of it
  std::optional<Model> model_;
};

/// Throws Error for a plan whose cases cannot be opened, as far as that is known before a model is read.
void check_cases(const BenchPlan& plan, const BenchOptions& options);

}  // namespace binosplat::app
