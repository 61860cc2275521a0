// Writes PlayCanvas' SOG, version 2.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "base/progress.h"
#include "formats/containers/zip_file.h"
#include "formats/models/codebook.h"
#include "formats/models/model_writers.h"
#include "formats/models/morton.h"
#include "formats/models/sog.h"
#include "formats/pictures/webp.h"
#include "formats/training/training_words.h"

namespace binosplat {

namespace {

/// Larger logarithms of scales are clipped, as in PlayCanvas.
constexpr double max_sog_log_scale = 20.0;

using Rgba = std::array<std::uint8_t, 4>;

/// A picture and its name in the archive. The picture has one texel for each Gaussian, except the palette's
/// picture.
struct TableTexture {
  std::string name;
  int width = 0, height = 0;
  std::vector<std::uint8_t> texels;

  TableTexture(std::string name_, std::size_t width_, std::size_t height_)
      : name(std::move(name_)),
        width(static_cast<int>(width_)),
        height(static_cast<int>(height_)),
        texels(4 * width_ * height_, 255) {}
  void set(std::size_t i, const Rgba& value) { std::copy(value.begin(), value.end(), &texels[4 * i]); }
};

float sog_log_scale(float scale) {
  return static_cast<float>(
      std::clamp(std::log(static_cast<double>(scale)), -max_sog_log_scale, max_sog_log_scale));
}

/// Returns the stored value of a position.
double log_position(double p) { return std::copysign(std::log1p(std::abs(p)), p); }

class SogWriter {
 public:
  SogWriter(const Model& model, std::span<const std::uint32_t> order)
      : model_(model), order_(order), values_(3 * static_cast<std::size_t>(sh_count(model.degree))) {
    const auto n = static_cast<double>(model.count());
    width_ = 4 * static_cast<std::size_t>(std::ceil(std::sqrt(n) / 4.0));
    height_ = (model.count() + 4 * width_ - 1) / (4 * width_) * 4;
    if (width_ > max_webp_side || height_ > max_webp_side)
      fail("{}: {} Gaussians do not fit the {} x {} texels of a SOG", model.name, model.count(),
           max_webp_side, max_webp_side);
    meta_ = {{"version", 2}, {"asset", {{"generator", "binosplat"}}}, {"count", model.count()}};
    write_training(model, stores_flat(model), meta_);
  }

  ZipEntries files(bool shows_progress) {
    add_positions();
    add_scales();
    add_rotations();
    add_colours();
    if (model_.degree > 0) add_harmonics();
    ZipEntries entries(textures_.size() + 1);
    const std::string meta = meta_.dump();
    const auto text = std::as_bytes(std::span(meta));
    entries[0] = {"meta.json", {text.begin(), text.end()}};
    std::optional<Progress> progress;
    if (shows_progress) progress.emplace("writing", textures_.size());
    parallel_for(textures_.size(), [&](std::size_t k) {
      const TableTexture& t = textures_[k];
      entries[k + 1] = {t.name, webp_file(t.texels, t.width, t.height)};
      if (progress) progress->add(1);
    });
    return entries;
  }

 private:
  /// Adds a picture with value(i) for Gaussian i; returns its file name.
  template <typename Value>
  std::string add(const std::string& name, const Value& value) {
    TableTexture& texture = textures_.emplace_back(name + ".webp", width_, height_);
    parallel_for(order_.size(), [&](std::size_t k) { texture.set(k, value(order_[k])); });
    return texture.name;
  }

  /// Builds a codebook of get(i, c) for all Gaussians and channels.
  template <typename Get>
  Codebook codebook(const Get& get) const {
    std::vector<float> values(3 * model_.count());
    parallel_for(model_.count(), [&](std::size_t i) {
      for (std::size_t c = 0; c < 3; ++c) values[3 * i + c] = get(i, c);
    });
    return Codebook(std::move(values));
  }

  void add_positions() {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const glm::vec3& p : model_.position) {
      const glm::dvec3 q = model_.axes.origin + glm::dvec3(p);
      const glm::dvec3 v(log_position(q.x), log_position(q.y), log_position(q.z));
      low = glm::min(low, v);
      high = glm::max(high, v);
    }
    const auto step = [&](std::size_t i, int c) {
      const double span = high[c] - low[c];
      return span > 0.0
                 ? nearest_step((log_position(model_.axes.origin[c] + model_.position[i][c]) - low[c]) /
                                    span * 65535.0,
                                65535)
                 : 0u;
    };
    const auto bytes = [&](std::size_t i, int shift) {
      Rgba texel{0, 0, 0, 255};
      for (int c = 0; c < 3; ++c)
        texel[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(step(i, c) >> shift & 255u);
      return texel;
    };
    const std::string lower = add("means_l", [&](std::size_t i) { return bytes(i, 0); });
    const std::string upper = add("means_u", [&](std::size_t i) { return bytes(i, 8); });
    meta_["means"] = {
        {"mins", {low.x, low.y, low.z}}, {"maxs", {high.x, high.y, high.z}}, {"files", {lower, upper}}};
  }

