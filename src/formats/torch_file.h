#pragma once
// Reads weights of TorchScript files (`torch.jit.trace(...).save(FILE.pt)`) without PyTorch. Such a file is a
// zip archive whose entries ROOT/data/0, 1, ... are the tensors, raw float32, in the module's order.

#include <cstddef>
#include <filesystem>
#include <vector>

namespace binosplat {

/// Returns the first `count` tensors of the file as flat lists. A caller that knows the network derives the
/// shapes from the sizes. Throws Error if the file is no such archive or has no data.pkl, or if a tensor is
/// missing, damaged or larger than 64 MiB. Also throws Error for tensors that are not float32 little-endian
/// or not finite. The text names the file and the entry.
std::vector<std::vector<float>> load_torch_tensors(const std::filesystem::path& path, std::size_t count);

}  // namespace binosplat
