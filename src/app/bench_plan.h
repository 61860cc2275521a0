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
#include "lab/bench_results.h"

namespace binosplat::app {

/// The cameras, photos and the rest are those of every scene.
struct BenchOptions : MeasuredOptions {
  std::vector<std::string> scenes;
  std::string axes = "quick";
  std::string output = "out/bench";
  Shard shard;                           // of the points
  std::vector<std::string> merge;        // folders, instead of scenes
  std::string compare;                   // results.json of an older run
  std::optional<double> fail_if_slower;  // percent
  std::string calibration;               // a file whose settings are measured, too
  std::optional<float> far;              // of the table by depth, world units
  double ppd = 67.0;
  bool profile = false;
};

/// One scene of the run, and its cameras; the model is read when a point needs it.
struct BenchScene {
  std::string name;  // the file's, without folders and ending
  SceneOptions options;
  CameraList list;
};

/// What tells a scene, its cameras and its photos from others of the same names.
nlohmann::ordered_json scene_identity(const MeasuredOptions& options, const Exposures& exposures,
                                      const BenchScene& scene);

/// Points that share a model, views and their size: a chart.
struct BenchCase {
  std::size_t scene = 0;
  int eyes = 1;
  std::string size;
  std::size_t first = 0;  // point of the plan; there are as many as settings
};

struct BenchPlan {
  lab::Axes axes;
  std::vector<BenchScene> scenes;
  PhotoSource photos;  // of the only scene
  std::vector<BenchCase> cases;
  std::vector<lab::BenchPoint> points;
  std::shared_ptr<const nlohmann::ordered_json> json;  // what two runs must have in common to be one
};

/// Throws Error for scenes, cameras or axes that cannot be used. Reads no model.
BenchPlan make_plan(const BenchOptions& options);

/// Which pictures a case is of.
RigOptions rig_of(const BenchCase& which);
Lens lens_of(const BenchCase& which);

/// The points of a folder: what was measured, by number of the plan.
class BenchFolder {
 public:
  /// Starts the folder, or goes on with it. Throws Error if it holds another plan.
  BenchFolder(std::filesystem::path folder, std::shared_ptr<const nlohmann::ordered_json> plan);
  /// A folder that is there, with whatever plan it has. Throws Error if it has none.
  explicit BenchFolder(std::filesystem::path folder);

  const std::shared_ptr<const nlohmann::ordered_json>& plan() const { return plan_; }
  bool same_plan(const BenchFolder& other) const;
  std::size_t size() const;           // points of the plan
  bool has(std::size_t point) const;  // whole
  lab::BenchNumbers load(std::size_t point) const;
  void save(std::size_t point, const lab::BenchNumbers& measured) const;
  /// All points, measured or not.
  lab::BenchResults results() const;
  /// Writes report.html, results.json and results.csv.
  void save_results(const lab::BenchResults& results) const;
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path file(std::size_t point) const;

  std::filesystem::path folder_;
  std::shared_ptr<const nlohmann::ordered_json> plan_;
};

/// The points of the results.json that --compare names. Throws Error if it is none.
std::vector<lab::BenchPoint> load_points(const std::filesystem::path& path);

}  // namespace binosplat::app
