#include "render/anchors.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "shared/types.h"

namespace binosplat::render {

namespace {

std::vector<const Network*> networks_of(const Scaffold& scaffold) {
  std::vector<const Network*> networks{&scaffold.opacity, &scaffold.covariance, &scaffold.colour};
  if (scaffold.bank) networks.push_back(&*scaffold.bank);
  return networks;
}

// The number of features among a network's inputs. View direction and distance follow the features.
std::size_t features_in(const Scaffold& scaffold, std::size_t network) {
  return network < 3 ? scaffold.feature_count : 0;
}

// The largest number of hidden units of a network, rounded up to a multiple of four.
std::size_t padded_hidden(const Scaffold& scaffold) {
  std::size_t most = 0;
  for (const Network* network : networks_of(scaffold)) most = std::max(most, network->hidden);
  return (most + 3) / 4 * 4;
}

std::vector<shared::Anchor> pack_anchors(const Scaffold& s, std::size_t first, std::size_t count) {
  std::vector<shared::Anchor> packed(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t n = first + k;
    packed[k] = {glm::vec4(s.position[n], 0.0f), s.rotation[n], glm::vec4(s.offset_scale[n], 0.0f),
                 glm::vec4(s.scale[n], 0.0f)};
  }
  return packed;
}

// The strides through a feature, one per resolution: full; with a feature bank a quarter, half and full.
std::vector<std::size_t> strides_of(const Scaffold& scaffold) {
  return scaffold.bank ? std::vector<std::size_t>{4, 2, 1} : std::vector<std::size_t>{1};
}

// The contribution of anchor n's feature to one hidden unit. The sum is in float64, so that it is rounded
// only once.
double from_feature(const Scaffold& scaffold, std::size_t n, std::size_t stride, const Network& network,
                    std::size_t unit) {
  const std::size_t features = scaffold.feature_count;
  const float* feature = &scaffold.feature[n * features];
  const float* weights = &network.first[unit * network.inputs];
  double sum = 0.0;
  for (std::size_t i = 0; i < features; ++i)
    sum += double{weights[i]} * feature[stride * (i % (features / stride))];
  return sum;
}

std::vector<glm::vec4> pack_view_free(const Scaffold& scaffold, std::size_t first, std::size_t count) {
  const std::vector<std::size_t> strides = strides_of(scaffold);
  const std::array<const Network*, 3> networks{&scaffold.opacity, &scaffold.covariance, &scaffold.colour};
  const std::size_t quads = padded_hidden(scaffold) / 4;
  std::vector<glm::vec4> packed(strides.size() * networks.size() * quads * count, glm::vec4(0.0f));
  parallel_for(count, [&](std::size_t k) {
    for (std::size_t level = 0; level < strides.size(); ++level) {
      for (std::size_t i = 0; i < networks.size(); ++i) {
        for (std::size_t unit = 0; unit < networks[i]->hidden; ++unit) {
          const std::size_t quad = (level * networks.size() + i) * quads + unit / 4;
          packed[quad * count + k][static_cast<int>(unit % 4)] =
              static_cast<float>(from_feature(scaffold, first + k, strides[level], *networks[i], unit));
        }
      }
    }
  });
  return packed;
}

// The bias of a first layer, including the appearance's contribution to colours.
std::vector<double> constant_part(const Scaffold& scaffold, const Network& network) {
  std::vector<double> bias(network.first_bias.begin(), network.first_bias.end());
  if (&network != &scaffold.colour) return bias;
  const std::size_t size = scaffold.appearance_size;
  const float* row = scaffold.appearances.data() + scaffold.appearance * size;
  for (std::size_t unit = 0; unit < network.hidden; ++unit) {
    // The appearance's weights are the last of each unit.
    const float* weights = network.first.data() + (unit + 1) * network.inputs - size;
    for (std::size_t i = 0; i < size; ++i) bias[unit] += double{weights[i]} * row[i];
  }
  return bias;
}

// The weights in the layout of scaffold_networks.glsl.
std::vector<glm::vec4> pack_networks(const Scaffold& scaffold) {
  const std::size_t hidden = padded_hidden(scaffold);
  const std::vector<const Network*> networks = networks_of(scaffold);
  std::vector<glm::vec4> packed;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const Network& network = *networks[i];
    std::vector<double> bias = constant_part(scaffold, network);
    bias.resize(hidden);
    for (std::size_t unit = 0; unit < hidden; unit += 4)
      packed.emplace_back(bias[unit], bias[unit + 1], bias[unit + 2], bias[unit + 3]);
    for (std::size_t unit = 0; unit < hidden; ++unit) {
      glm::vec4& ray = packed.emplace_back(0.0f);
      if (unit >= network.hidden) continue;
      const float* weights = &network.first[unit * network.inputs + features_in(scaffold, i)];
      ray = {weights[0], weights[1], weights[2], network.distance ? weights[3] : 0.0f};
    }
  }
  for (const Network* network : networks) {
    for (std::size_t row = 0; row < network->outputs; ++row) {
      const std::size_t at = packed.size();
      packed.resize(at + hidden / 4 + 1, glm::vec4(0.0f));
      for (std::size_t unit = 0; unit < network->hidden; ++unit)
        packed[at + unit / 4][static_cast<int>(unit % 4)] = network->second[row * network->hidden + unit];
      packed.back().x = network->second_bias[row];
    }
  }
  return packed;
}

}  // namespace

std::int64_t anchor_bytes(const Scaffold& scaffold) {
  const std::size_t floats =
      3 * scaffold.offset_count + strides_of(scaffold).size() * 3 * padded_hidden(scaffold);
  return static_cast<std::int64_t>(scaffold.anchor_count() * (sizeof(shared::Anchor) + 4 * floats));
}

void NetworkBuffers::upload(const Scaffold& scaffold) {
  const std::vector<glm::vec4> packed = pack_networks(scaffold);
  weights.upload(packed);
  bytes = static_cast<std::int64_t>(packed.size() * sizeof(glm::vec4));
  hidden = static_cast<std::uint32_t>(padded_hidden(scaffold));
  bank = scaffold.bank.has_value();
}

AnchorBuffers::AnchorBuffers(gl::Context& context, const Scaffold& scaffold, std::size_t first,
                             std::size_t anchor_count)
    : count(static_cast<std::uint32_t>(anchor_count)),
      anchors(context, "anchors"),
      offsets(context, "offsets of an anchor's Gaussians"),
      view_free(context, "networks' first layers without the view") {
  anchors.upload(pack_anchors(scaffold, first, anchor_count));
  const std::size_t k = scaffold.offset_count;
  offsets.upload(std::span(scaffold.offset).subspan(first * k, anchor_count * k));
  view_free.upload(pack_view_free(scaffold, first, anchor_count));
}

}  // namespace binosplat::render
