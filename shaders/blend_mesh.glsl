// The depths of the caller's meshes (MESH_DEPTH): splats behind a mesh are not drawn. Part of blending.glsl.
//   MESH_TESTED_BY_BLOCK   defined: a block first tests whether it may have any splat behind a mesh (blend_subgroups.comp)
#define NO_MESH 3e38  // beyond every splat

layout(std430, binding = 10) readonly buffer MeshSources { MeshSource mesh_sources[]; };  // by view
// The caller's textures with mesh depths, by view. Lower units have the canvases' textures.
layout(binding = MAX_CANVASES) uniform sampler2D meshes_0;
layout(binding = MAX_CANVASES + 1) uniform sampler2D meshes_1;
layout(binding = MAX_CANVASES + 2) uniform sampler2D meshes_2;
layout(binding = MAX_CANVASES + 3) uniform sampler2D meshes_3;

float number_at(uint nth, ivec2 texel, int level) {
  if (nth == 1u) return texelFetch(meshes_1, texel, level).r;
  if (nth == 2u) return texelFetch(meshes_2, texel, level).r;
  if (nth == 3u) return texelFetch(meshes_3, texel, level).r;
  return texelFetch(meshes_0, texel, level).r;
}

uint view_at_hand();

// Returns the mesh's view z (tangent projection: distance) in pixel p of this invocation; NO_MESH without a mesh.
float mesh_at(uint p) {
  uint nth = view_at_hand();
  MeshSource from = mesh_sources[nth];
  uvec2 at = uvec2((vec2(first_pixel + uvec2(0u, p)) + 0.5) * from.step);
  float d = number_at(nth, ivec2(from.left + at.x, from.top - at.y), int(from.level));
  precise float z = from.scale * d;
  if (from.is_inverse != 0u) {
    precise float inverse = z + from.offset;
    z = inverse > 0.0 ? 1.0 / inverse : NO_MESH;
  }
  z = from_view_z(p, z);
  return d != from.nothing && z > 0.0 && z < NO_MESH ? z : NO_MESH;  // NaN: none
}

#ifdef MESH_TESTED_BY_BLOCK
float nearest_mesh;  // the smallest mesh depth in the block
#define MESH(p) mesh_at(p)
#define NO_MESHES (nearest_mesh == NO_MESH)

void keep_mesh(uint p, float depth) {
  nearest_mesh = p == 0u ? depth : min(nearest_mesh, depth);
  if (p + 1u == COLUMN) nearest_mesh = subgroupMin(nearest_mesh);
}
#else
float mesh[COLUMN];
#define MESH(p) mesh[p]
#define NO_MESHES false

void keep_mesh(uint p, float depth) { mesh[p] = depth; }
#endif

void begin_meshes(uint p, bool inside) { keep_mesh(p, inside ? mesh_at(p) : NO_MESH); }

// The mesh's depth in a pixel; 0 without a mesh.
float mesh_behind(uint p) {
  if (NO_MESHES) return 0.0;
  float depth = MESH(p);
  return depth < NO_MESH ? depth : 0.0;
}

// Ends a pixel if this splat and all later ones of the list lie behind its mesh.
void end_behind_mesh(uint at, uint p, float farthest) {
  if (depth_of(at) - frame.depth_slack > farthest) end_pixel(p);
}
