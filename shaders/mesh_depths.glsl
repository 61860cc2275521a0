// How far pixels are seen where the caller's meshes stand in a view (mesh_depth.comp): for each tile the nearest and the farthest
// of its pixels, then by pixel, of tiles in which there is a mesh.
#define NO_MESH 3e38  // as far as anything is seen
