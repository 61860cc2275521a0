#pragma once
// Tables as CSV, for spreadsheets.

#include <string>

#include "lab/page.h"

namespace binosplat::lab {

/// A line of names, if there are any, then a line a row: numbers as they are, texts in quotes; nothing for
/// what is empty or not finite.
std::string csv(const Table& table);

}  // namespace binosplat::lab
