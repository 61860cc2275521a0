// T_upper of a Gaussian in a view: the upper bound of its transmittance. It is 1 if it is unknown: in the first frame,
// after a camera cut, for Gaussians out of view, and beyond the table by depth (docs/method.md 5).
#if TRANSMITTANCE == TRANSMITTANCE_ONE
float bound_of(View view, uint v, uint gaussian, float depth) { return 1.0; }

#elif TRANSMITTANCE == TRANSMITTANCE_DEPTH
layout(std430, binding = 7) readonly buffer DepthTables { float depth_tables[]; };  // T_upper of equal bins over [0, far)

float bound_of(View view, uint v, uint gaussian, float depth) {
  precise float bin = depth / view.table_far * float(view.table_bins);
  return bin < float(view.table_bins) ? depth_tables[view.table_first + uint(bin)] : 1.0;
}

#else
layout(std430, binding = 7) readonly buffer Bounds { float bounds[]; };  // (view, Gaussian)

float bound_of(View view, uint v, uint gaussian, float depth) {
  return frame.has_bounds == 0u ? 1.0 : bounds[v * frame.gaussian_count + gaussian];
}

#endif
