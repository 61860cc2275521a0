// Exact: what leaves a mark makes a pair.

float threshold(float size, float upper, float loss) { return float(ALPHA_MIN); }
