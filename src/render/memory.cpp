#include "render/memory.h"

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "primitives/radix_sort.h"
#include "render/halves.h"

namespace binosplat::render {

std::uint32_t starting_slots(std::uint32_t gaussians) {
  constexpr std::uint32_t slots_start = 1u << 20;
  // Their splats are what a shader reaches of one buffer on some GPUs, of two eyes; windows show fewer.
  constexpr std::uint32_t slots_start_most = 1u << 24;
  return std::max(std::min(gaussians / 2, slots_start_most), std::min(gaussians, slots_start));
}

std::int64_t starting_pairs(const FrameShape& shape) {
  constexpr std::int64_t pairs_per_splat = 16;
  // A model that grows is one that somebody moves through: making more room takes 100 ms.
  const int most_bits = shape.gaussian_room > shape.gaussian_count ? 25 : 24;
  return std::clamp(shape.slots * std::int64_t{shape.view_count()} * pairs_per_splat, std::int64_t{1} << 16,
                    std::int64_t{1} << most_bits);
}

MemoryNeeds memory_needs(const FrameShape& shape) {
  MemoryNeeds needs;
  const std::uint32_t decodings = shape.offset_count == 0 ? 1 : shape.decoding_count();
  const int precision = shape.settings.precision;
  needs.model =
      shape.anchor_bytes + std::int64_t{decodings} * shape.gaussian_room *
                               (gaussian_bytes(precision) + harmonic_bytes(shape.degree, precision));
  const bool measured = measures(shape.settings.transmittance);
  const std::int64_t bytes_a_splat = splat_bytes(precision) + (measured ? 12 : 8);
  const std::int64_t bytes_a_gaussian = 4 + (measured ? shape.asked * 8 : 0);
  const bool has_supertiles = shape.supertile_side > 1;
  const std::int64_t pair_bytes =
      4 * 4 + (has_supertiles ? 4 : 0);  // supertile and splat, twice; the tiles' lists
  const std::int64_t slot_bytes =
      shape.view_count() * bytes_a_splat + 6 * 4;  // indices, order twice, offsets
  needs.frame = shape.gaussian_room * bytes_a_gaussian + shape.slots * slot_bytes + shape.pixel_count * 20 +
                shape.tile_count() * (has_supertiles ? 14LL : 12LL) + starting_pairs(shape) * pair_bytes +
                4 * primitives::RadixSort::counters_of(starting_pairs(shape), shape.supertile_bits());
  return needs;
}

void Capacity::start(const FrameShape& shape, const Workings& asked) {
  // What stands in for stages needs all the room that it takes at once.
  slots = std::max<std::int64_t>(slots, asked.stand_in ? shape.gaussian_room : shape.slots);
  if (asked.slots > 0) slots = asked.slots;
  for (std::int64_t* of_pairs : {&pairs, &tile_pairs})
    *of_pairs = asked.pairs > 0 ? asked.pairs : std::max(*of_pairs, starting_pairs(shape));
}

void Capacity::grow(const FrameShape& shape, const shared::Counters& counters) {
  const auto larger = [](std::uint32_t wanted) { return std::int64_t{wanted} + wanted / 8; };
  if (counters.pairs == COUNT_MAX) {
    throw Error(ExitCode::out_of_memory,
                "more than a billion Gaussian-tile pairs in one frame: use a smaller picture");
  }
  if ((counters.overflow & OVERFLOW_ORDER) != 0) {
    log_info("drawn again: {} Gaussians in view, room for {}", counters.order_wanted, slots);
    slots = std::min<std::int64_t>(larger(counters.order_wanted), shape.gaussian_room);
  }
  if ((counters.overflow & OVERFLOW_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-{} pairs, room for {}", counters.pairs,
             shape.supertile_side == 1 ? "tile" : "supertile", pairs);
    pairs = larger(counters.pairs);
  }
  if ((counters.overflow & OVERFLOW_TILE_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-tile pairs, room for {}", counters.tile_pairs, tile_pairs);
    tile_pairs = larger(counters.tile_pairs);
  }
}

}  // namespace binosplat::render
