#!/usr/bin/env bash
# The program of runtime/HOST.md, as C and as C++: it prints what the page shows, and for each law what `perilat drive` says of
# the same bond. Arguments: source folder, program, C compiler.
set -euo pipefail
source=$1 program=$2 compiler=$3

work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_host.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*"
  exit 1
}

cd "$work"
ln -s "$source" FOLDER
ln -s "$program" perilat
export PATH=$work:$PATH
page=$source/runtime/HOST.md
block() { awk -v from="\`\`\`$1" '$0 == from { on = 1; next } /^```/ { on = 0 } on' "$page"; }

# What the page does and shows
block c >host.c
block sh >commands.sh
awk '/^```/ { code = !code } !code && sub(/^    /, "")' "$page" >shown
[ "$(wc -l <host.c)" -gt 40 ] && [ "$(wc -l <shown)" = 5 ] || fail "the page has another program, or shows something else"
bash -e commands.sh >said 2>&1 || { cat said; fail "the commands of the page"; }
grep -v '^written ' said | diff shown - || fail "the program says something else than the page shows"

strict="-Wall -Wextra -Werror -I $source host.c -lm"
eval "\"$compiler\" -std=c11 $strict -o host_c" || fail "the program in C11"
cpp=${CXX:-c++}
if command -v "$cpp" >/dev/null; then
  eval "\"$cpp\" -x c++ -std=c++17 $strict -o host_cpp" || fail "the program in C++17"
else
  echo "no C++ compiler: the program was not tried in C++"
fi

# The columns of the host's lines in the table of the drive: stretch, N, and the law's fields. A difference counts by the largest value.
cat >same.awk <<'END'
BEGIN { FS = "," }
FNR == 1 { file++ }
file == 1 { for (k = 1; k <= NF; k++) { split($k, w, " "); name[k] = w[1]; host[FNR, k] = w[2] }; rows = FNR; columns = NF; next }
/^#/ { next }
!header { header = 1; for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); place[$k] = k }; next }
{
  line++
  for (k = 1; k <= columns; k++) {
    if (!(name[k] in place)) { print "no column " name[k]; bad = 1; exit }
    x = $place[name[k]]; gap = x - host[line, k]
    if (gap < 0) gap = -gap; if (x < 0) x = -x
    if (gap > worst[k]) worst[k] = gap; if (x > most[k]) most[k] = x
  }
}
END {
  if (line != rows || rows < 10) { print rows " lines of the host, " line " of the drive"; bad = 1 }
  for (k = 1; k <= columns; k++) {
    if (most[k] == 0) { print name[k] " is 0 throughout"; bad = 1 }
    if (worst[k] > 1e-9 * most[k]) { print name[k] " differs by " worst[k]; bad = 1 }
  }
  exit bad
}
END

# A law, how far it is drawn, one of its parameters with a value in SI.
compare() {
  cat >drive.nml <<END
&simulation  steps = 20  /
&bond        spacing = '5 mm'  thickness = '100 mm'  /
&material    model = '$1'  ${3%=*} = ${3#*=}  /
&path        quantity = 'stretch'  times = 0, '1 s', '2 s'  values = 0, $2, 0  /
&output      csv = 'drive.csv'  /
END
  perilat build "FOLDER/models/$1.plm" -o law.so >log 2>&1 || { cat log; fail "building $1"; }
  perilat drive drive.nml >log 2>&1 || { cat log; fail "the drive of $1"; }
  for host in host_c host_cpp; do
    [ -x "$host" ] || continue
    "./$host" ./law.so "$2" 10 "$3" >host.txt || fail "$host with $1"
    awk -f same.awk <(sed 's/, /,/g' host.txt) drive.csv || fail "$host and the drive of $1"
  done
}
compare cohesive 3e-3 f_t=2e6
compare mplm_bilinear 5e-3 S_t=1e-4 # micropolar, with rate terms
compare elastic_central -1e-3 E=2e10

# Kernels made with a later header, whose records have more behind what this host knows, and with an earlier one, whose table
# ends before the last member.
perilat check FOLDER/models/cohesive.plm --dump=c >now.c
sed 's/^} pl_\(law\|strip\|bond_class\|states\);$/  double appended[4];\n&/' now.c >later.c
sed 's/^  const void \*context;.*//' now.c >earlier.c
[ "$(diff now.c later.c | grep -c '^> .*appended')" = 4 ] && [ "$(diff now.c earlier.c | grep -c '^<')" = 1 ] || fail "the records"
./host_c ./cohesive.so 3e-3 10 f_t=2e6 >expected
for age in later earlier; do
  eval "\"$compiler\" -std=gnu11 -O1 -fPIC -shared -ffp-contract=off $age.c -o $age.so -lm" || fail "the $age kernel"
  ./host_c "./$age.so" 3e-3 10 f_t=2e6 | diff expected - || fail "the $age kernel says something else"
done

# What the host cannot do it says.
refused() { ! "$@" >log 2>&1 || fail "not refused: $*"; }
refused ./host_c ./law.so 1e-3 10 E=-1 && grep -q 'E = -1: out of bounds' log || fail "$(cat log)"
refused ./host_c ./law.so 1e-3 10 F=1 && grep -q 'no parameter' log || fail "$(cat log)"
perilat build FOLDER/models/lps.plm -o families.so >log 2>&1 || { cat log; fail "building lps"; }
refused ./host_c ./families.so 1e-3 10 && grep -q 'no law of bonds' log || fail "$(cat log)"
