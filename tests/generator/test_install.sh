#!/usr/bin/env bash
# Installs into a folder of its own and works from there: laws by name, a run, a solver, the public headers, programs in C and
# C++ by CMake and by pkg-config. Arguments: build folder, source folder, C compiler, CMake, its generator, and the program
# that it builds with.
set -euo pipefail
build=$1 source=$2 compiler=$3 cmake=$4 generator=$5 make_program=$6

work=$(mktemp -d "${TMPDIR:-/tmp}/perilat install.XXXXXX") # with a blank
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}
trap 'echo "FAILED: line $LINENO" >&2' ERR

"$cmake" --install "$build" --prefix "$work/first place" >"$work/log"
mv "$work/first place" "$work/prefix" # what is installed may be moved
prefix=$work/prefix
perilat=$prefix/bin/perilat
export PERILAT_CACHE=$work/cache
unset PERILAT_MODELS
mkdir "$work/elsewhere"
cd "$work/elsewhere"

# A build folder may stand anywhere.
"$cmake" -S "$source" -B "$work/outside" -G "$generator" -DCMAKE_MAKE_PROGRAM="$make_program" -DCMAKE_C_COMPILER="$compiler" \
  -DBUILD_TESTING=OFF >"$work/log" 2>&1 || { cat "$work/log"; fail "configuring a build folder outside of the source folder"; }
cp "$build/perilat" "$work/outside/"
"$work/outside/perilat" check elastic_central | grep -q 'no errors' || fail "the laws of a build folder outside of the source folder"

# Nothing that is installed knows the folders it came from: no text, no program, no library.
if grep -r -l -a -F -e "$source" -e "$build" "$prefix"; then
  fail "these files name the source or build folder"
fi

"$perilat" --version | grep -q '^perilat [0-9]'
for law in "$source"/models/*.plm; do
  "$perilat" check "$(basename "$law" .plm)" | grep -q 'no errors'
done
"$perilat" drive "$prefix/share/perilat/models/drives/elastic_central.nml" | grep -q 'expectations hold'
# Every link of the documentation leads somewhere.
pages=0
while IFS= read -r page; do
  pages=$((pages + 1))
  { grep -o '](\([^)]*\))' "$page" || true; } | sed 's/^](//; s/)$//; s/#.*//' | while IFS= read -r link; do
    case $link in "" | http*) continue ;; esac
    [ -e "$(dirname "$page")/$link" ] || fail "$page: there is no $link"
  done
done < <(find "$prefix/share/doc/perilat" -name '*.md')
grep -q 'No licence has been chosen yet' "$prefix/share/doc/perilat/README.md" || fail "README does not speak of the licence"
[ "$pages" -gt 60 ] || fail "only $pages pages of documentation"
"$perilat" check "$prefix/share/perilat/examples/notched_beam/d3_s6.35.nml" | grep -q 'no errors'

sed "s/NAME/cohesive/g" "$source/generator/templates/deck.nml" >deck.nml
"$perilat" run deck.nml --set "simulation.end_time=0.1 ms" --set output.result=run.h5 2>&1 | grep -q 'written'
"$perilat" info run.h5 | grep -q opening
"$perilat" build deck.nml -o solver | grep -q 'written solver'
PATH=/nonexistent ./solver --set "simulation.end_time=0.1 ms" --set output.result=solver.h5 >solver.log 2>&1
"$perilat" compare run.h5 solver.h5 | grep -q '^same'
! objdump -p solver | grep -q 'NEEDED.*cairo' || fail "a solver draws nothing, and asks for Cairo"
"$perilat" new mine >new.log
"$perilat" drive mine_drive.nml | grep -q '5 of 5 expectations hold'

# Public headers say all that they need, in either language; inner ones stay behind.
cpp=${CXX:-c++}
command -v "$cpp" >/dev/null || cpp=
include=$prefix/include/perilat
headers=0
while IFS= read -r header; do
  headers=$((headers + 1))
  [ "$header" = dsl/base/diagnostic_codes.h ] && continue # a list of X, for those that say what X is
  echo "#include \"$header\"" >one.c
  "$compiler" -std=c11 -Wall -Wextra -Werror -fsyntax-only -I"$include" one.c || fail "$header in C11"
  [ -z "$cpp" ] || "$cpp" -x c++ -std=c++17 -Wall -Wextra -Werror -fsyntax-only -I"$include" one.c || fail "$header in C++17"
done < <(cd "$include" && find . -name '*.h' | sed 's/^..//')
[ "$headers" -gt 20 ] && [ -f "$include/runtime/kernel.h" ] && [ -f "$include/generator/kernel/model.h" ] || fail "$headers headers"
for inner in runtime/interaction/sweep.h runtime/simulation/simulation_state.h generator/plan/plan.h generator/report/run_state.h dsl/syntax/parsing.h; do
  [ ! -e "$include/$inner" ] || fail "$inner is installed"
done

# A C program against the libraries: the law is found, checked, and driven through the runtime's reader of results.
cat >use.c <<'END'
#include <stdio.h>
#include <stdlib.h>

#include "generator/kernel/model.h"
#include "runtime/result/result_read.h"

