#pragma once
// Writes OpenUSD text files with Gaussians.

#include <fmt/core.h>

#include <string>

#include "support/load.h"

namespace binosplat::test {

/// Returns a list of `count` tuples of `components` numbers each.
template <typename Number>
std::string usd_list(std::size_t count, int components, const Number& number) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) {
    text += i > 0 ? ", " : "";
    if (components > 1) text += "(";
    for (int c = 0; c < components; ++c) text += fmt::format("{}{}", c > 0 ? ", " : "", number(i, c));
    if (components > 1) text += ")";
  }
  return text + "]";
}

/// Returns the attributes of a model's Gaussians, one a line.
inline std::string usd_attributes(const Model& model) {
  const std::size_t n = model.count(), values = static_cast<std::size_t>(sh_count(model.degree));
  return "point3f[] positions = " +
         usd_list(n, 3, [&](std::size_t i, int c) { return model.position[i][c]; }) +
         "\nquatf[] orientations = " +
         usd_list(n, 4, [&](std::size_t i, int c) { return model.rotation[i][c]; }) +
         "\nfloat3[] scales = " + usd_list(n, 3, [&](std::size_t i, int c) { return model.scale[i][c]; }) +
         "\nfloat[] opacities = " + usd_list(n, 1, [&](std::size_t i, int) { return model.opacity[i]; }) +
         fmt::format("\nuniform int radiance:sphericalHarmonicsDegree = {}", model.degree) +
         "\nfloat3[] radiance:sphericalHarmonicsCoefficients = " +
         usd_list(n * values, 3,
                  [&](std::size_t k, int c) { return model.sh[3 * k + static_cast<std::size_t>(c)]; }) +
         " (\n  elementSize = " + std::to_string(values) + "\n)\n";
}

inline std::string usd_prim(const Model& model, const std::string& more = "") {
  return "def ParticleField3DGaussianSplat \"splats\" (\n  prepend apiSchemas = [\"ColorSpaceAPI\"]\n)\n{\n" +
         usd_attributes(model) + more + "}\n";
}

/// Returns a complete file.
inline std::string usd_file(const std::string& prims, const std::string& metadata = "") {
  return "#usda 1.0\n(\n  \"\"\"Made by a test; it's \"quoted\" (and more.\"\"\"\n  upAxis = \"Y\"\n  "
         "metersPerUnit = 1\n" +
         metadata + ")\n\n" + prims;
}

inline Model load_usd_text(const std::string& text) { return load_model_of(text, "a.usda"); }

}  // namespace binosplat::test
