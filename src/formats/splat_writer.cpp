// antimatter15's .splat.

#include "formats/bytes.h"
#include "formats/model_writers.h"
#include "formats/row_writer.h"

namespace binosplat {

Losses write_splat(OutputFile& file, const Model& model) {
  const std::size_t values = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const auto colour = [&](std::size_t i, std::size_t c) { return 0.5 + sh_c0 * model.sh[i * values + c]; };
  RowWriter rows([&](std::span<const std::byte> bytes) { file.write(bytes); }, model.count());
  rows.write(model.count(), 32, [&](std::size_t i, std::byte* row) {
    for (int c = 0; c < 3; ++c) {
      store_number(row + 4 * c, model.position[i][c]);
      store_number(row + 12 + 4 * c, model.scale[i][c]);
      row[24 + c] = static_cast<std::byte>(nearest_step(255.0 * colour(i, static_cast<std::size_t>(c)), 255));
    }
    row[27] = static_cast<std::byte>(nearest_step(255.0 * model.opacity[i], 255));
    // Bytes reach from -1 to 127/128: of q and -q, which turn alike, the one whose largest component fits.
    const glm::vec4& q = model.rotation[i];
    int largest = 0;
    for (int c = 1; c < 4; ++c) {
      if (std::abs(q[c]) > std::abs(q[largest])) largest = c;
    }
    const double sign = q[largest] > 0.0f ? -1.0 : 1.0;
    for (int c = 0; c < 4; ++c)
      row[28 + c] = static_cast<std::byte>(nearest_step(128.0 + 128.0 * sign * q[c], 255));
  });

  Losses losses;
  if (model.degree > 0)
    losses.push_back(
        fmt::format(".splat keeps no harmonics: those of degrees 1 to {} are dropped, and with "
                    "them what changes with the viewer's place",
                    model.degree));
  count_lost(losses, model, "base colours outside 0 to 1, which .splat clips", [&](std::size_t i) {
    bool out = false;
    for (std::size_t c = 0; c < 3; ++c) out = out || std::abs(colour(i, c) - 0.5) > 0.5 + 0.5 / 255.0;
    return out;
  });
  if (model.antialiased) losses.push_back(".splat does not tell of anti-aliasing: draw it with --antialias");
  return losses;
}

}  // namespace binosplat
