// AdaGScale (Jo et al., equation 10): what lies beyond a Gaussian's tiles may sum up to K = tolerance, in alpha * px^2.

float threshold(float size, float bound, float tolerance) {
  precise float th = tolerance / (bound * 6.283185307179586 * size) + float(ALPHA_MIN);
  return th;
}
