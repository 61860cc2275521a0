#include "formats/perspective.h"

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "base/log.h"

namespace binosplat {

namespace {

constexpr const char *order_key = "sortingMethod", *projection_key = "projection";
// By the numbers of shared/axes.h.
constexpr std::array<std::string_view, 2> order_words = {"zDepth", "cameraDistance"};
constexpr std::array<std::string_view, 2> projection_words = {"perspective", "tangential"};

int number_of(const char* key, std::string_view word, const std::array<std::string_view, 2>& words,
              int otherwise, std::string_view place) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (word == words[k]) return static_cast<int>(k);
  }
  log_warning("{}: {} '{}' is not known and drawn as {}; {} and {} are", place, key, word,
              words[static_cast<std::size_t>(otherwise)], words[0], words[1]);
  return otherwise;
}

// key: word, for what is not 3D-GS's.
std::vector<std::pair<std::string, std::string>> words_of_perspective(const Perspective& perspective) {
  std::vector<std::pair<std::string, std::string>> words;
  if (perspective.order != ORDER_DEPTH)
    words.emplace_back(order_key, order_words[static_cast<std::size_t>(perspective.order)]);
  if (perspective.projection != PROJECTION_AFFINE)
    words.emplace_back(projection_key, projection_words[static_cast<std::size_t>(perspective.projection)]);
  return words;
}

}  // namespace

Perspective read_perspective(const JsonValue& holder, const Perspective& unless_said) {
  Perspective read = unless_said;
  if (holder.has(order_key))
    read.order = number_of(order_key, holder.at(order_key).text(), order_words, read.order, holder.source());
  if (holder.has(projection_key)) {
    read.projection = number_of(projection_key, holder.at(projection_key).text(), projection_words,
                                read.projection, holder.source());
  }
  return read;
}

Perspective read_perspective(const std::string& place, const std::string& order,
                             const std::string& projection) {
  Perspective read;
  if (!order.empty()) read.order = number_of(order_key, order, order_words, read.order, place);
  if (!projection.empty())
    read.projection = number_of(projection_key, projection, projection_words, read.projection, place);
  return read;
}

void write_perspective(const Perspective& perspective, nlohmann::ordered_json& holder) {
  for (const auto& [key, word] : words_of_perspective(perspective)) holder[key] = word;
}

Perspective read_perspective(const std::vector<std::string>& comments) {
  Perspective read;
  const auto word_after = [](const std::string& comment, std::string_view key) -> std::optional<std::string> {
    const std::string start = std::string(key) + ": ";
    const std::size_t at = comment.find_first_not_of(" \t");
    if (at == std::string::npos || comment.compare(at, start.size(), start) != 0) return std::nullopt;
    const std::size_t begin = at + start.size();
    return comment.substr(begin, comment.find_first_of(" \t\r", begin) - begin);
  };
  for (const std::string& comment : comments) {
    if (const auto word = word_after(comment, order_key))
      read.order = number_of(order_key, *word, order_words, read.order, "a comment of the ply");
    if (const auto word = word_after(comment, projection_key))
      read.projection =
          number_of(projection_key, *word, projection_words, read.projection, "a comment of the ply");
  }
  return read;
}

std::string perspective_comments(const Perspective& perspective) {
  std::string lines;
  for (const auto& [key, word] : words_of_perspective(perspective))
    lines += fmt::format("comment {}: {}\n", key, word);
  return lines;
}

}  // namespace binosplat
