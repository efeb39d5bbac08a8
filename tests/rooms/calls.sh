#!/usr/bin/env bash
# Holds the objects to what includes say: a header declares only what its own .c defines, and files do not call each other in
# circles. What calls.txt allows is not told, but what it allows in vain; PERILAT_BLESS=1 takes that out. Arguments: the source
# folder, nm, and a file that lists the objects, one a line.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
sources=$1 nm=$2 objects=$3
[ -x "$nm" ] || { echo "no nm here"; exit 77; }

# "FILE + SYMBOL" for what a file defines, "FILE - SYMBOL" for what it needs; a file is the path of its source without its ending.
# Texts that the build makes C of have no source.
symbols() {
  while IFS= read -r object; do
    file=${object##*.dir/} file=${file#./} file=${file#generated/} file=${file%.c.o}
    [ -e "$sources/$file.c" ] || [ -e "$sources/$file.l" ] || [ -e "$sources/$file.y" ] || continue
    "$nm" "$object" | awk -v file="$file" 'NF == 2 && $1 == "U" { print file, "-", $2 } NF == 3 && $2 ~ /[TDRBC]/ { print file, "+", $3 }'
  done <"$objects"
}

# Files of each circle of the symbols on the standard input, a line each, and below each what calls what (Tarjan 1972).
circles() {
  awk '
    function visit(v, list, count, k, w, n, members) {
      order[v] = low[v] = ++visited
      stack[++depth] = v; on_stack[v] = 1
      count = split(targets[v], list, " ")
      for (k = 1; k <= count; k++) {
        w = list[k]
        if (!(w in order)) { visit(w); if (low[w] < low[v]) low[v] = low[w] }
        else if (on_stack[w] && order[w] < low[v]) low[v] = order[w]
      }
      if (low[v] != order[v]) return
      for (n = 0; ; ) {
        w = stack[depth--]; on_stack[w] = 0; n++
        members = w " " members; ring[w] = v
        if (w == v) break
      }
      if (n > 1) { circle[v] = members }
    }
    $2 == "+" { home[$3] = $1 }
    $2 == "-" { from[++needs] = $1; what[needs] = $3 }
    END {
      for (k = 1; k <= needs; k++) {
        a = from[k]; b = home[what[k]]
        if (b == "" || a == b) continue
        if (calls[a, b] == "") { targets[a] = targets[a] " " b; node[++nodes] = a }
        calls[a, b] = calls[a, b] " " what[k]
      }
      for (k = 1; k <= nodes; k++) if (!(node[k] in order)) visit(node[k])
      for (v in circle) {
        print "circle " circle[v]
        for (pair in calls) {
          split(pair, ends, SUBSEP)
          if (ring[ends[1]] == v && ring[ends[2]] == v) print "calls " ends[1] " " ends[2] calls[pair]
        }
      }
    }'
}

# Functions and data that headers of the folder $1 declare and other files than theirs define, by the symbols in $2: a line
# "HEADER FILE NAMES" for each of these files.
foreign() {
  (cd "$1" && find dsl runtime generator -name '*.h' | LC_ALL=C sort | xargs awk -v table="$2" '
    BEGIN { while ((getline line <table) > 0) if (split(line, f, " ") == 3 && f[2] == "+") home[f[3]] = f[1] }
    function without(text, what) {
      while (match(text, what)) text = substr(text, 1, RSTART - 1) (what ~ /\(/ ? "@" : " ") substr(text, RSTART + RLENGTH)
      return text
    }
    # The statements of a header without comments, bodies and parameters: "int f@".
    function look(header, text, own, count, statement, k, name, files, file) {
      own = header; sub(/\.h$/, "", own)
      text = without(text, "/[*]([^*]|[*]+[^*/])*[*]+/"); gsub(/@/, " ", text)
      text = without(without(text, "[{][^{}]*[}]"), "\\([^()]*\\)")
      count = split(text, statement, ";")
      for (k = 1; k <= count; k++)
        for (text = statement[k]; match(text, /[A-Za-z_][A-Za-z_0-9]*/); ) {
          name = substr(text, RSTART, RLENGTH)
          text = substr(text, RSTART + RLENGTH)
          if ((name in home) && home[name] != own && (text ~ /^ *@/ || statement[k] ~ /^ *extern /)) {
            if (!(home[name] in files)) files[home[name]] = ""
            files[home[name]] = files[home[name]] " " name
          }
        }
      for (file in files) print header, file files[file]
    }
    FNR == 1 { if (header) look(header, text); header = FILENAME; text = ""; continued = 0 }
    continued || /^[ \t]*#/ { continued = /\\$/; next }
    { sub(/\/\/.*/, ""); gsub(/\t/, " "); text = text " " $0 }
    END { if (header) look(header, text) }')
}

# What is wrong with circles and foreign declarations on the standard input, but for those that the list $1 allows; or, when $2
# is `allowed`, lines of a list with those that are needed.
faults() {
  awk -v list="$1" -v allowed="${2:-}" '
    BEGIN {
      while ((getline line <list) > 0) {
        count = split(line, words, " ")
        if (words[1] == "circle") for (k = 2; k <= count; k++) { ring[words[k]] = line; idle[words[k]] = 1 }
        if (words[1] == "declares") idle[words[2] " " words[3]] = 1
      }
    }
    $1 == "circle" {
      new = 0
      for (k = 2; k <= NF; k++) { new = new || ring[$k] == "" || ring[$k] != ring[$2]; delete idle[$k] }
      if (allowed && !new) print
      if (!allowed && new) print "files call each other in a " $0
    }
    $1 == "calls" && new && !allowed { print "  `" $2 "` calls `" $3 "`:" substr($0, length($2 $3) + 8) }
    $1 ~ /\.h$/ {
      known = ($1 " " $2) in idle
      if (allowed && known) print "declares", $1, $2
      if (!allowed && !known) print $1 " declares what " $2 ".c defines:" substr($0, length($1 $2) + 2)
      delete idle[$1 " " $2]
    }
    END { if (!allowed) for (what in idle) print "calls.txt: `" what "` is not needed any more: take it out" }'
}

work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_calls.XXXXXX")
trap 'rm -rf "$work"' EXIT
symbols >"$work/symbols"
[ "$(wc -l <"$work/symbols")" -gt 100 ] || { echo "the objects hold no symbols"; exit 1; }
{ circles; foreign "$sources" "$work/symbols"; } <"$work/symbols" >"$work/found"
if [ -n "${PERILAT_BLESS:-}" ]; then
  { grep '^#' "$here/calls.txt"; faults "$here/calls.txt" allowed <"$work/found" | LC_ALL=C sort; } >"$work/list"
  cp "$work/list" "$here/calls.txt"
fi
found=$(faults "$here/calls.txt" <"$work/found")
[ -z "$found" ] || { echo "$found"; exit 1; }

# The check sees what it is for: a circle of three with a fourth file beside it, a declaration in a wrong place, a list that
# allows too much.
mkdir -p "$work/dsl" "$work/runtime" "$work/generator"
printf '%s\n' 'dsl/a + a' 'dsl/a - b' 'dsl/b + b' 'dsl/b - c' 'dsl/c + c' 'dsl/c - a' 'dsl/d - a' 'dsl/d + d' >"$work/planted"
printf '%s\n' '/* int d(void); */' 'int a(void);' 'static inline int e(void) {' '  return b();' '}' 'int' 'c(int b, int f(void));' \
  'extern int d[3];' >"$work/dsl/a.h"
{ circles; foreign "$work" "$work/planted"; } <"$work/planted" >"$work/found"
printf '%s\n' 'circle dsl/a dsl/b dsl/c' 'declares dsl/a.h dsl/c' 'declares dsl/a.h dsl/d' 'circle dsl/e dsl/f' >"$work/list"
planted=$(faults /dev/null <"$work/found" && faults "$work/list" <"$work/found")
for fault in 'in a circle dsl/a dsl/b dsl/c' '`dsl/c` calls `dsl/a`: a' 'a.h declares what dsl/c.c defines: c' 'dsl/d.c defines: d' \
  '`dsl/e` is not needed' '`dsl/f` is not needed'; do
  grep -qF "$fault" <<<"$planted" || { echo "planted faults are not seen: $fault"; echo "$planted"; exit 1; }
done
[ "$(wc -l <<<"$planted")" = 8 ] || { echo "more is told than was planted:"; echo "$planted"; exit 1; }
echo "headers declare what is theirs, and calls run one way"
