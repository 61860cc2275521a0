#!/usr/bin/env bash
# tidy.sh [--all]: clang-tidy over the sources that changed since origin/main (where that is absent, or is what is
# checked out: in the last commit), for at most four minutes; --all: over every source, however long it takes.
# clang reads no headers that g++ has precompiled: build/tidy has the commands without them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Each version finds other things, so one decides.
if [[ $(clang-tidy --version) != *"version 14."* ]]; then
  echo "clang-tidy 14 (Debian 12) decides, and this is another: nothing is checked"
  exit
fi

# Names of changed and of new files below include, src, stereo, shaders and tests; fails where there is no history to compare with.
changed() {
  local base
  base=$(git merge-base HEAD origin/main) || base=$(git rev-parse HEAD) || return
  if [[ $base == $(git rev-parse HEAD) ]]; then base=$(git rev-parse --verify HEAD~1) || return; fi
  git diff --name-only --diff-filter=d "$base" -- include src stereo shaders tests
  git ls-files --others --exclude-standard -- include src stereo shaders tests
}

# The .cpp files to look at: with --all the unity files; else those that changed, and for each changed header one that
# includes it.
chosen() {
  local names name
  if [[ $unity == ON ]]; then
    sed -n "s:^  \"file\"\: \"$PWD/\(.*/Unity/.*\)\",*$:\1:p" build/tidy/compile_commands.json
    return
  fi
  if ! names=$(changed 2>/dev/null); then
    find src stereo tests -name '*.cpp'
    return
  fi
  for name in $names; do
    case $name in
      *.cpp) echo "$name" ;;
      include/*.h) grep -rlF --include='*.cpp' "<${name#*/}>" src stereo tests | head -n 1 || true ;;
      stereo/*.h) grep -rlF --include='*.cpp' "\"$name\"" src stereo tests | head -n 1 || true ;;
      *.h) grep -rlF --include='*.cpp' "\"${name#*/}\"" src stereo tests | head -n 1 || true ;;
    esac
  done
}

# tidy FILE: quiet when it is clean; past the deadline it only names the file.
tidy() {
  if ((EPOCHSECONDS > deadline)); then echo "clang-tidy: out of time, not checked: $1"; return; fi
  if ! grep -qF "/$1\"" build/tidy/compile_commands.json; then echo "clang-tidy: not built here, not checked: $1"; return; fi
  local findings
  findings=$(clang-tidy --quiet -p build/tidy --checks="$checks" "$1" 2>&1) && return
  sed '/ warnings\{0,1\} generated\.$/d' <<<"$findings"
  return 1
}
export -f tidy

unity=OFF deadline=$((EPOCHSECONDS + 240)) checks=
if [[ ${1:-} == --all ]]; then unity=ON deadline=$((EPOCHSECONDS + 86400)) checks=-bugprone-suspicious-include; fi
export deadline checks
cmake --preset release -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_UNITY_BUILD=$unity --log-level=ERROR >/dev/null
mapfile -t files < <(chosen | sort -u)
echo "clang-tidy on ${#files[@]} files"
if ((${#files[@]})); then printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" bash -c 'tidy "$1"' -; fi
