#!/usr/bin/env bash
# Every mutant of this folder says what is wrong, applies to the sources as they are, and names tests that there are.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
faults=0

fault() {
  echo "$1" >&2
  faults=$((faults + 1))
}

for file in "$here"/*.patch; do
  name=$(basename "$file")
  head -n 1 "$file" | grep -q '^[^-].*\.$' || fault "$name: its first line does not say what is wrong"
  patch --dry-run -s -f -F0 -p1 -d "$root" <"$file" || fault "$name: does not apply"
  for test in $(sed -n 's/^Tests: //p' "$file"); do
    [ -f "$root/tests/$(sed 's/[.]\([^.]*\)$/.test_\1/; s/[.]/\//g' <<<"$test").c" ] || fault "$name: there is no test $test"
  done
done
[ "$faults" -eq 0 ]
