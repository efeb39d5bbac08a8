/* Texts in, places and printed messages out: what a user sees. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"

/* One text with the messages about it. */
typedef struct sheet {
  source_set sources;
  diagnostics d;
} sheet;

static void sheet_begin(sheet *s, const char *text) {
  *s = (sheet){0};
  source_add(&s->sources, "law.plm", text, strlen(text));
  diag_begin(&s->d, &s->sources);
}

static span span_of(const sheet *s, const char *part) {
  const char *text = s->sources.items[0].text, *found = strstr(text, part);
  assert_non_null(found);
  uint32_t begin = (uint32_t)(found - text);
  return (span){begin, begin + (uint32_t)strlen(part), 0};
}

static void prints(sheet *s, const char *expected) {
  char *printed = NULL;
  size_t length;
  FILE *out = open_memstream(&printed, &length);
  diag_print(&s->d, out);
  fclose(out);
  assert_string_equal(printed, expected);
  free(printed);
  diag_clear(&s->d);
  source_clear(&s->sources);
}

static void message_shows_line_caret_hint_and_note(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "model m\n  x = alfa2*stretch\n  x = 3\n");
  diag_report(&s.d, DIAG_DUPLICATE_NAME, span_of(&s, "x = 3"), "`%s` is declared twice", "x");
  diag_note(&s.d, span_of(&s, "x"), "first declared here");
  diag_report(&s.d, DIAG_UNKNOWN_NAME, span_of(&s, "alfa2"), "there is no quantity `alfa2`");
  const char *candidates[] = {"stretch", "alpha2", "beta"};
  diag_suggest(&s.d, "alfa2", candidates, 3);
  assert_int_equal(s.d.errors, 2);
  prints(&s, "law.plm:2:7: error: there is no quantity `alfa2` [unknown-name]\n"
             "  2 |   x = alfa2*stretch\n"
             "    |       ^~~~~\n"
             "  hint: did you mean `alpha2`?\n"
             "law.plm:3:3: error: `x` is declared twice [duplicate-name]\n"
             "  3 |   x = 3\n"
             "    |   ^~~~~\n"
             "law.plm:2:3: note: first declared here\n"
             "  2 |   x = alfa2*stretch\n"
             "    |   ^\n");
}

static void warnings_are_not_errors(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "parameter beta = 1\n");
  diag_report(&s.d, DIAG_UNUSED, span_of(&s, "beta"), "nothing uses `beta`");
  assert_int_equal(s.d.errors, 0);
  prints(&s, "law.plm:1:11: warning: nothing uses `beta` [unused]\n"
             "  1 | parameter beta = 1\n"
             "    |           ^~~~\n");
}

static void columns_count_characters(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "\tx = 1 \xC2\xB5m\xE2\x82\xAC y\r\n");
  diag_report(&s.d, DIAG_SYNTAX, span_of(&s, "y"), "here");
  diag_report(&s.d, DIAG_SYNTAX, span_of(&s, "\xC2\xB5m\xE2\x82\xAC"), "there");
  prints(&s, "law.plm:1:8: error: there [syntax]\n"
             "  1 | \tx = 1 \xC2\xB5m\xE2\x82\xAC y\n"
             "    | \t      ^~~\n"
             "law.plm:1:12: error: here [syntax]\n"
             "  1 | \tx = 1 \xC2\xB5m\xE2\x82\xAC y\n"
             "    | \t          ^\n");
}

static void caret_stays_on_its_line(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "x = | 1 when a\n    | 2 otherwise");
  diag_report(&s.d, DIAG_CASES, span_of(&s, "1 when a\n    | 2"), "two lines");
  diag_report(&s.d, DIAG_SYNTAX, (span){32, 32, 0}, "end of the text");
  diag_report(&s.d, DIAG_SYNTAX, (span){500, 600, 0}, "beyond the text");
  prints(&s, "law.plm:1:7: error: two lines [cases]\n"
             "  1 | x = | 1 when a\n"
             "    |       ^~~~~~~~\n"
             "law.plm:2:18: error: end of the text [syntax]\n"
             "  2 |     | 2 otherwise\n"
             "    |                  ^\n"
             "law.plm:2:18: error: beyond the text [syntax]\n"
             "  2 |     | 2 otherwise\n"
             "    |                  ^\n");
}

