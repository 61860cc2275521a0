#!/usr/bin/env bash
# scripts/bundle.sh LIBRARIES FILE...: programs and modules take the libraries that they are linked to with them. Copies
# these, and what they are linked to themselves, to the folder LIBRARIES, and has the FILEs find them there, wherever
# both are moved together. Copies have names of their own, so that no other program's library of the same name is taken
# for them, nor they for it. Prints a line for each: its file, and the Debian package with its version. Left to the
# system are those that every Linux has, and the window system's.
set -euo pipefail
of_system='^(ld-linux-x86-64|libc|libm|libdl|libpthread|librt|libgcc_s|libstdc\+\+|libz|libX11)\.so'
folder=$1
shift
mkdir -p "$folder"
command -v patchelf >/dev/null || { echo "bundle.sh: there is no patchelf (Debian: apt-get install patchelf)" >&2; exit 2; }

declare -A place  # of a library by the name that it is asked for
while read -r name _ path _; do
  if [[ $path == /* ]]; then
    place[$name]=$path
  elif [[ $path == not ]] && ! [[ $name =~ $of_system ]]; then
    echo "bundle.sh: $name, which $* need, is not on this machine" >&2
    exit 2
  fi
done < <(ldd "$@" | grep '=>')

files=("$@")
for ((i = 0; i < ${#files[@]}; ++i)); do
  file=${files[i]}
  for name in $(patchelf --print-needed "$file"); do
    [[ $name =~ $of_system ]] && continue
    copy=$folder/${name/.so/-binosplat.so}
    if [[ ! -e $copy ]]; then
      cp "$(realpath "${place[$name]}")" "$copy"
      chmod 755 "$copy"
      strip --strip-unneeded "$copy"
      patchelf --set-soname "$(basename "$copy")" "$copy"
      files+=("$copy")
      package=$(dpkg-query -S "$(realpath "${place[$name]}")" 2>/dev/null || dpkg-query -S "${place[$name]}") || package=unknown
      package=${package%%:*}
      echo "$(basename "$copy") $package $(dpkg-query -W -f '${Version}' "$package" | head -1)"
    fi
    patchelf --replace-needed "$name" "$(basename "$copy")" "$file"
  done
  where=/$(realpath --relative-to "$(dirname "$file")" "$folder")
  patchelf --set-rpath "\$ORIGIN${where%/.}" "$file"
done
