#include "study/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "study/fields.h"

namespace binosplat::study {

using nlohmann::ordered_json;

int find_choice(const std::string& place, const std::string& name, std::span<const Choice> choices) {
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const Choice& c) { return c.name == name; });
  if (found == choices.end()) {
    std::vector<std::string> names;
    for (const Choice& choice : choices) names.emplace_back(choice.name);
    fail("{}: '{}' is not one of {}", place, name, fmt::join(names, ", "));
  }
  return static_cast<int>(found - choices.begin());
}

NamedSettings named(const render::FrameSettings& s) {
  NamedSettings names{tiles_choices[s.tiles].name, s.tile_size, th_choices[s.th].name, {}, {}, {}};
  if (s.precision != PRECISION_FULL) names.precision = precision_choices[s.precision].name;
  if (s.th == TH_TAU) return names;
  names.transmittance = transmittance_choices[s.transmittance].name;
  names.loss = std::stod(fmt::format("{}", s.loss));
  return names;
}

static void fields(const auto& io, Some<NamedSettings> auto& s) {
  io("tiles", s.tiles, "tile", s.tile, "th", s.th, "precision", s.precision, "transmittance", s.transmittance,
     "loss", s.loss);
}

void to_json(ordered_json& json, const NamedSettings& settings) { fields(FieldWriter{json}, settings); }
void from_json(const ordered_json& json, NamedSettings& settings) { fields(FieldReader{json}, settings); }
ordered_json to_json(const render::FrameSettings& settings) { return named(settings); }

std::string describe_family(const render::FrameSettings& s) {
  std::vector<std::string> words;
  if (s.tiles != TILES_ELLIPSE || s.th == TH_TAU) words.emplace_back(tiles_choices[s.tiles].name);
  if (s.th != TH_TAU) {
    words.emplace_back(th_choices[s.th].name);
    if (s.transmittance != TRANSMITTANCE_ONE) words.emplace_back(transmittance_choices[s.transmittance].name);
  }
  if (s.tile_size != TILE_SIZE_DEFAULT) words.push_back(fmt::format("tile {}", s.tile_size));
  if (s.precision != PRECISION_FULL) words.emplace_back(precision_choices[s.precision].name);
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string describe(const render::FrameSettings& s) {
  return s.th == TH_TAU ? describe_family(s) : fmt::format("{}, {:g}", describe_family(s), s.loss);
}

void check(const std::string& place, const render::FrameSettings& s) {
  const auto wrong = [&](const char* why) { fail("{}: {}: {}", place, to_json(s).dump(), why); };
  if (s.th != TH_TAU && !(s.loss > 0.0f)) wrong("th needs a loss above 0");
  if (s.th == TH_TAU && s.loss != 0.0f) wrong("a loss has no effect with tau, which is exact");
  if (s.th == TH_TAU && s.transmittance != TRANSMITTANCE_ONE)
    wrong("transmittance has no effect with tau, which is exact");
}

bool is_exact(const render::FrameSettings& s) {
  return s.precision == PRECISION_FULL && s.th == TH_TAU &&
         (s.tiles == TILES_ELLIPSE || s.tiles == TILES_SNUG || s.tiles == TILES_ALL);
}

}  // namespace binosplat::study
