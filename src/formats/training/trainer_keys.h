#pragma once
// What trainers and file formats say about how a model was trained: one table of their keys.

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/training/flat_values.h"
#include "scene/model.h"

namespace binosplat {

/// What a key with a certain value means for the pictures.
struct Meaning {
  enum Kind {
    near_plane,   // `number` world units
    low_pass,     // of variance `number`, px^2
    compensated,  // opacity compensated for the low-pass, if `number` is 1
    linear,       // colours are linear light
    by_distance,  // Gaussians in the order of their distance, not depth
    background,   // of bg_color
    differs,      // `sentence`: what is drawn otherwise, and a remedy
    note          // `sentence`: how to draw the model as it was trained
  };
  Kind kind;
  double number;                   // NaN: the key's value
  const char* sentence = nullptr;  // nullptr: the model is drawn so
};

struct TrainerKey {
  const char* writer;  // the trainer's or the format's name
  const char* key;     // "" stands for every file of this writer
  const char* value;   // in lower case; "*": any; "!X": any but X
  Meaning meaning;
};

std::span<const TrainerKey> trainer_keys();

/// What a file says about the training.
struct TrainingSaid {
  std::optional<double> near_plane;  // world units
  std::optional<double> kernel_px2;
  std::optional<bool> antialiased;
  std::optional<Order> order;
  std::optional<bool> linear;
  std::vector<std::pair<std::string, std::string>> keys;  // the table's keys that the file has, with values
  /// Differences between the training's rendering and this program's: their effect, and a remedy.
  std::vector<std::string> differences;
  std::vector<std::string> notes;  // hints for drawing the model as it was trained
};

/// Reads the keys of some writers in a file. `prefix` precedes the table's keys in `values`.
TrainingSaid read_keys(std::initializer_list<std::string_view> writers, const FlatValues& values,
                       const std::string& prefix = "");

/// Returns a key's value in lower case (Python writes True, YAML true), or nothing for null and none.
std::optional<std::string> find_value(const FlatValues& values, const std::string& key);

/// Training::kernel_by of a ply with Mip-Splatting's filter_3D, whose low-pass is usually 0.1 px^2.
constexpr const char* by_filter = "its filter_3D";
/// A difference that exists only if no exposure.json lies above the model.
constexpr const char* lacks_exposures =
    "it was trained with an exposure for each photo (train_test_exp), and their exposure.json is missing: "
    "pictures are further from the photos. `exposure` FILE names it";

/// Takes what a file says, unless `training` says it already; then warns of a difference, naming `model`.
/// `by` names the file.
void follow(const TrainingSaid& said, const std::string& by, const std::string& model, Training& training);

}  // namespace binosplat
