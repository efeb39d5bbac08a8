/* Two laws of families on one lattice, each with its share of the particles: one law in two parts
   gives what it gives whole; across a boundary a bond bears the mean of what both laws give it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/ir/random_values.h"
#include "generator/lower/lowered.h"
#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

#define START "&simulation end_time = 1 /\n&material lattice = 'l' model = 'm' /\n"
#define HEXAGON                                                                                    \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"                \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n"
#define SQUARE                                                                                     \
  "&lattice name = 'l' kind = 'square' spacing = '5 mm' thickness = '10 mm' horizon = 3.015 /\n"   \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n"
#define FCC                                                                                        \
  "&lattice name = 'l' kind = 'fcc' spacing = '5 mm' shells = 2 /\n"                               \
  "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = '18 mm' /\n"
#define NOISE                                                                                      \
  "&lattice name = 'l' kind = 'blue_noise' spacing = '5 mm' thickness = '10 mm' /\n"               \
  "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = '40 mm' /\n"
#define CHAIN                                                                                      \
  "&lattice name = 'l' kind = 'square' spacing = '5 mm' thickness = '10 mm' /\n"                   \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, '-1 mm' size = '95 mm', '2 mm' /\n"

/* A law at work on a lattice, on the interpreter. */
typedef struct part {
  model model;
  pl_law *law;
  double *parameters;
  sweep *state;
} part;

static law_setting setting_of(const rows *g) {
  return g->dimensions == 3 ? SETTING_SPACE : SETTING_PLANE_STRESS;
}

static void part_open(part *p, const char *name, const rows *g, const double *share) {
  char path[4096];
  const law_variation v = {.shares = share != NULL};
  snprintf(path, sizeof path, SOURCE_DIR "/models/%s.plm", name);
  memset(p, 0, sizeof *p);
  assert_true(model_open(&p->model, path, NULL, 0));
  p->model.law =
      law_on_lattice(p->model.law, setting_of(g), g->list != NULL, g->list ? 0 : 2 * g->directions);
  assert_true(model_plan_varying(&p->model, &v));
  p->law = plan_interpreted(p->model.plan);
  assert_int_equal(p->law->reads_share, share != NULL);
  p->parameters = must_calloc((size_t)p->law->parameter_count + 1, sizeof *p->parameters);
  for (int k = 0; k < p->law->parameter_count; k++)
    p->parameters[k] = p->law->parameters[k].initial;
}

static void part_start(part *p, const rows *g, const double *share) {
  p->state = interaction_new(g, p->law, p->parameters, 1e-7, 2, true, true);
  p->state->share = share;
}

static void part_close(part *p) {
  sweep_free(p->state);
  free(p->parameters);
  plan_interpreted_free(p->law);
  model_close(&p->model);
}

static double *value_of(const part *p, const char *name) {
  for (int k = 0; k < p->law->parameter_count; k++)
    if (strcmp(p->law->parameters[k].name, name) == 0) return &p->parameters[k];
  fail_msg("no parameter %s", name);
  return NULL;
}

/* 1 where x is below `below`, and what is left of 1. */
static double *shares_of(const rows *g, double below, bool left) {
  double *share = must_calloc((size_t)g->size, sizeof *share);
  for (long q = 0; q < g->size; q++)
    share[q] = (g->x[q] < below) != left;
  return share;
}

static void move(const part *p, int component, long site, double by) {
  p->state->body->displacement[component][site] = by;
}

static double stored(const part *p) {
  double sum = 0;
  sweep_observe(p->state);
  for (int row = 0; row < p->state->body->lattice->row_count; row++)
    sum += p->state->body->observed[row].stored;
  return sum;
}

/* --- one law in two parts --------------------------------------------------------------------- */

static void check_whole(const char *name, const char *text) {
  deck_case c;
  char deck_text[2048];
  snprintf(deck_text, sizeof deck_text, START "%s", text);
  assert_true(deck_case_lattice(&c, deck_text));
  const rows *g = c.lattice;
  double *share[] = {NULL, shares_of(g, 1.3e-3, false), shares_of(g, 1.3e-3, true)};
  part parts[3];
  uint64_t seed = 7;
  for (int k = 0; k < 3; k++) {
    part_open(&parts[k], name, g, share[k]);
    if (k == 0) rows_set_density(c.lattice, *value_of(&parts[0], "rho"));
    part_start(&parts[k], g, share[k]);
  }
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < g->dimensions; d++) {
      const double by = g->spacing * draw_uniform(&seed, -1e-3, 1e-3);
      for (int k = 0; k < 3; k++)
        move(&parts[k], d, g->particle_site[p], by);
    }
  for (int k = 0; k < 3; k++)
    sweep_find_forces(parts[k].state);
  double most = 0, gap = 0, across = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < g->dimensions; d++) {
      double f[3];
      for (int k = 0; k < 3; k++)
        f[k] = parts[k].state->body->force[d][g->particle_site[p]];
      most = fmax(most, fabs(f[0]));
      gap = fmax(gap, fabs(f[1] + f[2] - f[0]));
      across = fmax(across, fmin(fabs(f[1]), fabs(f[2])));
    }
  const double energy = stored(&parts[0]), sum = stored(&parts[1]) + stored(&parts[2]);
  print_message("%-13s of %ld particles: forces %.1e of the largest off, energy %.1e\n", name,
                g->particle_count, gap / most, fabs(sum - energy) / energy);
  assert_true(gap < 1e-13 * most && across > 0.01 * most);
  assert_true(energy > 0 && fabs(sum - energy) < 1e-13 * energy);
  for (int k = 0; k < 3; k++) {
    part_close(&parts[k]);
    free(share[k]);
  }
  deck_case_close(&c);
}

