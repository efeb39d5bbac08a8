#!/usr/bin/env bash
# Runs the beams whose results are missing and draws all curves, load over crack mouth opening: all_curves.png, and one
# picture for each depth. Another program than ../../build/perilat or the one installed: PERILAT=path bash plot_all.sh
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}
[[ -n ${PERILAT:-} || -x $perilat ]] || perilat=perilat

beams=(d3_s6.35 d3_s3.175 d6_s6.35 d6_s3.175 d9_s12.7 d9_s6.35 d9_s3.175)

# Files and labels of the beams whose name begins with $1, for `perilat plot`.
curves() {
  local beam name
  for beam in "${beams[@]}"; do
    [[ $beam == "$1"* ]] || continue
    name=${beam%%_s*}
    printf '%s\n' "$beam.h5" --label "${name^^}, ${beam##*_s} mm"
  done
}

draw() { # beginning of the names, picture, title
  local -a files
  mapfile -t files < <(curves "$1")
  "$perilat" plot "${files[@]}" --x cmod --y load --title "$3" -o "$2"
}

for beam in "${beams[@]}"; do
  [[ -s $beam.h5 ]] || "$perilat" run "$beam.nml"
done

draw d  all_curves.png "Notched beams"
draw d3 d3_curves.png  "Notched beam D3"
draw d6 d6_curves.png  "Notched beam D6"
draw d9 d9_curves.png  "Notched beam D9"
