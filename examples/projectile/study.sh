#!/usr/bin/env bash
# The twenty runs of the source's Table 6.1: prints the largest stress by mass and speed, MPa, and draws its course for all masses at
# 30 m/s and for all speeds at 0.175 kg. Results that are there are not computed again. bash study.sh plane|space
# Another program than ../../build/perilat: PERILAT=path bash study.sh plane
set -euo pipefail
cd "$(dirname "$0")"
perilat=${PERILAT:-../../build/perilat}
deck=${1:-plane}
masses=(0.175 0.200 0.225 0.250)
speeds=(30 40 50 60 70)

# Of the projectile, by its length in mm: the four masses are as many layers of particles.
case $deck in
plane) lengths=(17.728 20.261 22.793 25.326) ;;
space) lengths=(17.852 20.402 22.953 25.503) ;;
*) echo "study.sh: plane or space, not $deck" >&2; exit 1 ;;
esac

name() { echo "${deck}_$1kg_$2ms.h5"; }

run() { # mass, length, speed
  local body
  if [[ $deck == plane ]]; then
    body="body[projectile].size=31.4 mm, $2 mm"
  else
    body="body[projectile].to=0, $(awk "BEGIN { print 10 + $2 }") mm, 0"
  fi
  "$perilat" run "$deck.nml" --set "$body" --set "initial_velocity.value=-$3 m/s" --set "simulation.end_time=24 us" \
    --set "simulation.title=$1 kg at $3 m/s" --set output.frames=0 --set "output.result=$(name "$1" "$3")"
}

peak() { "$perilat" export "$1" --history stress | awk -F, 'NR > 1 && $2 > most { most = $2 } END { printf "%.1f", most / 1e6 }'; }

printf '| | %s kg | %s kg | %s kg | %s kg |\n|---|---|---|---|---|\n' "${masses[@]}"
for speed in "${speeds[@]}"; do
  printf '| %s m/s |' "$speed"
  for k in 0 1 2 3; do
    result=$(name "${masses[k]}" "$speed")
    [[ -s $result ]] || run "${masses[k]}" "${lengths[k]}" "$speed" >&2
    printf ' %s |' "$(peak "$result")"
  done
  echo
done

draw() { # title, picture, then label and result by turns
  local title=$1 picture=$2 results=() labels=()
  shift 2
  for (( ; $#; )); do
    labels+=(--label "$1") results+=("$2")
    shift 2
  done
  "$perilat" plot "${results[@]}" --y stress --title "$title" "${labels[@]}" -o "$picture" >&2
}
by_mass=() by_speed=()
for mass in "${masses[@]}"; do by_mass+=("$mass kg" "$(name "$mass" 30)"); done
for speed in "${speeds[@]}"; do by_speed+=("$speed m/s" "$(name 0.175 "$speed")"); done
draw "Stress under the blow at 30 m/s" "${deck}_masses.png" "${by_mass[@]}"
draw "Stress under the blow of 0.175 kg" "${deck}_speeds.png" "${by_speed[@]}"
