#include "preview/messages.h"

#include <gtest/gtest.h>

namespace binosplat::preview {
namespace {

std::vector<std::string> texts(Messages& messages, double now) {
  std::vector<std::string> out;
  for (const Message& message : messages.current(now)) out.push_back(message.text);
  return out;
}

using Texts = std::vector<std::string>;

TEST(Messages, ReplaceDoneAndKeepTrouble) {
  Messages messages;
  messages.add("saved a.png", false, 0.0);
  messages.add("b.ply: no such file", true, 0.5);
  messages.add("saved c.png", false, 1.0);
  EXPECT_EQ(texts(messages, 1.0), (Texts{"b.ply: no such file", "saved c.png"}));
  messages.add("b.ply: no such file", true, 2.0);
  EXPECT_EQ(texts(messages, 2.0), (Texts{"saved c.png", "b.ply: no such file"})) << "told twice";
}

TEST(Messages, Expire) {
  Messages messages;
  EXPECT_FALSE(messages.next_change(0.0));
  messages.add("saved a.png", false, 10.0);
  messages.add("trouble", true, 10.0);
  const auto first = messages.next_change(10.0);
  ASSERT_TRUE(first);
  EXPECT_EQ(texts(messages, 10.0 + *first - 1e-3).size(), 2U);
  EXPECT_EQ(texts(messages, 10.0 + *first), (Texts{"trouble"}));
  EXPECT_GT(messages.next_change(10.0).value_or(0.0), *first);
  EXPECT_TRUE(texts(messages, 1000.0).empty());
}

TEST(Messages, AreLimitedInNumber) {
  Messages messages;
  for (int k = 0; k < 20; ++k) messages.add(std::to_string(k), true, 0.0);
  EXPECT_LE(messages.current(0.0).size(), 5U);
  EXPECT_EQ(texts(messages, 0.0).back(), "19");
}

}  // namespace
}  // namespace binosplat::preview
