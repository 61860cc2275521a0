#include "formats/models/sog_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "formats/containers/size_limits.h"
#include "formats/containers/zip_file.h"
#include "formats/models/smallest_three.h"
#include "formats/models/sog.h"
#include "formats/pictures/webp.h"
#include "formats/training/trainer_keys.h"
#include "formats/training/training_words.h"
#include "scene/reduce.h"

namespace binosplat {

namespace {

enum Texture { means_l, means_u, quats, scales, sh0, labels, texture_count };

/// Returns the value of each byte, linear from `low` for 0 to `high` for 255.
std::array<float, 256> linear_table(double low, double high) {
  std::array<float, 256> table;
  for (std::size_t b = 0; b < 256; ++b)
    table[b] = static_cast<float>(low + (high - low) * static_cast<double>(b) / 255.0);
  return table;
}

/// Reads 256 values. Old writers wrote null as the first value, which is one step below the second.
std::array<float, 256> codebook(const JsonValue& values) {
  values.list_of(256);
  std::array<float, 256> table;
  for (std::size_t b = 0; b < 256; ++b) {
    if (b == 0 && values.value()[0].is_null()) continue;
    table[b] = static_cast<float>(values.at(b).number());
  }
  if (values.value()[0].is_null()) table[0] = table[1] + (table[1] - table[255]) / 255.0f;
  return table;
}

std::array<float, 256> exponential(std::array<float, 256> table) {
  for (float& v : table) v = std::exp(v);
  return table;
}

std::string file_name(const JsonValue& value) {
  std::string name = value.text();
  if (!is_below_folder(name))
    value.fail_here("a file must lie beside meta.json or below; it is named '{}'", name);
  return name;
}

}  // namespace

std::size_t SogSource::Textures::bytes() const {
  std::size_t sum = 0;
  for (const auto& texels : data) sum += texels.size();
  return sum;
}

SogSource::SogSource(std::string source, const nlohmann::json& json, ReadFile read)
    : source_(std::move(source)), read_(std::move(read)) {
  const JsonValue meta(source_, json);
  const std::uint64_t version = meta.has("version") ? meta.at("version").whole(1000) : 1;
  if (version > 2) meta.at("version").fail_here("unknown SOG version {}: expected 1 or 2", version);
  if (version == 2) {
    count_ = meta.at("count").whole(std::uint64_t{max_webp_side} * max_webp_side);
  } else {
    count_ = meta.at("means").at("shape").at(0).whole(std::uint64_t{max_webp_side} * max_webp_side);
  }
  if (count_ == 0) fail("{} holds no Gaussians: its count is 0", source_);
  training_.flat = meta.has("model") && meta.at("model").text() == "2dgs";
  training_.perspective = read_perspective(meta);
  if (training_.perspective != Perspective{}) training_.perspective_by = source_;
  nlohmann::json single = nlohmann::json::object();  // without the tables
  for (const auto& [key, value] : json.items())
    if (!value.is_structured()) single[key] = value;
  follow(read_keys({"SOG"}, json_values(single)), source_, source_, training_);
  const char* items[] = {"quats", "scales", "sh0"};
  for (std::size_t i = 0; i < 2; ++i) files_[i] = file_name(meta.at("means").at("files").list_of(2).at(i));
  for (std::size_t i = 0; i < 3; ++i) files_[quats + i] = file_name(meta.at(items[i]).at("files").at(0));
  mean_low_ = meta.at("means").at("mins").vector<3>();
  mean_span_ = meta.at("means").at("maxs").vector<3>() - mean_low_;
  if (version == 2) {
    scale_.fill(exponential(codebook(meta.at("scales").at("codebook"))));
    dc_.fill(codebook(meta.at("sh0").at("codebook")));
    opacity_ = linear_table(0.0, 1.0);
  } else {
    read_tables_v1(meta);
  }
  if (meta.has("shN")) read_harmonics(meta.at("shN"));
  // The low bytes of positions are noise, which WebP cannot compress, so the size of their picture limits the
  // number of Gaussians. A picture with less than a byte for 256 Gaussians is forged, even for a small model.
  const std::vector<std::byte> low = read_(files_[means_l]);
  bytes_ = low.size();
  const TableSize size = sog_texture_size(named(files_[means_l]), low);
  if (size.x * size.y < count_ || count_ / 256 > bytes_ || count_ > max_gaussians_in(bytes_)) {
    fail("{}: {} Gaussians are promised, but {} has {} x {} texels in {} bytes{}", source_, count_,
         files_[means_l], size.x, size.y, low.size(), more_may_be_allowed);
  }
}

void SogSource::read_tables_v1(const JsonValue& meta) {
  const auto between = [&](const char* item, std::size_t n, std::size_t i) {
    const JsonValue value = meta.at(item);
    return linear_table(value.at("mins").numbers(n)[i], value.at("maxs").numbers(n)[i]);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    scale_[c] = exponential(between("scales", 3, c));
    dc_[c] = between("sh0", 4, c);
  }
  opacity_ = between("sh0", 4, 3);  // logits until the next line
  for (float& v : opacity_) v = 1.0f / (1.0f + std::exp(-v));
}

void SogSource::read_harmonics(const JsonValue& sh) {
  const std::string centroids = file_name(sh.at("files").list_of(2).at(0));
  labels_file_ = file_name(sh.at("files").at(1));
  sh_ = sh.has("codebook") ? codebook(sh.at("codebook"))
                           : linear_table(sh.at("mins").number(), sh.at("maxs").number());
  const std::vector<std::byte> bytes = read_(centroids);
  const TableSize size = sog_texture_size(named(centroids), bytes);
  if (sh.has("bands")) {
    degree_ = static_cast<int>(sh.at("bands").whole(3));
    if (degree_ == 0) sh.at("bands").fail_here("expected 1, 2 or 3");
  } else {
    while (degree_ < 3 && sog_palette_columns * static_cast<std::size_t>(sh_count(degree_) - 1) < size.x)
      ++degree_;
  }
  const std::size_t width = sog_palette_columns * static_cast<std::size_t>(sh_count(degree_) - 1);
  const std::size_t capacity = sog_palette_columns * size.y;
  palette_ = sh.has("count") ? sh.at("count").whole(max_sog_palette) : std::min(capacity, max_sog_palette);
  if (size.x != width || palette_ > capacity || capacity > 2 * max_sog_palette) {
    fail(
        "{}: {} x {} texels; expected {} x {} or a few more rows, for a palette of {} entries for harmonics "
        "of degree {}",
        named(centroids), size.x, size.y, width, (palette_ + sog_palette_columns - 1) / sog_palette_columns,
        palette_, degree_);
  }
  palette_texels_ = sog_texels(named(centroids), bytes);
}

std::string SogSource::named(const std::string& file) const { return source_ + ": " + file; }

std::vector<std::uint8_t> SogSource::texels(const std::string& file) const {
  const std::vector<std::byte> bytes = read_(file);
  const TableSize size = sog_texture_size(named(file), bytes);
  if (size.x * size.y < count_ || size.x * size.y > 4 * count_ + 65536)
    fail("{}: {} x {} texels do not fit {} Gaussians", named(file), size.x, size.y, count_);
  return sog_texels(named(file), bytes);
}

std::shared_ptr<const SogSource::Textures> SogSource::textures() const {
  std::array<std::string, texture_count> names;
  std::copy(files_.begin(), files_.end(), names.begin());
  names[labels] = labels_file_;
  const auto textures = std::make_shared<Textures>();
  parallel_for(std::size_t{texture_count}, [&](std::size_t i) {
    if (!names[i].empty()) textures->data[i] = texels(names[i]);
  });
  return textures;
}

bool SogSource::decode_one(const Textures& textures, std::size_t i, Model& model, std::size_t slot) const {
  const auto texel = [&](Texture texture) { return &textures.data[texture][4 * i]; };
  const std::uint8_t* low = texel(means_l);
  const std::uint8_t* high = texel(means_u);
  const std::uint8_t* three = texel(quats);
  glm::dvec3 position;
  glm::vec3 scale;
  std::array<float, 3 * sh_count(3)> sh{};
  for (int c = 0; c < 3; ++c) {
    const double n = mean_low_[c] + mean_span_[c] * (low[c] + 256 * high[c]) / 65535.0;
    position[c] = std::copysign(std::expm1(std::abs(n)), n);
    const auto channel = static_cast<std::size_t>(c);
    scale[c] = scale_[channel][texel(scales)[c]];
    sh[channel] = dc_[channel][texel(sh0)[c]];
  }
  // The largest of w, x, y, z is omitted, and the fourth byte names it.
  glm::vec4 rotation(1, 0, 0, 0);
  if (three[3] >= 252) {
    SmallestThree smallest{three[3] - 252};
    for (int k = 0; k < 3; ++k) smallest.others[k] = (three[k] / 255.0 - 0.5) * std::sqrt(2.0);
    rotation = smallest.quaternion();
  }
  if (degree_ > 0) {
    const std::uint8_t* label = texel(labels);
    const std::size_t entry = label[0] + 256u * label[1];
    const std::size_t values = static_cast<std::size_t>(sh_count(degree_) - 1);
    const std::size_t row = entry / sog_palette_columns * sog_palette_columns * values;
    for (std::size_t k = 0; entry < palette_ && k < values; ++k) {
      const std::uint8_t* rgb = &palette_texels_[4 * (row + entry % sog_palette_columns * values + k)];
      for (std::size_t c = 0; c < 3; ++c) sh[3 + 3 * k + c] = sh_[rgb[c]];
    }
  }
  const glm::vec3 drawn(scale.x, scale.y, flat() ? 0.0f : scale.z);
  return place(model, slot, {position, drawn, rotation, opacity_[texel(sh0)[3]], sh.data()});
}

void SogSource::decode(Model& model, std::span<const Range> ranges, std::vector<std::uint8_t>& kept,
                       const Textures& textures) const {
  for (const Range& range : ranges) {
    const auto decode_at = [&](std::size_t i) {
      kept[range.slot + i] = decode_one(textures, range.first + i, model, range.slot + i) ? 1 : 0;
    };
    parallel_for(range.count, decode_at, 2048);
  }
}

std::vector<Model> SogSource::decode_each(const Model& like, std::span<const Range> ranges,
                                          const Textures& textures) const {
  std::vector<Range> together(ranges.begin(), ranges.end());
  std::size_t total = 0;
  for (Range& range : together) range.slot = std::exchange(total, total + range.count);
  Model all = without_gaussians(like);
  all.resize(total);
  std::vector<std::uint8_t> kept(total);
  decode(all, together, kept, textures);
  keep_only(all, kept);
  std::vector<Model> each;
  std::size_t at = 0;
  for (const Range& range : together) {
    const auto of = std::span(kept).subspan(range.slot, range.count);
    const auto count = static_cast<std::size_t>(std::ranges::count(of, 1));
    append(each.emplace_back(without_gaussians(like)), all, at, count);
    at += count;
  }
  return each;
}

}  // namespace binosplat
