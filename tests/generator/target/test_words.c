/* The words of the target: holes are filled with their pieces, and no name of a law is one that
   words use. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "generator/target/words.h"

static void holes_take_their_pieces(void **state) {
  (void)state;
  c_text t = {0};
  words_add(&t, WORDS_OF(SAY_STORE, "  ", "at_force_0[q]", "$1*N"));
  assert_string_equal(t.text, "  at_force_0[q] = $1*N;\n"); /* what a piece holds is no hole */
  free(t.text);
  arena *memory = arena_new();
  assert_string_equal(words_text(memory, WORDS_OF(SAY_NOTHING)), "");
  assert_string_equal(words_text(memory, WORDS_OF(SAY_SMALLER, "a", "b")), "pl_min(a, b)");
  const char *list = words_join(memory, NULL, ", ", "a");
  assert_string_equal(words_join(memory, list, ", ", "b"), "a, b");
  arena_free(memory);
}

/* Every word with as many pieces as it may have: none is left open, none is cut. */
static void every_word_is_filled(void **state) {
  (void)state;
  static const char *const pieces[] = {NULL, "@", "@", "@", "@", "@", "@", "@", "@", "@"};
  static const char *const texts[] = {
#define X(name, text) text,
      C_WORDS(X)
#undef X
  };
  for (size_t w = 0; w < sizeof texts / sizeof *texts; w++) {
    c_text t = {0};
    words_add(&t, (word)w, pieces);
    size_t holes = 0;
    for (const char *c = strchr(texts[w], '$'); c; c = strchr(c + 1, '$'))
      holes++;
    assert_int_equal(t.length, strlen(texts[w]) - holes);
    assert_null(t.text ? strchr(t.text, '$') : NULL);
    free(t.text);
  }
}

static void names_of_loops_are_taken(void **state) {
  (void)state;
  c_names n = {0};
  words_reserve(&n);
  assert_string_equal(c_names_make(&n, "slot_0"), "x_slot_0");
  assert_string_equal(c_names_make(&n, "before_12"), "x_before_12");
  assert_string_equal(c_names_make(&n, "before_crack"), "before_crack");
  assert_string_equal(c_names_make(&n, "UNIFORMS"), "UNIFORMS_2");
  assert_string_equal(c_names_make(&n, "to"), "x_to_2"); /* to_2 is an array of a loop */
  assert_string_equal(c_names_make(&n, "value"), "value");
  assert_string_equal(c_names_make(&n, "value"), "x_value_2");
  c_names_clear(&n);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(holes_take_their_pieces),
      cmocka_unit_test(every_word_is_filled),
      cmocka_unit_test(names_of_loops_are_taken),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
