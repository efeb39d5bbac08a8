#!/usr/bin/env bash
# What the pages of the course say is so: the first fifteen minutes, word by word; what starters still ask for; minutes, and how many
# wrong laws there are; the commands of the tasks, in the folders that students get; the numbers of 07_time_step beside perilat's own.
# Arguments: source folder, program.
set -euo pipefail
course=$1/examples/course program=$2

work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_course.XXXXXX")
trap 'rm -rf "$work"' EXIT
faults=0
fault() {
  echo "FAULT: $*"
  faults=$((faults + 1))
}

# The first fifteen minutes: the messages that README.md shows are those of the steps it tells.
cp -r "$course/01_one_bond" "$work/01"
rm -rf "$work/01/teacher"
cd "$work/01"
said() { # $1: formula of EA, $2: of N; what check says goes to $work/said
  sed "s/constant EA = ?/constant EA = $1/; s/force N = ?/force N = $2/" starter.plm >answer.plm
  "$program" check answer.plm >"$work/said" 2>&1 || true
}
shown() { grep -F "$1" "$course/README.md" | sed "s/^ *//" >"$work/shown" || true; }
holds() { # the line of README.md with $1 is a line of what was said
  shown "$1"
  [ "$(wc -l <"$work/shown")" = 1 ] || fault "README.md has no single line with: $1"
  grep -qxF "$(cat "$work/shown")" "$work/said" || fault "README.md shows: $(cat "$work/shown"), but the program says: $(head -3 "$work/said")"
}
said '?' '?'
holds 'the constant `EA` is still to be written'
said 'E*s' 'EA*stretch'
holds '`force N` must be a force (N), but'
said 'E*s*t' 'EA*stretch'
grep -q 'no errors' "$work/said" || fault "E*s*t is refused: $(cat "$work/said")"
if "$program" drive answer.plm public.nml >"$work/said" 2>&1; then fault "E*s*t passes the public path"; fi
grep -q '^FAIL' "$work/said" || fault "the public path does not say what is missed"
cd "$work"

# A starter reads, but for what is still to be written; only 02_patch_test has slips in units, four of them.
for starter in "$course"/*/starter.plm; do
  folder=$(basename "$(dirname "$starter")")
  "$program" check "$starter" >"$work/said" 2>&1 || true
  grep -q '\[hole\]' "$work/said" || fault "$folder: its starter has nothing to write"
  others=$(grep ': error: ' "$work/said" | grep -vc '\[hole\]' || true)
  slips=0
  [ "$folder" = 02_patch_test ] && slips=4
  [ "$others" = "$slips" ] || fault "$folder: its starter has $others errors beside what is to be written: $(cat "$work/said")"
  # what describes the law is true of a finished one, too
  if grep '^!>' "$starter" | grep -q 'written'; then fault "$folder: its description says what is to be written"; fi
  grep -q '^model answer$' "$starter" || fault "$folder: the law of its starter is not called answer"
done

# Public expectations are rounded; that the solution's numbers are not, a task says.
for exercise in "$course"/*/exercise.nml; do
  folder=$(basename "$(dirname "$exercise")")
  grep -q "'sample'\|'reference'" "$exercise" || continue
  grep -q 'compared to six digits' "$course/$folder/task.md" || fault "$folder: its task does not say how exactly a law is compared"
done

# Each task: how long it takes, where words are written, which file is handed in and how it is marked.
for exercise in "$course"/*/exercise.nml; do
  folder=$(basename "$(dirname "$exercise")")
  task=$course/$folder/task.md
  handed=answer.plm
  [ -e "$course/$folder/starter.txt" ] && handed=answers.txt
  minutes=$(sed -n 's/.*minutes = \([0-9]*\).*/\1/p' "$exercise")
  grep -q "^\*$minutes minutes\. " "$task" || fault "$folder: its task does not say that it takes $minutes minutes"
  grep -q "^    perilat grade \. $handed" "$task" || fault "$folder: its task does not say how $handed is marked"
  grep -q "(10 points, read by your teacher; .*\`$handed\`" "$task" || fault "$folder: its task does not say where words are written"
  named=$(grep -n "named \`$handed\`\|name \`$handed\`" "$task" | head -1 | cut -d: -f1)
  used=$(grep -n "^    perilat .*$handed" "$task" | head -1 | cut -d: -f1)
  [ -n "$named" ] && [ "$named" -lt "$used" ] || fault "$folder: its task uses $handed before it says what that is"
