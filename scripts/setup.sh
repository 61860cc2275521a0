# Sourced by ./demo and ./check.

# install_packages LIST...: installs the Debian packages that the lists name and that are missing. Asks nothing of apt,
# and needs no rights, when all are there.
install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "Not a Debian system: what $* name is taken to be installed." >&2
    return
  fi
  local package missing=() sudo=()
  for package in $(sed 's/#.*//' "$@"); do
    [[ $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) == "install ok installed" ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "Missing packages, and neither root nor sudo to install them. As root, run:" >&2
      echo "  apt-get install ${missing[*]}" >&2
      return 1
    fi
    sudo=(sudo)
  fi
  echo "Installing ${missing[*]}"
  "${sudo[@]}" apt-get -qq update
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null
}
