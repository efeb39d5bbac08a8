/* Closed forms of a path may read another law than the driven one: what a student calls EA does not
   decide what is expected of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/drive/drive_expect.h"
#include "generator/drive/driven_law.h"

#define LAW(factor, begin)                                                                         \
  "model answer\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"                       \
  "  parameter rho = 2323 [kg/m^3] in (0, inf)\n  state kappa on bond = " begin "\n"               \
  "  constant EA = " factor "*sqrt(3)/2*E*s*t\n  kappa = max(kappa, stretch)\n"                    \
  "  force N = EA*stretch\n  output k = kappa\nend model\n"

static void write_file(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  assert_int_equal(fclose(out), 0);
}

typedef struct driven {
  arena *memory;
  source_set sources;
  diagnostics said;
  drive_input *in;
  driven_law of;
  drive_table columns, table;
} driven;

static void drive(driven *d, const char *answer) {
  memset(d, 0, sizeof *d);
  d->memory = arena_new();
  diag_begin(&d->said, &d->sources);
  char text[512];
  snprintf(text, sizeof text,
           "&material model = '%s' E = '20 GPa' /\n"
           "&path quantity = 'stretch' times = 0, 1, 2 values = 0, 2e-4, 1e-4 /\n"
           "&expect quantity = 'peak N' formula = 'EA*stretch' /\n"
           "&expect quantity = 'k' formula = 'kappa' /\n",
           answer);
  const int file = source_add(&d->sources, "trusted.nml", text, strlen(text));
  d->in = drive_read(d->memory, &d->sources, file, NULL, 0, &d->said);
  assert_non_null(d->in);
  assert_int_equal(driven_law_open(&d->of, d->memory, d->in, false, &d->said), DRIVEN_READY);
  driven_law_columns(&d->of, &d->columns);
  drive_band band;
  assert_true(driven_law_march(&d->of, &d->table, &band));
}

static void let_go(driven *d) {
  drive_table_free(&d->columns);
  drive_table_free(&d->table);
  driven_law_close(&d->of);
  diag_clear(&d->said);
  source_clear(&d->sources);
  arena_free(d->memory);
}

static void judge(driven *answer, driven *trusted, drive_verdict verdicts[2]) {
  drive_expectations *x =
      drive_expectations_read(answer->in, &trusted->of.model, &answer->columns, &answer->said);
  assert_non_null(x);
  drive_judge(x, &answer->table, trusted->of.parameters, &trusted->table, verdicts);
  drive_expectations_free(x);
}

static void forms_read_the_trusted_law(void **state) {
  (void)state;
  write_file("trusted_answer.plm", LAW("2", "1e-3"));
  write_file("trusted_law.plm", LAW("1", "0"));
  driven answer, trusted;
  drive_verdict own[2], theirs[2];
  drive(&answer, "trusted_answer.plm");
  drive(&trusted, "trusted_law.plm");
  judge(&answer, &answer, own);
  judge(&answer, &trusted, theirs);
  const double EA = sqrt(3) / 2 * 20e9 * 0.01 * 0.1;
  assert_true(own[0].passed && own[1].passed); /* it agrees with itself */
  assert_false(theirs[0].passed || theirs[1].passed);
  assert_true(fabs(theirs[0].expected - EA * 2e-4) < 1e-9 * EA);
  assert_true(fabs(theirs[0].found - 2 * EA * 2e-4) < 1e-9 * EA);
  assert_true(fabs(theirs[1].expected - 2e-4) < 1e-12); /* its own state, of its own way */
  let_go(&answer);
  let_go(&trusted);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(forms_read_the_trusted_law)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
