#pragma once
// Reads weights of TorchScript files (`torch.jit.trace(...).save(FILE.pt)`) without PyTorch. Such a file is a
// zip archive whose entries ROOT/data/0, 1, ... are the tensors, raw float32, in the module's order.

#include <cstddef>
#include <filesystem>
#include <vector>

namespace binosplat {

/// Returns the first `count` tensors as flat lists; a caller that knows the network derives shapes from
/// sizes. Throws Error naming file and entry for other archives, for tensors that are missing, damaged or
/// larger than 64 MiB, and for tensors that are not float32, little-endian and finite.
std::vector<std::vector<float>> load_torch_tensors(const std::filesystem::path& path, std::size_t count);

}  // namespace binosplat
