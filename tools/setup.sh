# shellcheck shell=bash
# Shared steps of quickstart and runtests: Debian packages, the build, the Python environment. To be sourced from the
# repository's root. Each step is skipped when it is done, prints one line, and keeps its output in build/log/.

export LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive MPLBACKEND=Agg
# Caches stay inside the repository.
export XDG_CACHE_HOME="$PWD/build/cache" MPLCONFIGDIR="$PWD/build/cache/matplotlib"
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_INPUT=1 PIP_ROOT_USER_ACTION=ignore
mkdir -p build/log "$MPLCONFIGDIR"

say() { printf '%s\n' "$*"; }
die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# log_of TEXT: path of the log of a step.
log_of() { printf 'build/log/%s.log' "$(tr -cs 'A-Za-z0-9\n' '-' <<<"$1")"; }

# ended TEXT STATUS START: print the result of a step; after a failure show the end of its log and stop.
ended() {
  if [ "$2" = 0 ]; then
    printf 'done (%d s)\n' $((SECONDS - $3))
  else
    printf 'failed\n'
    tail -n 20 "$(log_of "$1")" >&2
    die "$1 failed; the whole log is $(log_of "$1")"
  fi
}

# step TEXT COMMAND...: run quietly.
step() {
  local text=$1 start=$SECONDS status=0
  shift
  printf '%s ... ' "$text"
  "$@" >"$(log_of "$text")" 2>&1 </dev/null || status=$?
  ended "$text" $status $start
}

# counted_step TEXT COMMAND...: the same for a command that counts its steps as Ninja does, with its progress.
counted_step() {
  local text=$1 start=$SECONDS status=0
  shift
  printf '%s ... ' "$text"
  "$@" 2>&1 </dev/null | tee "$(log_of "$text")" | show_count "$text" || status=$?
  ended "$text" $status $start
}

# show_count TEXT: show the count of lines that start with [DONE/ALL]: on a terminal in one line; elsewhere a line each quarter.
show_count() {
  local text=$1 line percent start=$SECONDS shown=0
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    percent=$((100 * BASH_REMATCH[1] / BASH_REMATCH[2]))
    if [ -t 1 ]; then
      printf '\r%s ... %d of %d steps, %d s' "$text" "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" $((SECONDS - start))
    elif [ $percent -lt 100 ] && [ $((percent / 25)) -gt $((shown / 25)) ]; then
      [ $shown -gt 0 ] || printf '\n'
      printf '  %d of %d steps after %d s\n' "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}" $((SECONDS - start))
      shown=$percent
    fi
  done
  if [ -t 1 ]; then
    printf '\r\033[K%s ... ' "$text"
  elif [ $shown -gt 0 ]; then
    printf '%s ... ' "$text"
  fi
}

install_packages() {
  if [ "$(id -u)" = 0 ]; then
    apt-get update && apt-get -o Acquire::Retries=3 install -y --no-install-recommends "$@"
  else
    sudo apt-get update && sudo DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 install -y --no-install-recommends "$@"
  fi
}

# The Debian packages named in a log of CMake, or all packages of its list of libraries.
library_packages() { sed -n 's/.*: Debian \([a-z0-9-]*\),.*/\1/p' "${1:-cmake/Dependencies.cmake}"; }

can_install() {
  command -v apt-get >/dev/null || return 1
  [ "$(id -u)" = 0 ] && return
  command -v sudo >/dev/null || return 1
  sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; }
}

# need PACKAGE...: install these Debian packages if that is possible here, otherwise name them and stop.
need() {
  [ $# -gt 0 ] || return 0
  can_install || die "missing, in Debian's names: $*
Without apt and root they cannot be installed from here. Install them, load their modules, or see \"Without root\" in
README.md; then run $0 again."
  step "Installing Debian packages: $*" install_packages "$@"
}

# A Python that evolvent supports and that can make virtual environments.
find_python() {
  local candidate
  for candidate in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11}; do
    if "$candidate" -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
      command -v "$candidate"
      return
    fi
  done
  return 1
}

