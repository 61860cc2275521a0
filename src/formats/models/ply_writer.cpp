// Writes INRIA's ply, as its trainer does.

#include <cmath>

#include "formats/containers/bytes.h"
#include "formats/models/model_writers.h"
#include "formats/models/row_writer.h"
#include "formats/training/training_words.h"

namespace binosplat {

namespace {

/// Returns a float near `start` that `decode` converts to exactly `wanted`; if there is none, the float
/// nearest to `start`. `step`, the distance between candidates, changes the decoded number by a quarter of
/// the spacing of floats, since decoding rounds a few times.
template <typename Decode>
float float_for(float wanted, double start, double step, const Decode& decode) {
  for (int k = 0; k <= 32; ++k) {
    const int offset = k % 2 == 0 ? k / 2 : -(k + 1) / 2;
    const float raw = static_cast<float>(start + offset * step);
    if (decode(raw) == wanted) return raw;
  }
  return static_cast<float>(start);
}

/// Returns the stored logarithm of a scale. For a scale of 0 it is finite, but decodes to 0.
float ply_log_scale(float scale) {
  const double start = std::max(std::log(static_cast<double>(scale)), -110.0);
  return float_for(scale, start, 0x1p-26, [](float raw) { return std::exp(raw); });
}

/// Returns the stored logit of an opacity: 0 and 1 become -100 and 100.
float logit(float opacity) {
  const double a = opacity;
  const double start = std::clamp(std::log(a) - std::log1p(-a), -100.0, 100.0);
  return float_for(opacity, start, 0x1p-26 / std::max(1.0 - a, 0x1p-25),
                   [](float raw) { return 1.0f / (1.0f + std::exp(-raw)); });
}

}  // namespace

Losses write_ply(OutputFile& file, const Model& model) {
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree)), higher = values / 3 - 1;
  std::string header =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", model.count());
  std::size_t columns = 0;  // number of columns of 4 bytes
  const auto add = [&](const std::string& name, bool is_wide = false) {
    header += fmt::format("property {} {}\n", is_wide ? "double" : "float", name);
    columns += is_wide ? 2 : 1;
  };
  const bool is_far = model.axes.origin != glm::dvec3(0.0);
  for (const char* name : {"x", "y", "z"}) add(name, is_far);
  for (const char* name : {"nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"}) add(name);
  for (std::size_t k = 0; k < 3 * higher; ++k) add(fmt::format("f_rest_{}", k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    add(name);
  // Comments follow the elements, because INRIA's viewer reads the count from the third line.
  header += training_comments(model, stores_flat(model));
  file.write(header + "end_header\n");

  RowWriter rows([&](std::span<const std::byte> bytes) { file.write(bytes); }, model.count());
  rows.write(model.count(), 4 * columns, [&](std::size_t i, std::byte* row) {
    const auto put = [&](auto value) {
      store_number(row, value);
      row += sizeof(value);
    };
    const float* sh = &model.sh[i * values];
    for (int c = 0; c < 3; ++c)
      is_far ? put(model.axes.origin[c] + model.position[i][c]) : put(model.position[i][c]);
    for (int c = 0; c < 3; ++c) put(0.0f);  // normals
    for (std::size_t c = 0; c < 3; ++c) put(sh[c]);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = 1; k <= higher; ++k) put(sh[3 * k + c]);
    }
    put(logit(model.opacity[i]));
    for (int c = 0; c < 3; ++c) put(ply_log_scale(model.scale[i][c]));
    for (int c = 0; c < 4; ++c) put(model.rotation[i][c]);
  });
  if (!is_far) return {};
  return {"positions are so far from zero that they are written as doubles, which some programs cannot read"};
}

}  // namespace binosplat
