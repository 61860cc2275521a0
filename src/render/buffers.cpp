#include "render/buffers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "primitives/amount.h"

namespace binosplat::render {

namespace {

// Of one Gaussian, with the padding that vec4s need.
std::int64_t harmonic_bytes(int degree) { return (3 * sh_count(degree) + 3) / 4 * 16; }

void pack_gaussians(const Model& model, std::size_t first, std::span<shared::Gaussian> packed) {
  for (std::size_t k = 0; k < packed.size(); ++k) {
    const std::size_t i = first + k;
    packed[k].position = glm::vec4(model.position[i], model.opacity[i]);
    packed[k].rotation = model.rotation[i];
    packed[k].scale = glm::vec4(model.scale[i], 0.0f);
  }
}

// `padded` is zero between the coefficients of two Gaussians.
void pad_harmonics(const Model& model, std::size_t first, std::span<float> padded, std::size_t stride) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  for (std::size_t k = 0; k < padded.size() / stride; ++k)
    std::copy_n(&model.sh[(first + k) * floats], floats, &padded[k * stride]);
}

// A page of a model, in pieces: switches of levels must not wait for memory that is touched once.
void upload_page(const Model& model, const ModelBuffers::Page& page) {
  constexpr std::size_t piece = 1 << 15;
  const std::size_t stride = static_cast<std::size_t>(harmonic_bytes(model.degree)) / sizeof(float);
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  page.gaussians->reserve(page.count * static_cast<std::int64_t>(sizeof(shared::Gaussian)));
  page.harmonics->reserve(page.count * harmonic_bytes(model.degree));
  std::vector<shared::Gaussian> packed(std::min<std::size_t>(piece, page.count));
  std::vector<float> padded(stride == floats ? 0 : packed.size() * stride);
  for (std::size_t at = 0; at < page.count; at += piece) {
    const std::size_t first = page.first + at, count = std::min<std::size_t>(piece, page.count - at);
    const auto gaussians = std::span(packed).first(count);
    pack_gaussians(model, first, gaussians);
    page.gaussians->upload_part<shared::Gaussian>(gaussians, at);
    if (padded.empty()) {
      page.harmonics->upload_part(std::span(model.sh).subspan(first * floats, count * floats), at * stride);
    } else {
      const auto harmonics = std::span(padded).first(count * stride);
      pad_harmonics(model, first, harmonics, stride);
      page.harmonics->upload_part<float>(harmonics, at * stride);
    }
  }
}

}  // namespace

ModelBuffers::ModelBuffers(gl::Context& context, const Model& model, std::uint32_t page_gaussians)
    : networks(context), page_gaussians_(page_gaussians) {
  upload(context, model);
}

void ModelBuffers::upload(gl::Context& context, const Model& model) {
  const std::int64_t each = std::max<std::int64_t>(sizeof(shared::Gaussian), harmonic_bytes(model.degree));
  const std::int64_t reach = context.limits().storage_block_bytes / each;
  const std::size_t step = page_gaussians_ != 0 ? page_gaussians_ : static_cast<std::size_t>(reach);
  box.reset();
  if (model.scaffold) {
    pages.clear();
    upload_pages(context, *model.scaffold, page_gaussians_ != 0 ? step : step / MAX_VIEWS);
  } else {
    upload_pages(context, model, step);
    if (model.count() > 0) box = all_bounds(model);
  }
}

void ModelBuffers::upload_pages(gl::Context& context, const Model& model, std::size_t step) {
  pages.resize((model.count() + step - 1) / step);
  for (std::size_t k = 0; k < pages.size(); ++k) {
    Page& page = pages[k];
    page.first = static_cast<std::uint32_t>(k * step);
    page.count = static_cast<std::uint32_t>(std::min(step, model.count() - k * step));
    page.anchors.reset();
    if (!page.gaussians) page.gaussians = std::make_unique<gl::Buffer>(context, "Gaussians");
    if (!page.harmonics) page.harmonics = std::make_unique<gl::Buffer>(context, "SH coefficients");
    upload_page(model, page);
  }
}

void ModelBuffers::upload_pages(gl::Context& context, const Scaffold& scaffold, std::size_t step) {
  const std::size_t k = scaffold.offset_count;
  const std::size_t anchors = std::max<std::size_t>(step / k, 1);
  for (std::size_t first = 0; first < scaffold.anchor_count(); first += anchors) {
    const std::size_t count = std::min(anchors, scaffold.anchor_count() - first);
    Page& page = pages.emplace_back();
    page.first = static_cast<std::uint32_t>(first * k);
    page.count = static_cast<std::uint32_t>(count * k);
    page.gaussians = std::make_unique<gl::Buffer>(context, "decoded Gaussians");
    page.harmonics = std::make_unique<gl::Buffer>(context, "decoded colours");
    page.anchors = std::make_unique<AnchorBuffers>(context, scaffold, first, count);
  }
  networks.upload(scaffold);
}

void ModelBuffers::reserve(const FrameShape& shape) {
  if (shape.offset_count == 0) return;
  for (Page& page : pages) {
    const std::int64_t gaussians = std::int64_t{shape.decoding_count()} * page.count;
    page.gaussians->reserve(gaussians * static_cast<std::int64_t>(sizeof(shared::Gaussian)));
    page.harmonics->reserve(gaussians * harmonic_bytes(0));
    for (gl::Buffer* kept : {page.anchors->kept.get(), page.anchors->kept_last.get()})
      kept->reserve(std::int64_t{shape.decoding_count()} * page.anchors->count * 4);
  }
}

