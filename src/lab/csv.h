#pragma once
// Writes tables as CSV, for spreadsheets.

#include <string>

#include "lab/page.h"

namespace binosplat::lab {

/// Returns a line of column names, if there are any, then a line per row. Texts are quoted. Numbers that are
/// not finite become empty cells.
std::string csv(const Table& table);

}  // namespace binosplat::lab
