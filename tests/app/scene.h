#pragma once
// A small scene in a temporary folder: a model with cameras.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/output_file.h"
#include "formats/models/model_output.h"
#include "formats/pictures/image_file.h"
#include "measure/metrics.h"
#include "support/fixtures.h"
#include "support/models.h"
#include "support/ply.h"
#include "support/program.h"

namespace binosplat::test {

/// Returns a camera at (x, 0, 0) that looks along z, in the format of cameras.json.
inline nlohmann::json camera_json(const std::string& name, double x) {
  return {{"img_name", name},
          {"width", 72},
          {"height", 48},
          {"position", {x, 0.0, 0.0}},
          {"rotation", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
          {"fx", 60.0},
          {"fy", 60.0}};
}

/// Returns 300 Gaussians of degree 1, about 4 units in front of the cameras.
inline PlyFile small_model() {
  PlyFile file = inria_file(1, 300);
  for (std::size_t i = 0; i < file.rows.size(); ++i) {
    file.at(i, "x") *= 0.8;
    file.at(i, "y") *= 0.5;
    file.at(i, "z") = 4.0 + 0.4 * file.at(i, "z");
    for (const char* scale : {"scale_0", "scale_1", "scale_2"})
      file.at(i, scale) = -2.5 + 0.3 * file.at(i, scale);
  }
  return file;
}

inline void save_ply(const std::filesystem::path& path, const Model& model) {
  OutputFile file(path);
  write_model(file, model, ModelFormat::ply);
  file.commit();
}

/// Returns a floor of 8 x 8, z up, with a low wall on one side, all of flat Gaussians.
inline Model floor_model() {
  Model model;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const float x = 0.2f * static_cast<float>(i) - 4.0f, y = 0.2f * static_cast<float>(j) - 4.0f;
      add(model, {x, y, 0.0f}, {0.1f, 0.1f, 0.01f}, 0.95f, {(i + j) % 2 == 0 ? 0.8f : 0.2f, 0.6f, 0.2f});
      if (j < 10)
        add(model, {x, 4.0f, 0.1f * static_cast<float>(j)}, {0.1f, 0.01f, 0.1f}, 0.95f, {0.2f, 0.2f, 0.8f});
    }
  }
  return model;
}

/// The same with walls on all sides.
inline Model room_model() {
  Model model = floor_model();
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 20; ++j) {
      const float a = 0.2f * static_cast<float>(i) - 4.0f, z = 0.1f * static_cast<float>(j);
      add(model, {a, -4.0f, z}, {0.1f, 0.01f, 0.1f}, 0.95f, {0.2f, 0.2f, 0.8f});
      for (const float x : {-4.0f, 4.0f})
        add(model, {x, a, z}, {0.01f, 0.1f, 0.1f}, 0.95f, {0.8f, 0.2f, 0.2f});
      if (j >= 10) add(model, {a, 4.0f, z}, {0.1f, 0.01f, 0.1f}, 0.95f, {0.2f, 0.2f, 0.8f});
    }
  }
  return model;
}

using Words = std::vector<std::string>;

/// Whether the CPU draws, by the name of a device in results or JSON.
inline bool is_software(const std::string& device) { return device.starts_with("llvmpipe"); }

