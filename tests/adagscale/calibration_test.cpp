#include "adagscale/calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/calibration.h"
#include "support/models.h"

namespace binosplat::adagscale {
namespace {

TEST(ThresholdCalibration, IdentifiesModelAndViews) {
  const Model model = test::random_model(3, 100, 1);
  ThresholdCalibration c = test::sample_calibration();
  c.gaussians = model.count();
  c.hash = model_hash(model);
  EXPECT_TRUE(is_of(c, model));
  // The smallest change of any value makes another model.
  for (const int what : {0, 1, 2, 3, 4}) {
    Model other = model;
    float& value = what == 0   ? other.position[99].z
                   : what == 1 ? other.scale[0].x
                   : what == 2 ? other.rotation[50].w
                   : what == 3 ? other.opacity[7]
                               : other.sh.back();
    value = std::nextafter(value, 10.0f);
    EXPECT_FALSE(is_of(c, other)) << what;
  }
  EXPECT_TRUE(covers(c, {1, 8.9, 0})) << "within 6 of view c";
  EXPECT_FALSE(covers(c, {1, 9.1, 0}));
  c.reach = INFINITY;
  EXPECT_TRUE(covers(c, {100, 0, 0}));
}

}  // namespace
}  // namespace binosplat::adagscale
