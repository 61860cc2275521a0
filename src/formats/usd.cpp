#include "formats/usd.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <set>

#include "base/log.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "formats/content.h"
#include "formats/join.h"
#include "formats/perspective.h"
#include "formats/plausible.h"
#include "formats/usd_transform.h"
#include "formats/usda.h"
#include "formats/zip_file.h"
#include "scene/transform.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

std::string flatten_command(const fs::path& path) {
  fs::path text = path.filename();
  return fmt::format("usdcat --flatten {} -o {}", path.filename().string(),
                     text.replace_extension(".flat.usda").string());
}

bool is_scene_name(std::string_view name) {
  const std::string ending = lowered_ending(name);
  return ending == ".usda" || ending == ".usd" || ending == ".usdc";
}

bool has_schema(const UsdaPrim& prim, std::string_view schema) {
  const auto found = prim.metadata.find("apiSchemas");
  if (found == prim.metadata.end() || found->second.rest() == "None") return false;
  return std::ranges::count(found->second.texts(), schema) > 0;
}

std::string token_of(const UsdaPrim& prim, std::string_view name) {
  const UsdaText* value = prim.attribute(name);
  return value != nullptr ? value->text() : "";
}

class UsdReader {
 public:
  UsdReader(const fs::path& path, const std::string& source, std::string_view text)
      : path_(path), source_(source), file_(read_usda(source, text)) {}

