// Where the splats of a frame lie, (view, slot): those of a view side by side, since an eye's tiles read them and not the other's.
#include "frame.glsl"

uint splat_of(uint slot, uint v) { return v * frame.slots + slot; }
uint view_of(uint splat) { return splat / frame.slots; }
uint slot_of(uint splat) { return splat % frame.slots; }
// What its view's order group sorts it by.
#define DEPTH_OF(splat, view) depths[(view).order_group * frame.slots + slot_of(splat)]
