#!/usr/bin/env bash
# README.md shows what the program does: the commands of its first chapter run in their order, and what it prints of them (the
# run of the notched beam, the peak of the changed law, the message for a slip) is, word by word, what they say. Only README.md is to be
# edited when the program says something else. Arguments: source folder, program.
set -euo pipefail
source=$1 program=$2

work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_readme.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*"
  exit 1
}

chapter=$work/chapter
awk '/^## / { within = $0 == "## Five minutes" } within' "$source/README.md" >"$chapter"

# Lines of the chapter's block from the first to the second pattern, without their indentation.
block() {
  awk -v from="$1" -v to="$2" '/^    / && $0 ~ from { on = 1 } on { print substr($0, 5) } on && $0 ~ to { exit }' "$chapter"
}

# Every line of $1 is in $2, in that order; "..." stands for any.
shows() {
  awk 'NR == FNR { if ($0 != "...") line[++lines] = $0; next }
       at < lines && $0 == line[at + 1] { at++ }
       END { if (lines < 3) print "nothing to compare"; else if (at < lines) print line[at + 1] }' "$1" "$2" >"$work/missing"
  [ -s "$work/missing" ] || return 0
  echo "README.md shows"
  cat "$work/missing"
  echo "but the program says"
  cat "$2"
  exit 1
}

mkdir -p "$work/examples/notched_beam" "$work/bin"
cp "$source"/examples/notched_beam/*.nml "$work/examples/notched_beam"
cp -r "$source/models" "$work/models"
ln -s "$program" "$work/bin/perilat"
export PATH=$work/bin:$PATH
unset PERILAT_MODELS

# The equation that takes the place of the one of that name, once the law has been copied.
change_law() {
  local equation
  equation=$(block '! was: ' .)
  [ "$(grep -c '^  eps_mp = ' my_law.plm)" = 1 ] || fail "the law has no single line to change"
  awk -v equation="  $equation" '/^  eps_mp = / { $0 = equation } { print }' ../../models/mplm_bilinear.plm >my_law.plm
}

cd "$work"
commands=0
while IFS= read -r line; do
  commands=$((commands + 1))
  eval "$line" >"$work/said.$commands" 2>&1 || { cat "$work/said.$commands"; fail "$line"; }
  case $line in
    "cp "*) change_law ;;
    "perilat run d3_s6.35.nml") cp "$work/said.$commands" "$work/published" ;;
    "perilat run d3_s6.35.nml "*) cp "$work/said.$commands" "$work/mine" ;;
  esac
done < <(sed -n -E 's/^    ((cd|cp|perilat|\.\/beam) .*)/\1/p' "$chapter")
[ "$commands" -ge 14 ] || fail "only $commands commands"
for made in curve.png crack.png compare.png beam fast.h5 my_own.h5; do
  [ -s "$made" ] || fail "there is no $made"
done

block '^    Notched beam D3' 'ended early' >"$work/shown"
[ "$(wc -l <"$work/shown")" -ge 8 ] || fail "the run of the beam is not shown"
shows "$work/shown" "$work/published"

peak() {
  awk '$1 == "load" && $2 == "largest" { printf "%.2f", $3 / 1000 }' "$1"
}
sentence="The peak rises from $(peak "$work/published") to $(peak "$work/mine") kN."
grep -qF "$sentence" "$chapter" || fail "README.md does not say: $sentence"

# The slip of the message stands in the line that it shows.
block 'bad\.plm:' 'hint:' >"$work/shown"
number=$(sed -n '1s/^bad\.plm:\([0-9]*\):.*/\1/p' "$work/shown")
slip=$(sed -n "2s/^ *$number | //p" "$work/shown")
awk -v number="$number" -v slip="$slip" 'NR == number { $0 = slip } { print }' ../../models/mplm_bilinear.plm >bad.plm
[ "$(diff bad.plm ../../models/mplm_bilinear.plm | grep -c '^<')" = 1 ] || fail "the slip is not one line"
! perilat check bad.plm >"$work/said" 2>&1 || fail "the slip is not found"
shows "$work/shown" "$work/said"
echo "$commands commands, the run, the peaks and the message are as README.md shows them"
