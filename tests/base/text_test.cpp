#include "base/text.h"

#include <gtest/gtest.h>

namespace binosplat {
namespace {

TEST(ComesBefore, OrdersNumbersByValue) {
  const char* const names[] = {"a",          "f_1.ply", "f_02.ply", "f_2.ply", "f_10.ply",
                               "f_10_1.ply", "f_10b",   "g",        "g0"};
  for (const char* const& a : names) {
    for (const char* const& b : names) EXPECT_EQ(natural_less(a, b), &a < &b) << a << " " << b;
  }
  EXPECT_TRUE(natural_less("x99999999999999999999", "x100000000000000000000"));
}

TEST(Text, Base64MatchesRfc4648) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

}  // namespace
}  // namespace binosplat