  void add_scales() {
    const auto get = [&](std::size_t i, std::size_t c) {
      return sog_log_scale(model_.scale[i][static_cast<glm::length_t>(c)]);
    };
    const Codebook book = codebook(get);
    const std::string file = add("scales", [&](std::size_t i) -> Rgba {
      return {book.nearest(get(i, 0)), book.nearest(get(i, 1)), book.nearest(get(i, 2)), 255};
    });
    meta_["scales"] = {{"codebook", book.entries()}, {"files", {file}}};
  }

  void add_rotations() {
    const std::string file = add("quats", [&](std::size_t i) -> Rgba {
      const SmallestThree smallest = smallest_three(model_.rotation[i]);
      Rgba texel;
      for (int c = 0; c < 3; ++c) {
        texel[static_cast<std::size_t>(c)] =
            static_cast<std::uint8_t>(nearest_step((smallest.others[c] / std::sqrt(2.0) + 0.5) * 255.0, 255));
      }
      texel[3] = static_cast<std::uint8_t>(252 + smallest.largest);
      return texel;
    });
    meta_["quats"] = {{"files", {file}}};
  }

  void add_colours() {
    const auto get = [&](std::size_t i, std::size_t c) { return model_.sh[i * values_ + c]; };
    const Codebook book = codebook(get);
    const std::string file = add("sh0", [&](std::size_t i) -> Rgba {
      const auto opacity = static_cast<std::uint8_t>(nearest_step(255.0 * model_.opacity[i], 255));
      return {book.nearest(get(i, 0)), book.nearest(get(i, 1)), book.nearest(get(i, 2)), opacity};
    });
    meta_["sh0"] = {{"codebook", book.entries()}, {"files", {file}}};
  }

  void add_harmonics() {
    const std::size_t higher = values_ - 3, coefficients = higher / 3;
    const Palette palette = make_palette(model_.count(), higher, max_sog_palette,
                                         [&](std::size_t i) { return &model_.sh[i * values_ + 3]; });
    const Codebook book(palette.entries);
    const std::size_t rows = (palette.count + sog_palette_columns - 1) / sog_palette_columns;
    TableTexture& centroids =
        textures_.emplace_back("shN_centroids.webp", sog_palette_columns * coefficients, rows);
    for (std::size_t k = 0; k < palette.count * coefficients; ++k) {
      const float* rgb = &palette.entries[3 * k];
      centroids.set(k, {book.nearest(rgb[0]), book.nearest(rgb[1]), book.nearest(rgb[2]), 255});
    }
    const std::string labels = add("shN_labels", [&](std::size_t i) -> Rgba {
      const std::uint32_t label = palette.labels[i];
      return {static_cast<std::uint8_t>(label & 255u), static_cast<std::uint8_t>(label >> 8), 0, 255};
    });
    meta_["shN"] = {{"count", palette.count},
                    {"bands", model_.degree},
                    {"codebook", book.entries()},
                    {"files", {"shN_centroids.webp", labels}}};
  }

  const Model& model_;
  std::span<const std::uint32_t> order_;
  std::size_t values_;  // coefficients of a Gaussian, including degree 0
  std::size_t width_ = 0, height_ = 0;
  nlohmann::ordered_json meta_;
  std::deque<TableTexture> textures_;
};

}  // namespace

ZipEntries sog_files(const Model& model) {
  std::vector<std::uint32_t> order(model.count());
  std::iota(order.begin(), order.end(), 0u);
  return SogWriter(model, order).files(false);
}

Losses sog_losses(const Model& model) {
  Losses losses;
  const double thin = std::exp(-max_sog_log_scale), thick = std::exp(max_sog_log_scale);
  const bool is_flat = stores_flat(model);
  count_lost(losses, model, "scales beyond e^-20 to e^20, which a SOG clips", [&](std::size_t i) {
    const glm::vec3& s = model.scale[i];
    return std::min({s.x, s.y, is_flat ? s.x : s.z}) < thin || std::max({s.x, s.y, s.z}) > thick;
  });
  return losses;
}

Losses write_sog(OutputFile& file, const Model& model) {
  const std::vector<std::uint32_t> order = morton_order(model.position);
  file.write(zip_of(SogWriter(model, order).files(true)));
  return sog_losses(model);
}

}  // namespace binosplat
