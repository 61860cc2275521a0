#pragma once
// Tables as CSV, for spreadsheets.

#include <string>

#include "lab/page.h"

namespace binosplat::lab {

/// A line of column names, if any, then a line a row: plain numbers, quoted texts. Empty and non-finite cells
/// are empty.
std::string csv(const Table& table);

}  // namespace binosplat::lab
