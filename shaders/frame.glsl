// What holds for a whole frame. What a page or an order group differ in, each dispatch is told by uniforms.
layout(std140, binding = 0) uniform Frame { FrameParameters frame; };
