/* Several lattices with laws of their own in one run: each body moves as it would alone, to the
   last bit; energies add up; what only some of them have; names that clash. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_read.h"
#include "runtime/interaction/sweep.h"
#include "runtime/parts/run_body.h"
#include "runtime/simulation/simulation.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/elastic_law.h"
#include "tests/runtime/family_law.h"

enum { BEAM, BLOCK, BAR, BODIES };
static const pl_law *const laws[BODIES] = {&elastic_beam, &family_hexagon, &elastic_bar};

typedef struct together {
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  double parameters[BODIES][ELASTIC_PARAMETERS];
  simulation_law law[BODIES];
  simulation *simulation;
} together;

/* The laws are those of the deck's materials, in their order. */
static void open_all(together *t, const char *text, const pl_law *const *of) {
  memset(t, 0, sizeof *t);
  t->memory = arena_new();
  diag_begin(&t->said, &t->sources);
  const int file = source_add(&t->sources, "deck.nml", text, strlen(text));
  t->deck = deck_read(t->memory, &t->sources, file, NULL, 0, &t->said);
  for (int b = 0; t->deck && b < t->deck->lattice_count; b++) {
    assert_true(material_parameters(&t->deck->materials[b], of[b], t->parameters[b], &t->said));
    t->law[b] = (simulation_law){.law = of[b], .parameters = t->parameters[b]};
  }
  if (t->deck) t->simulation = simulation_new(t->deck, t->law, &t->said);
}

static void close_all(together *t) {
  simulation_free(t->simulation);
  diag_clear(&t->said);
  source_clear(&t->sources);
  arena_free(t->memory);
}

/* What all decks begin with, then what each body brings; places do not overlap. */
#define HEAD                                                                                       \
  "&simulation end_time = 1e-4 step = 2e-7 threads = %d /\n"                                       \
  "&gravity acceleration = 300, -2000 rise = 5e-5 /\n&damping rate = 2000 until = 6e-5 /\n"
#define OF_BODY(name, kind, more)                                                                  \
  "&lattice name = '" name "' kind = " kind " thickness = 0.1 /\n"                                 \
  "&material lattice = '" name "' model = 'm' " more " /\n"
#define BEAM_DECK                                                                                  \
  OF_BODY("beam", "'hexagonal' spacing = 0.01", "S_t = 1e-5")                                      \
  "&body lattice = 'beam' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.05 /\n"                  \
  "&region name = 'foot' lattice = 'beam' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n" \
  "&region name = 'tip' lattice = 'beam' shape = 'rectangle' corner = 0.19, 0 size = 0.1, 0.1 /\n" \
  "&support region = 'foot' fix = 'x', 'y', 'rotation' /\n"                                        \
  "&drive region = 'tip' component = 'y' velocity = 0.3 rise = 1e-5 start = 2e-5 /\n"
#define BLOCK_DECK                                                                                 \
  OF_BODY("block", "'hexagonal' spacing = 0.012", "S_t = 1e-6")                                    \
  "&body lattice = 'block' shape = 'rectangle' corner = 0, 0.3 size = 0.1, 0.25 /\n"               \
  "&region name = 'side' lattice = 'block' shape = 'rectangle' corner = 0, 0.3 size = 0.02, 1 /\n" \
  "&force region = 'side' component = 'x' total = 90000 history = 'ramp' rise = 1e-4 /\n"
#define BAR_DECK                                                                                   \
  OF_BODY("bar", "'hexagonal' spacing = 0.008 rotation = 20", "tau = 1e-7")                        \
  "&body lattice = 'bar' shape = 'rectangle' corner = 0.5, 0 size = 0.03, 0.1 /\n"                 \
  "&region name = 'all' lattice = 'bar' shape = 'rectangle' corner = 0.4, 0 size = 1, 1 /\n"       \
  "&initial_velocity region = 'all' component = 'x' value = 1 /\n"
