// The places of a frame's splats: (view, slot). Those of a view are contiguous, because an eye's tiles read them and
// not the other's.
#include "frame.glsl"

uint splat_of(uint slot, uint v) { return v * frame.slots + slot; }
uint view_of(uint splat) { return splat / frame.slots; }
uint slot_of(uint splat) { return splat % frame.slots; }
// The sort key of a splat in its view's order group.
#define DEPTH_OF(splat, view) depths[(view).order_group * frame.slots + slot_of(splat)]
