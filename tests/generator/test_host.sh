#!/usr/bin/env bash
# The programs of runtime/HOST.md, as C and as C++: they print what the page shows, and for each law what `perilat drive` says of
# the same bond, or the same family. Arguments: source folder, program, C compiler.
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
# The page's parts: bonds, a family alone, a point.
awk '{ part = /^## A family alone/ ? "family" : /^## A point of a continuum/ ? "point" : part ? part : "host"; print > (part ".md") }' "$source/runtime/HOST.md"
block() { awk -v from="\`\`\`$1" '$0 == from { on = 1; next } /^```/ { on = 0 } on' "$2.md"; }
cpp=${CXX:-c++}
command -v "$cpp" >/dev/null || echo "no C++ compiler: the programs were not tried in C++"

# What a part does and shows, in so many lines; its program in both languages.
try() {
  block c "$1" >"$1.c"
  block sh "$1" >commands.sh
  awk '/^```/ { code = !code } !code && sub(/^    /, "")' "$1.md" >shown
  [ "$(wc -l <"$1.c")" -gt 40 ] && [ "$(wc -l <shown)" = "$2" ] || fail "the page has another program, or shows something else"
  bash -e commands.sh >said 2>&1 || { cat said; fail "the commands of the page"; }
  grep -v '^written ' said | diff shown - || fail "the program says something else than the page shows"
  strict="-Wall -Wextra -Werror -I $source $1.c -lm"
  eval "\"$compiler\" -std=c11 $strict -o $1_c" || fail "the program in C11"
  ! command -v "$cpp" >/dev/null || eval "\"$cpp\" -x c++ -std=c++17 $strict -o $1_cpp" || fail "the program in C++17"
}
try host 5
try family 1
try point 4

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

# The family and the drive of the same strain, and the solid of lps: they differ by as much as the strain turns bonds.
same_stress() {
  cat >drive.nml <<END
&simulation  steps = 1  /
&particle    lattice = 'hexagonal'  spacing = '10 mm'  thickness = '100 mm'  /
&material    model = '$1'  /
&path        quantity = 'strain_xx'  times = 0, '1 s'  values = 0, 1$2  /
&path        quantity = 'strain_yy'  times = 0, '1 s'  values = 0, '-0.5$2'  /
&path        quantity = 'strain_xy'  times = 0, '1 s'  values = 0, '0.7$2'  /
&output      csv = 'drive.csv'  /
END
  perilat drive drive.nml >log 2>&1 || { cat log; fail "the drive of $1"; }
  for host in family_c family_cpp; do
    [ -x "$host" ] || continue
    "./$host" ./law.so "1$2" "-0.5$2" "0.7$2" | tr -d , >family.txt || fail "$host with $1"
    awk -F, -v law="$1" -v strain="1$2" '
      function off(what, is, should) {
        gap = (is - should)/largest; if (gap < 0) gap = -gap
        if (!(gap < 3*strain)) { print law ", " what ": " is ", not " should; bad = 1 }
      }
      FNR == NR { split($0, w, " "); host["xx"] = w[2]; host["yy"] = w[4]; host["xy"] = w[6]; next }
      !header { header = 1; for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); place[$k] = k }; next }
      { for (c in host) drive[c] = $place["stress_" c] }
      END {
        E = 25e9; nu = 0.2; stiff = E/(1 - nu^2)*strain
        solid["xx"] = stiff*(1 - 0.5*nu); solid["yy"] = stiff*(-0.5 + nu); solid["xy"] = stiff*(1 - nu)*0.7
        largest = drive["xx"]; if (!(largest > 0)) { print "no stress"; exit 1 }
        for (c in host) { off("drive", host[c], drive[c]); if (law == "lps") off("solid", host[c], solid[c]) }
        exit bad
      }' family.txt drive.csv || fail "$host and the drive of $1"
  done
}
for law in lps pmb; do
  perilat build "FOLDER/models/$law.plm" --for irregular -o law.so >log 2>&1 || { cat log; fail "building $law"; }
  for strain in e-4 e-6 e-9; do
    same_stress "$law" "$strain"
  done
done

# A point that hardens, strained and unloaded, and the drive of the same.
perilat build FOLDER/tests/generator/laws/hardening_point.plm --for plane_strain -o law.so >log 2>&1 || { cat log; fail "building the point"; }
cat >drive.nml <<END
&simulation  steps = 4  /
&point       setting = 'plane_strain'  /
&material    model = 'FOLDER/tests/generator/laws/hardening_point.plm'  /
&path        quantity = 'strain_xx'  times = 0, '2 s', '4 s'  values = 0, 6e-3, 0  /
&path        quantity = 'strain_yy'  times = 0, '2 s', '4 s'  values = 0, '-2e-3', 0  /
&path        quantity = 'strain_xy'  times = 0, '2 s', '4 s'  values = 0, 1e-3, 0  /
&output      csv = 'drive.csv'  /
END
perilat drive drive.nml >log 2>&1 || { cat log; fail "the drive of the point"; }
for host in point_c point_cpp; do
  [ -x "$host" ] || continue
  "./$host" ./law.so 6e-3 -2e-3 1e-3 | sed 's/ Pa$//; s/, /,/g' >points.txt
  awk -F, '
    FNR == NR { for (k = 1; k <= 4; k++) { split($k, w, " "); host[FNR, w[1]] = w[2] } rows = FNR; next }
    !header { header = 1; for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); place[$k] = k }; next }
    line++ == 0 { next } # at rest
    { for (c in place) if (((line - 1), c) in host) {
        gap = host[line - 1, c] - $place[c]; if (gap < 0) gap = -gap; compared++
        if (gap > (c ~ /stress/ ? 1 : 1e-9)) { print c ": " host[line - 1, c] ", not " $place[c]; bad = 1 } } }
    END { if (rows != 4 || compared != 16) { print rows " lines, " compared " compared"; bad = 1 } exit bad }
  ' points.txt drive.csv || fail "$host and the drive of the point"
done
refused ./point_c ./cohesive.so 0 0 0 && grep -q 'no law of a continuum' log || fail "$(cat log)"

refused ./family_c ./cohesive.so 0 0 0 && grep -q 'no law of single families' log || fail "$(cat log)"
refused ./family_c ./families.so 0 0 0 && grep -q 'no law of single families' log || fail "$(cat log)"
refused perilat build FOLDER/models/cohesive.plm --for irregular && grep -q 'is not for `irregular`: its line `for` names' log || fail "$(cat log)"
refused perilat build FOLDER/models/lps.plm --for space,plane_stress && grep -q 'takes one setting' log || fail "$(cat log)"
