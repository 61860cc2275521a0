// Numbers in text.

#include "base/numbers.h"

#include <gtest/gtest.h>

#include <string>

namespace binosplat {
namespace {

TEST(Numbers, ParsesPairs) {
  EXPECT_EQ(two_numbers("1280x720", 'x'), std::pair(1280u, 720u));
  EXPECT_EQ(two_numbers("2/8", '/'), std::pair(2u, 8u));
  for (const char* wrong : {"", "x", "12", "12x", "x12", "12/3", "-1x2", "+1x2", "1x-2", "1x2x3", " 1x2",
                            "1 x2", "1x2 ", "1.5x2", "99999999999x1"}) {
    EXPECT_EQ(two_numbers(wrong, 'x'), std::nullopt) << wrong;
  }
}

TEST(Numbers, TakesLeadingNumber) {
  std::string_view text = "17:rest";
  EXPECT_EQ(take_number(text), 17u);
  EXPECT_EQ(text, ":rest");
  EXPECT_EQ(take_number(text), std::nullopt);
  EXPECT_EQ(text, ":rest");
}

TEST(Numbers, RealsAreReadWholly) {
  EXPECT_EQ(parse_real("+2.5e-1"), 0.25);
  EXPECT_EQ(parse_real("-3"), -3.0);
  for (const char* wrong : {"", "+", "x", "1x", " 1", "1 ", "1,5"})
    EXPECT_EQ(parse_real(wrong), std::nullopt);
}

}  // namespace
}  // namespace binosplat