#define HISTORY "&output frames = 3 sample = 2e-6 /\n"
#define FRAMES                                                                                     \
  "&output frames = 3 sample = 2e-6 fields = 'displacement', 'rotation', 'damage', 'omega', "      \
  "'most' /\n"
#define WATCHED                                                                                    \
  "&monitor name = 'load' kind = 'reaction' region = 'foot' component = 'y' /\n"                   \
  "&monitor name = 'gap' kind = 'opening' between = 'tip', 'all' component = 'x' /\n"              \
  "&monitor name = 'worst' kind = 'field' field = 'omega' region = 'side' /\n"                     \
  "&monitor name = 'cracks' kind = 'damaged' /\n"                                                  \
  "&monitor name = 'of_beam' kind = 'damaged' lattice = 'beam' /\n"                                \
  "&monitor name = 'of_block' kind = 'damaged' lattice = 'block' /\n"                              \
  "&monitor name = 'kinetic' kind = 'energy' lattice = 'beam' component = 'kinetic' /\n"           \
  "&monitor name = 'stored' kind = 'energy' lattice = 'block' component = 'stored' /\n"            \
  "&monitor name = 'p' kind = 'momentum' lattice = 'bar' component = 'x' /\n"                      \
  "&monitor name = 'N' kind = 'force' lattice = 'beam' at = 0.1, 0 normal = 1, 0 /\n"              \
  "&monitor name = 'sigma' kind = 'stress' lattice = 'block' at = 0.05, 0.4 component = 'yy' /\n"

static void must_open_all(together *t, int threads, const char *more) {
  char text[8192];
  snprintf(text, sizeof text, HEAD BEAM_DECK BLOCK_DECK BAR_DECK FRAMES "%s", threads, more);
  open_all(t, text, laws);
  if (!t->simulation) diag_print(&t->said, stderr);
  assert_non_null(t->simulation);
}

static void go_on(simulation *s, long steps) {
  const long until = simulation_step_done(s) + steps;
  step_status status = STEP_OK;
  while (status == STEP_OK && simulation_step_done(s) < until) {
    if (simulation_frame_due(s)) simulation_frame_taken(s);
    status = simulation_advance(s, until - simulation_step_done(s), NULL);
  }
}

static int series_of(const simulation *s, const char *name) {
  for (int k = 0; k < simulation_series_count(s); k++)
    if (strcmp(simulation_series(s, k, NULL, NULL), name) == 0) return k;
  fail_msg("no series %s", name);
  return -1;
}

static const double *values_of(const simulation *s, const char *name) {
  const double *values;
  simulation_series(s, series_of(s, name), NULL, &values);
  return values;
}

static void same_motion(simulation *a, int of_a, simulation *b, int of_b) {
  const sweep *x = simulation_state(a, of_a), *y = simulation_state(b, of_b);
  const size_t site = (size_t)x->body->lattice->size * sizeof(double);
  assert_int_equal(x->body->lattice->size, y->body->lattice->size);
  for (int d = 0; d < x->body->dof; d++) {
    assert_memory_equal(x->body->displacement[d], y->body->displacement[d], site);
    assert_memory_equal(x->body->velocity[d], y->body->velocity[d], site);
  }
  for (int f = 0; f < x->law->field_count; f++) {
    const size_t planes = (size_t)sweep_planes(x, (int)x->law->fields[f].place);
    assert_memory_equal(x->field[f], y->field[f], planes * site);
  }
}

