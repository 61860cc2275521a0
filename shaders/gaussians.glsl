// The Gaussians of a page of the model. In Scaffold-GS a view uses the Gaussians that exist in its decoding.
//   OFFSETS   K of Scaffold-GS, 0 for other models
//   HALF      1: in half precision

#if HALF
#include "half_precision.glsl"
layout(std430, binding = 1) readonly buffer Gaussians { uvec4 gaussians[]; };  // (decoding, Gaussian), two each
#define GAUSSIAN(at) unpack_gaussian(gaussians[2u * (at)], gaussians[2u * (at) + 1u])
#else
layout(std430, binding = 1) readonly buffer Gaussians { Gaussian gaussians[]; };  // (decoding, Gaussian)
#define GAUSSIAN(at) gaussians[at]
#endif
#include "frame.glsl"
uniform uint page_first;      // index of the page's first Gaussian in the frame
uniform uint page_count;      // Gaussians of the page in one instance
uniform uint instance_first;  // the model's first instance
uniform uint instance_count;

// A frame has the page's Gaussians once per instance, one instance after another. For Gaussian i of these, returns the
// index in the page, and the index of the first view of its instance.
uvec2 place_in_page(uint i) {
  uint instance = instance_count > 1u ? i / page_count : 0u;
  return uvec2(i - instance * page_count, (instance_first + instance) * frame.view_count);
}

#if OFFSETS > 0

layout(std430, binding = 9) readonly buffer Kept { uint kept[]; };  // (view, anchor), a bit for each Gaussian

// The place of the page's Gaussian i for view v. A probe shares the Gaussians of its view. is_kept() returns whether it exists.
uint place_of(uint i, uint v) {
  return (v < frame.requested_views ? v : frame.probed_view) * page_count + i;
}

bool is_kept(uint i, uint v) {
  uint place = place_of(i, v);
  uint bits = kept[place / uint(OFFSETS)];
  return (bits >> (place % uint(OFFSETS)) & 1u) != 0u;
}

#else

uint place_of(uint i, uint v) { return i; }

bool is_kept(uint i, uint v) { return true; }

#endif