done

# Minutes of task and table, and how many wrong laws the table tells.
for exercise in "$course"/*/exercise.nml; do
  folder=$(basename "$(dirname "$exercise")")
  minutes=$(sed -n 's/.*minutes = \([0-9]*\).*/\1/p' "$exercise")
  grep -qF "]($folder/task.md) | $minutes |" "$course/README.md" || fault "README.md: $folder does not take $minutes minutes"
  wrong=$(find "$course/$folder/teacher/wrong" -type f 2>/dev/null | wc -l)
  [ "$wrong" = 0 ] || grep -qF "]($folder/task.md) | $minutes | $wrong |" "$course/TEACHING.md" ||
    fault "TEACHING.md: $folder does not have $minutes minutes and $wrong wrong laws"
done

# What students get: nothing that is the teacher's. With the solution as their answer all that the task tells them to do works there.
for folder in 01_one_bond 02_patch_test 03_moments 04_fracture_energy 05_memory 06_damping 07_time_step 08_plastic_bar 09_family; do
  "$program" grade "$course/$folder" --publish "$work/$folder" >"$work/said" 2>&1 || fault "$folder is not published: $(cat "$work/said")"
  [ ! -e "$work/$folder/teacher" ] || fault "$folder: the teacher's folder is published"
  cd "$work/$folder"
  cp "$course/$folder"/teacher/solution.plm answer.plm 2>/dev/null && printf '! In words: it is so.\n' >>answer.plm || cp "$course/$folder/teacher/solution.txt" answers.txt
  commands=$(sed -n 's/^    \(perilat .*\)/\1/p' task.md | sed 's/   *[^ ].*//')
  [ "$(wc -l <<<"$commands")" -ge 3 ] || fault "$folder: its task tells of less than three commands"
  while IFS= read -r line; do
    expected=0
    [[ $line == *"step='2.1 us'"* ]] && expected=1 # the task says that it is refused
    status=0
    eval "${line/#perilat/\"\$program\"}" >"$work/said" 2>&1 || status=$?
    [ $status = $expected ] || fault "$folder: $line ends with $status: $(tail -3 "$work/said")"
    case $line in "perilat grade"*) grep -q 'judged by the teacher' "$work/said" || fault "$folder: nothing is hidden" ;; esac
  done <<<"$commands"
  cd "$work"
done

# The numbers of 07_time_step are those that perilat finds. $1: name in solution.txt; $2: of the law; then options of info
solution=$course/07_time_step/teacher/solution.txt
value_of() { sed -n "s/^$1 *= *\([0-9.e+-]*\).*/\1/p" "$solution"; }
close() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > 0 && b > 0 && (a - b)^2 < (2e-5*b)^2) }'; }
step_is() {
  local name=$1
  shift
  local found
  found=$("$program" info "$@" | sed -n 's/.*stable step *\([0-9.e+-]*\) us.*/\1/p')
  close "$(value_of "$name")" "$found" || fault "07_time_step: $name is $(value_of "$name"), but perilat says $found us"
}
step_is step_at_nu_0 elastic_micropolar --set nu=0
step_is step_at_nu_fifth elastic_micropolar --set nu=0.2
step_is step_at_nu_third elastic_micropolar --set nu=0.33333333333
step_is step_at_5_mm elastic_micropolar --set nu=0.2 --spacing '5 mm'
step_is step_with_dashpots "$course/06_damping/teacher/solution.plm"
change=$(value_of nu_of_change)
for side in -1 1; do
  mode=$("$program" info elastic_micropolar --set nu="$(awk -v n="$change" -v d="$side" 'BEGIN { printf "%.6f", n + d*1e-5 }')" | sed -n 's/.*us (\([a-z]*\) mode.*/\1/p')
  [ "$mode" = "$([ "$side" = 1 ] && echo translation || echo rotation)" ] || fault "07_time_step: at nu_of_change $side e-5 the $mode mode rules"
done

[ "$faults" = 0 ] && echo "the pages of the course hold"
exit $((faults > 0))
