#include "stream/chooser.h"

#include <algorithm>

#include "base/log.h"

namespace binosplat {

LevelChoice Chooser::choose(std::span<const shared::View> views, const DetailRequest& request,
                            const VisibleChunks& visible) {
  DetailRequest of_chunks = request;
  of_chunks.max_gaussians -= std::min(request.max_gaussians, files_.environment_count());
  LevelChoice choice = choose_levels(files_.chunks(), views, of_chunks, visible, before_);
  before_ = views.empty() ? std::vector<std::size_t>() : choice.levels;
  const std::size_t total = files_.count(choice.levels);
  if (total > request.max_gaussians && !warned_) warn_over_limit(files_.name(), total, request.max_gaussians);
  warned_ = total > request.max_gaussians;
  return choice;
}

void warn_over_limit(const std::string& name, std::size_t total, std::size_t most) {
  log_warning("{}: even the coarsest levels of detail have {} Gaussians, but only {} fit into memory", name,
              total, most);
}

}  // namespace binosplat
