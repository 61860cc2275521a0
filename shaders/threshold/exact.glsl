// Exact: every visible splat makes a pair.

float threshold(float size, float bound, float tolerance) { return float(ALPHA_MIN); }
