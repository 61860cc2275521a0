#include "formats/cameras/dataparser.h"

#include "base/path_questions.h"
#include "formats/cameras/cameras_file.h"
#include "formats/cameras/transforms.h"
#include "formats/containers/opened_file.h"
#include "formats/training/training_run.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

// p' = scale (rotation p + shift).
struct Similarity : RigidTransform {
  double scale = 1.0;
};

// Returns the transform that ns-process-data applied to the poses before it wrote them; for a COLMAP
// reconstruction, the identity; nothing if the cameras are in the model's world already.
std::optional<Similarity> applied(const fs::path& cameras) {
  const fs::path cameras_file = resolve_cameras(cameras);
  if (is_folder(cameras_file)) return Similarity{};
  const OpenedFile file(cameras_file);
  if (file.content != Content::json || !is_transforms(file.json())) return std::nullopt;
  const JsonValue value = file.root();
  Similarity done;
  if (value.has("applied_transform")) {
    done = {read_rows(value.at("applied_transform"))};
  } else if (is_there(cameras_file.parent_path() / "colmap/sparse/0")) {
    // Older files lack the key, but were written with this transform.
    done.rotation = glm::dmat3(0, 1, 0, 1, 0, 0, 0, 0, -1);
  }
  if (value.has("applied_scale")) done.scale = value.at("applied_scale").above_zero();
  return done;
}

}  // namespace

std::optional<fs::path> find_dataparser(const fs::path& model) {
  return find_above(is_folder(model) ? model / "." : model, "dataparser_transforms.json", 3);
}

bool move_into_training(const fs::path& dataparser, const fs::path& cameras_file,
                        std::vector<Camera>& cameras) {
  const auto before = applied(cameras_file);
  if (!before) return false;
  const OpenedFile file(dataparser);
  const Similarity to{read_rows(file.root().at("transform")), file.root().at("scale").above_zero()};
  for (Camera& camera : cameras) {
    const glm::dvec3 p = glm::transpose(before->rotation) * (camera.position / before->scale - before->shift);
    camera.position = to.scale * (to.rotation * p + to.shift);
    camera.rotation = to.rotation * glm::transpose(before->rotation) * camera.rotation;
  }
  return true;
}

}  // namespace binosplat