static void a_law_in_two_parts_is_the_whole(void **state) {
  (void)state;
  check_whole("splm_elastic", HEXAGON);
  check_whole("splm_elastic", NOISE);
  check_whole("splm_elastic", FCC);
  check_whole("lps", SQUARE);
  check_whole("lps", NOISE);
  check_whole("pmb", SQUARE);
}

/* --- two laws --------------------------------------------------------------------------------- */

/* Forces of bonds balance, whatever laws they come from. */
static void two_laws_give_no_momentum(void **state) {
  (void)state;
  deck_case c;
  assert_true(deck_case_lattice(&c, START HEXAGON));
  const rows *g = c.lattice;
  static const char *const names[] = {"splm_elastic", "lps"};
  double *share[] = {shares_of(g, 1.3e-3, false), shares_of(g, 1.3e-3, true)};
  double sum[2] = {0, 0}, moment = 0, size = 0;
  uint64_t seed = 11;
  part parts[2];
  for (int k = 0; k < 2; k++) {
    part_open(&parts[k], names[k], g, share[k]);
    if (k == 0) rows_set_density(c.lattice, *value_of(&parts[0], "rho"));
    part_start(&parts[k], g, share[k]);
  }
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      const double by = g->spacing * draw_uniform(&seed, -1e-2, 1e-2);
      for (int k = 0; k < 2; k++)
        move(&parts[k], d, g->particle_site[p], by);
    }
  for (int k = 0; k < 2; k++)
    sweep_find_forces(parts[k].state);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    double f[2], at[2] = {g->x[q], g->y[q]};
    for (int d = 0; d < 2; d++) {
      f[d] = parts[0].state->body->force[d][q] + parts[1].state->body->force[d][q];
      at[d] += parts[0].state->body->displacement[d][q];
      sum[d] += f[d];
      size += fabs(f[d]);
    }
    moment += at[0] * f[1] - at[1] * f[0];
  }
  print_message("two laws: force %.1e, moment %.1e of the sum of sizes\n",
                hypot(sum[0], sum[1]) / size, fabs(moment) / (0.04 * size));
  assert_true(hypot(sum[0], sum[1]) < 1e-13 * size && fabs(moment) < 1e-13 * 0.04 * size);
  for (int k = 0; k < 2; k++) {
    part_close(&parts[k]);
    free(share[k]);
  }
  deck_case_close(&c);
}

/* A chain of E and 2 E: what all bonds bear alike stretches them by 1, 2/3 and 1/2: the bond across
   is as stiff as the mean of both. */
static void a_bar_of_two_laws_balances_at_the_boundary(void **state) {
  (void)state;
  enum { LEFT = 10, PARTICLES = 20 };
  deck_case c;
  assert_true(deck_case_lattice(&c, START CHAIN));
  const rows *g = c.lattice;
  assert_int_equal(g->particle_count, PARTICLES);
  const double boundary = g->x[g->particle_site[LEFT]] - 0.5 * g->spacing, stretch = 1e-4;
  double *share[] = {shares_of(g, boundary, false), shares_of(g, boundary, true)};
  part parts[2];
  for (int k = 0; k < 2; k++) {
    part_open(&parts[k], "pmb", g, share[k]);
    *value_of(&parts[k], "G_0") = 1e6; /* nothing breaks */
    *value_of(&parts[k], "E") *= 1 + k;
    if (k == 0) rows_set_density(c.lattice, *value_of(&parts[0], "rho"));
    part_start(&parts[k], g, share[k]);
  }
  double u = 0;
  for (int p = 0; p < PARTICLES; p++) {
    const double part_of = p < LEFT ? 1 : p == LEFT ? 2.0 / 3 : 0.5;
    u += p ? part_of * stretch * g->spacing : 0;
    for (int k = 0; k < 2; k++)
      move(&parts[k], 0, g->particle_site[p], u);
  }
  for (int k = 0; k < 2; k++)
    sweep_find_forces(parts[k].state);
  double borne = 0, left = 0;
  for (int p = 0; p < PARTICLES; p++) {
    const double f = parts[0].state->body->force[0][g->particle_site[p]] +
                     parts[1].state->body->force[0][g->particle_site[p]];
    if (p == 0) borne = f;
    if (p > 1 && p < PARTICLES - 2) left = fmax(left, fabs(f)); /* families at the ends are less */
  }
  print_message("boundary of E and 2 E: %.1e of the force is left\n", left / fabs(borne));
  assert_true(borne > 0 && left < 1e-11 * borne);
  for (int k = 0; k < 2; k++) {
    part_close(&parts[k]);
    free(share[k]);
  }
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_law_in_two_parts_is_the_whole),
      cmocka_unit_test(two_laws_give_no_momentum),
      cmocka_unit_test(a_bar_of_two_laws_balances_at_the_boundary),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