static void each_body_moves_as_it_would_alone(void **state) {
  (void)state;
  static const char *const alone[BODIES] = {HEAD BEAM_DECK HISTORY, HEAD BLOCK_DECK HISTORY,
                                            HEAD BAR_DECK HISTORY};
  static const char *const names[BODIES] = {"beam", "block", "bar"};
  together all;
  must_open_all(&all, 2, "");
  go_on(all.simulation, 10000);
  const long samples = simulation_history(all.simulation, NULL);
  for (int b = 0; b < BODIES; b++) {
    together one;
    char text[4096], name[64];
    snprintf(text, sizeof text, alone[b], 1);
    open_all(&one, text, &laws[b]);
    if (!one.simulation) diag_print(&one.said, stderr);
    go_on(one.simulation, 10000);
    same_motion(all.simulation, b, one.simulation, 0);
    assert_int_equal(simulation_history(one.simulation, NULL), samples);
    for (int term = 0; term < LEDGER_COUNT; term++) {
      snprintf(name, sizeof name, "%s/%s", names[b], ledger_names[term] + strlen("energy/"));
      assert_memory_equal(values_of(all.simulation, name),
                          values_of(one.simulation, ledger_names[term]),
                          (size_t)samples * sizeof(double));
    }
    close_all(&one);
  }
  close_all(&all);
}

/* Something happens in each, and the sums are the sums. */
static void energies_add_up(void **state) {
  (void)state;
  together t;
  must_open_all(&t, 1, WATCHED);
  go_on(t.simulation, 10000);
  const simulation *s = t.simulation;
  const long last = simulation_history(s, NULL) - 1;
  for (int term = 0; term < LEDGER_IMBALANCE; term++) {
    char name[3][64];
    const char *part = ledger_names[term] + strlen("energy/");
    snprintf(name[0], sizeof name[0], "beam/%s", part);
    snprintf(name[1], sizeof name[1], "block/%s", part);
    snprintf(name[2], sizeof name[2], "bar/%s", part);
    for (long n = 0; n <= last; n++) {
      double sum = 0;
      for (int b = 0; b < BODIES; b++)
        sum += values_of(s, name[b])[n];
      assert_true(sum == values_of(s, ledger_names[term])[n]);
    }
  }
  assert_true(values_of(s, "beam/dissipated_damage")[last] > 0);
  assert_true(values_of(s, "bar/dissipated_damping")[last] > 0);
  assert_true(values_of(s, "block/stored")[last] > 0);
  assert_true(isnan(values_of(s, "energy/imbalance")[last])); /* the block's is not known, */
  assert_true(fabs(values_of(s, "beam/imbalance")[last]) <
              1e-2 * values_of(s, "beam/external")[last]);
  const char *why;
  assert_true(simulation_judges(s, series_of(s, "beam/imbalance"), &why) && !why);
  assert_true(simulation_judges(s, series_of(s, "block/imbalance"), &why) && why);
  assert_true(simulation_judges(s, series_of(s, "energy/imbalance"), &why) && why);
  assert_false(simulation_judges(s, series_of(s, "beam/kinetic"), &why));
  close_all(&t);
}

