#pragma once
// URIs in files of models (RFC 3986): files beside them, or embedded data.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/json_file.h"

namespace binosplat {

/// Replaces each % with two hexadecimal digits by their byte.
std::string percent_decoded(std::string_view text);

bool has_data(const JsonValue& uri);

/// Returns the bytes of a data: URI (RFC 2397), base64 or percent-encoded. Throws Error naming the key if the
/// comma is missing or the base64 is invalid.
std::vector<std::byte> data_in(const JsonValue& uri);

/// Returns the file in or below `folder` that a relative URI names, decoded or, since some programs do not
/// encode names, as it is. If the URI leads elsewhere, throws Error naming the key.
std::filesystem::path file_named(const std::filesystem::path& folder, const JsonValue& uri);

}  // namespace binosplat