int main(int argc, char **argv) {
  char error[1000];
  model m;
  char *path = argc == 3 ? model_find(argv[1], NULL) : NULL;
  bool good = path && model_open(&m, path, NULL, 0) && model_plan(&m);
  result_file *f = good ? result_read(argv[2], error, sizeof error) : NULL;
  long particles = 0;
  int dimensions;
  if (f)
    free(result_read_reference(f, &particles, &dimensions));
  printf("%s has %d parameters; %ld particles\n", good ? m.law->tree->name : "?", good ? m.law->parameters.count : 0,
         particles);
  return f && particles > 0 ? 0 : 1;
}
END
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.20)
project(use LANGUAGES C ${CPP})
set(CMAKE_C_STANDARD 11)
set(CMAKE_CXX_STANDARD 17)
find_package(perilat 0.1 REQUIRED)
if(NOT EXISTS ${PERILAT_MODELS_DIR}/elastic_central.plm OR NOT EXISTS ${PERILAT_EXECUTABLE})
  message(FATAL_ERROR "the package does not say where its models and command are")
endif()
add_executable(use use.c)
target_link_libraries(use PRIVATE perilat::generator)
if(CPP)
  add_executable(host host.cpp)
  target_link_libraries(host PRIVATE perilat::generator)
endif()
END
# A C++ program that checks a law, runs a deck, and steps a simulation of its own.
cat >host.cpp <<'END'
#include <cstdio>
#include <cstring>

#include "generator/kernel/material_law.h"
#include "generator/run/run.h"
#include "runtime/deck/deck_read.h"
#include "runtime/result/result.h"
#include "runtime/simulation/simulation.h"

static const char deck_text[] = "&simulation end_time = '0.1 ms' /\n"
                                "&lattice name = 'a' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' /\n"
                                "&material lattice = 'a' model = 'elastic_central' /\n"
                                "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = '50 mm', '50 mm' /\n"
                                "&gravity acceleration = 0, -9.81 /\n";

int main(int argc, char **argv) {
  run_options options = {};
  options.program = argv[0];
  options.deck_path = argc == 2 ? argv[1] : "";
  options.check_only = true;
  const bool right = run_deck(&options) == 0;
  arena *memory = arena_new();
  source_set sources = {};
  diagnostics said;
  diag_begin(&said, &sources);
  const int file = source_add(&sources, "host", deck_text, std::strlen(deck_text));
  const deck *k = deck_read(memory, &sources, file, nullptr, 0, &said);
  model m = {};
  long steps = 0;
  if (k && material_law_open(&k->materials[0], &k->lattices[0], nullptr, &m, &said)) {
    char error[1000];
    const char *note;
    double values[16];
    const pl_law *law = model_kernel(&m, true, &note, error, sizeof error);
    simulation_law laws = {law, values, NULL, 0};
    simulation *s = law && material_parameters(&m.values, law, values, &said) ? simulation_new(k, &laws, &said) : nullptr;
    while (s && simulation_advance(s, 100, nullptr) == STEP_OK)
      ;
    steps = s ? simulation_step_done(s) : 0;
    if (s) simulation_free(s);
  }
  diag_print(&said, stderr);
  std::printf("%s, %s steps\n", right ? "right" : "wrong", steps > 0 ? "some" : "no");
  if (m.memory) model_close(&m);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return right && steps > 0 ? 0 : 1;
}
END
export PERILAT_MODELS=$prefix/share/perilat/models
expected="elastic_central has 2 parameters; 281 particles"
"$cmake" -S . -B cmake-build -G "$generator" -DCMAKE_MAKE_PROGRAM="$make_program" -DCMAKE_C_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$prefix" ${cpp:+-DCPP=CXX} >cmake.log 2>&1 || { cat cmake.log; fail "configuring with the CMake package"; }
"$cmake" --build cmake-build >cmake.log 2>&1 || { cat cmake.log; fail "building with the CMake package"; }
[ "$(./cmake-build/use elastic_central run.h5)" = "$expected" ] || fail "the program built by CMake"

pc=$(find "$prefix" -name perilat.pc -printf '%h\n')
export PKG_CONFIG_PATH=$pc
[ -f "$(pkg-config --variable=modelsdir perilat | sed 's/\\//g')/elastic_central.plm" ] || fail "modelsdir of pkg-config"
eval "\"$compiler\" -std=gnu11 use.c -o use $(pkg-config --cflags --libs perilat)"
[ "$(./use elastic_central run.h5)" = "$expected" ] || fail "the program built by pkg-config"
awk '$0 == "```c" { on = 1; count++; next } /^```/ { on = 0 } on { print > ("page" count ".c") }' "$prefix/share/doc/perilat/runtime/HOST.md"
grep -q pl_law page1.c && grep -q pl_law page2.c || fail "the page of hosts has no programs"
eval "\"$compiler\" -std=c11 -Wall -Wextra -Werror -fsyntax-only page1.c page2.c $(pkg-config --cflags-only-I perilat)" || fail "the programs of the page"
if [ -n "$cpp" ]; then
  ./cmake-build/host deck.nml 2>&1 | grep -q 'right, some steps' || fail "the C++ program built by CMake"
  eval "\"$cpp\" -std=c++17 -Wall -Wextra -Werror host.cpp -o host $(pkg-config --cflags --libs perilat)"
  ./host deck.nml | grep -q 'right, some steps' || fail "the C++ program built by pkg-config"
else
  echo "no C++ compiler: the headers were not tried in C++"
fi

# Manual and completion.
for page in perilat perilat-run perilat-new; do
  gzip -t "$prefix/share/man/man1/$page.1.gz" || fail "no man page $page"
done
bash -n "$prefix/share/bash-completion/completions/perilat"
[ -s "$prefix/share/zsh/site-functions/_perilat" ] && [ -s "$prefix/share/fish/vendor_completions.d/perilat.fish" ]
echo "installed, moved and used from another folder"
