#pragma once
// What the parts of `binosplat study` share.

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/measured_options.h"
#include "app/photos.h"
#include "app/rig_options.h"
#include "app/shots.h"
#include "lab/motion_paths.h"
#include "lab/page.h"
#include "shared/axes.h"

namespace binosplat::app {

/// Of --turn: as many as suffice for a mean.
inline const ViewChoice photos_of_a_turn{.views = {}, .wanted = 16};

/// Of --motion.
struct MotionOptions {
  bool chosen = false;
  std::vector<std::string> motions;  // empty: all
  std::vector<std::string> rules;    // TH,SOURCE; empty: all
  std::optional<std::size_t> segments;
  lab::SegmentLengths lengths;
  int rounds = 2;
  bool no_equal = false;
};

struct StudyOptions : MeasuredOptions {
  std::vector<std::string> scenes;  // `scene` is the first; more of --levels only
  RigOptions rig;
  bool stability = false;
  bool rules = false;
  bool turn = false;
  bool levels = false;
  std::optional<glm::ivec2> rays;  // of --turn, across and down; none: as many as the device is quick with
  MotionOptions motion;
  std::vector<DetailNeed> details = {
      {.db = 30}, {.db = 35}, {.db = 40}, {.db = 45}};  // of --levels, in order
  std::optional<int> frames;                            // timed of each rule in each round
  std::vector<std::string> test;
  std::string output;
  std::vector<std::string> cases;
  double target = 40.0;  // dB
  // Of the rule that is carried, where it is steered, and where motion is.
  int th = TH_SQUARED, transmittance = TRANSMITTANCE_ONE;  // of shared/axes.h
  std::optional<float> tolerance, quality;                 // quality in dB
  std::string json;
  std::vector<std::string> not_for_analyses;  // options given that these know nothing of
};

/// What is there to study, and the shots of it that the options ask for.
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

/// --stability: prints the tables, and saves.
void study_stability(gl::Context& context, const StudyOptions& options, const Studied& studied);

/// --turn: prints the table, and saves.
void study_turn(gl::Context& context, const StudyOptions& options, const Studied& studied);

/// Adds --motion, which it returns, and the options that no other study takes.
CLI::Option* add_motion_options(CLI::App& sub, MotionOptions& options);

/// --motion: prints the tables, and saves.
void study_motion(const StudyOptions& options);

/// Adds --levels, which it returns, and the option that no other study takes.
CLI::Option* add_levels_options(CLI::App& sub, StudyOptions& options);

/// --levels: prints the tables, and saves.
void study_levels(const StudyOptions& options);

}  // namespace binosplat::app