/// Returns `words`, followed by `more`.
inline Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Returns whether a run succeeded; the message has its output.
inline testing::AssertionResult good(const Outcome& outcome) {
  if (outcome.code == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "exit code " << outcome.code << ": " << outcome.err;
}

/// Returns whether a text contains a part; the message has the text.
inline testing::AssertionResult has(const std::string& text, const std::string& part) {
  const bool is = text.find(part) != std::string::npos;
  return (is ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "'" << part << "' is " << (is ? "" : "not ") << "in:\n"
         << text;
}

/// Returns whether a run ended with this code and printed this on standard error.
inline testing::AssertionResult ended(const Outcome& outcome, int code, const std::string& said) {
  if (outcome.code == code && outcome.err.find(said) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "exit code " << outcome.code << ", expected " << code << " and '"
                                     << said << "' in: " << outcome.err;
}

/// Returns a run's outcome, and expects that it succeeded.
inline Outcome checked(Outcome outcome) {
  EXPECT_TRUE(good(outcome));
  return outcome;
}

/// Returns the PSNR between two picture files.
inline double psnr_of_files(const std::filesystem::path& a, const std::filesystem::path& b) {
  return measure::psnr(load_image(a), load_image(b));
}

/// Words of a command line, and the expected message.
struct Refusal {
  Words words;
  std::string said;
};

struct SceneTest : testing::Test {
  TempFolder folder;
  const std::string model = folder / "model.ply";
  const std::string out = folder / "out";

  /// Writes model.ply only.
  SceneTest() { write_text(model, to_bytes(small_model())); }

  /// Writes JSON into a file of that name, and returns its path.
  std::string save(const std::string& name, const nlohmann::json& what) const {
    write_text(folder / name, what.dump());
    return folder / name;
  }

  /// Writes two heads and a stereo pair with eyes 0.2 apart into the model's folder.
  void add_cameras() {
    save("cameras.json", {camera_json("front", 0.0), camera_json("side", 0.5), camera_json("pair_left", -0.1),
                          camera_json("pair_right", 0.1)});
  }

  /// Writes `count` cameras 0.1 apart: view0 and so on.
  void add_row_of_cameras(int count) {
    nlohmann::json cameras;
    for (int i = 0; i < count; ++i)
      cameras.push_back(camera_json("view" + std::to_string(i), 0.1 * i - 0.05 * (count - 1)));
    save("cameras.json", cameras);
  }

  /// Writes a pose into the model's folder, like the preview.
  void save_pose(double units_per_metre, double ipd_metres) const {
    nlohmann::json pose = camera_json("saved", 0.5);
    pose.update({{"up", {0, -1, 0}},
                 {"units_per_metre", units_per_metre},
                 {"ipd_metres", ipd_metres},
                 {"near", 0.1}});
    save("model.binosplat.json", nlohmann::json::array({pose}));
  }

  static bool have_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1") == 0; }

  /// Returns what a shell command prints.
  std::string asked(const std::string& command) const {
    const std::string said = folder / "said";
    EXPECT_EQ(std::system((command + " > " + said).c_str()), 0) << command;
    std::string text = read_text(said);
    std::filesystem::remove(said);
    return text;
  }

  /// Returns a video's properties and its number of frames.
  std::string facts_of(const std::string& video) const {
    return asked("ffprobe -v error -count_frames -show_streams " + video);
  }

  /// Runs a command. If it writes files and has no -o, it writes into `out`.
  Outcome run_into_out(Words words, const Surroundings& surroundings = {}) const {
    const bool writes = words.front() != "compare" && words.front() != "info";
    if (writes && std::ranges::find(words, "-o") == words.end()) words.insert(words.end(), {"-o", out});
    return run_program(words, surroundings);
  }

  Outcome render(const Words& words, const Surroundings& surroundings = {}) const {
    return run_into_out(joined({"render", model}, words), surroundings);
  }

  /// Returns the report of a successful run.
  nlohmann::json reported(const Words& words) const {
    EXPECT_TRUE(good(render(joined(words, {"--json", folder / "r.json"}))));
    return load_json(folder / "r.json");
  }

  /// Expects that the command line is refused with each of these additional words, and leaves no files.
  void expect_refused_after(const Words& line, const std::vector<Refusal>& refusals) const {
    const auto before = folder.files();
    for (const auto& [words, said] : refusals)
      EXPECT_TRUE(ended(run_into_out(joined(line, words)), 2, said)) << testing::PrintToString(words);
    EXPECT_EQ(folder.files(), before);
  }

  /// The same for `render`, always with `more`.
  void expect_refused(const std::vector<Refusal>& refusals, const Words& more = {}) const {
    expect_refused_after(joined({"render", model}, more), refusals);
  }
};

}  // namespace binosplat::test

namespace binosplat {

// Names that nearly all tests of commands use.
namespace fs = std::filesystem;
using nlohmann::json;
using test::camera_json;
using test::checked;
using test::contents_of;
using test::ended;
using test::floor_model;
using test::good;
using test::has;
using test::is_software;
using test::joined;
using test::load_json;
using test::Outcome;
using test::PlyFile;
using test::Program;
using test::psnr_of_files;
using test::read_text;
using test::Refusal;
using test::room_model;
using test::run_program;
using test::save_ply;
using test::SceneTest;
using test::small_model;
using test::Surroundings;
using test::TempFolder;
using test::wait_for_file;
using test::wait_until;
using test::Words;
using test::write_text;
using Names = std::set<std::string>;

}  // namespace binosplat
