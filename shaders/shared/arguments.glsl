// Computes the arguments of indirect dispatches from counts on the GPU. `groups_max` is the driver's limit of work
// groups along x.

uvec2 split_groups(uint groups, uint groups_max) {
  uint rows = (groups + groups_max - 1u) / groups_max;
  return rows == 0u ? uvec2(0u, 1u) : uvec2((groups + rows - 1u) / rows, rows);
}

uint blocks_of(uint count, uint block) { return count / block + uint(count % block != 0u); }

DispatchArguments make_arguments(uint count, uint groups_max) {
  uvec2 threads = split_groups(blocks_of(count, THREADS), groups_max);
  uvec2 bin = split_groups(blocks_of(count, BIN_BLOCK), groups_max);
  return DispatchArguments(count, threads.x, threads.y, 1u, bin.x, bin.y, 1u, 0u);
}
