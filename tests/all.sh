#!/usr/bin/env bash
# Installs what is missing, builds, does the main job, and passes all tests. The fast tests run a second time under the
# address and undefined-behaviour sanitizers. Programs that open results (ParaView) are installed, too. Ends with ctest's own summary.
set -euo pipefail
cd "$(dirname "$0")/.."

bash examples/first_light.sh

sanitized=build-sanitize
PERILAT_BUILD=$sanitized PERILAT_CLIENTS=ON .ci/setup -DPERILAT_SANITIZE=ON
ctest --test-dir "$sanitized" -L fast --output-on-failure -j 2

ctest --test-dir build -LE long --output-on-failure -j 2
