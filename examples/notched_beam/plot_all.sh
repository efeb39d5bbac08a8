#!/usr/bin/env bash
# Runs the beams whose results are missing and draws all curves, load over crack mouth opening and over load-point displacement:
# all_curves.png, all_lpd.png, and one picture of each for each depth; and six stages of the crack in D9, d9_stages.png. Another program than ../../build/perilat or the one installed: PERILAT=path bash plot_all.sh
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

draw() { # beginning of the names, beginning of the pictures, title
  local -a files
  mapfile -t files < <(curves "$1")
  "$perilat" plot "${files[@]}" --x cmod --y load --title "$3" -o "$2_curves.png"
  "$perilat" plot "${files[@]}" --x lpd --y load --title "$3" -o "$2_lpd.png"
}

for beam in "${beams[@]}"; do
  [[ -s $beam.h5 ]] || "$perilat" run "$beam.nml"
done

draw d  all "Notched beams"
draw d3 d3  "Notched beam D3"
draw d6 d6  "Notched beam D6"
draw d9 d9  "Notched beam D9"

[[ -s d9_long.h5 ]] || "$perilat" run d9_s12.7.nml --set "stop.after=70 ms" --set output.result=d9_long.h5
"$perilat" plot d9_long.h5 --map damage --frames cmod=0.128mm,0.288mm,0.607mm,0.915mm,1.221mm,1.376mm -o d9_stages.png
