// AdaGScale (Jo et al., equation 10): a Gaussian's loss outside its tiles may reach K = tolerance, in alpha * px^2.

float threshold(float size, float bound, float tolerance) {
  precise float th = tolerance / (bound * 6.283185307179586 * size) + float(ALPHA_MIN);
  return th;
}
