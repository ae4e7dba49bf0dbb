#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Finds what Talus needs and installs what is missing: with apt-get when this
# is root or sudo asks no password, otherwise it says what to type and ends
# with status 1. Takes a fraction of a second when everything is there.
#
#   tools/setup.sh [COMMAND...]   further commands to have, e.g. clang-format-14
#
# Environment: CC, CPPFLAGS (where p4est is, if not in a usual place), PYTHON.
set -u

cc=${CC:-mpicc}
missing=()  # what, in words
packages=() # what brings it on Debian

# need "what" package... : notes something missing
need() {
  missing+=("$1")
  shift
  packages+=("$@")
}

have() {
  command -v "$1" > /dev/null 2>&1
}

find_programs() {
  have gcc || have cc || need "a C compiler" gcc libc6-dev
  have make || need make make
  have pkg-config || need pkg-config pkg-config
  { have mpicc && have mpirun; } || need MPI libopenmpi-dev openmpi-bin
}

# One run of the preprocessor tells which headers are there, and whether HDF5
# and p4est can do MPI.
probe() {
  cat << 'EOF'
#if !__has_include(<stdlib.h>)
MISSING libc
#endif
#if !__has_include(<zlib.h>)
MISSING zlib
#endif
#if !__has_include(<gsl/gsl_errno.h>)
MISSING gsl
#endif
#if !__has_include(<lua.h>)
MISSING lua
#endif
#if !__has_include(<check.h>)
MISSING check
#endif
#if __has_include(<p4est_config.h>)
#include <p4est_config.h>
#endif
#ifndef P4EST_ENABLE_MPI
MISSING p4est
#endif
#if __has_include(<H5pubconf.h>)
#include <H5pubconf.h>
#endif
#ifndef H5_HAVE_PARALLEL
MISSING hdf5
#endif
EOF
}

find_libraries() {
  local flags name found
  flags=$(pkg-config --cflags hdf5-openmpi lua5.4 gsl check 2> /dev/null) ||
    flags=$(for name in hdf5-openmpi lua5.4 gsl check; do
      pkg-config --cflags "$name" 2> /dev/null
    done)
  # shellcheck disable=SC2086 # flags are words
  found=$(probe | "$cc" -E -P ${CPPFLAGS:-} $flags - 2> /dev/null) ||
    found=$(printf 'MISSING %s\n' libc zlib gsl lua check p4est hdf5)
  while read -r word name; do
    [ "$word" = MISSING ] && need_library "$name"
  done <<< "$found"
}

need_library() {
  case $1 in
    libc) need "the C library" libc6-dev ;;
    zlib) need zlib zlib1g-dev ;;
    gsl) need GSL libgsl-dev ;;
    lua) need "Lua 5.4" liblua5.4-dev ;;
    check) need Check check ;;
    p4est) need "p4est with MPI" libp4est-dev ;;
    hdf5) need "HDF5 with MPI-IO" libhdf5-openmpi-dev ;;
  esac
}

# The python3 on PATH need not be the system's own, which apt serves.
find_python() {
  local p
  for p in "${PYTHON:-python3}" python3 /usr/bin/python3; do
    # A directory that a removed package left behind has no origin.
    "$p" -c 'import sys
from importlib.util import find_spec
for name in "h5py", "matplotlib":
    if not getattr(find_spec(name), "origin", None):
        sys.exit(1)' \
      2> /dev/null && return
  done
  need "a Python with h5py and matplotlib" \
    python3 python3-h5py python3-matplotlib
}

find_all() {
  missing=()
  packages=()
  find_programs
  find_libraries
  find_python
  local name
  for name in "$@"; do have "$name" || need "$name" "$name"; done
}

say_missing() {
  local list
  printf -v list '%s, ' "${missing[@]}"
  echo "missing: ${list%, }"
}

install() {
  local as=()
  if [ "$(id -u)" -ne 0 ]; then
    if have sudo && sudo -n true 2> /dev/null; then as=(sudo -n); else
      return 1
    fi
  fi
  have apt-get || return 1
  echo "installing with apt-get, which may take minutes: ${packages[*]}"
  echo "  reading the lists of packages ..."
  "${as[@]}" apt-get update -qq &&
    "${as[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C \
      apt-get install -y -q --no-install-recommends "${packages[@]}" 2>&1 |
    show_progress
  return "${PIPESTATUS[0]}"
}

# What apt-get fetches and sets up, a line each, and what is wrong.
show_progress() {
  sed -u -n -e '/^Need to get /s/^/  /p' \
    -e 's/^Get:[0-9]* [^ ]* [^ ]* [^ ]* \([^ ]*\) .*\[\(.*\)\]$/  got \1, \2/p' \
    -e '/^Setting up /s/^/  /p' -e '/^[EW]: /p'
}

find_all "$@"
[ ${#missing[@]} -eq 0 ] && exit 0
say_missing
if install; then
  find_all "$@"
  [ ${#missing[@]} -eq 0 ] && exit 0
  echo "still" "$(say_missing)"
fi
echo "Please install it; on Debian 12:"
echo "  sudo apt-get install ${packages[*]}"
exit 1
