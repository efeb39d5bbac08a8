/* Kernels for lists read neighbours that stand side by side with unit stride, and all others by
   their list. Both find the same to the bit: a plate with exact edges and a notch, and a block
   turned against its lattice, move the same with what is known of their neighbours
   (pl_family.alike) and without. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/interaction.h"
#include "runtime/lattice/list_ways.h"
#include "runtime/lattice/scattered.h"
#include "tests/verification/case.h"

enum { STEPS = 30 };

typedef struct moved {
  deck_case c;
  rows *list; /* its particles, or those of the lattice as a list */
  model law;
  sweep *w;
} moved;

/* Uniform in (-1, 1). */
static double draw(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  *state ^= *state << 17;
  return (double)(int64_t)*state * 0x1p-63;
}

static rows *as_list(const rows *g) {
  double *at[3], *measure = must_alloc((size_t)g->particle_count * sizeof *measure);
  scattered from = {.points = {.dimensions = g->dimensions, .count = g->particle_count},
                    .measure = measure,
                    .spacing = g->spacing,
                    .horizon = g->horizon * (1 + BRAVAIS_REACH_TOLERANCE)};
  long crowded;
  for (int a = 0; a < g->dimensions; a++)
    from.points.at[a] = at[a] = must_alloc((size_t)g->particle_count * sizeof **at);
  for (long p = 0; p < g->particle_count; p++) {
    double from_origin[3];
    rows_place(g, g->particle_site[p], from_origin);
    measure[p] = g->volume;
    for (int a = 0; a < g->dimensions; a++)
      at[a][p] = from_origin[a];
  }
  rows *list = scattered_rows(&from, &crowded);
  for (int a = 0; a < g->dimensions; a++)
    free(at[a]);
  free(measure);
  return list;
}

/* Strains near 1e-3: some yield, some crack. */
static void shake(moved *m) {
  const rows *g = m->list;
  uint64_t seed = 99;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < g->dimensions; d++)
      m->w->body->displacement[d][g->particle_site[p]] = 1e-3 * g->spacing * draw(&seed);
}

static void move_body(moved *m, const char *text, const char *name, law_setting setting, bool ways,
                      int threads) {
  char error[4096];
  const char *note;
  law_case of;
  memset(m, 0, sizeof *m);
  assert_true(deck_case_lattice(&m->c, text));
  rows *g = m->list = m->c.lattice->list ? m->c.lattice : as_list(m->c.lattice);
  if (ways) print_message("%s: %.3f of all neighbours stand alike\n", name, list_ways_share(g));
  assert_true(list_ways_share(g) > 0.5);
  assert_true(law_case_read(&of, name));
  m->law = of.model;
  m->law.law = law_on_lattice(m->law.law, setting, true, 0);
  assert_true(model_plan(&m->law));
  const pl_law *kernel = model_kernel(&m->law, false, &note, error, sizeof error);
  assert_non_null(kernel);
  double parameters[64];
  assert_true(kernel->parameter_count <= 64);
  for (int p = 0; p < kernel->parameter_count; p++)
    parameters[p] = kernel->parameters[p].initial;
  if (!ways) {
    free(g->list->way);
    free(g->list->alike);
    g->list->way = NULL;
    g->list->alike = NULL;
  }
  rows_set_density(g, 2300);
  m->w = interaction_new(g, kernel, parameters, 2e-7, threads, false, false);
  shake(m);
  for (int step = 0; step < STEPS; step++)
    assert_true(sweep_step(m->w));
}

static void close_body(moved *m) {
  sweep_free(m->w);
  if (m->list != m->c.lattice) rows_free(m->list);
  model_close(&m->law);
  deck_case_close(&m->c);
}

static void compare_planes(const rows *g, const double *a, const double *b, long planes) {
  for (long k = 0; k < planes; k++)
    for (long p = 0; p < g->particle_count; p++) {
      const long q = k * g->size + g->particle_site[p];
      assert_memory_equal(&a[q], &b[q], sizeof *a);
    }
}

static void compare(const moved *a, const moved *b) {
  const rows *g = a->list;
  for (int d = 0; d < g->dimensions; d++)
    compare_planes(g, a->w->body->displacement[d], b->w->body->displacement[d], 1);
  for (int f = 0; f < a->w->law->field_count; f++)
    compare_planes(g, a->w->field[f], b->w->field[f],
                   sweep_planes(a->w, a->w->law->fields[f].place));
}

#define DECK(lattice, bodies)                                                                      \
  "&simulation end_time = 1 /\n&lattice name = 'l' " lattice                                       \
  " /\n&material lattice = 'l' model = 'splm_elastic' /\n" bodies

static const char plate[] = DECK(
    "kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' edges = 'exact'",
    "&body lattice = 'l' shape = 'rectangle' corner = 2*0 size = '1500 mm', '900 mm' /\n"
    "&notch lattice = 'l' shape = 'rectangle' corner = '520 mm', 0 size = '3 mm', '210 mm' /\n");
static const char block[] =
    DECK("kind = 'fcc' shells = 2 spacing = '10 mm' rotation = 10 axis = 1, 2, 3",
         "&body lattice = 'l' shape = 'box' corner = 3*0 size = '430 mm', '310 mm', '300 mm' /\n");

static void the_same(const char *text, const char *name, law_setting setting) {
  moved with, without;
  move_body(&with, text, name, setting, true, 2);
  move_body(&without, text, name, setting, false, 1);
  compare(&with, &without);
  close_body(&with);
  close_body(&without);
}

static void plates_move_the_same(void **state) {
  (void)state;
  the_same(plate, "splm_elastic", SETTING_PLANE_STRESS);
  the_same(plate, "splm_concrete", SETTING_PLANE_STRESS);
}

static void blocks_move_the_same(void **state) {
  (void)state;
  the_same(block, "splm_elastic", SETTING_SPACE);
  the_same(block, "splm_concrete", SETTING_SPACE);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(plates_move_the_same),
                                     cmocka_unit_test(blocks_move_the_same)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
