#include "reference/decode.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "reference/tiles.h"

namespace binosplat::reference {

namespace {

double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

std::vector<double> layer(const std::vector<float>& weights, const std::vector<float>& bias,
                          const std::vector<double>& in) {
  std::vector<double> out(bias.begin(), bias.end());
  for (std::size_t row = 0; row < out.size(); ++row) {
    for (std::size_t i = 0; i < in.size(); ++i) out[row] += weights[row * in.size() + i] * in[i];
  }
  return out;
}

std::vector<double> run(const Network& network, const std::vector<double>& inputs) {
  std::vector<double> hidden = layer(network.first, network.first_bias, inputs);
  for (double& h : hidden) h = std::max(h, 0.0);
  return layer(network.second, network.second_bias, hidden);
}

// The networks' inputs that depend on the eye.
struct AnchorRay {
  glm::dvec3 direction;  // from the eye to the anchor, unit length
  double distance;
};

// The inputs of a network: feature, direction, and the distance if the network uses it.
std::vector<double> inputs_of(const Network& network, const std::vector<double>& feature,
                              const AnchorRay& ray) {
  std::vector<double> inputs = feature;
  for (int c = 0; c < 3; ++c) inputs.push_back(ray.direction[c]);
  if (network.distance) inputs.push_back(ray.distance);
  return inputs;
}

// The feature of anchor `n`. A feature bank mixes it with the same feature at half and at a quarter of the
// resolution. The weights depend on the ray.
std::vector<double> feature_of(const Scaffold& scaffold, std::size_t n, const AnchorRay& ray) {
  const std::size_t count = scaffold.feature_count;
  const float* stored = &scaffold.feature[n * count];
  std::vector<double> feature(stored, stored + count);
  if (!scaffold.bank) return feature;
  std::vector<double> weight = run(*scaffold.bank, inputs_of(*scaffold.bank, {}, ray));
  double sum = 0.0;
  const double most = *std::max_element(weight.begin(), weight.end());
  for (double& w : weight) sum += w = std::exp(w - most);
  for (std::size_t i = 0; i < count; ++i) {
    feature[i] = (weight[0] * stored[4 * (i % (count / 4))] + weight[1] * stored[2 * (i % (count / 2))] +
                  weight[2] * stored[i]) /
                 sum;
  }
  return feature;
}

glm::dvec3 eye_of(const shared::View& view) { return glm::dvec3(view.anchor) + glm::dvec3(view.eye); }

Decoded decode_one(const Scaffold& scaffold, std::size_t id, double alpha, const double* covariance,
                   const double* colour) {
  const std::size_t n = id / scaffold.offset_count;
  Decoded decoded;
  decoded.id = id;
  Gaussian& g = decoded.gaussian;
  g.position = glm::dvec3(scaffold.position[n]) +
               glm::dvec3(scaffold.offset[id]) * glm::dvec3(scaffold.offset_scale[n]);
  for (int c = 0; c < 3; ++c) {
    g.scale[c] = scaffold.scale[n][c] * sigmoid(covariance[c]);
    decoded.colour[c] = sigmoid(colour[c]);
  }
  g.rotation = glm::dvec4(covariance[3], covariance[4], covariance[5], covariance[6]);
  g.rotation /= std::max(glm::length(g.rotation), 1e-12);
  g.opacity = alpha;
  return decoded;
}

// The Gaussians of anchor `n` that have positive opacity.
std::vector<Decoded> decode_anchor(const Scaffold& scaffold, std::size_t n, const glm::dvec3& eye) {
  const glm::dvec3 towards = glm::dvec3(scaffold.position[n]) - eye;
  const double distance = glm::length(towards);
  const AnchorRay ray{towards / distance, distance};
  const std::vector<double> feature = feature_of(scaffold, n, ray);
  const std::vector<double> opacity = run(scaffold.opacity, inputs_of(scaffold.opacity, feature, ray));
  const std::vector<double> covariance =
      run(scaffold.covariance, inputs_of(scaffold.covariance, feature, ray));
  std::vector<double> inputs = inputs_of(scaffold.colour, feature, ray);
  const std::size_t row = scaffold.appearance * scaffold.appearance_size;
  for (std::size_t i = 0; i < scaffold.appearance_size; ++i) inputs.push_back(scaffold.appearances[row + i]);
  const std::vector<double> colour = run(scaffold.colour, inputs);
  std::vector<Decoded> kept;
  for (std::size_t k = 0; k < scaffold.offset_count; ++k) {
    const double alpha = std::tanh(opacity[k]);
    if (alpha > 0.0) {
      kept.push_back(
          decode_one(scaffold, n * scaffold.offset_count + k, alpha, &covariance[7 * k], &colour[3 * k]));
    }
  }
  return kept;
}

}  // namespace

bool sees_anchor(const Scaffold& scaffold, std::size_t n, const shared::View& view) {
  const Splat splat = project({scaffold.position[n], scaffold.offset_scale[n], scaffold.rotation[n], 1.0},
                              view);  // low-pass without anti-aliasing, as trained
  return splat.drawn && touches_any(splat, TILES_AABB, view);
}

std::vector<Decoded> decode(const Scaffold& scaffold, const shared::View& view, bool anchor_cull) {
  const glm::dvec3 eye = eye_of(view);
  std::vector<std::vector<Decoded>> by_anchor(scaffold.anchor_count());
  parallel_for(by_anchor.size(), [&](std::size_t n) {
    if (!anchor_cull || sees_anchor(scaffold, n, view)) by_anchor[n] = decode_anchor(scaffold, n, eye);
  });
  std::vector<Decoded> all;
  for (const std::vector<Decoded>& kept : by_anchor) all.insert(all.end(), kept.begin(), kept.end());
  return all;
}

std::vector<Splat> project_all(const Model& model, const shared::View& view, bool anchor_cull,
                               const Perspective& perspective) {
  std::vector<Splat> splats(model.count());
  if (!model.scaffold) {
    parallel_for(splats.size(), [&](std::size_t i) { splats[i] = project(model, i, view, perspective); });
    return splats;
  }
  const std::vector<Decoded> decoded = decode(*model.scaffold, view, anchor_cull);
  parallel_for(decoded.size(), [&](std::size_t i) {
    Splat splat = project(decoded[i].gaussian, view, {model.kernel_px2, model.antialiased}, perspective);
    splat.colour = decoded[i].colour;
    splats[decoded[i].id] = splat;
  });
  return splats;
}

}  // namespace binosplat::reference
