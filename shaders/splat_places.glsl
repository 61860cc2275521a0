// The places of a frame's splats: (view, slot). The splats of a view are contiguous, because a tile reads the splats of
// one eye only.
#include "frame.glsl"

uint splat_of(uint slot, uint v) { return v * frame.slots + slot; }
uint view_of(uint splat) { return splat / frame.slots; }
uint slot_of(uint splat) { return splat % frame.slots; }
// The sort key of a splat in its view's order group.
#define DEPTH_OF(splat, view) depths[(view).order_group * frame.slots + slot_of(splat)]