/* Counts go over all bodies; an opening lies between two of them. */
static void monitors_watch_bodies(void **state) {
  (void)state;
  together t;
  must_open_all(&t, 1, WATCHED);
  go_on(t.simulation, 10000);
  simulation *s = t.simulation;
  const long last = simulation_history(s, NULL) - 1;
  const sweep *beam = simulation_state(s, BEAM), *bar = simulation_state(s, BAR);
  const rows *g = beam->body->lattice, *b = bar->body->lattice;
  double bonds = 0, particles = 0, mean[2] = {0, 0};
  for (int k = 0; k < g->directions; k++)
    for (long q = 0; q < g->size; q++)
      bonds += rows_has_bond(g, q, k) && beam->field[0][k * g->size + q] > 0;
  const sweep *block = simulation_state(s, BLOCK);
  for (long p = 0; p < block->body->lattice->particle_count; p++)
    particles += block->field[0][block->body->lattice->particle_site[p]] > 0;
  for (long p = 0; p < b->particle_count; p++)
    mean[1] += bar->body->displacement[0][b->particle_site[p]] / (double)b->particle_count;
  long count = 0;
  for (long p = 0; p < g->particle_count; p++) {
    if (g->x[g->particle_site[p]] < 0.19 - 1e-6) continue;
    mean[0] += beam->body->displacement[0][g->particle_site[p]];
    count++;
  }
  assert_true(bonds > 0 && particles > 0);
  assert_true(values_of(s, "cracks")[last] >= bonds + particles);
  assert_true(values_of(s, "cracks")[last] <= 1.1 * (bonds + particles) + 5);
  assert_true(fabs(values_of(s, "gap")[last] - (mean[1] - mean[0] / (double)count)) < 1e-15);
  assert_true(values_of(s, "of_beam")[last] > 0 && values_of(s, "of_block")[last] > 0);
  const double mass = b->mass * (double)b->particle_count;
  double sigma = 0;
  assert_true(fabs(values_of(s, "p")[0] - mass) < 1e-12 * mass);
  for (long n = 0; n <= last; n++) {
    const double kinetic = values_of(s, "beam/kinetic")[n],
                 stored = values_of(s, "block/stored")[n];
    assert_true(values_of(s, "of_beam")[n] + values_of(s, "of_block")[n] ==
                values_of(s, "cracks")[n]);
    assert_true(fabs(values_of(s, "kinetic")[n] - kinetic) <= 1e-10 * fabs(kinetic));
    assert_true(fabs(values_of(s, "stored")[n] - stored) <= 1e-12 * stored);
    sigma = fmax(sigma, fabs(values_of(s, "sigma")[n]));
  }
  assert_true(fabs(values_of(s, "N")[last]) > 1 && sigma > 1);
  assert_true(values_of(s, "worst")[last] > 0);
  assert_true(fabs(values_of(s, "load")[last]) > 1);
  close_all(&t);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  together one, more;
  must_open_all(&one, 1, WATCHED);
  go_on(one.simulation, 10000);
  for (int threads = 2; threads <= 5; threads += 3) {
    must_open_all(&more, threads, WATCHED);
    assert_int_equal(simulation_threads(more.simulation), threads);
    go_on(more.simulation, 10000);
    for (int b = 0; b < BODIES; b++)
      same_motion(one.simulation, b, more.simulation, b);
    close_all(&more);
  }
  close_all(&one);
}

