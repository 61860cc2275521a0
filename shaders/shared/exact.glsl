// fp32 arithmetic with the rounding error known. GL does not promise that fma() is fused (llvmpipe's is not), so products
// are split after Dekker (1971). Valid while |a|, |b| < 1e34.

float product_error(float a, float b, float product) {
  precise float split_a = 4097.0 * a;
  precise float split_b = 4097.0 * b;
  precise float a_high = split_a - (split_a - a);
  precise float b_high = split_b - (split_b - b);
  precise float a_low = a - a_high;
  precise float b_low = b - b_high;
  precise float error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
  return error;
}

// a b - c d without the cancellation that makes the determinant of a long thin ellipse worthless.
float difference_of_products(float a, float b, float c, float d) {
  precise float ab = a * b;
  precise float cd = c * d;
  precise float difference = (ab - cd) + (product_error(a, b, ab) - product_error(c, d, cd));
  return difference;
}
