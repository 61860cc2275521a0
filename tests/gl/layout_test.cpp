// The structs that C++ and GLSL share lie where the driver says they lie.

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

// Offsets of the members of a struct in a storage block `struct items[]`, and its stride under the name "";
// or in a uniform block of one.
enum class Block { storage, uniform };

std::map<std::string, int> driver_offsets(const std::string& type, Block block = Block::storage) {
  test::TempFolder folder;
  std::filesystem::create_directory(folder / "shared");
  for (const auto& [name, text] : embedded_shaders()) {
    if (name.rfind("shared/", 0) == 0) test::write_text(folder / name, text);
  }
  // Every member must be used, or a driver may leave it out: copying the whole struct uses all.
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
#define AT(type, member) \
  { #member, static_cast < int>(offsetof(shared::type, member)) }
#define STRIDE(type) \
  { "", static_cast<int>(sizeof(shared::type)) }

TEST(Layout, ViewIsWhereTheDriverPutsIt) {
  const Offsets expected = {AT(View, row_x),
                            AT(View, row_y),
                            AT(View, row_z),
                            AT(View, anchor),
                            AT(View, eye),
                            AT(View, lens),
                            AT(View, slopes),
                            AT(View, centre),
                            AT(View, width),
                            AT(View, height),
                            AT(View, tiles_x),
                            AT(View, tiles_y),
                            AT(View, supertile_offset),
                            AT(View, pixel_offset),
                            AT(View, order_group),
                            AT(View, pitch),
                            AT(View, shift_x),
                            AT(View, shift_y),
                            AT(View, is_probe),
                            AT(View, left),
                            AT(View, top),
                            AT(View, first_row),
                            AT(View, tolerance_share),
                            AT(View, low_pass_share),
                            AT(View, lists_shift),
                            AT(View, unused_1),
                            AT(View, unused_2),
                            AT(View, unused_3),
                            STRIDE(View)};
  EXPECT_EQ(driver_offsets("View"), expected);
}

TEST(Layout, FrameParametersAreWhereTheDriverPutsThem) {
  const Offsets expected = {AT(FrameParameters, background),
                            AT(FrameParameters, tolerance),
                            AT(FrameParameters, far),
                            AT(FrameParameters, depth_bins),
                            AT(FrameParameters, has_bounds),
                            AT(FrameParameters, view_count),
                            AT(FrameParameters, asked),
                            AT(FrameParameters, probed),
                            AT(FrameParameters, gaussian_count),
                            AT(FrameParameters, slots),
                            AT(FrameParameters, tile_count),
                            AT(FrameParameters, list_per_view),
                            AT(FrameParameters, has_regions),
                            AT(FrameParameters, offset_count),
                            AT(FrameParameters, views_per_decoding),
                            AT(FrameParameters, decoding_of_probe),
                            AT(FrameParameters, anchor_cull),
                            AT(FrameParameters, depth_slack),
                            AT(FrameParameters, unused_1),
                            AT(FrameParameters, unused_2),
                            AT(FrameParameters, unused_3),
                            STRIDE(FrameParameters)};
  EXPECT_EQ(driver_offsets("FrameParameters"), expected);
  Offsets in_block = expected;  // of a frame there is one
  in_block[""] = 0;
  EXPECT_EQ(driver_offsets("FrameParameters", Block::uniform), in_block);
}

TEST(Layout, GaussianAndSplatAreWhereTheDriverPutsThem) {
  const Offsets gaussian = {AT(Gaussian, position), AT(Gaussian, rotation), AT(Gaussian, scale),
                            STRIDE(Gaussian)};
  EXPECT_EQ(driver_offsets("Gaussian"), gaussian);
  const Offsets splat = {AT(Splat, mean),  AT(Splat, depth),  AT(Splat, opacity),
                         AT(Splat, conic), AT(Splat, colour), STRIDE(Splat)};
  EXPECT_EQ(driver_offsets("Splat"), splat);
}

TEST(Layout, PlacedRayIsWhereTheDriverPutsIt) {
  const Offsets ray = {AT(PlacedRay, pixel), AT(PlacedRay, place), AT(PlacedRay, unused), STRIDE(PlacedRay)};
  EXPECT_EQ(driver_offsets("PlacedRay"), ray);
}

TEST(Layout, MeshSourceIsWhereTheDriverPutsIt) {
  const Offsets source = {AT(MeshSource, step),     AT(MeshSource, left),       AT(MeshSource, top),
                          AT(MeshSource, level),    AT(MeshSource, is_inverse), AT(MeshSource, scale),
                          AT(MeshSource, offset),   AT(MeshSource, nothing),    AT(MeshSource, unused_1),
                          AT(MeshSource, unused_2), AT(MeshSource, unused_3),   STRIDE(MeshSource)};
  EXPECT_EQ(driver_offsets("MeshSource"), source);
}

TEST(Layout, AnchorIsWhereTheDriverPutsIt) {
  const Offsets anchor = {AT(Anchor, position), AT(Anchor, rotation), AT(Anchor, offset_scale),
                          AT(Anchor, scale), STRIDE(Anchor)};
  EXPECT_EQ(driver_offsets("Anchor"), anchor);
}

TEST(Layout, CountersAndDispatchArgumentsAreWhereTheDriverPutsThem) {
  Offsets counters = {AT(Counters, visible),
                      AT(Counters, order_wanted),
                      AT(Counters, pairs),
                      AT(Counters, tile_pairs),
                      AT(Counters, overflow),
                      AT(Counters, truncated_lists),
                      AT(Counters, depths_low),
                      AT(Counters, depths_high),
                      AT(Counters, probe_low),
                      AT(Counters, probe_high),
                      AT(Counters, probe_squares_low),
                      AT(Counters, probe_squares_high),
                      AT(Counters, long_lists),
                      AT(Counters, long_x),
                      AT(Counters, long_y),
                      AT(Counters, long_z),
                      AT(Counters, large),
                      AT(Counters, large_x),
                      AT(Counters, large_y),
                      AT(Counters, large_z),
                      AT(Counters, large_entries),
                      AT(Counters, fill_x),
                      AT(Counters, fill_y),
                      AT(Counters, fill_z),
                      AT(Counters, slabs),
                      AT(Counters, unused_1),
                      AT(Counters, unused_2),
                      AT(Counters, unused_3),
                      STRIDE(Counters)};
  for (std::size_t kind = 0; kind < SORT_KINDS; ++kind) {
    const int at = static_cast<int>(offsetof(shared::Counters, lists) + kind * sizeof(shared::ListCount));
    const std::string name = fmt::format("lists[{}].", kind);
    for (int n = 0; const char* member : {"count", "groups_x", "groups_y", "groups_z"})
      counters[name + member] = at + 4 * n++;
  }
  EXPECT_EQ(driver_offsets("Counters"), counters);
  const Offsets arguments = {
      AT(DispatchArguments, count),     AT(DispatchArguments, threads_x), AT(DispatchArguments, threads_y),
      AT(DispatchArguments, threads_z), AT(DispatchArguments, bin_x),     AT(DispatchArguments, bin_y),
      AT(DispatchArguments, bin_z),     AT(DispatchArguments, unused),    STRIDE(DispatchArguments)};
  EXPECT_EQ(driver_offsets("DispatchArguments"), arguments);
  Offsets wrong = arguments;  // the comparison sees a member out of place
  wrong["bin_x"] += 4;
  EXPECT_NE(driver_offsets("DispatchArguments"), wrong);
}

}  // namespace
}  // namespace binosplat::gl
