#include "formats/models/ksplat.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/error.h"
#include "formats/containers/bytes.h"

namespace binosplat {

namespace {

constexpr std::size_t ksplat_header_bytes = 4096, section_header_bytes = 1024;
constexpr std::size_t max_sections = 65536;

/// Storage of a Gaussian at the three compression levels, in bytes.
struct Storage {
  std::size_t position, scale, rotation, harmonic;  // harmonic: one coefficient
};
constexpr Storage storages[] = {{12, 12, 16, 4}, {6, 6, 8, 2}, {6, 6, 8, 1}};
constexpr std::size_t colour_bytes = 4;

struct Section {
  std::size_t count = 0, capacity = 0;  // of Gaussians
  std::size_t bucket_size = 0, buckets = 0, full_buckets = 0, partial_buckets = 0;
  double block = 0.0;  // side of a bucket, world units
  std::size_t bucket_bytes = 0;
  double range = 1.0;
  int degree = 0;
  std::size_t at = 0;  // byte where its data begins

  std::size_t data() const { return at + 4 * partial_buckets + buckets * bucket_bytes; }
};

class KsplatReader {
 public:
  KsplatReader(const std::string& source, std::span<const std::byte> bytes) : source_(source), bytes_(bytes) {
    if (bytes.size() < ksplat_header_bytes) {
      fail("{} is cut short: a .ksplat header has {} bytes, and {} are there", source, ksplat_header_bytes,
           bytes.size());
    }
    const int major = std::to_integer<int>(bytes[0]), minor = std::to_integer<int>(bytes[1]);
    if (major != 0 || minor < 1)
      fail("{}: unknown .ksplat version {}.{}: expected 0.1", source, major, minor);
    level_ = load_number<std::uint16_t>(&bytes[20]);
    if (level_ >= std::size(storages))
      fail("{}: compression level {}, at byte 20; expected 0, 1 or 2", source, level_);
    sh_low_ = load_number<float>(&bytes[36]);
    sh_high_ = load_number<float>(&bytes[40]);
    if (sh_low_ == 0.0f && sh_high_ == 0.0f) {
      sh_low_ = -1.5f;
      sh_high_ = 1.5f;
    }
    read_sections();
  }

  Model read() const {
    Model model;
    model.format = ".ksplat";
    for (const Section& section : sections_) model.degree = std::max(model.degree, section.degree);
    model.resize(count_);
    std::vector<std::uint8_t> kept(count_);
    std::size_t slot = 0;
    for (const Section& section : sections_) {
      const std::vector<std::size_t> buckets = buckets_of(section);
      for (std::size_t i = 0; i < section.count; ++i, ++slot)
        kept[slot] = decode(section, buckets, i, model, slot) ? 1 : 0;
    }
    keep_only(model, kept);
    return model;
  }

 private:
  std::uint32_t word(std::size_t at) const { return load_number<std::uint32_t>(&bytes_[at]); }

  std::size_t record_bytes(const Section& section) const {
    const Storage& s = storages[level_];
    return s.position + s.scale + s.rotation + colour_bytes +
           3 * static_cast<std::size_t>(sh_count(section.degree) - 1) * s.harmonic;
  }

  void read_sections() {
    // Reads all sections for which the header has room, since in some files the number of sections, at byte
    // 8, is 0. Unused sections have no Gaussians and no data.
    const std::size_t most = word(4), promised = word(16);
    if (most > max_sections || ksplat_header_bytes + most * section_header_bytes > bytes_.size()) {
      fail("{} is damaged or cut short: its header has room for {} sections, which {} bytes cannot hold",
           source_, most, bytes_.size());
    }
    std::size_t at = ksplat_header_bytes + most * section_header_bytes;
    for (std::size_t i = 0; i < most; ++i) {
      const Section section = read_section(i, at);
      at = section.data() + section.capacity * record_bytes(section);
      count_ += section.count;
      sections_.push_back(section);
    }
    if (count_ != promised) {
      fail("{}: its header promises {} Gaussians, at byte 16, but its sections have {}", source_, promised,
           count_);
    }
    if (count_ == 0) fail("{} holds no Gaussians", source_);
  }

  Section read_section(std::size_t index, std::size_t at) const {
    const std::size_t header = ksplat_header_bytes + index * section_header_bytes;
    Section s;
    s.count = word(header);
    s.capacity = word(header + 4);
    s.bucket_size = word(header + 8);
    s.buckets = word(header + 12);
    s.block = load_number<float>(&bytes_[header + 16]);
    s.bucket_bytes = load_number<std::uint16_t>(&bytes_[header + 20]);
    const std::uint32_t range = word(header + 24);
    s.range = range != 0 ? range : level_ == 0 ? 1.0 : 32767.0;
    s.full_buckets = word(header + 32);
    s.partial_buckets = word(header + 36);
    s.degree = load_number<std::uint16_t>(&bytes_[header + 40]);
    s.at = at;
    if (s.degree > 3)
      fail("{}: section {} has harmonics of degree {}; expected 0 to 3", source_, index, s.degree);
    if (s.count > s.capacity)
      fail("{}: section {} has {} Gaussians and room for {}", source_, index, s.count, s.capacity);
    // All numbers are below 2^32, so the sum is far below 2^64.
    const std::size_t needed =
        4 * s.partial_buckets + s.buckets * s.bucket_bytes + s.capacity * record_bytes(s);
    if (needed > bytes_.size() - at) {
      fail("{} is cut short: section {} takes {} bytes from byte {} on, and {} are there", source_, index,
           needed, at, bytes_.size() - at);
    }
    if (level_ > 0 && s.bucket_bytes < 12) {
      fail("{}: section {} has buckets of {} bytes; expected 12, three floats", source_, index,
           s.bucket_bytes);
    }
    return s;
  }

