// A dropped pair costs a squared error of at most kappa = tolerance, in px * squared colour. The error is (T_upper
// alpha)^2 S, with S the pixels of a tile that the Gaussian covers (docs/method.md 5), at most 256 px. Larger than 64
// tiles, S is a 64th of the Gaussian: one Gaussian in front of everything would otherwise change the error of the
// picture by some dB from frame to frame.

float threshold(float size, float bound, float tolerance) {
  precise float area = 3.141592653589793 * size;
  precise float covered = max(min(256.0, area), area / 64.0);
  precise float th = max(float(ALPHA_MIN), sqrt(tolerance / covered) / bound);
  return th;
}
