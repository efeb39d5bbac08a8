#!/usr/bin/env bash
# Installs what is missing, builds, does the main job, and passes all tests. The fast tests run a second time under the
# address and undefined-behaviour sanitizers. Ends with ctest's own summary.
set -euo pipefail
cd "$(dirname "$0")/.."

# Fortran's and C++'s own compilers read decks and headers; packages are made and judged.
export PERILAT_PACKAGES="gfortran g++ dpkg-dev lintian"

bash examples/first_light.sh

sanitized=build-sanitize
PERILAT_BUILD=$sanitized .ci/setup -DPERILAT_SANITIZE=ON
ctest --test-dir "$sanitized" -L fast --output-on-failure -j 2

ctest --test-dir build -LE long --output-on-failure -j 2
