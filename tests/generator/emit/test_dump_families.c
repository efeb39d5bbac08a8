/* What --dump=passes and --dump=ir say of a law of families (PERILAT_BLESS=1 rewrites the golden
   file). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/law_variant.h"
#include "generator/emit/plan_dump.h"
#include "tests/dsl/text_files.h"
#include "tests/generator/law_text.h"

static char *dumped(void (*dump)(const kernel_plan *, FILE *)) {
  tested_law *t = open_law_file(SOURCE_DIR "/tests/generator/families/stored.plm");
  assert_non_null(t);
  assert_non_null(t->plan);
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  dump(t->plan, out);
  fclose(out);
  close_law(t);
  return text;
}

static void passes_show_reads_writes_and_costs(void **state) {
  (void)state;
  char *text = dumped(plan_dump);
  assert_golden(SOURCE_DIR "/tests/generator/plan/golden/stored.passes", text);
  free(text);
}

static void nodes_stand_under_their_segments(void **state) {
  (void)state;
  char *text = dumped(plan_dump_ir);
  static const char *const expected[] = {"pass step 0, neighbour by neighbour\n",
                                         "pass step 3, particle by particle\n",
                                         "pass observe 0, particle by particle\n",
                                         "pass bounds, once\n",
                                         "largest most_j into slot 1 = %",
                                         "field near = %",
                                         "force z = %",
                                         "stored energy = %",
                                         "; near (line 16)"};
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
    if (!strstr(text, expected[k])) fail_msg("the dump does not say `%s`:\n%s", expected[k], text);
  free(text);
}

/* Forces along the axes come first, then moments about them. */
static void moments_on_particles_have_names(void **state) {
  (void)state;
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  tested_law *t = open_law_file(SOURCE_DIR "/models/mplm_space.plm");
  const law *in_space = law_on_lattice(t->law, SETTING_SPACE, false, 18);
  kernel_plan *p =
      plan_kernel_of_families(in_space, &(law_variation){.varying_count = 0}, &t->said);
  assert_non_null(p);
  plan_dump(p, out);
  fclose(out);
  assert_non_null(strstr(text, "force x, force y, force z, moment x, moment y, moment z"));
  plan_free(p);
  close_law(t);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(moments_on_particles_have_names),
                                     cmocka_unit_test(passes_show_reads_writes_and_costs),
                                     cmocka_unit_test(nodes_stand_under_their_segments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
