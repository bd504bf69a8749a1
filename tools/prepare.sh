# Read by tools/test and tools/demo: installs what is missing (Debian 12 or 13), configures and builds. Not run by itself.
# shellcheck shell=bash

build_packages=(
  g++ cmake ninja-build ccache pkg-config libglm-dev libtbb-dev libfmt-dev libpng-dev libjpeg-dev libmeshoptimizer-dev
  nlohmann-json3-dev libzstd-dev zlib1g-dev libtomlplusplus-dev libtinygltf-dev libcli11-dev libgtest-dev libegl1 libegl-dev libgl-dev
  libgl1-mesa-dri libdrm-dev libgbm-dev libhidapi-dev libudev-dev git
)
# Opened at run time, or used by single tests only: their absence is told, and is no failure.
optional_packages=(libosmesa6 libgpiod-dev xvfb libxtst6 libxcb-present0)

print_title() { printf '\n\033[1m%s\033[0m\n' "$*" | if [[ -t 1 ]]; then cat; else sed 's/\x1b\[[0-9;]*m//g'; fi; }
fail() { printf 'surefoot: %s\n' "$*" >&2; exit 1; }

installed() { [[ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]; }

# Prints those of the named packages that are not installed.
missing_of() {
  local package
  for package in "$@"; do installed "$package" || printf '%s\n' "$package"; done
}

as_root() {
  if [[ "$(id -u)" == 0 ]]; then "$@"
  elif command -v sudo >/dev/null; then sudo "$@"
  else fail "root is needed to install packages, and there is no sudo: run as root:  apt-get install ${missing[*]}"
  fi
}

apt_install() { as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"; }

# install_missing: build_packages must be there in the end; optional_packages where the archive has them.
install_missing() {
  command -v dpkg-query >/dev/null || fail "this script installs Debian packages; elsewhere, install by hand: ${build_packages[*]}"
  local missing optional wanted=() package
  mapfile -t missing < <(missing_of "${build_packages[@]}")
  mapfile -t optional < <(missing_of "${optional_packages[@]}")
  if (( ${#missing[@]} + ${#optional[@]} == 0 )); then return; fi
  print_title "Missing Debian packages: ${missing[*]} ${optional[*]}"
  if [[ "$(id -u)" != 0 ]]; then
    echo "They are installed with apt-get, which writes to the system: it needs root, so sudo may ask for your password."
  fi
  if ! as_root apt-get update -q; then
    if (( ${#missing[@]} == 0 )); then return; fi
    fail "apt-get update failed: is the network there?"
  fi
  if (( ${#missing[@]} > 0 )); then
    apt_install "${missing[@]}" || fail "these packages could not be installed: ${missing[*]}"
  fi
  for package in "${optional[@]}"; do
    if apt-cache show "$package" >/dev/null 2>&1; then wanted+=("$package"); else echo "$package is not in this Debian: done without."; fi
  done
  if (( ${#wanted[@]} > 0 )); then
    apt_install "${wanted[@]}" || echo "Done without: ${wanted[*]}"
  fi
}

parallel_jobs() { echo "${SUREFOOT_JOBS:-2}"; }

# at_once COMMAND ARGUMENT...: COMMAND with each argument in turn, as many at once as parallel_jobs says. Fails if one of them fails.
at_once() {
  local command=$1 argument running=0 status=0
  shift
  for argument in "$@"; do
    if (( running >= $(parallel_jobs) )); then wait -n || status=1; running=$((running - 1)); fi
    "$command" "$argument" &
    running=$((running + 1))
  done
  for (( ; running > 0; --running )); do wait -n || status=1; done
  return "$status"
}

# Prints the processes below this script, parents first, without the one that prints.
processes_below() {
  local stat line words pid known=" $$ " grew=1
  local -A parent_of=()
  for stat in /proc/[0-9]*/stat; do
    { read -r line <"$stat"; } 2>/dev/null || continue
    read -ra words <<<"${line##*) }"  # the name before it may hold anything
    parent_of[${line%% *}]=${words[1]}
  done
  while (( grew )); do
    grew=0
    for pid in "${!parent_of[@]}"; do
      if [[ $known == *" ${parent_of[$pid]} "* && $known != *" $pid "* ]]; then known+="$pid " grew=1; fi
    done
  done
  for pid in ${known#" $$ "}; do if (( pid != BASHPID )); then printf '%s\n' "$pid"; fi; done
}

# Ends all that still runs below this script. What runs in the background does not hear Ctrl-C; scripts get two seconds to tidy up.
end_children() {
  local pids tries
  mapfile -t pids < <(processes_below)
  (( ${#pids[@]} > 0 )) || return 0
  kill "${pids[@]}" 2>/dev/null || true
  for (( tries = 0; tries < 20; ++tries )); do
    kill -0 "${pids[@]}" 2>/dev/null || return 0
    sleep 0.1
  done
  kill -KILL "${pids[@]}" 2>/dev/null || true
}

# build PRESET [TARGET…]
build() {
  local preset=$1 targets=()
  shift
  if (( $# > 0 )); then targets=(--target "$@"); fi
  local linker=() compiler=()
  # Presets name clang for the sanitizers; without it GCC does, in twice the time.
  if [[ $preset == *san* ]] && ! command -v clang++ >/dev/null; then compiler=(-DCMAKE_CXX_COMPILER=c++); fi
  if command -v mold >/dev/null; then linker=(-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold); fi  # the same programs, linked in a tenth of the time
  cmake --preset "$preset" --log-level=WARNING "${linker[@]}" "${compiler[@]}" &&
    cmake --build --preset "$preset" --parallel "$(parallel_jobs)" "${targets[@]}"
}
