#!/usr/bin/env bash
# Results as programs of others see them: five small specimens are torn, a crack runs through a mesh, and a script looks at what has been written. Skipped
# where that program is not installed. Arguments: program, script, Debian packages that it needs, Python module to ask for.
set -euo pipefail
program=$1 script=$2 packages=$3 module=$4
here=$(cd "$(dirname "$0")" && pwd)

python=
for candidate in python3 /usr/bin/python3; do
  if command -v "$candidate" >/dev/null && "$candidate" -c "import $module" 2>/dev/null; then
    python=$candidate
    break
  fi
done
[ -n "$python" ] || { echo "skipped: $packages not installed"; exit 77; }
screen=()
if [ "$module" = paraview ] && [ -z "${DISPLAY:-}" ]; then
  command -v xvfb-run >/dev/null || { echo "skipped: $packages not installed"; exit 77; }
  screen=(xvfb-run -a -s "-screen 0 1024x768x24 -noreset") # or it starts anew when a first window is closed
fi

export PYTHONDONTWRITEBYTECODE=1
work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_clients.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
for deck in plane space irregular bars linked; do
  "$program" run "$here/$deck.nml" >"$deck.said" 2>&1 || { cat "$deck.said"; exit 1; }
  for frame in 0 1 2 3; do
    "$program" export "$deck.h5" --frame $frame -o "${deck}_particles_$frame.csv" >/dev/null
    "$program" export "$deck.h5" --frame $frame --bonds -o "${deck}_bonds_$frame.csv" >/dev/null
  done
done
"$program" run "$here/mesh.nml" >mesh.said 2>&1 || { cat mesh.said; exit 1; }
"$program" export mesh.h5 --cracks slit -o mesh_slit.csv >/dev/null
for frame in 0 1 2 3; do
  "$program" export mesh.h5 --frame $frame -o "mesh_particles_$frame.csv" >/dev/null
done
"${screen[@]}" "$python" "$here/$script" "$work"
