#!/usr/bin/env bash
# Builds the whole program with gcc and clang for x86-64, AVX2 and AVX-512, as far as they are here, and compares the digests of
# its runs (test_digests.c). Arguments: source folder, folder to build in, CMake, its generator, the launcher of compilers or "".
set -euo pipefail
source=$1 folder=$2 cmake=$3 generator=$4 launcher=$5

[ "$(uname -m)" = x86_64 ] || exit 77
processors=x86-64
if grep -qw avx2 /proc/cpuinfo; then processors+=" x86-64-v3"; fi
if grep -qw avx512vl /proc/cpuinfo; then processors+=" x86-64-v4"; fi

failed=0
for compiler in gcc clang; do
  command -v "$compiler" >/dev/null || continue
  for processor in $processors; do
    build=$folder/$compiler-$processor
    mkdir -p "$build"
    "$cmake" -S "$source" -B "$build" -G "$generator" -DPERILAT_NATIVE=OFF -DCMAKE_C_COMPILER="$compiler" \
      -DCMAKE_C_FLAGS="-march=$processor" -DCMAKE_C_COMPILER_LAUNCHER="$launcher" >"$build/log" 2>&1 &&
      "$cmake" --build "$build" --target generator_run_digests >"$build/log" 2>&1 || { tail -n 20 "$build/log"; exit 1; }
    if (cd "$build/tests" && PERILAT_CC=$compiler PERILAT_PROCESSOR=$processor ./generator_run_digests) >"$build/log" 2>&1; then
      echo "$compiler, $processor: the same bits"
    else
      echo "FAILED: $compiler, $processor"
      tail -n 40 "$build/log"
      failed=1
    fi
  done
done
exit $failed