  Model read() {
    note_unresolved(file_);
    for (const UsdaPrim& prim : file_.prims) show(prim, {});
    // As in other renderers, proxies are drawn only if no prim has the purpose render.
    for (const auto& add_proxy : proxies_)
      if (!has_render_) add_proxy();
    if (model_.count() == 0 && model_.left_out == 0) fail_without_gaussians();
    if (!unresolved_.empty()) {
      log_warning("{}: the contents of its {} are not drawn; merge them into one file with: {}", source_,
                  unresolved_, flatten_command(path_));
    }
    for (const char* type : {"Mesh", "PointInstancer", "Points", "Volume"}) {
      if (others_.contains(type)) log_warning("{}: only its Gaussians are drawn, and no {}", source_, type);
    }
    model_.format = flat_ ? "OpenUSD, flat Gaussians" : "OpenUSD";
    model_.axes.letters = axes();
    set_far_positions(model_, places_);
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail_without_gaussians() const {
    if (!unresolved_.empty()) {
      fail("{} has no Gaussians of its own, but {}: merge them into one file with: {}", source_, unresolved_,
           flatten_command(path_));
    }
    std::string names;
    for (const std::string& type : others_) names += (names.empty() ? ": " : ", ") + type;
    fail(
        "{} is an OpenUSD scene without visible Gaussians (ParticleField3DGaussianSplat){}{}", source_, names,
        nurec_ ? "; convert its NuRec volumes, a format of 3DGRUT, to a ParticleField with 3DGRUT's transcode"
               : "");
  }

  std::string axes() const {
    const auto found = file_.metadata.find("upAxis");
    const std::string up = found == file_.metadata.end() ? "Y" : found->second.text();
    if (up != "Y" && up != "Z") found->second.fail_here("upAxis '{}': expected Y or Z", up);
    return up == "Y" ? "RUB" : "RFU";
  }

  void note_unresolved(const UsdaPrim& prim) {
    for (const char* key : {"subLayers", "references", "payload", "inherits", "specializes", "variantSet"}) {
      if (unresolved_.empty() && prim.metadata.contains(key)) unresolved_ = key;
    }
  }

  /// Properties that a prim inherits from those above it.
  struct Inherited {
    glm::dmat4 matrix{1.0};
    std::string colours, purpose;
  };

  void show(const UsdaPrim& prim, Inherited inherited) {
    const auto active = prim.metadata.find("active");
    if (active != prim.metadata.end() && active->second.rest() == "false") return;
    note_unresolved(prim);
    if (prim.specifier != "def" || token_of(prim, "visibility") == "invisible") return;
    if (prim.attribute("visibility.timeSamples") != nullptr)
      log_warning("{}: the visibility of a prim changes with time; it is always drawn", source_);
    inherited.matrix = usd_transform(prim, inherited.matrix);
    if (prim.attribute("colorSpace:name") != nullptr) inherited.colours = token_of(prim, "colorSpace:name");
    if (prim.attribute("purpose") != nullptr) inherited.purpose = token_of(prim, "purpose");
    const bool flat =
        prim.type == "ParticleField" && has_schema(prim, "ParticleFieldKernelGaussianSurfletAPI");
    if (flat || prim.type == "ParticleField3DGaussianSplat" ||
        (prim.type == "ParticleField" && has_schema(prim, "ParticleFieldKernelGaussianEllipsoidAPI"))) {
      has_render_ = has_render_ || inherited.purpose == "render";
      if (inherited.purpose == "proxy") {
        proxies_.emplace_back([this, &prim, inherited, flat] { add(prim, inherited, flat); });
      } else if (inherited.purpose != "guide") {
        add(prim, inherited, flat);
      }
    } else if (prim.type.starts_with("ParticleField")) {
      prim.where.fail_here("'{}' is a {} with another kernel than a Gaussian's; only Gaussians can be drawn",
                           prim.name, prim.type);
    } else if (!prim.type.empty() && prim.type != "Xform" && prim.type != "Scope") {
      others_.insert(prim.type);
      nurec_ = nurec_ || prim.attribute("omni:nurec:isNuRecVolume") != nullptr;
    }
    if (prim.type == "PointInstancer") return;  // its children are only prototypes
    for (const UsdaPrim& child : prim.prims) show(child, inherited);
  }

  void add(const UsdaPrim& prim, const Inherited& inherited, bool flat) {
    const auto& [matrix, colours, purpose] = inherited;
    if (colours.starts_with("lin")) {
      log_warning("{}: its colours are linear light, and are drawn unconverted: too dark", source_);
    }
    // A scale of 0 hides a prim.
    if (glm::dmat3(matrix) == glm::dmat3(0.0)) return;
    Model part = gaussians_of(prim, flat);
    if (!transform(part, matrix, places_))
      prim.where.fail_here("the transform of '{}' moves Gaussians beyond the range of floats", prim.name);
    flat_ = flat_ || flat;
    join(model_, std::move(part));
  }

  /// Returns the numbers of the attribute `name` (floats) or, if it is missing, of NAMEh (halves): `each` for
  /// each of `count` Gaussians. Empty if both are missing.
  std::vector<float> values(const UsdaPrim& prim, const std::string& name, std::size_t components,
                            std::size_t each, std::size_t count) const {
    const UsdaText* text = prim.attribute(name);
    if (text == nullptr) text = prim.attribute(name + "h");
    if (text == nullptr) {
      for (const std::string& moving : {name + ".timeSamples", name + "h.timeSamples"}) {
        if (prim.attribute(moving) != nullptr)
          prim.attribute(moving)->fail_here("{} changes with time; only a still model can be drawn", name);
      }
      return {};
    }
    std::vector<float> numbers = text->tuples(components);
    const std::size_t wanted = each * count * components;
    if (numbers.size() < wanted) {
      text->fail_here("{} has {} values; expected {}, {} for each of {} positions", name,
                      numbers.size() / components, each * count, each, count);
    }
    if (numbers.size() > wanted && count > 0)
      log_warning("{}: of the {} values of {} only the first {} are used, as OpenUSD has it", source_,
                  numbers.size() / components, name, each * count);
    return numbers;
  }

  Model gaussians_of(const UsdaPrim& prim, bool flat) const {
    const std::vector<float> positions = values(prim, "positions", 3, 1, 0);
    const std::size_t n = positions.size() / 3;
    const std::vector<float> scales = values(prim, "scales", 3, 1, n);
    const std::vector<float> rotations = values(prim, "orientations", 4, 1, n);
    const std::vector<float> opacities = values(prim, "opacities", 1, 1, n);
    check_opacities(source_, opacities);
    const UsdaText* degree = prim.attribute("radiance:sphericalHarmonicsDegree");
    const double said = degree != nullptr ? degree->numbers(1)[0] : 3.0;
    if (!(said == 0.0 || said == 1.0 || said == 2.0 || said == 3.0 || said == 4.0))
      degree->fail_here("harmonics of degree {}; expected 0 to 4", said);
    const auto in_file = static_cast<std::size_t>(sh_count(static_cast<int>(said)));
    const std::vector<float> harmonics =
        values(prim, "radiance:sphericalHarmonicsCoefficients", 3, in_file, n);
    Model model;
    model.name = source_;
    model.degree = harmonics.empty() ? 0 : std::min(static_cast<int>(said), 3);
    model.perspective =
        read_perspective(source_, token_of(prim, "sortingModeHint"), token_of(prim, "projectionModeHint"));
    model.resize(n);
    std::vector<std::uint8_t> kept(n);
    const std::array<float, 3> grey{};
    for (std::size_t i = 0; i < n; ++i) {
      glm::vec3 scale = scales.empty() ? glm::vec3(1.0f) : glm::make_vec3(&scales[3 * i]);
      if (flat) scale.z = 0.0f;
      kept[i] = place(model, i,
                      {glm::make_vec3(&positions[3 * i]), scale,
                       rotations.empty() ? glm::vec4(1, 0, 0, 0) : glm::make_vec4(&rotations[4 * i]),
                       opacities.empty() ? 1.0f : opacities[i],
                       harmonics.empty() ? grey.data() : &harmonics[3 * in_file * i]});
    }
    model.lacks_degree_4 = said == 4.0 && !harmonics.empty();
    keep_only(model, kept);
    return model;
  }

  fs::path path_;
  std::string source_;  // for errors: the path, or the archive and the file in it
  UsdaPrim file_;
  Model model_;
  std::vector<glm::dvec3> places_;  // positions of the model's Gaussians in the scene
  bool flat_ = false, nurec_ = false, has_render_ = false;
  std::vector<std::function<void()>> proxies_;
  std::string unresolved_;        // for errors: the word for content in other files or variants
  std::set<std::string> others_;  // types of prims that are no Gaussians
};

}  // namespace

