#include "formats/model_file.h"

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/ply.h"

namespace binosplat {

Model load_model(const std::filesystem::path& path) {
  const Content content = content_of(MappedFile(path).bytes());
  if (content != Content::ply) {
    fail("{} is not a model that can be read: expected INRIA's ply, but it looks like {}", path.string(),
         describe(content));
  }
  Model model = load_ply(path);
  if (model.left_out > 0) {
    log_warning("{}: {} of {} Gaussians left out (values not finite, or a zero quaternion)", path.string(),
                model.left_out, model.left_out + model.count());
  }
  return model;
}

}  // namespace binosplat
