/* Laws of bonds: the compiled kernel against the interpreter, and its text through both compilers,
   with loops that are vector instructions. */
#ifndef PERILAT_TESTS_BONDS_KERNEL_H
#define PERILAT_TESTS_BONDS_KERNEL_H

#include "tests/generator/kernel/compiled_kernel.h"

static inline void assert_vectorised(model *m, const char *gcc, const char *function) {
  const char *text = model_c_text(m), *at = strstr(text, function),
             *end = at ? strstr(at, "\n}\n") : NULL;
  /* All loops of the function: */
  while (end && (at = strstr(at, "  PL_INDEPENDENT\n")) && at < end) {
    char expected[64];
    int line = 2;
    for (const char *c = text; c < at; c++)
      line += *c == '\n';
    snprintf(expected, sizeof expected, ":%d:3: optimized: loop vectorized", line);
    if (gcc && !strstr(gcc, expected))
      fail_msg("line %d of the kernel of %s does not vectorise: %s", line, m->path, gcc);
    at++;
  }
}

static inline void assert_clean_and_vectorised(model *m) {
  char *gcc = compiler_says(m, "gcc", "-Wall -Wextra -Werror -fopt-info-vec-optimized");
  assert_non_null(strstr(model_c_text(m), "PL_PASS void rows(const pl_law *law"));
  assert_vectorised(m, gcc, "PL_PASS void rows(const pl_law *law");
  /* Where something is expected: */
  assert_vectorised(m, gcc, "PL_PASS void rows_unusual(const pl_law *law");
  free(gcc);
  free(compiler_says(m, "clang", "-Wall -Wextra -Werror -Wno-unused-command-line-argument"));
}

static inline int check_law_of_bonds(const char *path, const law_choice *choice) {
  model m;
  const bool of_bonds = model_open(&m, path, choice, choice ? 1 : 0) &&
                        m.law->tree->law != LAW_STATE && m.law->tree->law != LAW_CONTINUUM &&
                        m.law->tree->law != LAW_CRACK;
  model_close(&m);
  if (!of_bonds) return 0;
  const pl_law *kernel = open_kernel(&m, path, choice);
  assert_clean_and_vectorised(&m);
  assert_same_bits(&m, kernel, states_asked());
  model_close(&m);
  return 1;
}

#endif