std::optional<double> usd_units_per_metre(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  const MappedFile file(path);
  std::span<const std::byte> bytes = file.bytes();
  std::vector<std::byte> first;
  if (content_of(bytes) == Content::zip && is_usdz(path, bytes)) {
    const ZipFile zip(path.string(), bytes);
    bytes = first = zip.read(zip.names()[0]);
  }
  if (content_of(bytes) != Content::usda) return std::nullopt;
  const UsdaPrim scene = read_usda(path.string(), as_text(bytes), true);
  const auto found = scene.metadata.find("metersPerUnit");
  if (found == scene.metadata.end()) return std::nullopt;
  const double units = 1.0 / found->second.numbers(1)[0];
  if (!(units > 0.0) || !std::isfinite(units))
    found->second.fail_here("metersPerUnit: expected a number above 0");
  return units;
}

Model load_usda(const fs::path& path, std::string_view text) {
  return UsdReader(path, path.string(), text).read();
}

bool is_usdz(const fs::path& path, std::span<const std::byte> archive) {
  const std::vector<std::string> names = ZipFile(path.string(), archive).names();
  return !names.empty() && is_scene_name(names[0]);
}

Model load_usdz(const fs::path& path, std::span<const std::byte> archive) {
  const ZipFile zip(path.string(), archive);
  const std::string first = zip.names()[0];
  const std::vector<std::byte> bytes = zip.read(first);
  if (content_of(bytes) == Content::usda)
    return UsdReader(path, fmt::format("{}: its file {}", path.string(), first), as_text(bytes)).read();
  if (content_of(bytes) == Content::usdc) refuse_usd_crate(path);
  fail("{}: its file {} is not an OpenUSD scene, but looks like {}", path.string(), binosplat::quoted(first),
       describe(content_of(bytes)));
}

void refuse_usd_crate(const fs::path& path) {
  fail("{} holds a binary OpenUSD scene, and only text can be read; OpenUSD's tools make it with: {}",
       path.string(), flatten_command(path));
}

}  // namespace binosplat
