// The lists to sort, by kind, in any order within a kind. The first SORT_CLASSES kinds are classes of length. Work
// groups of 32, 64, ... up to (SORT_MAX / SORT_EACH) invocations sort them, with SORT_EACH entries per invocation.
// SORT_CROWDED_KIND has lists in which too many entries have nearly one depth. From SORT_LONG_KIND on, there is a kind
// for each round that splits lists (sort_split.comp). The slabs into which a list is split are lists, too.

// An item: supertile, first entry, number of entries. The last word is the second eye's supertile or NO_SECOND; for a
// slab it is SLAB plus the slab's index in slab_tiles.
#define SLAB 0x80000000u
layout(std430, binding = ITEMS_BINDING) writeonly buffer Items { uvec4 items[]; };
uniform uint item_capacity;  // room for items of each kind
uniform uint rounds;     // number of rounds that split lists

bool is_slab(uvec4 item) { return (item.w & SLAB) != 0u; }

// The kind of a list. If it is too long to sort at once, `round` will split it.
uint kind_of(uint length, uint round) {
  if (length > SORT_MAX) return SORT_LONG_KIND + round;
  return uint(max(findMSB(length - 1u) + 1 - findMSB(32u * SORT_EACH), 0));
}

// Allocates `count` items of a kind, and returns the place of the first.
uint make_room(uint kind, uint count) {
  uint place = atomicAdd(counters.lists[kind].count, count);
  atomicMax(counters.lists[kind].groups_x, min(place + count, SORT_GROUPS_MAX));
  counters.lists[kind].groups_y = 1u;
  counters.lists[kind].groups_z = 1u;
  if (kind >= SORT_LONG_KIND + rounds) atomicOr(counters.overflow, OVERFLOW_ROUNDS);
  return place;
}

void add_item(uint kind, uint place, uvec4 item) {
  if (kind < SORT_LONG_KIND + rounds && place < item_capacity) items[kind * item_capacity + place] = item;
}
