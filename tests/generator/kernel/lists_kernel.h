/* Laws of families planned for lists of neighbours of particles that stand on no lattice, whether
   their line `for` names these or not. */
#ifndef PERILAT_TESTS_LISTS_KERNEL_H
#define PERILAT_TESTS_LISTS_KERNEL_H

#include "tests/generator/kernel/compiled_family.h"

static inline bool suits_lists(const char *path, const law_choice *choice) {
  model m;
  assert_true(model_open(&m, path, choice, 1));
  const bool suits = model_suits_irregular(&m);
  model_close(&m);
  return suits;
}

static inline int on_lists(const char *path, const law_choice *choice, law_setting setting) {
  if (choice && !suits_lists(path, choice)) return 0;
  check_family_law_in(path, choice, setting, true, 0, states_asked() / 3);
  return 1;
}

static inline int on_lists_in_all_settings(const char *path, const law_choice *choice) {
  return check_settings(path, choice, on_lists);
}

#endif
