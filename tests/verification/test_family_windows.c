/* Small families of models/ in windows of rows against the same passes over the whole body: the
   same bits. Rows of round bodies with holes begin and end at ever other places, so that in a
   window they take the places of longer ones, and bonds that are absent lead to them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/law_variant.h"
#include "runtime/interaction/family_run.h"
#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

enum { STEPS = 40, LOOKS = 7 /* steps between two samples */ };

typedef struct round_body {
  const char *model, *deck;
  law_setting setting;
} round_body;

#define RING                                                                                       \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '10 mm' rotation = 11 /\n" \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '260 mm' inner_radius = '90 mm' /\n"  \
  "&material lattice = 'l' model = 'x' /\n"
#define STEPPED                                                                                    \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '50 mm' /\n"                \
  "&body lattice = 'l' shape = 'polygon' points = 0, 0, '40 mm', 0, '40 mm', '100 mm', '160 mm', " \
  "'100 mm', '160 mm', '200 mm', 0, '200 mm' /\n"                                                  \
  "&notch lattice = 'l' shape = 'disc' centre = '70 mm', '180 mm' radius = '18 mm' /\n"            \
  "&notch lattice = 'l' shape = 'disc' centre = '50 mm', '120 mm' radius = '12 mm' /\n"            \
  "&material lattice = 'l' model = 'x' /\n"
#define SHELL                                                                                      \
  "&simulation end_time = 1 /\n"                                                                   \
  "&lattice name = 'l' kind = 'fcc' shells = 1 spacing = '10 mm' /\n"                              \
  "&body lattice = 'l' shape = 'sphere' centre = 0, 0, 0 radius = '71 mm' inner_radius = '30 mm' " \
  "/\n"                                                                                            \
  "&material lattice = 'l' model = 'x' /\n"

/* Its output leaves 0/0 at places without a particle. */
#define OBSERVED_LINK "../tests/generator/families/observed_link"

static sweep *moving_body(const law_case *c, const rows *g, int blocks, bool looks) {
  const double time_step = 2e-7;
  sweep *w = interaction_new(g, c->compiled, c->parameters, time_step, blocks, false, false);
  for (long q = 0; q < g->size; q++)
    for (int d = 0; d < g->dimensions; d++)
      if (g->present[q]) w->body->velocity[d][q] = 30 * sin((double)q * (1 + d)) + 20 * g->y[q];
  for (int k = 0; k < STEPS; k++) {
    assert_true(sweep_step(w));
    if (looks && k % LOOKS == 0) sweep_observe(w);
  }
  return w;
}

static void assert_same_motion(const sweep *a, const sweep *b) {
  for (int d = 0; d < a->body->dof; d++)
    for (long q = 0; q < a->body->lattice->size; q++)
      if (a->body->lattice->present[q]) {
        assert_memory_equal(&a->body->displacement[d][q], &b->body->displacement[d][q],
                            sizeof(double));
        assert_memory_equal(&a->body->velocity[d][q], &b->body->velocity[d][q], sizeof(double));
      }
}

static void windows_of_round_bodies_give_the_same_bits(void **state) {
  static const round_body bodies[] = {{"splm_elastic", RING, SETTING_PLANE_STRESS},
                                      {"splm_concrete", RING, SETTING_PLANE_STRESS},
                                      {"splm_elastic", SHELL, SETTING_SPACE},
                                      {OBSERVED_LINK, STEPPED, SETTING_PLANE_STRESS}};
  (void)state;
  for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
    law_case c;
    deck_case k;
    assert_true(deck_case_lattice(&k, bodies[n].deck));
    assert_true(law_case_read(&c, bodies[n].model));
    c.model.law = law_on_lattice(c.model.law, bodies[n].setting, false, 2 * k.lattice->directions);
    assert_true(law_case_compile(&c));
    k.lattice->mass = *law_case_value(&c, "rho") * k.lattice->volume;
    sweep *whole = moving_body(&c, k.lattice, k.lattice->row_count / 2, false);
    assert_null(family_of(whole)->windows);
    for (int blocks = 1; blocks <= 2; blocks++)
      for (int looks = 0; looks < 2; looks++) {
        sweep *w = moving_body(&c, k.lattice, blocks, looks);
        if (blocks == 1) assert_non_null(family_of(w)->windows);
        assert_same_motion(whole, w);
        sweep_free(w);
      }
    sweep_free(whole);
    law_case_close(&c);
    deck_case_close(&k);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(windows_of_round_bodies_give_the_same_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
