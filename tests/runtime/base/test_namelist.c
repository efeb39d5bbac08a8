/* The notation of namelists: what Fortran's own reader accepts is read to the same values, and
   hopeless bytes are refused. Texts of syntax errors are in bad/. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "runtime/base/namelist.h"

typedef struct reading {
  source_set sources;
  diagnostics d;
  arena *memory;
  namelist *groups;
} reading;

static void read_bytes(reading *r, const char *text, size_t length) {
  *r = (reading){.memory = arena_new()};
  int file = source_add(&r->sources, "<test>", text, length);
  diag_begin(&r->d, &r->sources);
  r->groups = namelist_read(r->memory, &r->sources, file, &r->d);
}

static void read_text(reading *r, const char *text) {
  read_bytes(r, text, strlen(text));
}

static void end(reading *r) {
  diag_clear(&r->d);
  source_clear(&r->sources);
  arena_free(r->memory);
}

static const namelist_key *key_of(const reading *r, int group, const char *name) {
  assert_true(group < r->groups->group_count);
  const namelist_key *key = namelist_find(&r->groups->groups[group], name);
  assert_non_null(key);
  return key;
}

static bool spans(const reading *r, span where, const char *text) {
  const source *s = &r->sources.items[where.file];
  return where.end - where.begin == strlen(text) &&
         memcmp(s->text + where.begin, text, strlen(text)) == 0;
}

static void numbers_of_fortran(void **state) {
  (void)state;
  reading r;
  read_text(&r, "&g x = 1, -2.5 +.5 3. 1.5d-3, 1.5D+3,1e2 -1E-2\n 2*0.25, 0 /");
  static const double expected[] = {1, -2.5, 0.5, 3, 1.5e-3, 1.5e3, 1e2, -1e-2, 0.25, 0.25, 0};
  assert_int_equal(r.d.count, 0);
  const namelist_key *x = key_of(&r, 0, "X");
  assert_int_equal(x->value_count, 11);
  for (int i = 0; i < 11; i++) {
    assert_int_equal(x->values[i].kind, NAMELIST_NUMBER);
    assert_true(x->values[i].number == expected[i]);
  }
  end(&r);
}

static void texts_and_logicals(void **state) {
  (void)state;
  reading r;
  read_text(&r, "&g a='it''s' b=\"say \"\"so\"\"\" c='\"' d='! / &no' e='' f=2*'x'\n"
                "  l = .true. .FALSE. T f .t. .F. true False ! the end\n/");
  assert_int_equal(r.d.count, 0);
  static const char *const names[] = {"a", "b", "c", "d", "e"};
  static const char *const texts[] = {"it's", "say \"so\"", "\"", "! / &no", ""};
  for (int i = 0; i < 5; i++) {
    const namelist_key *key = key_of(&r, 0, names[i]);
    assert_int_equal(key->value_count, 1);
    assert_int_equal(key->values[0].kind, NAMELIST_TEXT);
    assert_string_equal(key->values[0].text, texts[i]);
  }
  assert_int_equal(key_of(&r, 0, "f")->value_count, 2);
  const namelist_key *l = key_of(&r, 0, "l");
  static const bool expected[] = {true, false, true, false, true, false, true, false};
  assert_int_equal(l->value_count, 8);
  for (int i = 0; i < 8; i++) {
    assert_int_equal(l->values[i].kind, NAMELIST_LOGICAL);
    assert_int_equal(l->values[i].logical, expected[i]);
  }
  end(&r);
}

static void groups_in_every_dress(void **state) {
  (void)state;
  reading r;
  read_text(&r, "\xEF\xBB\xBF! bär\r\n&First A=1 /! x\r\n&FIRST t = 3, f\n = 4,/&empty/\n"
                "&old\n  k = 1\n&end\n&last long =\n 1 ! one\n\n, 2\n,3,\nnext= 'a' \"b\"\n/");
  assert_int_equal(r.d.count, 0);
  assert_int_equal(r.groups->group_count, 5);
  assert_string_equal(r.groups->groups[0].name, "first");
  assert_string_equal(r.groups->groups[1].name, "first");
  assert_true(spans(&r, r.groups->groups[1].where, "&FIRST"));
  assert_true(key_of(&r, 1, "t")->values[0].number == 3); /* a key although T is a logical value */
  assert_true(key_of(&r, 1, "F")->values[0].number == 4);
  assert_int_equal(r.groups->groups[2].key_count, 0);
  assert_true(key_of(&r, 3, "k")->values[0].number == 1);
  assert_int_equal(key_of(&r, 4, "long")->value_count, 3);
  assert_int_equal(key_of(&r, 4, "next")->value_count, 2);
  end(&r);
}

