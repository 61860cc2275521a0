// The lines that the preview draws among the splats, as triangles that the CPU has projected (preview/marks.h).
struct MarkVertex {
  vec4 place;   // in clip space
  vec4 colour;  // display values
};
layout(std430, binding = 0) readonly buffer Vertices { MarkVertex vertices[]; };
out vec4 colour;

void main() {
  colour = vertices[gl_VertexID].colour;
  gl_Position = vertices[gl_VertexID].place;
}
