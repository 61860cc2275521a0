#include "formats/models/append_model.h"

#include <algorithm>
#include <utility>

#include "base/log.h"
#include "scene/reduce.h"

namespace binosplat {

void append_model(Model& all, Model&& part) {
  if (all.count() == 0) {
    const std::size_t left_out = all.left_out;
    all = std::move(part);
    all.left_out += left_out;
    return;
  }
  const int degree = std::max(all.degree, part.degree);
  for (Model* model : {&all, &part}) set_degree(*model, degree);
  append(all, part, 0, part.count());
  all.left_out += part.left_out;
  all.lacks_degree_4 = all.lacks_degree_4 || part.lacks_degree_4;
  all.antialiased = all.antialiased || part.antialiased;
  if (all.perspective != part.perspective || all.linear != part.linear)
    log_warning("{}: its parts differ in order, projection or colour space; all are drawn as the first",
                all.name);
}

}  // namespace binosplat
