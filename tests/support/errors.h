#pragma once
// What a user is told when something is wrong.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.h"

namespace binosplat::test {

/// Whether `action` throws an Error of that code whose text holds all of `parts`.
template <typename Action>
testing::AssertionResult fails_saying(Action action, const std::vector<std::string>& parts,
                                      ExitCode code = ExitCode::bad_input) {
  try {
    action();
  } catch (const Error& error) {
    const std::string text = error.what();
    if (error.code() != code) return testing::AssertionFailure() << "another exit code: " << text;
    for (const std::string& part : parts) {
      if (text.find(part) == std::string::npos) {
        return testing::AssertionFailure() << "no '" << part << "' in: " << text;
      }
    }
    return testing::AssertionSuccess() << text;
  } catch (const std::exception& error) {
    return testing::AssertionFailure() << "not an Error: " << error.what();
  }
  return testing::AssertionFailure() << "nothing was thrown that says " << testing::PrintToString(parts);
}

}  // namespace binosplat::test

/// Expects that a statement throws an Error, of bad input, whose text holds all of the parts behind it.
#define EXPECT_ERROR(statement, ...) \
  EXPECT_TRUE(::binosplat::test::fails_saying([&] { statement; }, {__VA_ARGS__}))
