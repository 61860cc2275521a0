#include "formats/cameras/transforms.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "formats/cameras/distortion.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/view_files.h"
#include "formats/pictures/image_file.h"

namespace binosplat {

namespace {

namespace fs = std::filesystem;

/// One frame. The file's values are the defaults of all frames.
class Frame {
 public:
  Frame(const fs::path& path, const JsonValue& root, const JsonValue& frame)
      : path_(path), root_(root), frame_(frame) {}

  /// Reads all of a camera except its name.
  void read(Camera& camera) const {
    read_size(camera);
    read_focal(camera);
    camera.cx = number("cx").value_or(camera.width / 2.0);
    camera.cy = number("cy").value_or(camera.height / 2.0);
    check_lens(fmt::format("{}: frame '{}'", path_, camera.name), camera);
    place_as_opengl(camera, read_rows(frame_.at("transform_matrix"), true));
  }

  std::optional<JsonValue> value(const char* key) const {
    return frame_.has(key) ? frame_.at(key) : root_.find(key);
  }

 private:
  std::optional<double> number(const char* key) const {
    const auto found = value(key);
    return found ? std::optional(found->number()) : std::nullopt;
  }

  void read_size(Camera& camera) const {
    const auto width = value("w"), height = value("h");
    if (width && height) {
      camera.width = width->pixels();
      camera.height = height->pixels();
      return;
    }
    const auto photo = find_view_photo(path_.parent_path(), camera);
    if (!photo)
      frame_.fail_here("w and h are missing, and so is the picture {} that has this size",
                       (path_.parent_path() / camera.name).string());
    const glm::ivec2 size = picture_size(*photo);
    camera.width = size.x;
    camera.height = size.y;
  }

  void read_focal(Camera& camera) const {
    // Returns the focal length for a picture of `pixels` px, from its angle in radians or in degrees.
    const auto focal = [&](const char* radians, const char* degrees, int pixels) -> std::optional<double> {
      auto angle = number(radians);
      if (!angle && number(degrees)) angle = glm::radians(*number(degrees));
      return angle ? std::optional(0.5 * pixels / std::tan(0.5 * *angle)) : std::nullopt;
    };
    auto fx = number("fl_x"), fy = number("fl_y");
    if (!fx) fx = focal("camera_angle_x", "x_fov", camera.width);
    if (!fy) fy = number("fl_x") ? fx : focal("camera_angle_y", "y_fov", camera.height);
    if (!fx && !fy) frame_.fail_here("there is neither fl_x nor camera_angle_x, so no focal length");
    camera.fx = fx.value_or(fy.value_or(0.0));
    camera.fy = fy.value_or(camera.fx);
  }

  const fs::path& path_;
  const JsonValue& root_;
  const JsonValue& frame_;
};

}  // namespace

RigidTransform read_rows(const JsonValue& rows, bool pose) {
  if (rows.size() != 3 && rows.size() != 4)
    rows.fail_here("expected 3 or 4 rows of 4 numbers, found {} rows", rows.size());
  RigidTransform to;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec4 row = rows.at(i).vector<4>();
    const int r = static_cast<int>(i);
    for (int j = 0; j < 3; ++j) to.rotation[j][r] = row[j];
    to.shift[r] = row[3];
  }
  const std::string fault = pose ? make_rotation(rows.source(), to.rotation) : rotation_fault(to.rotation);
  if (!fault.empty()) rows.fail_here("{}", fault);
  return to;
}

void place_as_opengl(Camera& camera, const RigidTransform& pose) {
  camera.rotation = glm::dmat3(pose.rotation[0], -pose.rotation[1], -pose.rotation[2]);
  camera.position = pose.shift;
}

bool is_transforms(const nlohmann::json& root) { return root.is_object() && root.contains("frames"); }

std::vector<Camera> load_transforms(const fs::path& path, const nlohmann::json& json) {
  const JsonValue root(path.string(), json);
  const JsonValue frames = root.at("frames");
  if (frames.size() == 0) frames.fail_here("no cameras: the list is empty");
  std::vector<Camera> named(frames.size()), cameras;
  for (std::size_t i = 0; i < frames.size(); ++i) named[i].name = frames.at(i).at("file_path").text();
  set_short_names(named);
  LensReport lens_report(path.string());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JsonValue value = frames.at(i);
    const Frame frame(path, root, value);
    const KeyOf key = [&](const char* name) { return frame.value(name); };
    if (const std::string fault = undrawable_lens(key); !fault.empty()) {
      lens_report.add_skipped(fmt::format("{}, frame {} (counted from 0), {}", path, i, fault));
      continue;
    }
    frame.read(named[i]);
    cameras.push_back(std::move(named[i]));
    lens_report.add(has_distortion(key));
  }
  lens_report.report();
  return cameras;
}

}  // namespace binosplat
