#pragma once
// Settings of trainers in three kinds of text, each flattened to keys and values.

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace binosplat {

/// Values without quotes, each by its path of keys, as in "pipeline.model.sh_degree".
using FlatValues = std::map<std::string, std::string, std::less<>>;

/// Flattens YAML with nested mappings. All spellings of null, true and false become these words; quoted text
/// that reads like true or false stays quoted. Tagged objects and lists are skipped, since no setting that
/// affects a picture is one. Throws Error naming `source` and the line.
FlatValues yaml_values(const std::string& source, std::string_view text);

/// Takes key and value from each comment: "SplatRenderMode: mip", "postshot.anti_aliasing=1", "antialiased
/// 1". Both are in lower case. The last of equal keys counts.
FlatValues comment_values(const std::vector<std::string>& comments);

/// Flattens Python's print of an argparse.Namespace: Namespace(eval=True, images='images').
FlatValues namespace_values(std::string_view text);

/// Flattens JSON. Throws Error as parse_json() does; `source` names the file.
FlatValues json_values(const std::string& source, std::string_view text);
FlatValues json_values(const nlohmann::json& root);

}  // namespace binosplat