# Tools are searched by their commands, so that modules and conda environments are found as well.
setup_tools() {
  local missing=()
  command -v gcc >/dev/null || command -v "${CC:-cc}" >/dev/null || missing+=(gcc libc6-dev)
  command -v "${FC:-gfortran}" >/dev/null || missing+=(gfortran)
  command -v cmake >/dev/null || missing+=(cmake)
  command -v ninja >/dev/null || missing+=(ninja-build)
  command -v pkg-config >/dev/null || missing+=(pkg-config)
  find_python >/dev/null || missing+=(python3-venv)
  if [ ${#missing[@]} -gt 0 ] && ! can_install; then
    # CMake cannot search for the libraries yet, so name them all.
    mapfile -t -O ${#missing[@]} missing < <(library_packages | grep -v pkg-config)
  fi
  need "${missing[@]}"
  find_python >/dev/null || die "no Python 3.11 or newer with the modules venv and ensurepip found; name one with PYTHON=..."
}

# missing_test_packages: the Debian packages of tests/machine.txt whose programs are missing here.
SYSTEM_FOLDERS=/usr/sbin:/usr/local/sbin:/sbin # not in the PATH of ordinary users
missing_test_packages() {
  local PATH=$PATH:$SYSTEM_FOLDERS list=${BASH_SOURCE[0]%/*}/../tests/machine.txt names packages
  while IFS=';' read -r names packages _; do
    [[ $names =~ ^[[:space:]]*(#|$) ]] && continue
    # shellcheck disable=SC2086  # one word a program
    [ -n "$(type -P ${names//|/ })" ] || printf '%s\n' $packages
  done <"$list"
}

# Everything else that the tests need. Without the right to install it, tests whose programs are missing are skipped.
setup_test_tools() {
  local missing
  mapfile -t missing < <(missing_test_packages | sort -u)
  if [ ${#missing[@]} -gt 0 ]; then
    can_install || {
      say "Missing, so that tests will be skipped: ${missing[*]}"
      return
    }
    need "${missing[@]}"
  fi
  export EVOLVENT_TESTS_COMPLETE=1
}

# configure PRESET: CMake finds the libraries, and lists the Debian packages of the missing ones.
configure() {
  local dir=build/$1 home missing
  home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$dir/CMakeCache.txt" 2>/dev/null || true)
  [ -f "$dir/build.ninja" ] && [ "$home" = "$PWD" ] && cmp -s CMakePresets.json "$dir/.CMakePresets.json" && return
  rm -rf "$dir"
  if ! cmake --preset "$1" >"build/log/configure-$1.log" 2>&1; then
    missing=$(library_packages "build/log/configure-$1.log")
    if [ -z "$missing" ]; then
      tail -n 20 "build/log/configure-$1.log" >&2
      die "CMake failed; the whole log is build/log/configure-$1.log"
    fi
    rm -rf "$dir"
    # shellcheck disable=SC2086  # one word a package
    need $missing
    step "Configuring $1" cmake --preset "$1"
  fi
  cp CMakePresets.json "$dir/.CMakePresets.json"
}

# build PRESET
build() {
  configure "$1"
  counted_step "Building $1" cmake --build --preset "$1"
}

# python_environment LOCK: create .venv with exactly the packages of the lock file.
python_environment() {
  local lock=$1 installed=.venv/.${1##*/} python identity
  python=$(find_python)
  identity="$PWD $("$python" --version)"
  if [ "$(cat .venv/.identity 2>/dev/null)" != "$identity" ]; then
    rm -rf .venv
    step "Making the Python environment .venv" "$python" -m venv .venv
    printf '%s\n' "$identity" >.venv/.identity
  fi
  if ! cmp -s "$lock" "$installed"; then
    step "Installing Python packages ($lock)" .venv/bin/python -m pip install --require-hashes -r "$lock"
    cp "$lock" "$installed"
  fi
  # Editable installation: Python reads the sources, and CMake's program is linked, not built again.
  if ! cmp -s pyproject.toml .venv/.pyproject.toml || ! cmp -s CMakeLists.txt .venv/.CMakeLists.txt; then
    step "Installing the Python package evolvent in place" .venv/bin/python -m pip install \
      --no-deps --no-build-isolation --config-settings=wheel.cmake=false --config-settings=editable.mode=inplace -e .
    cp pyproject.toml .venv/.pyproject.toml
    cp CMakeLists.txt .venv/.CMakeLists.txt
  fi
}
