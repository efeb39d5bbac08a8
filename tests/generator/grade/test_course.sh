#!/usr/bin/env bash
# usage: test_course.sh SOURCE PERILAT with|without: every exercise of the course put to the test, those with runs of specimens or
# those without: solution and equal forms get all points, every known wrong answer loses some and is known by its sentence.
set -u
source=$1 perilat=$2 runs=$3
failed=0
for exercise in "$source"/examples/course/*/exercise.nml; do
  [ -e "$exercise" ] || continue
  folder=$(dirname "$exercise")
  [ -e "$folder/teacher" ] || continue
  if grep -q "kind *= *'run'" "$exercise"; then has=with; else has=without; fi
  [ $has = "$runs" ] || continue
  if ! "$perilat" grade "$folder" --self-test > "said_$runs" 2>&1; then
    echo "perilat grade $folder --self-test"
    cat "said_$runs"
    failed=1
  fi
done
rm -f "said_$runs"
exit $failed
