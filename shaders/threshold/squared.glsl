// A dropped pair costs a squared error of at most kappa = tolerance, in px * squared colour. The error is (T_upper
// alpha)^2 S, with S the pixels of a tile that the Gaussian covers (docs/method.md 5). S is at most 256 px for any tile
// size, so that the picture does not depend on the tile size.

float threshold(float size, float bound, float tolerance) {
  precise float covered = min(256.0, 3.141592653589793 * size);
  precise float th = max(float(ALPHA_MIN), sqrt(tolerance / covered) / bound);
  return th;
}
