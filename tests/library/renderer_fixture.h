#pragma once
// A caller with two textures, and eyes as OpenXR gives them, for tests of include/binosplat.

#include <binosplat/renderer.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "scene/model.h"
#include "support/caller.h"

namespace binosplat {

constexpr glm::ivec2 size(72, 64);

/// Eyes as a Quest gives them: 49 degrees outwards and 37 inwards, each turned outwards by `cant` degrees.
inline std::array<Eye, 2> quest_eyes(double cant = 0.0) {
  std::array<Eye, 2> eyes;
  for (std::size_t k = 0; k < 2; ++k) {
    const double side = k == 0 ? -1.0 : 1.0;
    eyes[k].position = {side * 0.0315, 1.6, 0.0};
    const glm::dquat turn = glm::angleAxis(glm::radians(-side * cant), glm::dvec3(0, 1, 0));
    eyes[k].orientation = {turn.x, turn.y, turn.z, turn.w};
    eyes[k].fov = {glm::radians(k == 0 ? -49.0 : -37.0), glm::radians(k == 0 ? 37.0 : 49.0),
                   glm::radians(45.0), glm::radians(-48.0)};
  }
  return eyes;
}

/// Puts the head of quest_eyes() at the origin of the model's world. The head looks along z, with y down.
inline const Placement placement = {.origin = {0.0, 1.6, 0.0}};

inline const Settings over_black = {.background = glm::vec3(0.0f)};

inline SplatModel in_memory(Model model) {
  return SplatModel(std::make_shared<const Model>(std::move(model)));
}

struct Library : testing::Test {
  test::Caller caller;
  const std::array<std::uint32_t, 2> textures = {caller.texture(GL_RGBA32F, size.x, size.y),
                                                 caller.texture(GL_RGBA32F, size.x, size.y)};

  /// Both eyes, each into its texture.
  std::vector<View> views(const std::array<Eye, 2>& eyes = quest_eyes()) const {
    return {View{eyes[0], size, {.texture = textures[0]}}, View{eyes[1], size, {.texture = textures[1]}}};
  }
  std::vector<float> read(std::size_t eye) const { return caller.read<float>(textures[eye], size.x, size.y); }

  std::vector<float> read_depths(std::uint32_t id, int layer = 0) const {
    return caller.read_depths(id, size.x, size.y, layer);
  }

  /// A function of the driver's.
  template <typename F>
  F* function(const char* name) const {
    return reinterpret_cast<F*>(caller.get_proc_address()(name));
  }
};

}  // namespace binosplat
