#pragma once
// URIs in files of models (RFC 3986), as far as they name files beside them or hold data themselves.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/json_file.h"

namespace binosplat {

/// Bytes for all that is written as % and two hexadecimal digits; a % without them stays.
std::string percent_decoded(std::string_view text);

/// Whether a URI has the scheme data:.
bool has_data(const JsonValue& uri);

/// The bytes of one that has (RFC 2397), in base64 or percent-encoded. Throws Error naming the key for one
/// without a comma, or with what is no base64.
std::vector<std::byte> data_in(const JsonValue& uri);

/// The file in `folder`, or below it, that a relative URI names: by its decoded name or, if only that is
/// there, by the name as it is written, which some programs do not encode. Throws Error naming the key for
/// one that would lie elsewhere.
std::filesystem::path file_named(const std::filesystem::path& folder, const JsonValue& uri);

}  // namespace binosplat
