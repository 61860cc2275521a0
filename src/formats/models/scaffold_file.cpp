#include "formats/models/scaffold_file.h"

#include "base/error.h"
#include "base/path_questions.h"
#include "formats/containers/torch_file.h"

namespace binosplat {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t direction = 3;
constexpr const char *opacity_name = "opacity_mlp.pt", *covariance_name = "cov_mlp.pt",
                     *colour_name = "color_mlp.pt", *appearance_name = "embedding_appearance.pt",
                     *bank_name = "feature_bank_mlp.pt";

fs::path beside(const fs::path& ply, const char* name) { return ply.parent_path() / name; }

// Loads a network's weights. The sizes of the layers must fit each other and `outputs`.
Network load_network(const fs::path& path, std::size_t outputs) {
  if (!is_there(path)) {
    const bool united = is_there(beside(path, "checkpoints.pth"));
    fail("{} is missing: a Scaffold-GS model has it beside its point_cloud.ply{}", path,
         united ? "; checkpoints.pth holds the networks in one file: save them with mode 'split'" : "");
  }
  std::vector<std::vector<float>> tensors = load_torch_tensors(path, 4);
  Network network;
  network.first = std::move(tensors[0]);
  network.first_bias = std::move(tensors[1]);
  network.second = std::move(tensors[2]);
  network.second_bias = std::move(tensors[3]);
  network.hidden = network.first_bias.size();
  network.outputs = network.second_bias.size();
  if (network.hidden == 0 || network.first.empty() || network.first.size() % network.hidden != 0) {
    fail("{}: {} weights and {} biases do not form a first layer; expected inputs x hidden and hidden", path,
         network.first.size(), network.hidden);
  }
  network.inputs = network.first.size() / network.hidden;
  if (network.outputs != outputs || network.second.size() != outputs * network.hidden) {
    fail("{}: its second layer has {} weights and {} biases; expected {} x {} and {}", path,
         network.second.size(), network.outputs, outputs, network.hidden, outputs);
  }
  return network;
}

[[noreturn]] void fail_inputs(const fs::path& path, const Network& network, const std::string& expected) {
  fail("{}: its first layer has {} inputs; expected {}", path, network.inputs, expected);
}

Network load_plain(const fs::path& path, std::size_t features, std::size_t outputs) {
  Network network = load_network(path, outputs);
  const std::size_t least = features + direction;
  if (network.inputs != least && network.inputs != least + 1) {
    fail_inputs(path, network,
                fmt::format("{} (features and direction) or {} (and distance)", least, least + 1));
  }
  network.distance = network.inputs == least + 1;
  return network;
}

// Loads the colour network. If the network takes an appearance, also loads the appearances.
void load_colour(const fs::path& ply, Scaffold& scaffold) {
  const fs::path path = beside(ply, colour_name);
  scaffold.colour = load_network(path, 3 * scaffold.offset_count);
  Network& network = scaffold.colour;
  const std::size_t least = scaffold.feature_count + direction;
  if (network.inputs < least)
    fail_inputs(path, network, fmt::format("{} (features and direction) or more", least));
  const std::size_t more = network.inputs - least;
  network.distance = more == 1;
  if (more <= 1) return;
  const fs::path rows = beside(ply, appearance_name);
  if (!is_there(rows)) {
    fail("{} is missing: {} has {} inputs besides features and direction, so it needs appearances", rows,
         path, more);
  }
  scaffold.appearances = std::move(load_torch_tensors(rows, 1).front());
  const std::size_t values = scaffold.appearances.size();
  network.distance = values % more != 0 && values % (more - 1) == 0;
  scaffold.appearance_size = network.distance ? more - 1 : more;
  if (values == 0 || values % scaffold.appearance_size != 0)
    fail("{}: {} values; expected rows of {}, as {} takes them", rows, values, more, path);
}

void load_bank(const fs::path& ply, Scaffold& scaffold) {
  const fs::path path = beside(ply, bank_name);
  if (!is_there(path)) return;
  Network network = load_network(path, 3);
  if (network.inputs != direction + 1) fail_inputs(path, network, "4 (direction and distance)");
  if (scaffold.feature_count % 4 != 0)
    fail("{}: a feature bank needs a multiple of 4 features; {} has {}", path, ply, scaffold.feature_count);
  network.distance = true;
  scaffold.bank = std::move(network);
}

}  // namespace

bool is_scaffold(const PlyHeader& header) {
  const PlyElement* vertices = header.find("vertex");
  return vertices != nullptr && vertices->find("f_anchor_feat_0") != nullptr;
}

std::shared_ptr<Scaffold> load_scaffold(const OpenedFile& file) {
  const fs::path& ply = file.path;
  auto scaffold = std::make_shared<Scaffold>();
  load_anchors(file, *scaffold);
  const std::size_t features = scaffold->feature_count;
  const std::size_t k = scaffold->offset_count;
  scaffold->opacity = load_plain(beside(ply, opacity_name), features, k);
  scaffold->covariance = load_plain(beside(ply, covariance_name), features, 7 * k);
  load_colour(ply, *scaffold);
  load_bank(ply, *scaffold);
  return scaffold;
}

std::vector<fs::path> files_of_networks(const fs::path& ply) {
  std::vector<fs::path> files;
  for (const char* name : {opacity_name, covariance_name, colour_name, appearance_name, bank_name})
    files.push_back(beside(ply, name));
  return files;
}

}  // namespace binosplat
