#include "formats/usd_transform.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace binosplat {

namespace {

constexpr std::string_view operation_prefix = "xformOp:", inverse_prefix = "!invert!";

glm::dmat4 turn_around(char axis, double degrees) {
  return glm::rotate(glm::dmat4(1.0), glm::radians(degrees),
                     glm::dvec3(axis == 'X' ? 1 : 0, axis == 'Y' ? 1 : 0, axis == 'Z' ? 1 : 0));
}

/// Reads the rows of a matrix. OpenUSD's matrices multiply row vectors, so their rows are glm's columns.
glm::dmat4 matrix_in(UsdaText text) {
  glm::dmat4 matrix(1.0);
  text.expect('(');
  for (int row = 0; row < 4; ++row) {
    if (row > 0) text.expect(',');
    int at = 0;
    text.tuple(4, [&](double value) { matrix[row][at++] = value; });
  }
  text.take(',');
  text.expect(')');
  if (glm::transpose(matrix)[3] != glm::dvec4(0, 0, 0, 1))
    text.fail_here("the last column of this matrix is not 0 0 0 1, so it is not a prim's transform");
  return matrix;
}

glm::dmat4 operation(std::string_view kind, const UsdaText& value) {
  const glm::dmat4 still(1.0);
  if (kind == "transform") return matrix_in(value);
  if (kind == "translate") return glm::translate(still, glm::make_vec3(value.numbers(3).data()));
  if (kind == "scale") return glm::scale(still, glm::make_vec3(value.numbers(3).data()));
  if (kind == "orient") {
    const std::vector<double> q = value.numbers(4);  // w x y z
    const glm::dquat turn(q[0], q[1], q[2], q[3]);
    if (!(glm::length(turn) > 0.0)) value.fail_here("a rotation is a quaternion of length 0");
    return glm::mat4_cast(glm::normalize(turn));
  }
  constexpr std::string_view rotate = "rotate";
  const std::string_view axes = kind.starts_with(rotate) ? kind.substr(rotate.size()) : "";
  if (axes == "X" || axes == "Y" || axes == "Z") return turn_around(axes[0], value.numbers(1)[0]);
  std::string sorted(axes);
  std::ranges::sort(sorted);
  if (sorted != "XYZ") value.fail_here("unknown transform xformOp:{}", kind);
  // The first letter's rotation is applied first.
  const std::vector<double> angles = value.numbers(3);
  glm::dmat4 matrix(1.0);
  for (const char axis : axes)
    matrix = turn_around(axis, angles[static_cast<std::size_t>(axis - 'X')]) * matrix;
  return matrix;
}

}  // namespace

glm::dmat4 usd_transform(const UsdaPrim& prim, const glm::dmat4& parent) {
  const UsdaText* order = prim.attribute("xformOpOrder");
  if (order == nullptr) return parent;
  glm::dmat4 matrix = parent;
  for (const std::string& named : order->texts()) {
    if (named == "!resetXformStack!") {
      matrix = glm::dmat4(1.0);
      continue;
    }
    const bool inverse = named.starts_with(inverse_prefix);
    const std::string name = inverse ? named.substr(inverse_prefix.size()) : named;
    const UsdaText* value = prim.attribute(name);
    const UsdaText* moving = prim.attribute(name + ".timeSamples");
    if (value == nullptr && moving != nullptr)
      moving->fail_here("{} moves with time; only a still model can be drawn", name);
    if (value == nullptr || !name.starts_with(operation_prefix))
      order->fail_here("the transform '{}' of '{}' is missing", name, prim.name);
    const std::string_view kind = std::string_view(name).substr(operation_prefix.size());
    const glm::dmat4 one = operation(kind.substr(0, kind.find(':')), *value);
    matrix *= inverse ? glm::inverse(one) : one;
  }
  return matrix;
}

}  // namespace binosplat
