#include "render/buffers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "primitives/amount.h"
#include "render/halves.h"

namespace binosplat::render {

namespace {

// Of one Gaussian, with the padding that vec4s need.
std::int64_t harmonic_bytes(int degree, int precision) {
  const int in_a_word = precision == PRECISION_HALF ? 2 : 1;
  return (3 * sh_count(degree) + 4 * in_a_word - 1) / (4 * in_a_word) * 16;
}

std::int64_t gaussian_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Gaussian);
}

std::int64_t splat_bytes(int precision) {
  return precision == PRECISION_HALF ? sizeof(Halves) : sizeof(shared::Splat);
}

shared::Gaussian gaussian_of(const Model& model, std::size_t i) {
  return {glm::vec4(model.position[i], model.opacity[i]), model.rotation[i], glm::vec4(model.scale[i], 0.0f)};
}

// Fills a buffer with `stride` numbers of each Gaussian of a page, which pack(Gaussian, room) makes; in
// pieces: switches of levels must not wait for memory that is touched once. The room is zero where it leaves
// it alone.
template <typename T, typename Pack>
void upload_in_pieces(const ModelBuffers::Page& page, std::size_t stride, gl::Buffer& buffer,
                      const Pack& pack_one) {
  constexpr std::size_t piece = 1 << 15;
  std::vector<T> packed(std::min<std::size_t>(piece, page.count) * stride);
  for (std::size_t at = 0; at < page.count; at += piece) {
    const std::size_t count = std::min<std::size_t>(piece, page.count - at);
    for (std::size_t k = 0; k < count; ++k)
      pack_one(page.first + at + k, std::span(packed).subspan(k * stride, stride));
    buffer.upload_part<T>(std::span(packed).first(count * stride), at * stride);
  }
}

void upload_halves(const Model& model, const ModelBuffers::Page& page) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const std::size_t words = static_cast<std::size_t>(harmonic_bytes(model.degree, PRECISION_HALF)) / 4;
  upload_in_pieces<Halves>(page, 1, *page.gaussians, [&](std::size_t i, std::span<Halves> room) {
    room[0] = pack(gaussian_of(model, i));
  });
  upload_in_pieces<std::uint32_t>(page, words, *page.harmonics,
                                  [&](std::size_t i, std::span<std::uint32_t> room) {
                                    pack(std::span(model.sh).subspan(i * floats, floats), room);
                                  });
}

void upload_floats(const Model& model, const ModelBuffers::Page& page) {
  const std::size_t floats = 3 * static_cast<std::size_t>(sh_count(model.degree));
  const std::size_t stride =
      static_cast<std::size_t>(harmonic_bytes(model.degree, PRECISION_FULL)) / sizeof(float);
  upload_in_pieces<shared::Gaussian>(
      page, 1, *page.gaussians,
      [&](std::size_t i, std::span<shared::Gaussian> room) { room[0] = gaussian_of(model, i); });
  if (stride == floats) {
    page.harmonics->upload_part(std::span(model.sh).subspan(page.first * floats, page.count * floats), 0);
  } else {
    upload_in_pieces<float>(page, stride, *page.harmonics, [&](std::size_t i, std::span<float> room) {
      std::copy_n(&model.sh[i * floats], floats, room.begin());
    });
  }
}

}  // namespace

ModelBuffers::ModelBuffers(gl::Context& context, const Model& model, int precision,
                           std::uint32_t page_gaussians)
    : networks(context), page_gaussians_(page_gaussians) {
  upload(context, model, precision);
}

