// Filling dispatch arguments: group counts for things that are counted on the GPU. `groups_max` is the driver's limit along x.

uvec2 split_groups(uint groups, uint groups_max) {
  uint rows = (groups + groups_max - 1u) / groups_max;
  return rows == 0u ? uvec2(0u, 1u) : uvec2((groups + rows - 1u) / rows, rows);
}

uint blocks_of(uint count, uint block) { return count / block + uint(count % block != 0u); }

DispatchArguments make_arguments(uint first, uint count, uint groups_max) {
  uvec2 threads = split_groups(blocks_of(count, THREADS), groups_max);
  uvec2 scan = split_groups(max(1u, blocks_of(count, SCAN_BLOCK)), groups_max);  // of nothing, too, there is a total
  uvec2 sort = split_groups(blocks_of(count, SORT_BLOCK), groups_max);
  DispatchArguments a;
  a.count = count;
  a.first = first;
  a.threads_x = threads.x;
  a.threads_y = threads.y;
  a.threads_z = 1u;
  a.scan_x = scan.x;
  a.scan_y = scan.y;
  a.scan_z = 1u;
  a.sort_x = sort.x;
  a.sort_y = sort.y;
  a.sort_z = 1u;
  a.unused = 0u;
  return a;
}