  /// Returns each Gaussian's bucket: full buckets, then partial ones with stored lengths; none at level 0.
  std::vector<std::size_t> buckets_of(const Section& s) const {
    std::vector<std::size_t> buckets;
    if (level_ == 0) return buckets;
    if (s.full_buckets + s.partial_buckets > s.buckets) {
      fail("{}: {} full and {} partial buckets, but only {} have a centre", source_, s.full_buckets,
           s.partial_buckets, s.buckets);
    }
    for (std::size_t b = 0; b < s.full_buckets + s.partial_buckets; ++b) {
      const std::size_t length = b < s.full_buckets ? s.bucket_size : word(s.at + 4 * (b - s.full_buckets));
      if (length > s.capacity - buckets.size()) {
        fail("{}: bucket {} has {} Gaussians, but its section has only {} more", source_, b, length,
             s.capacity - buckets.size());
      }
      buckets.insert(buckets.end(), length, b);
    }
    if (buckets.size() < s.count)
      fail("{}: its buckets have {} Gaussians, and the section {}", source_, buckets.size(), s.count);
    return buckets;
  }

  float number(const std::byte* at, std::size_t i) const {
    return level_ == 0 ? load_number<float>(at + 4 * i) : load_half(at + 2 * i);
  }

  float harmonic(const std::byte* at, std::size_t i) const {
    if (level_ < 2) return number(at, i);
    return sh_low_ + (sh_high_ - sh_low_) * static_cast<float>(std::to_integer<int>(at[i])) / 255.0f;
  }

  bool decode(const Section& s, const std::vector<std::size_t>& buckets, std::size_t i, Model& model,
              std::size_t slot) const {
    const Storage& storage = storages[level_];
    const std::byte* at = &bytes_[s.data() + i * record_bytes(s)];
    glm::vec3 position;
    for (int c = 0; c < 3; ++c) {
      if (level_ == 0) {
        position[c] = number(at, static_cast<std::size_t>(c));
      } else {
        const std::byte* centre = &bytes_[s.at + 4 * s.partial_buckets + buckets[i] * s.bucket_bytes];
        const double offset = load_number<std::uint16_t>(at + 2 * c) - s.range;
        position[c] =
            static_cast<float>(offset * (0.5 * s.block / s.range) + load_number<float>(centre + 4 * c));
      }
    }
    at += storage.position;
    const glm::vec3 scale(number(at, 0), number(at, 1), number(at, 2));
    at += storage.scale;
    const glm::vec4 rotation(number(at, 0), number(at, 1), number(at, 2), number(at, 3));
    at += storage.rotation;
    std::array<float, 3 * sh_count(3)> sh{};
    for (std::size_t c = 0; c < 3; ++c) sh[c] = sh_of_colour(std::to_integer<int>(at[c]) / 255.0);
    const float opacity = static_cast<float>(std::to_integer<int>(at[3]) / 255.0);
    at += colour_bytes;
    // The file stores coefficients by band and, within a band, by channel.
    std::size_t first = 0;
    for (int band = 1; band <= s.degree; ++band) {
      const std::size_t width = 2 * static_cast<std::size_t>(band) + 1;
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t m = 0; m < width; ++m)
          sh[3 + 3 * (first + m) + c] = harmonic(at, 3 * first + c * width + m);
      }
      first += width;
    }
    return place(model, slot, {position, scale, rotation, opacity, sh.data()});
  }

  const std::string& source_;
  std::span<const std::byte> bytes_;
  std::size_t level_ = 0;
  float sh_low_ = 0.0f, sh_high_ = 0.0f;  // range of the bytes at compression level 2
  std::vector<Section> sections_;
  std::size_t count_ = 0;
};

}  // namespace

bool is_ksplat(std::span<const std::byte> bytes) {
  return bytes.size() >= ksplat_header_bytes + section_header_bytes && bytes[0] == std::byte{0} &&
         bytes[1] == std::byte{1} && bytes[2] == std::byte{0} && bytes[3] == std::byte{0} &&
         load_number<std::uint32_t>(&bytes[4]) > 0 && load_number<std::uint32_t>(&bytes[4]) <= max_sections;
}

Model load_ksplat(const std::string& source, std::span<const std::byte> bytes) {
  return KsplatReader(source, bytes).read();
}

}  // namespace binosplat