static void a_resumed_run_has_the_same_bits(void **state) {
  (void)state;
  static const char path[] = "test_bodies.state";
  char error[256];
  frame_mark frames = {0};
  together whole, first, second;
  must_open_all(&whole, 2, WATCHED);
  go_on(whole.simulation, 10000);
  must_open_all(&first, 2, WATCHED);
  go_on(first.simulation, 217);
  assert_true(simulation_save(first.simulation, path, "x", &frames, error, sizeof error));
  close_all(&first);
  must_open_all(&second, 3, WATCHED);
  if (!simulation_restore(second.simulation, path, "x", &frames, error, sizeof error))
    fail_msg("%s", error);
  go_on(second.simulation, 10000);
  for (int b = 0; b < BODIES; b++)
    same_motion(whole.simulation, b, second.simulation, b);
  const long samples = simulation_history(whole.simulation, NULL);
  for (int k = 0; k < simulation_series_count(whole.simulation); k++) {
    const double *p, *q;
    simulation_series(whole.simulation, k, NULL, &p);
    simulation_series(second.simulation, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  }
  unlink(path);
  close_all(&whole);
  close_all(&second);
}

/* Particles one body after the other; a damage is 0 and a rotation no number where there is none;
   fields of bonds are of their body. */
static void frames_hold_all_bodies(void **state) {
  (void)state;
  together t;
  must_open_all(&t, 1, "");
  go_on(t.simulation, 300);
  const frame_field *f;
  const int count = simulation_frame_fields(t.simulation, &f);
  static const struct {
    const char *name;
    bool on_bonds;
    int of;
  } expected[] = {{"displacement", false, BEAM}, {"rotation", false, BEAM}, {"damage", false, BEAM},
                  {"omega", true, BEAM},         {"omega", false, BLOCK},   {"most", true, BLOCK},
                  {"omega", true, BAR}};
  assert_int_equal(count, sizeof expected / sizeof *expected);
  long particles = 0, first[BODIES];
  for (int b = 0; b < BODIES; b++) {
    first[b] = particles;
    particles += simulation_rows(t.simulation, b)->particle_count;
  }
  double *values = must_calloc(20 * (size_t)particles, sizeof *values);
  for (int k = 0; k < count; k++) {
    assert_string_equal(f[k].name, expected[k].name);
    assert_int_equal(f[k].on_bonds, expected[k].on_bonds);
    assert_int_equal(f[k].interaction, expected[k].of);
    assert_int_equal(f[k].count, f[k].on_bonds
                                     ? simulation_rows(t.simulation, f[k].interaction)->bond_count
                                     : particles);
    simulation_frame_values(t.simulation, k, values);
    for (int b = 0; b < BODIES && !f[k].on_bonds; b++) {
      const sweep *w = simulation_state(t.simulation, b);
      const rows *g = w->body->lattice;
      for (long p = 0; p < g->particle_count; p++) {
        const double *v = values + (first[b] + p) * f[k].components;
        const long q = g->particle_site[p];
        if (k == 0) assert_true(v[0] == w->body->displacement[0][q]);
        if (k == 1) assert_true(b == BEAM ? v[0] == w->body->displacement[2][q] : isnan(v[0]));
        if (k == 2 && b == BAR) assert_true(v[0] == 0);
        if (k == 4) assert_true(b == BLOCK ? v[0] >= 0 : v[0] == 0);
      }
    }
  }
  free(values);
  close_all(&t);
}

/* Without `step` the shortest of the bodies' limits rules. */
static void the_stiffest_body_chooses_the_step(void **state) {
  (void)state;
  together t;
  char text[8192];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 /\n" BEAM_DECK BLOCK_DECK BAR_DECK FRAMES);
  open_all(&t, text, laws);
  assert_non_null(t.simulation);
  assert_int_equal(simulation_ruling_body(t.simulation), BAR);
  const double step = simulation_step_limit(t.simulation)->step;
  for (int b = 0; b < BODIES; b++)
    assert_true(simulation_state(t.simulation, b)->body->time_step == step);
  close_all(&t);
}

static void the_bad_body_is_named(void **state) {
  (void)state;
  together t;
  must_open_all(&t, 2, "");
  go_on(t.simulation, 20);
  const rows *g = simulation_rows(t.simulation, BLOCK);
  const long before = simulation_rows(t.simulation, BEAM)->particle_count;
  simulation_state(t.simulation, BLOCK)->body->velocity[1][g->particle_site[17]] = NAN;
  go_on(t.simulation, 20);
  const bad_state bad = simulation_bad(t.simulation);
  assert_int_equal(bad.body, BLOCK);
  assert_string_equal(bad.what, "not a number");
  assert_true(bad.particle >= before && bad.particle < before + g->particle_count);
  for (int k = 0; k < bad.family_count; k++)
    assert_true(bad.family[k].particle >= before);
  close_all(&t);
}

/* All come to rest before the next increment. */
static void bodies_relax_together(void **state) {
  (void)state;
  together t;
  open_all(
      &t,
      "&simulation end_time = 1 /\n&relaxation increments = 3 tolerance = 1e-6 /\n" OF_BODY(
          "beam", "'hexagonal' spacing = 0.01", "")
          OF_BODY(
              "block", "'hexagonal' spacing = 0.02",
              "") "&body lattice = 'beam' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.03 /\n"
                  "&body lattice = 'block' shape = 'rectangle' corner = 0, 0.3 size = 0.2, 0.1 /\n"
                  "&region name = 'a' lattice = 'beam' shape = 'rectangle' corner = 0, 0 size = "
                  "0.006, 1 "
                  "/\n"
                  "&region name = 'b' lattice = 'beam' shape = 'rectangle' corner = 0.094, 0 size "
                  "= 0.1, "
                  "1 /\n"
                  "&region name = 'c' lattice = 'block' shape = 'rectangle' corner = 0, 0.3 size = "
                  "0.011, "
                  "1 /\n"
                  "&region name = 'd' lattice = 'block' shape = 'rectangle' corner = 0.189, 0.3 "
                  "size = "
                  "0.1, 1 /\n"
                  "&support region = 'a' fix = 'xy' /\n&support region = 'c' fix = 'xy' /\n"
                  "&force region = 'b' component = 'x' total = 300 /\n"
                  "&force region = 'd' component = 'x' total = 700 /\n"
                  "&monitor name = 'at_a' kind = 'reaction' region = 'a' component = 'x' /\n"
                  "&monitor name = 'at_c' kind = 'reaction' region = 'c' component = 'x' /\n",
      laws);
  if (!t.simulation) diag_print(&t.said, stderr);
  assert_non_null(t.simulation);
  while (simulation_advance(t.simulation, 1L << 40, NULL) == STEP_OK)
    if (simulation_frame_due(t.simulation)) simulation_frame_taken(t.simulation);
  long unbalanced;
  assert_int_equal(simulation_increments(t.simulation, &unbalanced), 3);
  assert_int_equal(unbalanced, 0);
  for (int k = 0; k <= 3; k++) {
    assert_true(fabs(values_of(t.simulation, "at_a")[k] + 100.0 * k) < 1e-3);
    assert_true(fabs(values_of(t.simulation, "at_c")[k] + 700.0 / 3 * k) < 1e-3);
  }
  close_all(&t);
}

/* A soft body is balanced as well as a stiff one beside it: its own forces count. */
static void a_soft_body_comes_to_rest_beside_a_stiff_one(void **state) {
  (void)state;
  static const char alone[] =
      "&simulation end_time = 1 step = 2e-7 /\n&relaxation increments = 1 tolerance = 1e-5 "
      "/\n" OF_BODY(
          "soft", "'hexagonal' spacing = 0.01",
          "E = 30e6") "&body lattice = 'soft' shape = 'rectangle' corner = 0, 0.3 size = 0.06, "
                      "0.03 /\n"
                      "&region name = 'a' lattice = 'soft' shape = 'rectangle' corner = 0, 0 size "
                      "= "
                      "0.006, 1 /\n"
                      "&region name = 'b' lattice = 'soft' shape = 'rectangle' corner = 0.054, 0 "
                      "size = 0.1, 1 /\n"
                      "&support region = 'a' fix = 'xy' /\n"
                      "&drive region = 'b' component = 'x' displacement = 1e-5 /\n"
                      "&monitor name = 'at_a' kind = 'reaction' region = 'a' component = 'x' /\n"
                      "&monitor name = 'at_b' kind = 'reaction' region = 'b' component = 'x' /\n";
  static const char stiff[] =
      OF_BODY("stiff", "'hexagonal' spacing = 0.01", "") "&body lattice = 'stiff' shape = "
                                                         "'rectangle' corner = 0, 0 size = 0.06, "
                                                         "0.03 /\n"
                                                         "&region name = 'c' lattice = 'stiff' "
                                                         "shape = 'rectangle' corner = 0, 0 size "
                                                         "= 0.006, 1 /\n"
                                                         "&region name = 'd' lattice = 'stiff' "
                                                         "shape = 'rectangle' corner = 0.054, 0 "
                                                         "size = 0.1, 1 /\n"
                                                         "&support region = 'c' fix = 'xy' /\n"
                                                         "&drive region = 'd' component = 'x' "
                                                         "displacement = 1e-5 /\n";
  static const pl_law *const bars[] = {&elastic_bar, &elastic_bar};
  char text[4096];
  snprintf(text, sizeof text, "%s%s", alone, stiff);
  together t;
  open_all(&t, text, bars);
  if (!t.simulation) diag_print(&t.said, stderr);
  assert_non_null(t.simulation);
  while (simulation_advance(t.simulation, 1L << 40, NULL) == STEP_OK)
    if (simulation_frame_due(t.simulation)) simulation_frame_taken(t.simulation);
  long unbalanced;
  assert_int_equal(simulation_increments(t.simulation, &unbalanced), 1);
  const double at_a = values_of(t.simulation, "at_a")[1], at_b = values_of(t.simulation, "at_b")[1];
  print_message("%ld unbalanced, %g N and %g N\n", unbalanced, at_a, at_b);
  assert_int_equal(unbalanced, 0);
  assert_true(at_b > 1e-4 && fabs(at_a + at_b) < 1e-3 * at_b);
  close_all(&t);
}

static void must_refuse(const char *text, const pl_law *const *of, const char *at,
                        const char *sentence) {
  together t;
  open_all(&t, text, of);
  assert_null(t.simulation);
  if (t.said.errors != 1) diag_print(&t.said, stderr);
  assert_int_equal(t.said.errors, 1);
  const diagnostic *d = &t.said.items[0];
  if (!strstr(d->message, sentence)) fail_msg("%s, not: %s", d->message, sentence);
  if (strncmp(text + d->where.begin, at, strlen(at)) != 0)
    fail_msg("at %.20s, not at %s", text + d->where.begin, at);
  close_all(&t);
}

#define PAIR(a, b, more)                                                                           \
  "&simulation end_time = 1e-4 /\n" OF_BODY(a, "'hexagonal' spacing = 0.01", "")                   \
      OF_BODY(b, "'hexagonal' spacing = 0.01",                                                     \
              "") "&body lattice = '" a                                                            \
                  "' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n&body lattice = '" b     \
                  "' shape = 'rectangle' corner = 1, 0 size = 0.1, 0.1 /\n" more

static void names_may_not_clash(void **state) {
  (void)state;
  static const pl_law *const bars[] = {&elastic_bar, &elastic_bar};
  together t;
  open_all(&t, PAIR("one", "two", ""), bars);
  assert_non_null(t.simulation);
  close_all(&t);
  must_refuse(PAIR("one", "relaxation_steps", ""), bars, "'relaxation_steps'",
              "a result has another `relaxation_steps`");
  must_refuse(PAIR("one", "energy", ""), bars, "'energy'", "a result has another `energy`");
  must_refuse(PAIR("one", "two", "&monitor name = 'two' kind = 'damaged' /\n"), bars, "'two'",
              "cannot be named as a lattice");
  must_refuse("&simulation end_time = 1e-4 /\n" OF_BODY(
                  "one", "'hexagonal' spacing = 0.01",
                  "") "&body lattice = 'one' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
                      "&monitor name = 'one' kind = 'damaged' /\n"
                      "&stamp name = 'wall' shape = 'disc' centre = 1, 1 radius = 0.1 "
                      "velocity = 0 /\n",
              bars, "'one'", "cannot be named as a lattice");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_body_moves_as_it_would_alone),
      cmocka_unit_test(energies_add_up),
      cmocka_unit_test(monitors_watch_bodies),
      cmocka_unit_test(threads_do_not_change_bits),
      cmocka_unit_test(a_resumed_run_has_the_same_bits),
      cmocka_unit_test(frames_hold_all_bodies),
      cmocka_unit_test(the_stiffest_body_chooses_the_step),
      cmocka_unit_test(the_bad_body_is_named),
      cmocka_unit_test(bodies_relax_together),
      cmocka_unit_test(a_soft_body_comes_to_rest_beside_a_stiff_one),
      cmocka_unit_test(names_may_not_clash),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
