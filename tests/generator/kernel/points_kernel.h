/* Laws of continua and of cracks: the compiled kernel of each setting that a law names, and of each
   of its options, against the interpreter. To be included after cmocka.h. */
#ifndef PERILAT_TESTS_POINTS_KERNEL_H
#define PERILAT_TESTS_POINTS_KERNEL_H

#include "tests/generator/kernel/compiled_kernel.h"

static inline void check_setting(const char *path, const law_choice *choice, law_setting setting) {
  model m;
  const pl_law *kernel = open_kernel_for(&m, path, choice, &setting, false, 0);
  free(compiler_says(&m, "gcc", "-Wall -Wextra -Werror"));
  assert_same_bits(&m, kernel, states_asked());
  model_close(&m);
}

/* Of a continuum in every setting that the law names. */
static inline int check_law_of_points(const char *path, const law_choice *choice) {
  static const law_setting settings[] = {SETTING_PLANE_STRESS, SETTING_PLANE_STRAIN, SETTING_SPACE};
  bool meant[3] = {false};
  char words[96];
  model m;
  const bool opened = model_open(&m, path, choice, choice ? 1 : 0);
  const bool continuum = opened && m.law->tree->law == LAW_CONTINUUM;
  const bool crack = opened && m.law->tree->law == LAW_CRACK;
  for (int k = 0; k < 3; k++)
    meant[k] =
        crack ? k == 0
              : continuum && model_suits(&m, law_setting_name(settings[k]), words, sizeof words);
  model_close(&m);
  for (int k = 0; k < 3; k++)
    if (meant[k]) check_setting(path, choice, settings[k]);
  return continuum || crack;
}

#endif
