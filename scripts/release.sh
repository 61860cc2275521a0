#!/usr/bin/env bash
# scripts/release.sh [OUT]: makes, from what is committed, into OUT (out/release)
#   binosplat-VERSION-linux-x86_64.tar.xz  which runs where glibc is that of this machine or newer: unpack it anywhere
#   binosplat_VERSION_amd64.deb            for the Debian release of this machine
#   binosplat-VERSION-cpXY-....whl         for the Python of this machine, as widely as the archive
# and their SHA256SUMS. Each time the same bytes, in whichever folder: SOURCE_DATE_EPOCH is the commit's time.
set -euo pipefail
main() {
  case ${1:-} in -h | --help) sed -n '2,6s/^# //p' "$0"; exit ;; esac
  root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
  out=$(realpath -m "${1:-$root/out/release}")
  cd "$root"
  . scripts/setup.sh
  install_packages packages/build.txt packages/release.txt
  [[ -z $(git status --porcelain) ]] || echo "release.sh: what is not committed is left out" >&2

  export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)} LC_ALL=C TZ=UTC
  umask 022
  work=$(mktemp -d)
  trap "rm -rf '$work'" EXIT
  git clone -q "$root" "$work/source"
  cd "$work/source"
  cmake --preset release --log-level=NOTICE -DBINOSPLAT_TESTS=OFF -DBINOSPLAT_PYTHON=ON -DPython_EXECUTABLE=/usr/bin/python3 \
    -DCMAKE_CXX_FLAGS="-ffile-prefix-map=$work/source=."
  cmake --build --preset release -j "$(nproc)" --target all binosplat_shared
  version=$(sed -n 's/^project(binosplat VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
  mkdir -p "$out"

  echo "== Debian package"
  cpack --config build/release/CPackConfig.cmake -G DEB -B "$work/packages" >/dev/null
  cp "$work"/packages/*.deb "$out"

  echo "== wheel"
  BINOSPLAT_WHEEL_BUILD=$PWD/build/release /usr/bin/python3 packages/wheel/binosplat_wheel.py "$out"

  echo "== archive"
  name=binosplat-$version-linux-x86_64
  stage=$work/$name
  cmake --install build/release --prefix "$stage" --strip >/dev/null
  mkdir "$stage/python"
  mv "$stage"/lib/python3*/*-packages/binosplat "$stage/python/binosplat"
  # Who links to the archive's library need have none of those that it is made of.
  rm -r "$stage"/lib/*
  cp -P build/release/libbinosplat.so.* "$stage/lib"
  strip --strip-unneeded "$stage/lib/libbinosplat.so.$version"
  ln -s "libbinosplat.so.${version%.*}" "$stage/lib/libbinosplat.so"
  mkdir -p "$stage/lib/cmake/binosplat"
  sed "s/@VERSION@/$version/" cmake/portableConfig.cmake.in > "$stage/lib/cmake/binosplat/binosplatConfig.cmake"
  cp build/release/binosplatConfigVersion.cmake "$stage/lib/cmake/binosplat"
  cp packages/portable.txt "$stage/README"
  ln -s bin/binosplat "$stage/binosplat"
  scripts/bundle.sh "$stage/lib" "$stage"/bin/* "$stage/lib/libbinosplat.so.$version" "$stage"/python/binosplat/*.so > "$work/bundled"
  scripts/licences.sh "$stage/share/licences" < "$work/bundled"
  find "$stage" -type f -perm /111 -exec chmod 755 {} + -o -type f -exec chmod 644 {} +
  tar -C "$work" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --format=gnu -c "$name" |
    xz -9 -T1 > "$out/$name.tar.xz"
  cd "$out"
  sha256sum "$name.tar.xz" binosplat_*.deb binosplat-*.whl | tee SHA256SUMS
}

main "$@"  # read whole before it runs
