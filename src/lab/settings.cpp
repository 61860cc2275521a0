#include "lab/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "base/error.h"
#include "lab/fields.h"

namespace binosplat::lab {

using nlohmann::ordered_json;

NamedSettings named(const BenchSettings& s) {
  NamedSettings names{.tiles = tiles_choices[s.tiles].name, .tile = s.tile_size, .th = th_choices[s.th].name};
  if (s.precision != PRECISION_FULL) names.precision = precision_choices[s.precision].name;
  if (!render::is_exact(s.th)) {
    names.transmittance = transmittance_choices[s.transmittance].name;
    names.tolerance = std::stod(fmt::format("{}", s.tolerance));
  }
  if (s.foveation) {
    names.inset = s.foveation->inset_degrees;
    names.context = s.foveation->context_scale;
  }
  return names;
}

static void fields(const auto& io, Some<NamedSettings> auto& s) {
  io("tiles", s.tiles, "tile", s.tile, "th", s.th, "precision", s.precision, "transmittance", s.transmittance,
     "tolerance", s.tolerance, "inset", s.inset, "context", s.context);
}

void to_json(ordered_json& json, const NamedSettings& settings) { fields(FieldWriter{json}, settings); }
void from_json(const ordered_json& json, NamedSettings& settings) { fields(FieldReader{json}, settings); }
ordered_json to_json(const BenchSettings& settings) { return named(settings); }

std::string describe_family(const BenchSettings& s) {
  std::vector<std::string> words;
  if (s.tiles != TILES_ELLIPSE || render::is_exact(s.th)) words.emplace_back(tiles_choices[s.tiles].name);
  if (!render::is_exact(s.th)) {
    words.emplace_back(th_choices[s.th].name);
    if (s.transmittance != TRANSMITTANCE_ONE) words.emplace_back(transmittance_choices[s.transmittance].name);
  }
  if (s.tile_size != TILE_SIZE_DEFAULT) words.push_back(fmt::format("tile {}", s.tile_size));
  if (s.precision != PRECISION_FULL) words.emplace_back(precision_choices[s.precision].name);
  if (s.foveation) {
    words.push_back(fmt::format("inset {:g}", s.foveation->inset_degrees));
    words.push_back(fmt::format("context {:g}", s.foveation->context_scale));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string describe(const BenchSettings& s) {
  return render::is_exact(s.th) ? describe_family(s)
                                : fmt::format("{}, {:g}", describe_family(s), s.tolerance);
}

void check(const std::string& place, const BenchSettings& s) {
  try {
    if (!render::is_exact(s.th) && !(s.tolerance > 0.0f)) fail("th needs a tolerance above 0");
    render::check_choice(s);
    if (s.foveation) stereo::check(*s.foveation);
  } catch (const Error& error) {
    fail("{}: {}: {}", place, to_json(s).dump(), error.what());
  }
}

bool is_exact(const BenchSettings& s) {
  return !s.foveation && s.precision == PRECISION_FULL && render::is_exact(s.th) &&
         render::has_every_pair(s.tiles);
}

}  // namespace binosplat::lab
