#pragma once
// The page and the tables of a study of levels of detail.

#include "lab/levels.h"
#include "lab/page.h"

namespace binosplat::lab {

/// A row a scene and detail, the mean over its shots.
Table levels_table(const LevelsStudy& study);

/// How frame times grow with scenes: a row a scene, from the smallest on; the times of each detail, and these
/// as multiples of the smallest scene's. Of one scene: no rows.
Table growth_table(const LevelsStudy& study);

/// What the finest levels were not drawn of, and why: a sentence a scene; mostly none.
std::vector<std::string> problems_of(const LevelsStudy& study);

Page levels_page(const LevelsStudy& study);

}  // namespace binosplat::lab
