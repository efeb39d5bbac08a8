#!/usr/bin/env bash
# What the libraries take from C's mathematical library and from LAPACK: nothing whose bits depend on the version, the processor
# or the compiler. Arguments: C compiler, nm, libraries.
set -euo pipefail
compiler=$1 nm=$2
shift 2

# Exact, or rounded once as IEEE 754 asks.
exact="sqrt fabs copysign floor ceil trunc rint nearbyint round lrint llrint lround llround fma fmod remainder nextafter ldexp frexp
scalbn modf __muldc3"
# Elastic constants that are printed, the stable step, which is rounded, uncertainties of fits, and static solutions.
lapack="dpotrf_ dpotri_ dgesv_ dstev_ zheev_ dgesvd_ dpbtrf_ dpbtrs_"

library=$("$compiler" -print-file-name=libm.so.6)
[ -f "$library" ] || { echo "there is no libm.so.6 to read the names of functions from"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/perilat_symbols.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$nm" -D --defined-only "$library" | awk '{ sub(/@.*/, "", $3); print $3 }' | sort -u >"$work/mathematical"

# Those of an object or library that may have other bits elsewhere, each with its file.
strays() {
  "$nm" -A -u "$1" | awk -v mathematical="$work/mathematical" -v allowed="$exact $lapack" '
    BEGIN {
      while ((getline name <mathematical) > 0) known[name] = 1
      count = split(allowed, names)
      for (k = 1; k <= count; k++) good[names[k]] = 1
    }
    !($NF in good) && (($NF in known) || $NF ~ /^_ZGV|^__(mul|div)[sdxt]c3$|^__powi[sdxt]f2$|^[sdcz][a-z0-9]+_$/) {
      file = $1
      sub(/:$/, "", file)
      sub(/.*[:\/]/, "", file)
      print file, $NF
    }'
}

# The test sees what it is for.
printf '#include <math.h>\ndouble f(double x) { return exp(x) + fmin(x, 1) + sqrt(x); }\n' >"$work/probe.c"
"$compiler" -c "$work/probe.c" -o "$work/probe.o"
[ "$(strays "$work/probe.o" | awk '{ print $2 }' | sort | tr '\n' ' ')" = "exp fmin " ] || {
  echo "FAILED: exp and fmin are not seen in a file that has them"
  exit 1
}

found=$(for library in "$@"; do strays "$library"; done)
if [ -n "$found" ]; then
  echo "FAILED: bits of these differ from processor to processor; take those of dsl/base/elementary.h"
  echo "$found"
  exit 1
fi
echo "nothing but exact functions in $# libraries"
