// The networks of Scaffold-GS (Lu et al. 2024), of two layers each. The contribution of an anchor's feature to the
// first layer is computed once per model (ViewFree). The shader adds the contribution of direction and distance. Hidden
// units are stored in quads.
//   HIDDEN   hidden units, a multiple of 4     OFFSETS   K, Gaussians of an anchor     BANK   1 with a feature bank
//   WEIGHTS  number of vec4s of all weights, if they fit in shared memory; else 0

#define QUADS (HIDDEN / 4)

#define OPACITY 0u
#define COVARIANCE 1u
#define COLOUR 2u
#define FEATURE_BANK 3u

// Rows of the second layers.
#define OPACITY_ROW 0u
#define COVARIANCE_ROW uint(OFFSETS)
#define COLOUR_ROW uint(8 * OFFSETS)
#define BANK_ROW uint(11 * OFFSETS)

// For each network: QUADS of biases, then the weights of direction and distance by hidden unit. Then for each row of
// the second layers: QUADS of weights, and its bias.
layout(std430, binding = 3) readonly buffer Networks { vec4 networks[]; };
// By resolution of the feature, network, quad and anchor. Without a feature bank there is one resolution.
layout(std430, binding = 4) readonly buffer ViewFree { vec4 view_free[]; };

uniform uint anchor_count;  // of the page

// All invocations must call take_weights() before other functions: it copies the weights to shared memory.
#if WEIGHTS > 0
shared vec4 weights[WEIGHTS];

void take_weights() {
  for (uint i = gl_LocalInvocationIndex; i < WEIGHTS; i += THREADS) weights[i] = networks[i];
  barrier();
}
#else
#define weights networks

void take_weights() {}
#endif

struct Hidden {
  vec4 quads[QUADS];
};

vec4 from_ray(uint network, uint quad, vec4 ray) {
  uint at = network * uint(QUADS + HIDDEN);
  uint row = at + uint(QUADS) + 4u * quad;
  return weights[at + quad] + vec4(dot(weights[row], ray), dot(weights[row + 1u], ray),
                                    dot(weights[row + 2u], ray), dot(weights[row + 3u], ray));
}

float output_of(uint row, Hidden hidden) {
  uint at = uint((3 + BANK) * (QUADS + HIDDEN)) + row * uint(QUADS + 1);
  vec4 sum = vec4(weights[at + uint(QUADS)].x, 0.0, 0.0, 0.0);
  for (int q = 0; q < QUADS; ++q) sum += weights[at + uint(q)] * hidden.quads[q];
  return (sum.x + sum.y) + (sum.z + sum.w);
}

vec4 from_feature(uint resolution, uint network, uint quad, uint anchor) {
  return view_free[((resolution * 3u + network) * uint(QUADS) + quad) * anchor_count + anchor];
}

// The weights with which a feature bank mixes the feature at a quarter, half and full resolution.
vec3 bank_mix(vec4 ray) {
#if BANK == 1
  Hidden hidden;
  for (int q = 0; q < QUADS; ++q) hidden.quads[q] = max(from_ray(FEATURE_BANK, uint(q), ray), 0.0);
  vec3 w = vec3(output_of(BANK_ROW, hidden), output_of(BANK_ROW + 1u, hidden), output_of(BANK_ROW + 2u, hidden));
  w = exp(w - max(w.x, max(w.y, w.z)));
  return w / (w.x + w.y + w.z);
#else
  return vec3(0.0);
#endif
}

// Computes the first layer of a network for an anchor. `ray` has the direction from the eye and the distance; `mixed`
// is the result of bank_mix().
Hidden hidden_of(uint network, uint anchor, vec4 ray, vec3 mixed) {
  Hidden hidden;
  for (int q = 0; q < QUADS; ++q) {
    uint quad = uint(q);
#if BANK == 1
    vec4 feature = mixed.x * from_feature(0u, network, quad, anchor) + mixed.y * from_feature(1u, network, quad, anchor) +
                   mixed.z * from_feature(2u, network, quad, anchor);
#else
    vec4 feature = from_feature(0u, network, quad, anchor);
#endif
    hidden.quads[q] = max(feature + from_ray(network, quad, ray), 0.0);
  }
  return hidden;
}
