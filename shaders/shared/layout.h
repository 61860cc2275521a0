// Combines two pictures of equal size into one, equally for files and the screen. GLSL and C++ both compile
// this file, so it uses only vectors, uints and float literals with an f.
#ifndef BINOSPLAT_SHARED_LAYOUT_H
#define BINOSPLAT_SHARED_LAYOUT_H

#include "shared/choices.h"

#ifdef __cplusplus
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#define SHARED_FUNCTION inline
namespace binosplat::shared {
using uint = std::uint32_t;
using vec3 = glm::vec3;
using glm::clamp;
using std::pow;
#else
#define SHARED_FUNCTION
#endif

#define EYE_LEFT 0u
#define EYE_RIGHT 1u
#define EYE_BOTH 2u

// The source of a pixel: the mean of a block of `columns` x `rows` pixels of an eye. The block's upper left
// pixel is (x, y). EYE_BOTH mixes pixel (x, y) of both eyes.
struct LayoutSource {
  uint eye;  // EYE_
  uint x;
  uint y;
  uint columns;
  uint rows;
};

// The source of pixel (x, y) of the combined picture, from the upper left. An eye has width x height px.
SHARED_FUNCTION LayoutSource layout_source(uint kind, uint x, uint y, uint width, uint height) {
  LayoutSource from;
  from.eye = EYE_LEFT;
  from.x = x;
  from.y = y;
  from.columns = 1u;
  from.rows = 1u;
  if (kind == uint(LAYOUT_PARALLEL) || kind == uint(LAYOUT_CROSS_EYED)) {
    from.eye = (x >= width) == (kind == uint(LAYOUT_PARALLEL)) ? EYE_RIGHT : EYE_LEFT;
    from.x = x >= width ? x - width : x;
  } else if (kind == uint(LAYOUT_HALF_WIDTH)) {
    uint middle = width / 2u;
    from.eye = x >= middle ? EYE_RIGHT : EYE_LEFT;
    from.x = 2u * (x >= middle ? x - middle : x);
    from.columns = 2u;
  } else if (kind == uint(LAYOUT_OVER_UNDER)) {
    from.eye = y >= height ? EYE_RIGHT : EYE_LEFT;
    from.y = y >= height ? y - height : y;
  } else if (kind == uint(LAYOUT_HALF_HEIGHT)) {
    uint middle = height / 2u;
    from.eye = y >= middle ? EYE_RIGHT : EYE_LEFT;
    from.y = 2u * (y >= middle ? y - middle : y);
    from.rows = 2u;
  } else if (kind == uint(LAYOUT_ROWS)) {
    from.eye = y % 2u;
  } else if (kind == uint(LAYOUT_COLUMNS)) {
    from.eye = x % 2u;
  } else if (kind >= uint(LAYOUT_ANAGLYPH)) {
    from.eye = EYE_BOTH;
  }
  return from;
}

SHARED_FUNCTION float layout_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : pow((v + 0.055f) / 1.055f, 2.4f);
}

SHARED_FUNCTION float layout_to_display(float v) {
  return v <= 0.0031308f ? v * 12.92f : 1.055f * pow(v, 1.0f / 2.4f) - 0.055f;
}

SHARED_FUNCTION vec3 layout_to_linear(vec3 v) {
  return vec3(layout_to_linear(v.x), layout_to_linear(v.y), layout_to_linear(v.z));
}

// Mixes both eyes' display values for red-cyan glasses, with red for the left eye. LAYOUT_ANAGLYPH: Dubois,
// Conversion of a Stereo Pair to Anaglyph with the Least-Squares Projection Method, 2009, on linear light.
// LAYOUT_HALF_COLOUR and LAYOUT_GREY mix display values, as is usual: the left eye's luma (Rec. 601) as red,
// the right eye's colour or luma as green and blue.
SHARED_FUNCTION vec3 layout_mix(uint kind, vec3 left, vec3 right) {
  vec3 luma = vec3(0.299f, 0.587f, 0.114f);
  if (kind == uint(LAYOUT_HALF_COLOUR)) return vec3(dot(luma, left), right.y, right.z);
  if (kind == uint(LAYOUT_GREY)) return vec3(dot(luma, left), dot(luma, right), dot(luma, right));
  vec3 l = layout_to_linear(clamp(left, 0.0f, 1.0f));
  vec3 r = layout_to_linear(clamp(right, 0.0f, 1.0f));
  float red = dot(vec3(0.437f, 0.449f, 0.164f), l) + dot(vec3(-0.011f, -0.032f, -0.007f), r);
  float green = dot(vec3(-0.062f, -0.062f, -0.024f), l) + dot(vec3(0.377f, 0.761f, 0.009f), r);
  float blue = dot(vec3(-0.048f, -0.050f, -0.017f), l) + dot(vec3(-0.026f, -0.093f, 1.234f), r);
  return vec3(layout_to_display(clamp(red, 0.0f, 1.0f)), layout_to_display(clamp(green, 0.0f, 1.0f)),
              layout_to_display(clamp(blue, 0.0f, 1.0f)));
}

#ifdef __cplusplus
}  // namespace binosplat::shared
#endif

#endif
