#pragma once
// Weights in TorchScript's files (`torch.jit.trace(...).save(FILE.pt)`), read without PyTorch: a zip archive
// whose entries ROOT/data/0, 1, ... are the tensors, raw float32, in the order in which the module holds
// them.

#include <cstddef>
#include <filesystem>
#include <vector>

namespace binosplat {

/// The first `count` tensors of the file, flat; their shapes follow from their sizes for who knows the
/// network. Throws Error naming the file and the entry: no such archive, no data.pkl (some other kind of
/// file), a tensor missing, damaged, too large (64 MiB), not float32 little-endian, or with a value that is
/// not finite.
std::vector<std::vector<float>> load_torch_tensors(const std::filesystem::path& path, std::size_t count);

}  // namespace binosplat
