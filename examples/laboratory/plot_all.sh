#!/usr/bin/env bash
# Runs what is missing and draws both curves beside the measured ones, and both cracks.
# Another program than ../../build/perilat: PERILAT=path bash plot_all.sh
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}

for name in mixed_mode_beam l_panel; do
  [[ -s $name.h5 ]] || "$perilat" run "$name.nml"
  "$perilat" plot "$name.h5" --map damage -o "${name}_crack.png"
done
"$perilat" plot mixed_mode_beam.h5 --x cmod --y load --label "stated values" \
  --data mixed_mode_beam.csv --band load_low,load_high -o mixed_mode_beam_curve.png
"$perilat" plot l_panel.h5 --x displacement --y load --label "stated values" --data l_panel.csv -o l_panel_curve.png
