// The lists that are to be sorted, by kind, each kind in any order: SORT_CLASSES classes of length, which are sorted by groups of
// 32, 64, ... SORT_MOST / SORT_EACH invocations, SORT_EACH entries each; lists with too many of a few depths; and from
// SORT_LONG_KIND on what each round is to part into slabs, which are lists then (sort_split.comp).

// Supertile, first entry, entries; of a list the second eye's supertile, or NO_SECOND; of a part PART and the number by which
// slab_tiles knows it.
#define PART 0x80000000u
layout(std430, binding = ITEMS_BINDING) writeonly buffer Items { uvec4 items[]; };
uniform uint item_room;  // of each kind
uniform uint rounds;     // that part lists

bool is_part(uvec4 item) { return (item.w & PART) != 0u; }

// Of a list, that `round` parts first if it is too long.
uint kind_of(uint length, uint round) {
  if (length > SORT_MOST) return SORT_LONG_KIND + round;
  return uint(max(findMSB(length - 1u) + 1 - findMSB(32u * SORT_EACH), 0));
}

// Of `count` lists of a kind, where the first goes.
uint make_room(uint kind, uint count) {
  uint place = atomicAdd(counters.lists[kind].count, count);
  atomicMax(counters.lists[kind].groups_x, min(place + count, SORT_GROUPS_MOST));
  counters.lists[kind].groups_y = 1u;
  counters.lists[kind].groups_z = 1u;
  if (kind >= SORT_LONG_KIND + rounds) atomicOr(counters.overflow, OVERFLOW_ROUNDS);
  return place;
}

void add_item(uint kind, uint place, uvec4 item) {
  if (kind < SORT_LONG_KIND + rounds && place < item_room) items[kind * item_room + place] = item;
}