void ModelBuffers::upload(gl::Context& context, const Model& model, int precision) {
  precision_ = precision;
  const std::int64_t each = std::max(gaussian_bytes(precision), harmonic_bytes(model.degree, precision));
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
    page.gaussians->reserve(page.count * gaussian_bytes(precision_));
    page.harmonics->reserve(page.count * harmonic_bytes(model.degree, precision_));
    if (precision_ == PRECISION_HALF) {
      upload_halves(model, page);
    } else {
      upload_floats(model, page);
    }
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
    page.gaussians->reserve(gaussians * gaussian_bytes(precision_));
    page.harmonics->reserve(gaussians * harmonic_bytes(0, precision_));
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

std::uint32_t tile_blocks(std::int64_t pairs) {
  return static_cast<std::uint32_t>((pairs + TILE_BLOCK - 1) / TILE_BLOCK);
}

MemoryNeeds memory_needs(const FrameShape& shape) {
  MemoryNeeds needs;
  const std::uint32_t decodings = shape.offset_count == 0 ? 1 : shape.decoding_count();
  const int precision = shape.settings.precision;
  needs.model =
      shape.anchor_bytes + std::int64_t{decodings} * shape.gaussian_count *
                               (gaussian_bytes(precision) + harmonic_bytes(shape.degree, precision));
  const bool measured = measures(shape.settings.transmittance);
  const std::int64_t bytes_a_splat = splat_bytes(precision) + (measured ? 12 : 8);
  const std::int64_t bytes_a_gaussian = 4 + (measured ? shape.asked * 8 : 0);
  const bool shared_lists = shape.settings.list_tiles > 1;
  const std::int64_t pair_bytes = 4 * 4 + (shared_lists ? 4 : 0);  // list and splat, twice; the tiles' lists
  const std::int64_t slot_bytes =
      shape.view_count() * bytes_a_splat + 6 * 4;  // indices, order twice, offsets
  needs.frame = shape.gaussian_count * bytes_a_gaussian + shape.slots * slot_bytes + shape.pixel_count * 20 +
                shape.tile_count() * (shared_lists ? 14LL : 12LL) + starting_pairs(shape) * pair_bytes +
                4 * primitives::RadixSort::counters_of(starting_pairs(shape), shape.list_bits());
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
      touched(context, "what splats touch"),
      tall(context, "tall splats"),
      pair_amounts(context, "amounts of pairs"),
      pairs(context, "Gaussian-tile pairs"),
      ranges(context, "ranges of lists"),
      tile_amount(context, "amount of the tiles' counts"),
      tile_counts(context, "tiles' counts"),
      tile_ranges(context, "ranges of tiles"),
      tile_values(context, "lists of tiles"),
      long_lists(context, "tiles with long lists"),
      colours(context, "pixels"),
      z_sums(context, "depth of pixels"),
      shown(context, "what the blend comes by"),
      shown_light(context, "transmittance to show"),
      scan(context),
      sort(context),
      context_(context) {}

void FrameBuffers::upload(const FrameShape& shape) {
  views.upload(shape.views);
  if (shape.settings.transmittance != TRANSMITTANCE_DEPTH) return;
  std::vector<float> table = shape.settings.depth_table.upper;
  for (float& upper_of_bin : table)
    upper_of_bin = upper_of_bin > 0.0f ? std::max(upper_of_bin, static_cast<float>(UPPER_FLOOR)) : 1.0f;
  depth_table.upload(table);
}

void FrameBuffers::reserve(const FrameShape& shape, std::int64_t pair_capacity,
                           std::int64_t tile_pair_capacity) {
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
  splats.reserve(slots * shape.view_count() * splat_bytes(shape.settings.precision));
  touched.reserve(slots * shape.view_count() * 4);
  tall.reserve(slots * shape.view_count() * 4);
  pair_amounts.reserve(sizeof(primitives::SortAmounts));
  pairs.reserve(pair_capacity);
  ranges.reserve(std::max<std::int64_t>(shape.list_count, shape.view_count()) * 8);
  if (shape.settings.list_tiles > 1) {
    const std::int64_t counts = std::int64_t{tile_blocks(pairs.capacity())} * shape.tiles_a_list();
    tile_counts.reserve(counts * 4);
    scan.reserve(counts);
    tile_ranges.reserve(shape.tile_count() * 8LL);
    tile_values.reserve(tile_pair_capacity * 4);
  }
  long_lists.reserve(shape.tile_count() * 4LL);
  colours.reserve(shape.pixel_count * 16);
  z_sums.reserve(shape.pixel_count * 4);
  scan.reserve(std::max(blocks, slots));
  for (const OrderGroup& group : shape.groups) sort.reserve(order, group.key_bits);
  sort.reserve(pairs, shape.list_bits());
}

}  // namespace binosplat::render
