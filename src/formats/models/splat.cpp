#include "formats/models/splat.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
#include "formats/containers/bytes.h"

namespace binosplat {

namespace {

constexpr std::size_t record_bytes = 32;

glm::vec3 load_vec3(const std::byte* at) {
  return {load_number<float>(at), load_number<float>(at + 4), load_number<float>(at + 8)};
}

glm::vec4 load_rotation(const std::byte* at) {
  glm::vec4 q;
  for (int c = 0; c < 4; ++c) q[c] = static_cast<float>(std::to_integer<int>(at[c]) - 128) / 128.0f;
  return q;
}

bool has_plausible_scale(const std::byte* record) {
  const glm::vec3 scale = load_vec3(record + 12);
  return glm::all(glm::greaterThanEqual(scale, glm::vec3(0.0f))) &&
         glm::all(glm::lessThan(scale, glm::vec3(1e6f)));
}

bool has_unit_rotation(const std::byte* record) {
  return std::abs(glm::length(load_rotation(record + 28)) - 1.0f) < 0.05f;
}

/// Returns whether three quarters of the first 1,000 records, of at least one, are as `is` says.
bool holds_for_most(std::span<const std::byte> bytes, bool (*is)(const std::byte*)) {
  const std::size_t tried = std::min<std::size_t>(bytes.size() / record_bytes, 1000);
  std::size_t good = 0;
  for (std::size_t i = 0; i < tried; ++i) good += is(&bytes[i * record_bytes]) ? 1 : 0;
  return tried > 0 && 4 * good >= 3 * tried;
}

}  // namespace

bool is_splat(std::span<const std::byte> bytes) {
  return bytes.size() % record_bytes == 0 && holds_for_most(bytes, [](const std::byte* record) {
           return has_plausible_scale(record) && has_unit_rotation(record);
         });
}

Model load_splat(const std::string& source, std::span<const std::byte> bytes) {
  if (bytes.size() % record_bytes != 0) {
    fail("{}: {} bytes are no whole number of .splat's records of {}; it is cut short, or something else",
         source, bytes.size(), record_bytes);
  }
  // A file of zeros has such scales, but no rotations of length 1.
  if (!holds_for_most(bytes, [](const std::byte* record) {
        return has_plausible_scale(record) &&
               (has_unit_rotation(record) || load_vec3(record + 12) != glm::vec3(0.0f));
      }))
    fail("{} is not a .splat file: its scales are not plausible", source);
  if (!holds_for_most(bytes, has_unit_rotation))
    log_warning("{}: most of its quaternions do not have length 1; they are normalised", source);
  Model model;
  model.format = ".splat";
  decode_all(model, bytes.size() / record_bytes, [&](std::size_t i) {
    const std::byte* record = &bytes[i * record_bytes];
    float sh[3];
    for (int c = 0; c < 3; ++c) sh[c] = sh_of_colour(std::to_integer<int>(record[24 + c]) / 255.0);
    const float opacity = static_cast<float>(std::to_integer<int>(record[27]) / 255.0);
    return place(model, i,
                 {load_vec3(record), load_vec3(record + 12), load_rotation(record + 28), opacity, sh});
  });
  return model;
}

}  // namespace binosplat
