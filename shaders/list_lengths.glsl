// LISTS: the tiles that a program draws, by the length of their lists (LONG_LIST).
#include "shared/limits.h"

#define LISTS_SHORT 0
#define LISTS_LONG 1

// After every APPROXIMATE_STEP splats, the approximate blend tests whether blocks of APPROXIMATE_ROWS rows are dark.
#define APPROXIMATE_STEP (LISTS == LISTS_LONG ? APPROXIMATE_STEP_LONG : APPROXIMATE_STEP_SHORT)
#define APPROXIMATE_ROWS (LISTS == LISTS_LONG ? APPROXIMATE_BLOCK / 2 : APPROXIMATE_BLOCK)
