#pragma once
// Checks the errors that users see.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "base/error.h"

namespace binosplat::test {

/// Returns whether `action` throws an Error with that exit code whose text contains all of `parts`.
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

/// Expects that a statement throws an Error with exit code bad_input whose text contains all following
/// arguments.
#define EXPECT_ERROR(statement, ...) \
  EXPECT_TRUE(::binosplat::test::fails_saying([&] { statement; }, {__VA_ARGS__}))
