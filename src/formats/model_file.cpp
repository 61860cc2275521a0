#include "formats/model_file.h"

#include "base/error.h"
#include "base/log.h"
#include "base/mapped_file.h"
#include "formats/content.h"
#include "formats/ply.h"
#include "formats/scaffold_file.h"

namespace binosplat {

namespace {

void warn_of_left_out(const std::filesystem::path& path, std::size_t left_out, std::size_t all,
                      const char* what) {
  if (left_out == 0) return;
  log_warning("{}: {} of {} {} left out (values not finite, or a zero quaternion)", path.string(), left_out,
              all, what);
}

Model load_scaffold_model(const std::filesystem::path& ply) {
  const std::shared_ptr<Scaffold> scaffold = load_scaffold(ply);
  warn_of_left_out(ply, scaffold->left_out, scaffold->left_out + scaffold->anchor_count(), "anchors");
  return stand_in(scaffold);
}

}  // namespace

Model load_model(const std::filesystem::path& given) {
  std::error_code ignored;
  const std::filesystem::path path =
      std::filesystem::is_directory(given, ignored) ? find_point_cloud(given) : given;
  const MappedFile file(path);
  const Content content = content_of(file.bytes());
  if (content != Content::ply) {
    fail("{} is not a model that can be read: expected INRIA's ply, but it looks like {}", path.string(),
         describe(content));
  }
  if (is_scaffold(read_ply_header(path, file.bytes()))) return load_scaffold_model(path);
  Model model = load_ply(path);
  warn_of_left_out(path, model.left_out, model.left_out + model.count(), "Gaussians");
  return model;
}

}  // namespace binosplat
