#include "formats/cameras/head_trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <span>

#include "base/error.h"
#include "base/log.h"
#include "base/numbers.h"
#include "base/text.h"
#include "formats/cameras/lens.h"
#include "formats/cameras/nerfstudio.h"
#include "formats/cameras/transforms.h"
#include "formats/containers/content.h"

namespace binosplat {

namespace {

/// The columns that are read. The last three are one column, which has one of these names.
constexpr std::string_view trace_columns[] = {"ViewIndex",   "FOV1",        "FOV2",        "FOV3",
                                              "FOV4",        "PositionX",   "PositionY",   "PositionZ",
                                              "QuaternionX", "QuaternionY", "QuaternionZ", "QuaternionW",
                                              "Timestamp",   "timestep",    "elapsed_ms"};

/// One line, with its values in the order of trace_columns.
struct EyeLine {
  static constexpr std::size_t view = 0, fov = 1, position = 5, rotation = 8, ms = 12, count = 13;

  std::string where;  // for errors
  std::array<double, count> values{};

  glm::dvec3 place() const { return {values[position], values[position + 1], values[position + 2]}; }
  glm::dquat turn() const {
    const double* const xyzw = &values[rotation];
    const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    if (const double length = glm::length(q); !(std::abs(length - 1.0) < 0.01))
      fail("{}: its quaternion has length {:.4g}; expected 1", where, length);
    return glm::normalize(q);
  }
  /// Returns how far two sides of the picture, `side` and the next, are apart at a distance of 1.
  double extent(std::size_t side) const {
    const double low = values[side], high = values[side + 1];
    if (!(low > -1.55 && high < 1.55 && high - low > 0.01))
      fail("{}: {} and {} are {} and {}; expected radians that rise, from -1.55 to 1.55", where,
           trace_columns[side], trace_columns[side + 1], low, high);
    return std::tan(high) - std::tan(low);
  }
};

std::vector<std::string_view> split_at(std::string_view text, char between) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0, end = 0; at <= text.size(); at = end + 1) {
    end = std::min(text.find(between, at), text.size());
    parts.push_back(text.substr(at, end - at));
    if (parts.back().ends_with('\r')) parts.back().remove_suffix(1);
  }
  return parts;
}

std::vector<std::string_view> trace_header(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark, as editors write it
  return split_at(text.substr(0, text.find('\n')), ',');
}

EyeLine read_eye(std::string where, std::span<const std::string_view> header, std::string_view line) {
  const std::vector<std::string_view> fields = split_at(line, ',');
  if (fields.size() != header.size())
    fail("{}: {} values for {} columns", where, fields.size(), header.size());
  EyeLine eye{std::move(where)};
  for (std::size_t k = 0; k < EyeLine::count; ++k) {
    const auto any = std::span(trace_columns).subspan(k, k == EyeLine::ms ? 3 : 1);
    const auto column = std::ranges::find_first_of(header, any);
    if (column == header.end())
      fail("{}: the first line has no column {}", eye.where, alternatives({any.begin(), any.end()}));
    const std::string_view field = fields[static_cast<std::size_t>(column - header.begin())];
    const std::optional<double> value = parse_real(field);
    if (!value || !std::isfinite(*value))
      fail("{}: {} is {}; expected a finite number", eye.where, *column, quoted(field));
    eye.values[k] = *value;
  }
  return eye;
}

Camera head_between(const EyeLine& left, const EyeLine& right) {
  const glm::dmat3 axes = glm::mat3_cast(glm::slerp(left.turn(), right.turn(), 0.5));
  const glm::dvec3 across = right.place() - left.place();
  // Nothing else shows a quaternion of another order or handedness.
  if (!(glm::dot(across, axes[0]) >= 0.9 * glm::length(across)))
    fail("{}: by their quaternions (x, y, z, w) the right eye is not to the right of the left one",
         right.where);
  const glm::dmat3 to_world(1, 0, 0, 0, -1, 0, 0, 0, -1);
  Camera head;
  place_as_opengl(head, {to_world * axes, to_world * (0.5 * left.place() + 0.5 * right.place())});
  const auto mean = [&](std::size_t side) { return 0.5 * (left.extent(side) + right.extent(side)); };
  const double wide = mean(EyeLine::fov), high = mean(EyeLine::fov + 2);
  head.height = pose_height;
  head.width = 2 * static_cast<int>(std::lround(0.5 * pose_height * wide / high));
  set_vertical_fov(head, glm::degrees(2.0 * std::atan(0.5 * high)));
  check_lens(right.where, head);
  return head;
}

}  // namespace

bool is_head_trace(std::string_view text) {
  const std::vector<std::string_view> header = trace_header(text);
  return std::ranges::find_first_of(header, trace_columns) != header.end();
}

std::vector<Camera> load_head_trace(const std::filesystem::path& path, std::string_view text) {
  const std::vector<std::string_view> header = trace_header(text), lines = split_at(text, '\n');
  std::vector<EyeLine> eyes;
  for (std::size_t n = 1; n < lines.size(); ++n) {
    if (lines[n].empty()) continue;
    const double expected = static_cast<double>(eyes.size() % 2);
    eyes.push_back(read_eye(fmt::format("{}, line {}", path, n + 1), header, lines[n]));
    if (eyes.back().values[EyeLine::view] != expected)
      fail("{}: ViewIndex is {}; expected {}: a frame is a left eye (0), then a right eye (1)",
           eyes.back().where, eyes.back().values[EyeLine::view], expected);
  }
  if (eyes.size() < 2) fail("{} has no frame of two eyes", path);
  std::vector<Camera> heads;
  double apart = 0.0;
  for (std::size_t k = 1; k < eyes.size(); k += 2) {
    const EyeLine &left = eyes[k - 1], &right = eyes[k];
    heads.push_back(head_between(left, right));
    heads.back().name = fmt::format("{:05}", k / 2);
    heads.back().time = (left.values[EyeLine::ms] - eyes[0].values[EyeLine::ms]) / 1000.0;
    if (k > 1 && !(left.values[EyeLine::ms] > eyes[k - 3].values[EyeLine::ms]))
      fail("{}: its time is {} ms; expected more than the last frame's {} ms", left.where,
           left.values[EyeLine::ms], eyes[k - 3].values[EyeLine::ms]);
    apart += glm::distance(left.place(), right.place());
  }
  apart /= static_cast<double>(heads.size());
  log_info(
      "{}: {} heads with eyes {:.3g} units apart (63 mm at `units_per_metre` {:.3g}), {} x {} px (`size`)",
      path, heads.size(), apart, apart / 0.063, heads[0].width, heads[0].height);
  return heads;
}

}  // namespace binosplat
