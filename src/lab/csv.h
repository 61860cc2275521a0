#pragma once
// Tables as CSV, for spreadsheets and for commands that compare with an earlier run.

#include <string>
#include <string_view>

#include "lab/page.h"

namespace binosplat::lab {

/// Numbers as they are, texts in quotes; nothing for what is empty or not finite.
std::string csv_field(const Cell& cell);

/// A line of names, if there are any, then a line a row.
std::string csv(const Table& table);

/// Reads what csv() wrote: cells are numbers, texts or nothing; lines may end as Windows ends them. Throws
/// Error, naming `place` and the line.
Table read_csv(std::string_view text, const std::string& place);

}  // namespace binosplat::lab
