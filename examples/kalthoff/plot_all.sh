#!/usr/bin/env bash
# Runs the plate on both lattices, each as it is and turned, if the results are missing; prints the angles of the cracks and draws them.
# Another program than ../../build/perilat: PERILAT=path bash plot_all.sh
set -euo pipefail
cd "$(dirname "$0")"
export PERILAT=${PERILAT:-../../build/perilat}

plate() { # deck, angle of the lattice, result
  [[ -s $3.h5 ]] || "$PERILAT" run "$1.nml" --set "lattice.rotation=$2" --set "output.result=$3.h5"
  "$PERILAT" plot "$3.h5" --map broken --factor 1 -o "$3.png"
}

plate square  0  square
plate square  45 square_turned
plate hexagon 0  hexagon
plate hexagon 30 hexagon_turned
bash measure.sh square.h5 square_turned.h5 hexagon.h5 hexagon_turned.h5
