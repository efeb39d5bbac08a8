#!/usr/bin/env bash
# Installs what is missing, builds perilat, breaks the notched beam D6 (s = 6.35 mm), and draws curve and crack.
# Leaves d6_s6.35.h5, d6_s6.35.xdmf, d6_curve.png and d6_crack.png in examples/notched_beam/.
set -euo pipefail
cd "$(dirname "$0")/.."
.ci/setup
cd examples/notched_beam
../../build/perilat run d6_s6.35.nml
../../build/perilat plot d6_s6.35.h5 --x cmod --y load -o d6_curve.png
../../build/perilat plot d6_s6.35.h5 --map damage -o d6_crack.png
echo "look at examples/notched_beam/d6_curve.png and d6_crack.png; open d6_s6.35.xdmf in ParaView"
