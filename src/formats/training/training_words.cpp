#include "formats/training/training_words.h"

#include <array>
#include <string_view>
#include <utility>

#include "base/log.h"
#include "base/text.h"

namespace binosplat {

namespace {

constexpr const char *order_key = "sortingMethod", *projection_key = "projection", *flat_word = "2dgs";
// Indexed by Order and by Projection.
constexpr std::array<std::string_view, 2> order_words = {"zDepth", "cameraDistance"};
constexpr std::array<std::string_view, 2> projection_words = {"perspective", "tangential"};

template <typename Value>
Value value_of(const char* key, std::string_view word, const std::array<std::string_view, 2>& words,
               Value otherwise, std::string_view place) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (word == words[k]) return static_cast<Value>(k);
  }
  log_warning("{}: unknown {} '{}' is drawn as {}; known are {} and {}", place, key, word,
              words[static_cast<std::size_t>(otherwise)], words[0], words[1]);
  return otherwise;
}

// Returns key and word of each property that differs from 3D-GS.
std::vector<std::pair<std::string, nlohmann::json>> words_of_training(const Training& training) {
  const Perspective& perspective = training.perspective;
  std::vector<std::pair<std::string, nlohmann::json>> words;
  if (perspective.order != Order::depth)
    words.emplace_back(order_key, order_words[static_cast<std::size_t>(perspective.order)]);
  if (perspective.projection != Projection::affine)
    words.emplace_back(projection_key, projection_words[static_cast<std::size_t>(perspective.projection)]);
  if (training.kernel_px2 != KERNEL_PX2) words.emplace_back("lowPass", training.kernel_px2);
  if (training.linear) words.emplace_back("colorSpace", linear_word);
  if (training.near_plane) words.emplace_back("nearPlane", *training.near_plane);
  return words;
}

// Converts the words of sort order and projection, "" if missing. Warnings begin with `place`.
Perspective from_words(const std::string& place, const std::string& order, const std::string& projection,
                       const Perspective& defaults) {
  Perspective read = defaults;
  if (!order.empty()) read.order = value_of(order_key, order, order_words, read.order, place);
  if (!projection.empty())
    read.projection = value_of(projection_key, projection, projection_words, read.projection, place);
  return read;
}

}  // namespace

Perspective read_perspective(const JsonValue& holder, const Perspective& defaults) {
  const auto word = [&](const char* key) { return holder.has(key) ? holder.at(key).text() : ""; };
  return from_words(holder.source(), word(order_key), word(projection_key), defaults);
}

void write_training(const Training& training, bool flat, nlohmann::ordered_json& meta) {
  // PlayCanvas' readers know one or the other of these two keys.
  if (flat)
    meta["model"] = flat_word;
  else if (training.antialiased)
    meta["model"] = "antialiased";
  if (training.antialiased) meta["antialias"] = true;
  for (const auto& [key, word] : words_of_training(training)) meta[key] = word;
}

Perspective read_perspective(const std::vector<std::string>& comments) {
  // The last of several comments counts.
  const auto word = [&](std::string_view key) {
    std::string found;
    for (const std::string& comment : comments) {
      const std::vector<std::string_view> words = words_of(comment);
      if (words.size() >= 2 && words[0].ends_with(':') && words[0].substr(0, words[0].size() - 1) == key)
        found = words[1];
    }
    return found;
  };
  return from_words("a comment of the ply", word(order_key), word(projection_key), {});
}

std::string training_comments(const Training& training, bool flat) {
  std::string lines;
  if (flat) lines += fmt::format("comment SplatRenderMode: {}\n", flat_word);  // a later "mip" is read, too
  if (training.antialiased || !training.antialiased_by.empty())
    lines += fmt::format("comment SplatRenderMode: {}\n", training.antialiased ? "mip" : "default");
  for (const auto& [key, word] : words_of_training(training))
    lines += fmt::format("comment {}: {}\n", key, word.is_string() ? word.get<std::string>() : word.dump());
  return lines;
}

}  // namespace binosplat
