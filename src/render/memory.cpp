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

std::int64_t starting_pairs(const FramePlan& plan) {
  constexpr std::int64_t pairs_per_splat = 16;
  // A model that grows is one that somebody moves through: making more room takes 100 ms.
  const int most_bits = plan.gaussian_room > plan.gaussian_count ? 25 : 24;
  return std::clamp(starting_slots(plan.gaussian_room) * std::int64_t{plan.view_count()} * pairs_per_splat,
                    std::int64_t{1} << 16, std::int64_t{1} << most_bits);
}

MemoryNeeds memory_needs(const FramePlan& plan) {
  MemoryNeeds needs;
  const std::uint32_t decodings = plan.offset_count == 0 ? 1 : plan.decoding_count();
  const int precision = plan.settings.precision;
  needs.model = plan.anchor_bytes + std::int64_t{decodings} * plan.gaussian_room *
                                        (gaussian_bytes(precision) + harmonic_bytes(plan.degree, precision));
  const bool measured = measures(plan.settings.transmittance);
  const std::int64_t bytes_a_splat = splat_bytes(precision) + (measured ? 12 : 8);
  const std::int64_t bytes_a_gaussian = 4 + (measured ? plan.asked * 8 : 0);
  const bool has_supertiles = plan.supertile_side > 1;
  const std::int64_t pair_bytes =
      4 * 4 + (has_supertiles ? 4 : 0);  // supertile and splat, twice; the tiles' lists
  const std::int64_t slot_bytes = plan.view_count() * bytes_a_splat + 6 * 4;  // indices, order twice, offsets
  needs.frame = plan.gaussian_room * bytes_a_gaussian + starting_slots(plan.gaussian_room) * slot_bytes +
                plan.pixel_count * 20 + plan.tile_count() * (has_supertiles ? 14LL : 12LL) +
                starting_pairs(plan) * pair_bytes +
                4 * primitives::RadixSort::counters_of(starting_pairs(plan), plan.supertile_bits());
  return needs;
}

void Capacity::start(const FramePlan& plan, const Workings& asked) {
  // What stands in for stages needs all the room that it takes at once.
  slots =
      std::max<std::int64_t>(slots, asked.stand_in ? plan.gaussian_room : starting_slots(plan.gaussian_room));
  if (asked.slots > 0) slots = asked.slots;
  for (std::int64_t* of_pairs : {&pairs, &tile_pairs})
    *of_pairs = asked.pairs > 0 ? asked.pairs : std::max(*of_pairs, starting_pairs(plan));
}

void Capacity::grow(const FramePlan& plan, const shared::Counters& counters) {
  const auto larger = [](std::uint32_t wanted) { return std::int64_t{wanted} + wanted / 8; };
  if (counters.pairs == COUNT_MAX) {
    throw Error(ExitCode::out_of_memory,
                "more than a billion Gaussian-tile pairs in one frame: use a smaller picture");
  }
  if ((counters.overflow & OVERFLOW_ORDER) != 0) {
    log_info("drawn again: {} Gaussians in view, room for {}", counters.order_wanted, slots);
    slots = std::min<std::int64_t>(larger(counters.order_wanted), plan.gaussian_room);
  }
  if ((counters.overflow & OVERFLOW_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-{} pairs, room for {}", counters.pairs,
             plan.supertile_side == 1 ? "tile" : "supertile", pairs);
    pairs = larger(counters.pairs);
  }
  if ((counters.overflow & OVERFLOW_TILE_PAIRS) != 0) {
    log_info("drawn again: {} Gaussian-tile pairs, room for {}", counters.tile_pairs, tile_pairs);
    tile_pairs = larger(counters.tile_pairs);
  }
}

}  // namespace binosplat::render
