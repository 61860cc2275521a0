#pragma once
// Settings as trainers leave them, in three kinds of text: each becomes one list of keys and values.

#include <map>
#include <string>
#include <string_view>

namespace binosplat {

/// Values as words, without quotes, by the keys that lead to them: "pipeline.model.sh_degree".
using FlatValues = std::map<std::string, std::string, std::less<>>;

/// Of YAML, in mappings that may be nested: null, true and false as these words, and text that reads like one
/// of the last two in quotes. Tags of objects and lists are passed over, since no setting that matters to a
/// picture is one. Throws Error naming `source` and the line.
FlatValues yaml_values(const std::string& source, std::string_view text);

/// Of what Python prints of an argparse.Namespace: Namespace(eval=True, images='images').
FlatValues namespace_values(std::string_view text);

/// Of JSON. Throws Error as parse_json() does; `source` is the file.
FlatValues json_values(const std::string& source, std::string_view text);

}  // namespace binosplat
