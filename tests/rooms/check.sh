#!/usr/bin/env bash
# Holds the sources to the list of rooms: every file stands in one, includes only its own room and
# those above it, and no room is too full; that some test includes each header of the runtime; and
# that what the map names is there. Arguments: the source folder.
set -euo pipefail
list=$(cd "$(dirname "$0")" && pwd)/rooms.txt

# One line for each fault of the sources in folder $1.
faults() {
  (cd "$1" && grep -n '^#include "' -r dsl runtime generator --include='*.[chyl]' || true) | awk -v list="$list" '
    function room_of(path) { sub(/\/[^\/]*$/, "", path); return path }
    BEGIN {
      while ((getline line <list) > 0) {
        split(line, words, " ")
        if (words[1] != "" && words[1] != "#") place[words[1]] = ++rooms
      }
    }
    {
      split($0, part, ":")
      file = part[1]
      here = room_of(file)
      target = $0
      sub(/^[^"]*"/, "", target)
      sub(/".*/, "", target)
      there = room_of(target)
      at = file ":" part[2] ": "
      if (!(here in place)) print at "`" here "` is no room: see tests/rooms/rooms.txt"
      else if (!(there in place)) print at "`" target "` stands in no room: see tests/rooms/rooms.txt"
      else if (place[there] > place[here])
        print at "`" target "` stands in a room below `" here "`: a file includes its own room and those above it in tests/rooms/rooms.txt"
    }'
  (cd "$1" && find dsl runtime generator -name '*.[chyl]') | sed 's/\.[chyl]$//' | sort -u | sed 's/\/[^/]*$//' | sort | uniq -c |
    awk '$1 > 20 { print $2 ": " $1 " modules; a room holds 20" }'
}

# One line for each header of the runtime of folder $1 that no test includes.
untested() {
  (cd "$1" && LC_ALL=C comm -23 <(find runtime -name '*.h' | LC_ALL=C sort) \
    <(grep -rhoE '^#include "runtime/[^"]*"' tests --include='*.[ch]' --exclude-dir=fuzz --exclude-dir=benchmark | cut -d'"' -f2 | LC_ALL=C sort -u)) |
    sed 's/$/: no test includes it: write one in tests\//'
}

# One line for each file that the map in $2 names by its folder and that is not in folder $1.
misnamed() {
  grep -oE '`(dsl|runtime|generator|models)/[^` ]*`' "$2" | tr -d '`' | sort -u | while IFS= read -r name; do
    case $name in *NAME*) continue ;; esac
    (cd "$1" && compgen -G "$name" >/dev/null) || echo "tests/rooms/README.md: there is no \`$name\`"
  done
}

sources=$(cd "$1" && pwd) here=$(cd "$(dirname "$0")" && pwd)
found=$(faults "$sources"; untested "$sources"; misnamed "$sources" "$here/README.md")
[ -z "$found" ] || { echo "$found"; exit 1; }

# The check sees what it is for.
work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_rooms.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/dsl/base" "$work/runtime/deck" "$work/generator/attic"
echo '#include "runtime/deck/deck.h"' >"$work/dsl/base/arena.c"
echo '#include "dsl/base/arena.h"' >"$work/runtime/deck/deck.c"
echo '#include "dsl/base/arena.h"' >"$work/generator/attic/old.c"
for k in $(seq 21); do : >"$work/runtime/deck/m$k.c"; done
planted=$(faults "$work")
[ "$(echo "$planted" | wc -l)" = 3 ] && grep -q 'dsl/base/arena.c:1: .*below' <<<"$planted" && grep -q attic <<<"$planted" &&
  grep -q 'runtime/deck: 22 modules' <<<"$planted" || { echo "planted faults are not seen:"; echo "$planted"; exit 1; }
mkdir -p "$work/tests/runtime/deck"
touch "$work/runtime/deck/"{one,two}.h
echo '#include "runtime/deck/one.h"' >"$work/tests/runtime/deck/test_one.c"
planted=$(untested "$work")
[ "$planted" = 'runtime/deck/two.h: no test includes it: write one in tests/' ] || { echo "planted faults are not seen:"; echo "$planted"; exit 1; }
printf '`runtime/deck/one.h`, `runtime/deck/t*.h`, `runtime/deck`, `runtime/deck/four.h`\n' >"$work/map"
[ "$(misnamed "$work" "$work/map")" = 'tests/rooms/README.md: there is no `runtime/deck/four.h`' ] ||
  { echo "a name in vain is not seen"; exit 1; }
echo "all files stand in their rooms"
