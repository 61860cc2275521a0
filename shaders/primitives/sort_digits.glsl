// What the passes of a radix sort know of all its keys: at first how many blocks each pass has begun, then how often each digit
// of each pass occurs, twice, for this sort and for the next.
#define DIGITS (1u << DIGIT_BITS)
#define DIGIT_COUNTS SORT_PASSES_MAX
#define DIGIT_HALF (SORT_PASSES_MAX << SORT_BITS_MAX)
