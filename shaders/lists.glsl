// Of LISTS, which tiles are drawn.
#include "shared/limits.h"

#define LISTS_SHORT 0
#define LISTS_LONG 1

// With a loss, of a list: so many splats at a time, and then each block of so many rows is asked whether it is dark.
#define LOSSY_STEP (LISTS == LISTS_LONG ? LOSSY_STEP_LONG : LOSSY_STEP_SHORT)
#define LOSSY_ROWS (LISTS == LISTS_LONG ? LOSSY_BLOCK / 2 : LOSSY_BLOCK)
