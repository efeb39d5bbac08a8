#!/usr/bin/env bash
# Do the tests see bugs? Builds each mutant of this folder (NAME.patch) in a copy of the sources, runs the tests until one fails,
# and ends with `survivors N of M`. Arguments: names of mutants; all when none. With --named first only the tests that mutants
# name are run. README.md says more.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
work=${PERILAT_MUTANTS:-${TMPDIR:-/tmp}/perilat-mutants}
jobs=${PERILAT_JOBS:-$(nproc)}
copy=$work/source build=$work/build log=$work/log
mkdir -p "$copy" "$build"

give_up() {
  echo "$1" >&2
  [ -s "$log" ] && tail -n 40 "$log" >&2
  exit 1
}

# Files that differ are copied, so that only they are built again.
take_copy() {
  local file
  (cd "$root" && find . -path './build*' -prune -o -path ./.git -prune -o -type f -print) >"$work/files"
  while IFS= read -r file; do
    cmp -s "$root/$file" "$copy/$file" || install -D -p -T "$root/$file" "$copy/$file" && touch "$copy/$file"
  done <"$work/files"
  (cd "$copy" && find . -type f -print) | grep -vxFf "$work/files" | (cd "$copy" && xargs -r -d '\n' rm -f) || true
}

configure() {
  local launcher=()
  command -v ccache >/dev/null && launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache)
  cmake -S "$copy" -B "$build" -G Ninja "${launcher[@]}" >"$log" 2>&1
}

make_targets() { cmake --build "$build" -j "$jobs" --target "$@" >"$log" 2>&1; }

# run_tests OPTION...: the first test that fails, or nothing.
run_tests() {
  ctest --test-dir "$build" -j "$jobs" --stop-on-failure --no-tests=error "$@" >"$log" 2>&1 && return
  sed -n 's/^\t *[0-9]* - \([^ ]*\) (\(.*\)).*/\1 (\2)/p' "$log" | head -n 1 | grep . ||
    give_up "ctest $* says nothing of a test that fails"
}

# Programs of the tests that a mutant names are built and asked first.
named_killer() {
  local tests=$1 programs
  [ -n "$tests" ] || return 0
  programs=$(tr '.' '_' <<<"$tests")
  make_targets perilat $programs || give_up "$name does not build"
  run_tests -R "^($(tr ' ' '|' <<<"$tests"))\$"
}

killer_of() {
  local killer
  killer=$(named_killer "$(sed -n 's/^Tests: //p' "$here/$name.patch")")
  if [ -z "$killer" ] && ! $named_only; then
    make_targets all || give_up "$name does not build"
    killer=$(run_tests -L fast)
  fi
  if [ -z "$killer" ] && ! $named_only; then
    killer=$(run_tests -LE 'fast|long')
  fi
  echo "$killer"
}

turn() { patch -s -f -F0 -p1 -d "$copy" "$@" <"$here/$name.patch" >"$log" 2>&1; }

named_only=false
if [ "${1:-}" = --named ]; then
  named_only=true
  shift
fi
names=("$@")
[ ${#names[@]} -gt 0 ] || mapfile -t names < <(cd "$here" && ls -- *.patch | sed 's/\.patch$//')
take_copy
configure || give_up "the sources cannot be configured"
survivors=0 killers=()
for name in "${names[@]}"; do
  [ -f "$here/$name.patch" ] || give_up "there is no mutant $name"
  turn || give_up "$name does not apply"
  killer=$(killer_of) || exit 1
  turn -R || give_up "$name cannot be taken back"
  if [ -n "$killer" ]; then
    echo "$name: killed by $killer"
    killers+=("${killer%% *}")
  else
    echo "$name: SURVIVED"
    survivors=$((survivors + 1))
  fi
done

# What fails without a mutant, too, has killed none.
if [ ${#killers[@]} -gt 0 ]; then
  mapfile -t killers < <(printf '%s\n' "${killers[@]}" | sort -u)
  make_targets all || give_up "the sources do not build"
  killer=$(run_tests -R "^($(paste -sd '|' <(printf '%s\n' "${killers[@]}")))\$")
  [ -z "$killer" ] || give_up "$killer fails without a mutant, too"
fi
echo "survivors $survivors of ${#names[@]}"
