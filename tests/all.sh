#!/usr/bin/env bash
# Installs what is missing, builds, does the main job, and passes all tests. The fast tests run a second time under the
# address and undefined-behaviour sanitizers. Programs that open results (ParaView) are installed, too. Ends with ctest's own summary.
set -euo pipefail
cd "$(dirname "$0")/.."

# Fortran's and C++'s own compilers read decks and headers; packages are made and judged; ParaView and h5py open results, a browser and xmllint pages.
export PERILAT_PACKAGES="gfortran g++ dpkg-dev lintian patch python3-paraview xvfb xauth python3-h5py chromium libxml2-utils"

bash examples/first_light.sh

sanitized=build-sanitize
PERILAT_BUILD=$sanitized .ci/setup -DPERILAT_SANITIZE=ON
# Minutes long there: many laws checked or graded, or kernels and programs that are not built with sanitizers. These run only below.
ctest --test-dir "$sanitized" -L fast -E 'kernel\..*match|command\.(options|study)|check\.physics|grade\.hostile|run\.(digests|lost_runs)' \
  --output-on-failure -j 2

ctest --test-dir build -LE long --output-on-failure -j 2
