// Where the splats of a frame lie, (view, slot): those of a view side by side, since an eye's tiles read them and not the other's.
uniform uint slots;  // that each view has room for

uint splat_of(uint slot, uint v) { return v * slots + slot; }
uint view_of(uint splat) { return splat / slots; }
uint slot_of(uint splat) { return splat % slots; }
