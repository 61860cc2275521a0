#pragma once
// What the parts of `binosplat study` share.

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/analyses.h"
#include "app/measured_options.h"
#include "app/photos.h"
#include "app/rig_options.h"
#include "app/shots.h"
#include "lab/motion_paths.h"
#include "lab/page.h"

namespace binosplat::app {

/// Of --turn: as many as suffice for a mean.
inline const ViewChoice photos_of_a_turn{.views = {}, .wanted = 16};

/// Of --motion.
struct MotionOptions {
  bool chosen = false;
  std::vector<std::string> motions;  // empty: all
  std::optional<std::size_t> segments;
  lab::SegmentLengths lengths;
  int rounds = 2;
  bool no_equal = false;
};

struct StudyOptions : MeasuredOptions {
  std::vector<std::string> scenes;  // `scene` is the first
  AnalysesOptions analyses;
  RigOptions rig;
  bool turn = false;
  bool levels = false;
  std::optional<glm::ivec2> rays;  // of --turn, across and down; none: as many as the device is quick with
  MotionOptions motion;
  std::vector<DetailRequest> details = {
      {.db = 30}, {.db = 35}, {.db = 40}, {.db = 45}};  // of --levels, in order
  std::optional<int> frames;                            // timed of each rule in each round
  std::string output;
  double target = 40.0;          // of --motion, dB
  std::optional<float> quality;  // likewise
  std::string json;
};

/// The model and the views of it that the options name.
struct Studied {
  std::shared_ptr<const Model> model;
  CameraList list;
  double near_plane = 0.0;
  std::vector<Shot> shots;
};

/// Prints a table of a page, as Markdown.
void print_table(const lab::Table& table);

/// Writes what --json and -o ask for.
void save(const StudyOptions& options, const nlohmann::ordered_json& numbers, const lab::Page& page);

/// --turn: prints the table, and saves.
void study_turn(gl::Context& context, const StudyOptions& options, const Studied& studied);

/// Adds --motion and the options that no other study takes.
void add_motion_options(CLI::App& sub, MotionOptions& options);

/// --motion: prints the tables, and saves.
void study_motion(const StudyOptions& options);

/// Adds --levels and the option that no other study takes.
void add_levels_options(CLI::App& sub, StudyOptions& options);

/// --levels: prints the tables, and saves.
void study_levels(const StudyOptions& options);

}  // namespace binosplat::app
