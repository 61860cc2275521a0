#include "render/memory.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "render/halves.h"

namespace binosplat::render {

std::uint32_t starting_slots(std::uint32_t gaussians) {
  constexpr std::uint32_t slots_start = 1u << 20;
  // Some GPUs cannot address more splats of two eyes in one buffer.
  constexpr std::uint32_t max_slots_start = 1u << 24;
  return std::max(std::min(gaussians / 2, max_slots_start), std::min(gaussians, slots_start));
}

namespace {

// The capacity of a first frame: some entries and tiles per Gaussian, enough for most models.
Capacity starting_capacity(const FramePlan& plan) {
  constexpr std::int64_t pairs_per_splat = 8;
  // A model that may grow gets larger buffers: its viewer moves, and growing buffers takes 100 ms.
  const int max_bits = plan.gaussian_capacity > plan.gaussian_count ? 24 : 23;
  const std::int64_t pairs =
      std::clamp(starting_slots(plan.gaussian_capacity) * std::int64_t{plan.view_count()} * pairs_per_splat,
                 std::int64_t{1} << 15, std::int64_t{1} << max_bits);
  return {.slots = starting_slots(plan.gaussian_capacity),
          .pairs = pairs,
          .large_pairs = pairs / 2,
          .tile_pairs = 2 * pairs};
}

}  // namespace

MemoryNeeds memory_needs(const FramePlan& plan) {
  MemoryNeeds needs;
  const std::uint32_t decodings = plan.offset_count == 0 ? 1 : plan.requested_views;
  const int precision = plan.settings.precision;
  needs.model = plan.anchor_bytes;
  for (const PlannedModel& model : plan.models) {
    needs.model += decodings * static_cast<std::int64_t>(model.size.capacity) *
                   (gaussian_bytes(precision) + harmonic_bytes(model.degree, precision));
  }
  const bool measured = measures(plan.settings);
  const std::int64_t bytes_a_splat =
      splat_bytes(precision) + (measured ? 12 : 8) + (plan.has_discs() ? 16 : 0);
  const std::int64_t bytes_a_gaussian = 4 + (measured ? plan.requested_views * 8 : 0);
  const Capacity first = starting_capacity(plan);
  const std::int64_t slot_bytes = plan.view_count() * bytes_a_splat + 2 * 4;  // index and depth
  needs.frame = plan.gaussian_capacity * bytes_a_gaussian + first.slots * slot_bytes + plan.pixel_count * 20 +
                plan.tile_count() * 12LL + plan.supertile_count * (8LL + 16 * SORT_LONG_KIND) +
                (first.pairs + first.large_pairs) * 8 + first.tile_pairs * 4;
  return needs;
}

void Capacity::start(const FramePlan& plan, const DebugOptions& debug) {
  Capacity first = starting_capacity(plan);
  // A stand-in reports no overflow, so its buffers have room for all Gaussians.
  if (debug.stand_in) first.slots = plan.gaussian_capacity;
  slots = debug.slots > 0 ? debug.slots : std::max(slots, first.slots);
  if (debug.pairs > 0) {
    pairs = large_pairs = tile_pairs = debug.pairs;
    return;
  }
  pairs = std::max(pairs, first.pairs);
  large_pairs = std::max(large_pairs, first.large_pairs);
  tile_pairs = std::max(tile_pairs, first.tile_pairs);
}

void Capacity::grow(const FramePlan& plan, const shared::Counters& counters) {
  const auto lacks = [&](std::uint32_t what) { return (counters.overflow & what) != 0; };
  const auto enlarge = [&](std::uint32_t what, std::int64_t wanted, std::int64_t& capacity) {
    if (lacks(what)) capacity = wanted + wanted / 8;
  };
  if (lacks(OVERFLOW_COUNT)) {
    throw Error(ExitCode::out_of_memory,
                "more than two billion Gaussian-tile pairs in one frame: use a smaller picture");
  }
  enlarge(OVERFLOW_ORDER, counters.slots_wanted, slots);
  if (lacks(OVERFLOW_ORDER)) slots = std::min<std::int64_t>(slots, plan.gaussian_capacity);
  enlarge(OVERFLOW_LARGE, counters.large_entries, large_pairs);
  enlarge(OVERFLOW_PAIRS, counters.pairs, pairs);
  enlarge(OVERFLOW_TILE_PAIRS, counters.tile_pairs, tile_pairs);
  if (lacks(OVERFLOW_ROUNDS) && ++rounds > SORT_ROUNDS)
    throw std::logic_error("a list that cannot be split: sort_split.comp");
  if (!std::exchange(told, true))
    log_info("drawn again, because a buffer was too small; it grows, now and for later views");
}

}  // namespace binosplat::render
