#pragma once
// The page of rules along moving heads, and its tables, which the program prints, too.

#include "lab/motion.h"
#include "lab/page.h"

namespace binosplat::lab {

/// A row a rule along one of the study's paths: what it came to where every rule was asked for the same.
Table asked_table(const MotionResult& path);

/// The same at one true quality; without rows where that was not looked for.
Table target_table(const MotionResult& path);

/// "3 stretches of 60 frames, after 12 to find a tolerance; then a stop of 15": how long the segments of a
/// path are.
std::string lengths_of(const MotionPath& path);

Page motion_page(const MotionStudy& study);

}  // namespace binosplat::lab
