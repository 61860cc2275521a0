// Of LISTS, which tiles are drawn.
#include "shared/limits.h"

#define LISTS_SHORT 0
#define LISTS_LONG 1

// The approximate blend takes of a list so many splats at a time, and then each block of so many rows is asked whether it is dark.
#define APPROXIMATE_STEP (LISTS == LISTS_LONG ? APPROXIMATE_STEP_LONG : APPROXIMATE_STEP_SHORT)
#define APPROXIMATE_ROWS (LISTS == LISTS_LONG ? APPROXIMATE_BLOCK / 2 : APPROXIMATE_BLOCK)
