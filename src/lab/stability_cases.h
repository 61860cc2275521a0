#pragma once
// Where thresholds that go by the last frame can fail (docs/method.md 7), each as a small scene and a
// path.

#include <memory>
#include <string>
#include <vector>

#include "scene/camera.h"
#include "scene/model.h"
#include "stereo/rig.h"

namespace binosplat::lab {

struct StabilityCase {
  std::string name;
  std::string fear;  // what may go wrong, and which trap of docs/method.md 7 it is
  std::shared_ptr<const Model> model;
  std::vector<stereo::EyePair> frames;
  std::size_t event = 0;  // the frame from which settling is counted: 0, or the one after a jump
};

/// The built-in cases; each is 128 x 96 px an eye.
std::vector<StabilityCase> built_in_cases();

/// A 30 degree jump and a fast turn of 200 degrees/s at 90 Hz in a scene of the user's, from `head`.
std::vector<StabilityCase> cases_in(std::shared_ptr<const Model> scene, const Camera& head,
                                    const stereo::RigSettings& rig);

}  // namespace binosplat::lab