static void message_needs_no_source(void **state) {
  (void)state;
  diagnostics d;
  diag_begin(&d, NULL);
  diag_report(&d, DIAG_FILE, (span){0}, "cannot read `beam.nml`");
  char *printed = NULL;
  size_t length;
  FILE *out = open_memstream(&printed, &length);
  diag_print(&d, out);
  fclose(out);
  assert_string_equal(printed, "error: cannot read `beam.nml` [file]\n");
  free(printed);
  diag_clear(&d);
}

static void control_characters_do_not_reach_the_terminal(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "a\033[31mb\n");
  diag_report(&s.d, DIAG_BAD_CHARACTER, (span){1, 2, 0}, "this character");
  prints(&s, "law.plm:1:2: error: this character [bad-character]\n"
             "  1 | a\\x1b[31mb\n"
             "    |  ^~~~\n");
}

static void long_lines_are_cut_around_the_caret(void **state) {
  (void)state;
  char text[2001];
  memset(text, 'x', 2000);
  text[2000] = '\0';
  memcpy(text + 1000, "HERE", 4);
  sheet s;
  sheet_begin(&s, text);
  diag_report(&s.d, DIAG_SYNTAX, (span){1000, 2000, 0}, "long");
  char expected[600], *at = expected;
  at += sprintf(at, "law.plm:1:1001: error: long [syntax]\n  1 | ...");
  at += sprintf(at, "%.*s", 160, text + 940);
  at += sprintf(at, "...\n    |    %*s^", 60, "");
  memset(at, '~', 99);
  strcpy(at + 99, "\n");
  prints(&s, expected);
}

static void many_messages_are_counted(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "x\n");
  for (int i = 0; i < 1000; i++)
    diag_report(&s.d, DIAG_SYNTAX, (span){0, 1, 0}, "number %d", i);
  char *printed = NULL;
  size_t length;
  FILE *out = open_memstream(&printed, &length);
  diag_print(&s.d, out);
  fclose(out);
  assert_non_null(strstr(printed, "number 99 "));
  assert_null(strstr(printed, "number 100 "));
  assert_non_null(strstr(printed, "\nand 900 more like these\n"));
  assert_int_equal(s.d.errors, 1000);
  free(printed);
  diag_clear(&s.d);
  source_clear(&s.sources);
}

static void spans_join(void **state) {
  (void)state;
  span j = span_join((span){5, 9, 1}, (span){2, 6, 1});
  assert_int_equal(j.begin, 2);
  assert_int_equal(j.end, 9);
  j = span_join((span){5, 9, 1}, (span){2, 6, 0});
  assert_int_equal(j.begin, 5);
  assert_int_equal(j.file, 1);
}

static void is_nearest(const char *name, const char *expected) {
  static const char *const candidates[] = {"stretch", "stretch_rate", "alpha1", "alpha2",
                                           "s",       "EA",           "omega",  "theta_i"};
  const char *found = nearest_name(name, candidates, 8);
  if (expected) {
    assert_non_null(found);
    assert_string_equal(found, expected);
  } else if (found) {
    fail_msg("`%s` gave `%s`", name, found);
  }
}

static void nearest_names(void **state) {
  (void)state;
  is_nearest("strech", "stretch");
  is_nearest("Stretch", "stretch");
  is_nearest("ea", "EA");
  is_nearest("S", "s");
  is_nearest("alhpa2", "alpha2"); /* letters swapped */
  is_nearest("omgea", "omega");
  is_nearest("AE", "EA"); /* one slip, not two: short names bear no more */
  is_nearest("theta", "theta_i");
  is_nearest("streth_rate", "stretch_rate");
  is_nearest("q", NULL);
  is_nearest("viscosity", NULL);
  is_nearest("", NULL);
  char huge[5000];
  memset(huge, 'a', sizeof(huge) - 1);
  huge[sizeof(huge) - 1] = '\0';
  is_nearest(huge, NULL);
}

