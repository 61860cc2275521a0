#!/usr/bin/env bash
# scripts/licences.sh FOLDER: what the portable archive is made of. Reads lines FILE PACKAGE VERSION, which bundle.sh
# prints; writes FOLDER/CONTENTS.md, a table of them and of what is compiled in, and the licence of each.
set -euo pipefail
folder=$1
root=$(dirname "$0")/..
mkdir -p "$folder"
# Compiled in: headers, and libraries that Debian has as archives alone.
compiled=(libglm-dev libcli11-dev nlohmann-json3-dev libnanoflann-dev libeigen3-dev libxxhash-dev libimgui-dev pybind11-dev)
{
  echo "# What is inside"
  echo "binosplat itself is under the MIT licence ([LICENSE](LICENSE)). Libraries are those of Debian, whose source packages"
  echo "have their sources; the licence of each is in the file named after its package."
  echo
  echo "| what | Debian package | version | licence |"
  echo "|---|---|---|---|"
  {
    cat
    for package in "${compiled[@]}"; do
      echo "(compiled in) $package $(dpkg-query -W -f '${Version}' "$package")"
    done
  } | while read -r line; do
    read -r version package file < <(awk '{ v = $NF; p = $(NF - 1); NF -= 2; print v, p, $0 }' <<< "$line")
    cp "/usr/share/doc/$package/copyright" "$folder/$package"
    echo "| $file | $package | $version | [$package]($package) |"
  done | sort -u
  sed -n 's/^| `\(d3\|plot\)` | \(.*\) | \(.*\) | \(.*\) | .* |$/| (compiled in) | \2 | \3 | \4 ([\1](\1)) |/p' "$root/third_party/README.md"
} > "$folder/CONTENTS.md"
for bundle in d3 plot; do cp "$root/third_party/$bundle/LICENSE" "$folder/$bundle"; done
cp "$root/LICENSE" "$folder/LICENSE"
