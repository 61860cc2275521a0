// One triangle over the whole viewport, out of nothing but the numbers of its corners.
void main() { gl_Position = vec4(4.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0); }
