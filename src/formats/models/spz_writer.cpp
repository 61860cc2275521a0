// Writes Niantic's spz, version 3: all positions, then all opacities and so on, in whole bytes, within gzip.

#include "formats/containers/bytes.h"
#include "formats/containers/gzip.h"
#include "formats/models/model_writers.h"
#include "formats/models/row_writer.h"
#include "formats/models/spz_container.h"

namespace binosplat {

namespace {

constexpr std::uint32_t version = 3;
constexpr int fraction_bits_usual = 12;  // other writers always use 12
constexpr int max_fraction_bits = 24;
constexpr double max_position = (1 << 23) - 1;
// The least number of steps from 0 to the outermost position. With 12 bits, small models have fewer.
constexpr double min_steps = 1 << 14;

double outermost(const Model& model) {
  double most = 0.0;
  for (const glm::vec3& p : model.position) {
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(static_cast<double>(p[c])));
  }
  return most;
}

/// Returns the number of fraction bits of positions, which have 24 bits with the sign.
int fraction_bits(const Model& model) {
  const double most = outermost(model);
  int bits = fraction_bits_usual;
  while (bits < max_fraction_bits && std::ldexp(most, bits) < min_steps) ++bits;
  while (bits >= 0 && std::ldexp(most, bits) > max_position) --bits;
  if (bits < 0) fail("{}: positions reach {:.4g}, and spz stores at most {}", model.name, most, max_position);
  return bits;
}

/// Quantises a coefficient from -1 to 1 to one of `steps` bytes, the multiples of 256 / steps.
std::byte harmonic_byte(double v, int steps) {
  const int bucket = 256 / steps;
  const auto most = static_cast<std::uint32_t>(steps - 1);
  return static_cast<std::byte>(static_cast<int>(nearest_step((v + 1.0) * 128.0 / bucket, most)) * bucket);
}

/// Returns the number of steps for the higher coefficient `k` of all channels. Degree 1 has one bit more.
int steps_of(std::size_t k, int harmonic_bits) { return 1 << std::min(harmonic_bits + (k < 9 ? 1 : 0), 8); }

/// Packs the three smallest of x, y, z, w with nine bits and a sign each, the first one in the highest bits.
std::uint32_t packed_rotation(const glm::vec4& q) {
  const SmallestThree smallest = smallest_three(glm::vec4(q.y, q.z, q.w, q.x));
  auto word = static_cast<std::uint32_t>(smallest.largest);
  for (int c = 0; c < 3; ++c) {
    const double v = smallest.others[c];
    word = word << 10 | (v < 0.0 ? 512u : 0u) | nearest_step(std::abs(v) / std::sqrt(0.5) * 511.0, 511);
  }
  return word;
}

void write_rows(RowWriter& rows, const Model& model, int bits, int harmonic_bits) {
  const std::size_t n = model.count(), values = model.sh.size() / n;
  const SpzSizes sizes = spz_sizes(version, model.degree);
  const auto as_byte = [](double v) { return static_cast<std::byte>(nearest_step(v, 255)); };
  rows.write(n, sizes[spz_positions], [&](std::size_t i, std::byte* row) {
    for (int c = 0; c < 3; ++c, row += 3) {
      const auto fixed = std::lround(std::ldexp(static_cast<double>(model.position[i][c]), bits));
      const auto word = static_cast<std::uint32_t>(fixed);
      store_number(row, static_cast<std::uint16_t>(word));
      row[2] = static_cast<std::byte>(word >> 16);
    }
  });
  rows.write(n, sizes[spz_opacities],
             [&](std::size_t i, std::byte* row) { row[0] = as_byte(255.0 * model.opacity[i]); });
  rows.write(n, sizes[spz_colours], [&](std::size_t i, std::byte* row) {
    for (std::size_t c = 0; c < 3; ++c)
      row[c] = as_byte(255.0 * (0.5 + spz_colour_scale * model.sh[i * values + c]));
  });
  rows.write(n, sizes[spz_scales], [&](std::size_t i, std::byte* row) {
    for (int c = 0; c < 3; ++c)
      row[c] = as_byte(16.0 * (std::log(static_cast<double>(model.scale[i][c])) + 10.0));
  });
  rows.write(n, sizes[spz_rotations],
             [&](std::size_t i, std::byte* row) { store_number(row, packed_rotation(model.rotation[i])); });
  if (sizes[spz_harmonics] == 0) return;
  rows.write(n, sizes[spz_harmonics], [&](std::size_t i, std::byte* row) {
    for (std::size_t k = 0; k < sizes[spz_harmonics]; ++k)
      row[k] = harmonic_byte(model.sh[i * values + 3 + k], steps_of(k, harmonic_bits));
  });
}

Losses losses_of(const Model& model, int bits, int harmonic_bits) {
  const double reach = std::ldexp(1.0, bits) * outermost(model);
  const std::size_t values = model.sh.size() / model.count();
  Losses losses;
  if (reach > 0.0 && reach < min_steps)
    losses.push_back(fmt::format(
        "the model is so small that spz keeps positions in steps of {:.4g} only, {:.2g} of its size",
        std::ldexp(1.0, -bits), 1.0 / reach));
  if (bits < fraction_bits_usual)
    losses.push_back(fmt::format("the model is so large that spz keeps positions in steps of {:.4g} only",
                                 std::ldexp(1.0, -bits)));
  // Scales up to half a step beyond the range are only rounded to its ends, which is no loss.
  const double thin = std::exp(-10.0 - 0.5 / 16.0), thick = std::exp(255.5 / 16.0 - 10.0);
  count_lost(losses, model, "scales beyond e^-10 to e^5.94, which spz clips", [&](std::size_t i) {
    const glm::vec3& s = model.scale[i];
    return std::min({s.x, s.y, s.z}) < thin || std::max({s.x, s.y, s.z}) > thick;
  });
  count_lost(losses, model, "base colours beyond those of spz, which clips them", [&](std::size_t i) {
    const float* sh = &model.sh[i * values];
    return std::any_of(sh, sh + 3,
                       [](float v) { return std::abs(spz_colour_scale * v) > 0.5 + 0.5 / 255.0; });
  });
  count_lost(losses, model, "harmonics beyond about -1 to 1, which spz clips", [&](std::size_t i) {
    const float* sh = &model.sh[i * values];
    for (std::size_t k = 0; k < values - 3; ++k) {
      const double half = 1.0 / steps_of(k, harmonic_bits), v = sh[3 + k];
      if (v < -1.0 - half || v > 1.0 - half) return true;
    }
    return false;
  });
  return losses;
}

}  // namespace

Losses write_spz(OutputFile& file, const Model& model, int harmonic_bits) {
  const int bits = fraction_bits(model);
  std::vector<std::byte> bytes = spz_header(version, model.count(), model.degree, bits, model.antialiased);
  const auto append = [&](std::span<const std::byte> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  RowWriter rows(append, (model.degree > 0 ? 6 : 5) * model.count());
  write_rows(rows, model, bits, harmonic_bits);
  append(spz_axes_extension(model.axes.letters));
  file.write(gzip_of(bytes));
  return losses_of(model, bits, harmonic_bits);
}

}  // namespace binosplat
