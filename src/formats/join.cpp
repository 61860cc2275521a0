#include "formats/join.h"

#include <algorithm>
#include <utility>

#include "base/log.h"

namespace binosplat {

void join(Model& all, Model&& part) {
  if (all.count() == 0) {
    const std::size_t left_out = all.left_out;
    all = std::move(part);
    all.left_out += left_out;
    return;
  }
  const int degree = std::max(all.degree, part.degree);
  for (Model* model : {&all, &part}) {
    if (model->degree == degree) continue;
    const std::size_t from = 3 * static_cast<std::size_t>(sh_count(model->degree));
    const std::size_t to = 3 * static_cast<std::size_t>(sh_count(degree));
    std::vector<float> wide(model->count() * to);
    for (std::size_t i = 0; i < model->count(); ++i) std::copy_n(&model->sh[i * from], from, &wide[i * to]);
    model->sh = std::move(wide);
    model->degree = degree;
  }
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(all.position, part.position);
  add(all.scale, part.scale);
  add(all.rotation, part.rotation);
  add(all.opacity, part.opacity);
  add(all.sh, part.sh);
  all.left_out += part.left_out;
  all.lacks_degree_4 = all.lacks_degree_4 || part.lacks_degree_4;
  all.antialiased = all.antialiased || part.antialiased;
  if (all.perspective != part.perspective || all.linear != part.linear)
    log_warning("{}: its parts differ in order, projection or colour space; all are drawn as the first",
                all.name);
}

}  // namespace binosplat
