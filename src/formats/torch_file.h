#pragma once
// Reads weights of TorchScript files (`torch.jit.trace(...).save(FILE.pt)`) without PyTorch. Such a file is a
// zip archive whose entries ROOT/data/0, 1, ... are the tensors, raw float32, in the module's order.

#include <cstddef>
#include <filesystem>
#include <vector>

namespace binosplat {

/// Returns the first `count` tensors of the file, flat; a caller that knows the network derives their shapes
/// from their sizes. Throws Error naming the file and the entry: no such archive, no data.pkl (another kind
/// of file), a tensor missing, damaged, too large (64 MiB), not float32 little-endian, or with a value that
/// is not finite.
std::vector<std::vector<float>> load_torch_tensors(const std::filesystem::path& path, std::size_t count);

}  // namespace binosplat
