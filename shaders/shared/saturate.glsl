// Sums that stop at COUNT_MAX: a count of pairs can pass 2^32, and must not come back as a small number.

uint saturating_add(uint a, uint b) {
  uint sum = a + b;
  return sum < a ? COUNT_MAX : sum;
}
