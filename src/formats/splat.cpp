#include "formats/splat.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "formats/bytes.h"

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

/// Returns whether a trained model may contain this record.
bool is_plausible(const std::byte* record) {
  const glm::vec3 scale = load_vec3(record + 12);
  const double length = glm::length(load_rotation(record + 28));
  return glm::all(glm::greaterThanEqual(scale, glm::vec3(0.0f))) &&
         glm::all(glm::lessThan(scale, glm::vec3(1e6f))) && std::abs(length - 1.0) < 0.05;
}

}  // namespace

bool is_splat(std::span<const std::byte> bytes) {
  if (bytes.empty() || bytes.size() % record_bytes != 0) return false;
  const std::size_t tried = std::min<std::size_t>(bytes.size() / record_bytes, 1000);
  std::size_t good = 0;
  for (std::size_t i = 0; i < tried; ++i) good += is_plausible(&bytes[i * record_bytes]) ? 1 : 0;
  return 4 * good >= 3 * tried;
}

Model load_splat(const std::string& source, std::span<const std::byte> bytes) {
  if (bytes.size() % record_bytes != 0) {
    fail("{}: {} bytes are no whole number of .splat's records of {}; it is cut short, or something else",
         source, bytes.size(), record_bytes);
  }
  if (!is_splat(bytes)) {
    fail("{} is not a .splat file: its scales or quaternions are not plausible", source);
  }
  Model model;
  model.format = ".splat";
  model.resize(bytes.size() / record_bytes);
  std::vector<std::uint8_t> kept(model.count());
  const auto decode = [&](std::size_t i) {
    const std::byte* record = &bytes[i * record_bytes];
    float sh[3];
    for (int c = 0; c < 3; ++c)
      sh[c] = static_cast<float>((std::to_integer<int>(record[24 + c]) / 255.0 - 0.5) / sh_c0);
    const float opacity = static_cast<float>(std::to_integer<int>(record[27]) / 255.0);
    kept[i] =
        place(model, i, {load_vec3(record), load_vec3(record + 12), load_rotation(record + 28), opacity, sh});
  };
  parallel_for(kept.size(), decode, 2048);
  keep_only(model, kept);
  return model;
}

}  // namespace binosplat
