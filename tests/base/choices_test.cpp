#include "base/choices.h"

#include <gtest/gtest.h>

#include "support/errors.h"

namespace binosplat {
namespace {

TEST(Choices, AreFoundByName) {
  for (int k = 0; k < std::ssize(tiles_choices); ++k)
    EXPECT_EQ(find_choice("--tiles", tiles_choices[k].name, tiles_choices), k);
  EXPECT_ERROR(find_choice("--precision", "hal", precision_choices),
               "--precision: 'hal' is not one of full, half");
}

}  // namespace
}  // namespace binosplat
