/* What a study varies, as it is written. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "generator/study/study_axis.h"

typedef struct bench {
  arena *memory;
  source_set sources;
  diagnostics said;
} bench;

static void begin(bench *b) {
  *b = (bench){.memory = arena_new()};
  diag_begin(&b->said, &b->sources);
}

static void end(bench *b) {
  diag_clear(&b->said);
  source_clear(&b->sources);
  arena_free(b->memory);
}

static study_text given(bench *b, const char *text) {
  const int file = source_add(&b->sources, "--vary", text, strlen(text));
  return (study_text){text, source_whole(&b->sources, file)};
}

/* Values joined by bars, keys by slashes. */
static void reads(const char *text, const char *names, const char *values) {
  bench b;
  study_axis axis;
  char found[2][1000] = {"", ""};
  begin(&b);
  const study_text it = given(&b, text);
  assert_true(study_axis_read(b.memory, &it, &axis, &b.said));
  for (int k = 0; k < axis.key_count; k++) {
    strcat(strcat(found[0], k ? "/" : ""), axis.keys[k].name);
    for (int v = 0; v < axis.count; v++)
      strcat(strcat(found[1], v ? "|" : k ? "/" : ""), axis.keys[k].values[v]);
  }
  assert_string_equal(found[0], names);
  assert_string_equal(found[1], values);
  end(&b);
}

static void refuses(const char *text, const char *words) {
  bench b;
  study_axis axis;
  begin(&b);
  const study_text it = given(&b, text);
  assert_false(study_axis_read(b.memory, &it, &axis, &b.said));
  assert_int_equal(b.said.errors, 1);
  if (!strstr(b.said.items[0].message, words)) fail_msg("`%s`: %s", text, b.said.items[0].message);
  end(&b);
}

static void hints(const char *text, const char *words) {
  bench b;
  study_axis axis;
  begin(&b);
  const study_text it = given(&b, text);
  assert_false(study_axis_read(b.memory, &it, &axis, &b.said));
  if (!strstr(b.said.items[0].hint, words)) fail_msg("`%s`: %s", text, b.said.items[0].hint);
  end(&b);
}

static void lists(void **state) {
  (void)state;
  reads("lattice.spacing=10", "lattice.spacing", "10");
  reads("lattice.spacing = 10 mm , 5 mm", "lattice.spacing", "10 mm|5 mm");
  reads("body.shape=disc,rectangle", "body.shape", "disc|rectangle");
  reads("region[loading plate].at=1", "region[loading plate].at", "1");
  reads("region[a.b].at=1", "region[a.b].at", "1");
  reads("material.model=../a.plm, ../b.plm", "material.model", "../a.plm|../b.plm");
}

/* A unit at the end is that of the plain numbers before it, which would be in SI. */
static void shared_units(void **state) {
  (void)state;
  reads("lattice.spacing=20, 10, 5 mm", "lattice.spacing", "20 mm|10 mm|5 mm");
  reads("lattice.spacing=0.02 m, 10, 5 mm", "lattice.spacing", "0.02 m|10 mm|5 mm");
  reads("lattice.spacing=20 mm, 10, 5", "lattice.spacing", "20 mm|10|5");
}

static void values_with_commas(void **state) {
  (void)state;
  reads("lattice.origin=0, 0; 2.5 mm, 0", "lattice.origin", "0, 0|2.5 mm, 0");
}

static void ranges(void **state) {
  (void)state;
  reads("force.total=40..46:2 kN", "force.total", "40 kN|42 kN|44 kN|46 kN");
  reads("force.total=-40..-46:2 kN", "force.total", "-40 kN|-42 kN|-44 kN|-46 kN");
  reads("force.total=-40..-46:-2 kN", "force.total", "-40 kN|-42 kN|-44 kN|-46 kN");
  reads("a.b=0.1..0.35:0.1", "a.b", "0.1|0.2|0.3");
  reads("a.b=0..0.3:0.1", "a.b", "0|0.1|0.2|0.3"); /* 3*0.1 is more than 0.3 */
  reads("a.b=1..1:1", "a.b", "1");
}

static void keys_that_go_together(void **state) {
  (void)state;
  reads("lattice.spacing=20, 10 mm with material.S_t=1e-4,2e-4", "lattice.spacing/material.S_t",
        "20 mm|10 mm/1e-4|2e-4");
  refuses("a.b=1,2 with a.c=1", "has 1 value, but `a.b` has 2");
}

static void slips(void **state) {
  (void)state;
  refuses("", "form group.key=values");
  refuses("a.b", "form group.key=values");
  refuses("spacing=1", "form group.key=values");
  refuses(".b=1", "form group.key=values");
  refuses("a.=1", "form group.key=values");
  refuses("a.b=", "missing");
  refuses("a.b=1,", "missing");
  refuses("a.b=1,,2", "missing");
  refuses("a.b=1..2", "needs a step");
  refuses("a.b=1..2:0", "no values");
  refuses("a.b=1..x:1", "no range of numbers");
  refuses("a.b=1 m..2 m:5 s", "one unit");
  refuses("a.b=0..1:1e-9", "too many");
  refuses("a.b=40:2:60 kN", "`40:2:60 kN` is no number");
  hints("a.b=40:2:60 kN", "`40..60:2 kN`");
  hints("a.b=40:60:2", "`40..60:2`");
  hints("a.b=40:60 kN", "`40..60:STEP kN`");
  refuses("a.b=1..2:nan", "no range of numbers");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lists),  cmocka_unit_test(shared_units),
      cmocka_unit_test(ranges), cmocka_unit_test(values_with_commas),
      cmocka_unit_test(slips),  cmocka_unit_test(keys_that_go_together)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
