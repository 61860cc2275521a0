// Structs shared by C++ and GLSL have the layout that the driver reports.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>

#include "gl/program.h"
#include "shared/types.h"
#include "support/gl.h"
#include "support/program.h"

namespace binosplat::gl {
namespace {

// Whether a struct is in a storage block `struct items[]` or in a uniform block.
enum class Block { storage, uniform };

// Returns the offsets of a struct's members, and its stride under the name "".
std::map<std::string, int> driver_offsets(const std::string& type, Block block = Block::storage) {
  test::TempFolder folder;
  std::filesystem::create_directory(folder / "shared");
  for (const auto& [name, text] : embedded_shaders()) {
    if (name.rfind("shared/", 0) == 0) test::write_text(folder / name, text);
  }
  // Drivers may omit unused members: copying the whole struct uses all.
  const bool is_uniform = block == Block::uniform;
  test::write_text(
      folder / "layout.comp",
      "#include \"shared/types.h\"\nlayout(local_size_x = 1) in;\n"
      "layout(std430, binding = 0) buffer Items { " +
          type + " items[]; };\n" +
          (is_uniform ? "layout(std140, binding = 0) uniform One { " + type + " one; };\n" : "") +
          "void main() { items[gl_WorkGroupID.x + 1u] = " + (is_uniform ? "one" : "items[gl_WorkGroupID.x]") +
          "; }\n");
  const Functions& gl = test::gl_context().gl();
  const Program program(gl, "layout.comp", {}, folder.path(), ProgramCache({}, ""));
  std::map<std::string, int> offsets;
  int count = 0;
  const GLenum kind = is_uniform ? GL_UNIFORM : GL_BUFFER_VARIABLE;
  gl.GetProgramInterfaceiv(program.id(), kind, GL_ACTIVE_RESOURCES, &count);
  for (GLuint i = 0; i < static_cast<GLuint>(count); ++i) {
    char name[128] = {};
    gl.GetProgramResourceName(program.id(), kind, i, sizeof(name), nullptr, name);
    const GLenum wanted[] = {GL_OFFSET, GL_TOP_LEVEL_ARRAY_STRIDE};
    int values[2] = {};
    gl.GetProgramResourceiv(program.id(), kind, i, is_uniform ? 1 : 2, wanted, 2, nullptr, values);
    const std::string path = name;
    const std::string item = is_uniform ? "one." : "items[0].";
    const std::size_t at = path.find(item);
    offsets[at == std::string::npos ? path.substr(path.rfind('.') + 1) : path.substr(at + item.size())] =
        values[0];
    offsets[""] = values[1];
  }
  return offsets;
}

using Offsets = std::map<std::string, int>;

// Returns the offsets in C++: AT for each member of a list of any length.
#define AT(type, member) \
  { #member, static_cast < int>(offsetof(shared::type, member)) }
#define AGAIN_4(...) AGAIN_3(AGAIN_3(AGAIN_3(AGAIN_3(__VA_ARGS__))))
#define AGAIN_3(...) AGAIN_2(AGAIN_2(AGAIN_2(AGAIN_2(__VA_ARGS__))))
#define AGAIN_2(...) AGAIN_1(AGAIN_1(AGAIN_1(AGAIN_1(__VA_ARGS__))))
#define AGAIN_1(...) __VA_ARGS__
#define NO_ARGUMENTS ()
#define EACH_AT(type, member, ...) AT(type, member) __VA_OPT__(, NEXT_AT NO_ARGUMENTS(type, __VA_ARGS__))
#define NEXT_AT() EACH_AT
#define OFFSETS_OF(type, ...)                                                           \
  Offsets {                                                                             \
    AGAIN_4(EACH_AT(type, __VA_ARGS__)), { "", static_cast<int>(sizeof(shared::type)) } \
  }

Offsets offsets_of_counters() {
  Offsets counters =
      OFFSETS_OF(Counters, visible, slots_wanted, pairs, tile_pairs, overflow, truncated_lists, depths_low,
                 depths_high, probe_low, probe_high, probe_squares_low, probe_squares_high, long_lists,
                 long_x, long_y, long_z, large_splats, large_x, large_y, large_z, large_entries, fill_x,
                 fill_y, fill_z, slabs, probe_pairs, probed_pairs, unused);
  for (std::size_t kind = 0; kind < SORT_KINDS; ++kind) {
    const int at = static_cast<int>(offsetof(shared::Counters, lists) + kind * sizeof(shared::ListCount));
    const std::string name = fmt::format("lists[{}].", kind);
    for (int n = 0; const char* member : {"count", "groups_x", "groups_y", "groups_z"})
      counters[name + member] = at + 4 * n++;
  }
  return counters;
}

const std::map<std::string, Offsets> shared_structs = {
    {"View", OFFSETS_OF(View, row_x, row_y, row_z, anchor, eye, lens, slopes, centre, width, height, tiles_x,
                        tiles_y, supertile_offset, pixel_offset, order_group, pitch, shift_x, shift_y,
                        is_probe, left, top, first_row, tolerance_share, low_pass_share, lists_shift, opacity,
                        table_far, table_first, table_bins, unused_1, unused_2, unused_3)},
    {"FrameParameters",
     OFFSETS_OF(FrameParameters, background, tolerance, has_bounds, view_count, requested_views, probed_view,
                gaussian_count, slots, list_per_view, has_regions, has_broad_tiles, offset_count, anchor_cull,
                depth_slack, unused_1, unused_2, unused_3)},
    {"Gaussian", OFFSETS_OF(Gaussian, position, rotation, scale)},
    {"Splat", OFFSETS_OF(Splat, mean, depth, opacity, conic, colour)},
    {"PlacedRay", OFFSETS_OF(PlacedRay, pixel, place, unused)},
    {"MeshSource", OFFSETS_OF(MeshSource, step, left, top, level, is_inverse, scale, offset, nothing,
                              unused_1, unused_2, unused_3)},
    {"Anchor", OFFSETS_OF(Anchor, position, rotation, offset_scale, scale)},
    {"DispatchArguments",
     OFFSETS_OF(DispatchArguments, count, threads_x, threads_y, threads_z, bin_x, bin_y, bin_z, unused)},
    {"Counters", offsets_of_counters()}};

TEST(Layout, OffsetsMatchDriver) {
  for (const auto& [type, offsets] : shared_structs) EXPECT_EQ(driver_offsets(type), offsets) << type;
  Offsets in_block = shared_structs.at("FrameParameters");  // a uniform block has no stride
  in_block[""] = 0;
  EXPECT_EQ(driver_offsets("FrameParameters", Block::uniform), in_block);
  Offsets wrong = shared_structs.at("DispatchArguments");  // injected: a member out of place
  wrong["bin_x"] += 4;
  EXPECT_NE(driver_offsets("DispatchArguments"), wrong);
}

}  // namespace
}  // namespace binosplat::gl