/* Lines may end in a carriage return alone; one within lines is none. */
static void carriage_returns_end_lines(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "model m\r  x = y\rend\r");
  diag_report(&s.d, DIAG_UNUSED, span_of(&s, "x = y"), "it has no effect");
  prints(&s, "law.plm:2:3: warning: it has no effect [unused]\n"
             "  2 |   x = y\n"
             "    |   ^~~~~\n");
  sheet_begin(&s, "a\rb\nc\n");
  assert_int_equal(source_place(&s.sources, 0, 2).line, 1);
  source_clear(&s.sources);
}

/* Neither an error nor a warning, and printed behind these, with the reason. */
static void what_is_accepted_is_set_apart(void **state) {
  (void)state;
  sheet s;
  sheet_begin(&s, "force N = 1\nend\n");
  diag_report(&s.d, DIAG_REST_FORCE, span_of(&s, "force N = 1"), "it carries a force");
  for (int k = 0; k < 4; k++)
    diag_report(&s.d, DIAG_HEALING, span_of(&s, "end"), "it heals");
  assert_true(diag_may_be_accepted(DIAG_REST_FORCE) && diag_may_be_accepted(DIAG_DOMAIN));
  assert_false(diag_may_be_accepted(DIAG_UNITS) || diag_may_be_accepted(DIAG_TANGENT));
  diag_accept(&s.d, 0, "prestress");
  diag_accept(&s.d, 2, "it is clay");
  assert_int_equal(s.d.errors, 0);
  assert_int_equal(s.d.count, 3);
  assert_int_equal(s.d.accepted_count, 2);
  while (s.d.count)
    diag_accept(&s.d, 0, "it is clay");
  diag_report(&s.d, DIAG_HEALING, span_of(&s, "end"), "and again");
  assert_int_equal(s.d.count, 1);
  assert_int_equal(s.d.accepted_count, 5);
  s.d.accepted_count = 1; /* the four others alike */
  for (int k = 1; k < 5; k++)
    free(s.d.accepted[k].message);
  prints(&s, "law.plm:2:1: warning: and again [healing]\n"
             "  2 | end\n"
             "    | ^~~\n"
             "law.plm:1:1: accepted: it carries a force [rest-force]\n"
             "  1 | force N = 1\n"
             "    | ^~~~~~~~~~~\n"
             "  because: prestress\n");
}

static void arena_gives_zeroed_aligned_memory(void **state) {
  (void)state;
  arena *a = arena_new();
  size_t total = 0;
  for (size_t size = 0; size < 300000; size = size * 3 / 2 + 1) {
    unsigned char *memory = arena_alloc(a, size);
    assert_int_equal((uintptr_t)memory % _Alignof(max_align_t), 0);
    for (size_t i = 0; i < size; i++)
      assert_int_equal(memory[i], 0);
    memset(memory, 0xFF, size);
    total += size;
  }
  assert_true(total > 300000);
  assert_string_equal(arena_text(a, "stretch", 3), "str");
  assert_string_equal(arena_printf(a, "%s=%d", "s", 12), "s=12");
  arena_free(a);
  arena_free(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(message_shows_line_caret_hint_and_note),
      cmocka_unit_test(warnings_are_not_errors),
      cmocka_unit_test(columns_count_characters),
      cmocka_unit_test(caret_stays_on_its_line),
      cmocka_unit_test(message_needs_no_source),
      cmocka_unit_test(control_characters_do_not_reach_the_terminal),
      cmocka_unit_test(long_lines_are_cut_around_the_caret),
      cmocka_unit_test(many_messages_are_counted),
      cmocka_unit_test(spans_join),
      cmocka_unit_test(nearest_names),
      cmocka_unit_test(carriage_returns_end_lines),
      cmocka_unit_test(what_is_accepted_is_set_apart),
      cmocka_unit_test(arena_gives_zeroed_aligned_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
