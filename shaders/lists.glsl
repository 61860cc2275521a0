// The tiles that a program draws, by LISTS.
#include "shared/limits.h"

#define LISTS_SHORT 0
#define LISTS_LONG 1

// The approximate blend takes this many splats of a list at a time. It then tests each block of this many rows for
// darkness.
#define APPROXIMATE_STEP (LISTS == LISTS_LONG ? APPROXIMATE_STEP_LONG : APPROXIMATE_STEP_SHORT)
#define APPROXIMATE_ROWS (LISTS == LISTS_LONG ? APPROXIMATE_BLOCK / 2 : APPROXIMATE_BLOCK)