void ModelBuffers::keep_last() {
  for (Page& page : pages) {
    if (page.anchors) std::swap(page.anchors->kept, page.anchors->kept_last);
  }
}

std::int64_t starting_pairs(const FrameShape& shape) {
  constexpr std::int64_t pairs_per_splat = 16;
  return std::clamp(shape.slots * std::int64_t{shape.view_count()} * pairs_per_splat, std::int64_t{1} << 16,
                    std::int64_t{1} << 24);
}

MemoryNeeds memory_needs(const FrameShape& shape) {
  MemoryNeeds needs;
  const std::uint32_t decodings = shape.offset_count == 0 ? 1 : shape.decoding_count();
  needs.model =
      shape.anchor_bytes + std::int64_t{decodings} * shape.gaussian_count *
                               (std::int64_t{sizeof(shared::Gaussian)} + harmonic_bytes(shape.degree));
  const bool measured = measures(shape.settings.transmittance);
  const std::int64_t splat_bytes = sizeof(shared::Splat) + sizeof(std::uint32_t) * (measured ? 3 : 2);
  const std::int64_t gaussian_bytes = 4 + (measured ? shape.asked * 8 : 0);
  const std::int64_t pair_bytes = 4 * 4;                                     // tile and splat, twice
  const std::int64_t slot_bytes = shape.view_count() * splat_bytes + 6 * 4;  // indices, order twice, offsets
  needs.frame = shape.gaussian_count * gaussian_bytes + shape.slots * slot_bytes + shape.pixel_count * 20 +
                shape.tile_count * 12LL + starting_pairs(shape) * pair_bytes;
  return needs;
}

FrameBuffers::FrameBuffers(gl::Context& context)
    : views(context, "views"),
      counters(context, "counters"),
      depth_keys(context, "depth keys"),
      block_amount(context, "amount of blocks"),
      block_counts(context, "block counts"),
      order(context, "depth order"),
      pair_offsets(context, "pair offsets"),
      upper(std::make_unique<gl::Buffer>(context, "remembered transmittance")),
      upper_next(std::make_unique<gl::Buffer>(context, "transmittance to remember")),
      measured(context, "measured transmittance"),
      depth_table(context, "transmittance by depth"),
      splats(context, "splats"),
      tile_counts(context, "tile counts"),
      tall(context, "tall splats"),
      pair_amounts(context, "amounts of pairs"),
      pairs(context, "Gaussian-tile pairs"),
      ranges(context, "tile ranges"),
      long_lists(context, "tiles with long lists"),
      colours(context, "pixels"),
      z_sums(context, "depth of pixels"),
      shown(context, "what the blend comes by"),
      shown_light(context, "transmittance to show"),
      scan(context),
      sort(context),
      context_(context) {}

void FrameBuffers::upload(const FrameShape& shape) {
  std::vector<shared::View> all = shape.views;
  all.insert(all.end(), shape.between.begin(), shape.between.end());
  views.upload(all);
  if (shape.settings.transmittance != TRANSMITTANCE_DEPTH) return;
  std::vector<float> table = shape.settings.depth_table.upper;
  for (float& upper_of_bin : table)
    upper_of_bin = upper_of_bin > 0.0f ? std::max(upper_of_bin, static_cast<float>(UPPER_FLOOR)) : 1.0f;
  depth_table.upload(table);
}

void FrameBuffers::reserve(const FrameShape& shape, std::int64_t pair_capacity) {
  const std::int64_t gaussians = shape.gaussian_count;
  const std::int64_t slots = shape.slots;
  const std::int64_t blocks = (gaussians + COMPACT_BLOCK - 1) / COMPACT_BLOCK;
  counters.reserve(sizeof(shared::Counters));
  depth_keys.reserve(gaussians * 4);
  block_counts.reserve(blocks * 4);
  while (drawn.size() < shape.groups.size()) drawn.push_back(std::make_unique<DrawnBuffers>(context_));
  for (const auto& group : drawn) {
    group->amounts.reserve(sizeof(primitives::SortAmounts));
    group->indices.reserve(slots * 4);
  }
  if (measures(shape.settings.transmittance)) {
    upper->reserve(gaussians * shape.asked * 4);
    upper_next->reserve(gaussians * shape.asked * 4);
    measured.reserve(slots * shape.view_count() * 4);
  }
  if (shape.settings.weigh) measured.reserve(slots * shape.view_count() * 8);
  order.reserve(slots);
  pair_offsets.reserve(slots * 4);
  splats.reserve(slots * shape.view_count() * static_cast<std::int64_t>(sizeof(shared::Splat)));
  tile_counts.reserve(slots * shape.view_count() * 4);
  tall.reserve(slots * shape.view_count() * 4);
  pair_amounts.reserve(sizeof(primitives::SortAmounts));
  pairs.reserve(pair_capacity);
  ranges.reserve(std::max<std::int64_t>(shape.tile_count, shape.view_count()) * 8);
  long_lists.reserve(shape.tile_count * 4LL);
  colours.reserve(shape.pixel_count * 16);
  z_sums.reserve(shape.pixel_count * 4);
  scan.reserve(std::max(blocks, slots));
  sort.reserve(std::max(slots, pair_capacity));
}

}  // namespace binosplat::render