static void every_piece_has_its_place(void **state) {
  (void)state;
  reading r;
  read_text(&r, "&beam size = '457.2 mm', 0.1524  flag = T /");
  const namelist_key *size = key_of(&r, 0, "size");
  assert_true(spans(&r, r.groups->groups[0].where, "&beam"));
  assert_true(spans(&r, size->name_where, "size"));
  assert_true(spans(&r, size->value_where, "'457.2 mm', 0.1524"));
  assert_true(spans(&r, size->values[0].where, "'457.2 mm'"));
  assert_true(spans(&r, size->values[0].text_where, "457.2 mm"));
  assert_true(spans(&r, size->values[1].where, "0.1524"));
  assert_true(spans(&r, key_of(&r, 0, "flag")->value_where, "T"));
  end(&r);
}

static void refused(const char *text, size_t length, diag_code code, uint32_t begin) {
  reading r;
  read_bytes(&r, text, length);
  assert_int_equal(r.d.errors, 1);
  assert_int_equal(r.d.items[0].code, code);
  assert_int_equal(r.d.items[0].where.begin, begin);
  assert_true(r.groups->broken);
  end(&r);
}

static void bytes_that_are_no_text(void **state) {
  (void)state;
  refused("&g\0/", 4, DIAG_BAD_CHARACTER, 2);
  refused("&g x = 'a\x01' /", 13, DIAG_BAD_CHARACTER, 9);
  refused("! K\xF6ln\n&g /", 11, DIAG_BAD_CHARACTER, 3); /* Latin-1 */
  refused("&g /\n\xE2\x80", 7, DIAG_BAD_CHARACTER, 5);   /* cut short */
  refused("&g /\n\xC0\xAF", 7, DIAG_BAD_CHARACTER, 5);   /* overlong */
  refused("&g x = 'a\x7F' /", 13, DIAG_BAD_CHARACTER, 9);
}

static void limits_are_kept(void **state) {
  (void)state;
  size_t size = (size_t)NAMELIST_LARGEST_TEXT + 1;
  char *text = malloc(size);
  memset(text, ' ', size);
  refused(text, size, DIAG_TOO_LONG, 0);
  reading r;
  read_bytes(&r, text, size - 1);
  assert_int_equal(r.d.count, 0);
  end(&r);

  for (size_t i = 0; i + 3 <= size; i += 3) /* five million groups */
    memcpy(text + i, "&a/", 3);
  read_bytes(&r, text, size - 1);
  assert_int_equal(r.d.errors, 1);
  assert_int_equal(r.d.items[0].code, DIAG_TOO_LONG);
  assert_int_equal(r.groups->group_count, NAMELIST_MOST_GROUPS);
  end(&r);

  memset(text, '/', size); /* sixteen million errors */
  read_bytes(&r, text, size - 1);
  assert_true(r.d.errors <= NAMELIST_MOST_ERRORS + 1);
  end(&r);
  free(text);

  read_text(&r, "&g x = 1000000*1 /");
  assert_int_equal(key_of(&r, 0, "x")->value_count, 1000000);
  end(&r);
  read_text(&r, "&g x = 999999*1, 2*1 /");
  assert_int_equal(r.d.errors, 1);
  end(&r);
  read_text(&r, "&g x = 999999*1 / &g y = 1 / &h z = 1 /"); /* of all keys together */
  assert_int_equal(r.d.errors, 1);
  assert_int_equal(r.d.items[0].code, DIAG_TOO_LONG);
  end(&r);
  read_text(&r, "&g x = 99999999999999999999*1 /");
  assert_int_equal(r.d.errors, 1);
  end(&r);
}

static void number_prefixes(void **state) {
  (void)state;
  static const struct {
    const char *text;
    size_t used;
    double value;
  } cases[] = {{"6.35 mm", 4, 6.35}, {"1e3", 3, 1000}, {"1e", 1, 1},   {"2d", 1, 2},
               {"1.e2x", 4, 100},    {".", 0, 0},      {"-", 0, 0},    {"", 0, 0},
               {"+.5d1", 5, 5},      {"1e+", 1, 1},    {"0x10", 1, 0}, {"inf", 0, 0},
               {"12.5.3", 4, 12.5}};
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    double value = 0;
    assert_int_equal(namelist_number(cases[i].text, strlen(cases[i].text), &value), cases[i].used);
    if (cases[i].used) assert_true(value == cases[i].value);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers_of_fortran),     cmocka_unit_test(texts_and_logicals),
      cmocka_unit_test(groups_in_every_dress),  cmocka_unit_test(every_piece_has_its_place),
      cmocka_unit_test(bytes_that_are_no_text), cmocka_unit_test(limits_are_kept),
      cmocka_unit_test(number_prefixes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
