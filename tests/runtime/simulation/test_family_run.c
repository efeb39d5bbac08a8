/* Whole runs with a law of families: energies, threads, resuming, protection, frames and monitors,
   what is said of a state gone bad, and the stable step. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/simulation/same_runs.h"
#include "tests/runtime/simulation/watch_all.h"

/* Everything that moves and takes energy; the format takes threads, the law's values and more
   groups. */
static void open_busy(small_run *r, int threads, const char *values, const char *more) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 2e-4 step_safety = 0.5 threads = %d /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
      "&material lattice = 'c' model = 'm' %s /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.085, 0 size = 0.015, 0.1 /\n"
      "&region name = 'mid' shape = 'point' at = 0.05, 0.03 within = 0.006 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.2 rise = 1e-5 start = 6e-5 /\n"
      "&force region = 'mid' component = 'y' total = 500 history = 'ramp' rise = 1e-4 /\n"
      "&damping rate = 3000 from = 2e-6 until = 1.1e-4 /\n"
      "&gravity acceleration = 500, -2000 rise = 1.5e-4 /\n"
      "&initial_velocity region = 'mid' component = 'y' value = 0.02 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' average = 3e-5 /\n"
      "&monitor name = 'worst' kind = 'field' field = 'omega' region = 'mid' /\n"
      "&monitor name = 'strain' kind = 'field' field = 'xx' region = 'mid' /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n" WATCH_ALL("0")
      "&output frames = 7 sample = 1e-6 %s\n",
      threads, values, more);
  small_open(r, &family_hexagon, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* --- energies --------------------------------------------------------------------------------- */

/* Undamaged springs take nothing; what stretches of 1e-5 leave is of their second order in time. */
static void an_elastic_body_loses_nothing(void **state) {
  (void)state;
  small_run r;
  open_busy(&r, 2, "", "/");
  loses_nothing(&r);
  small_close(&r);
}

/* With damage and dampers the law takes what the stored energy lets go; never negative, and more
   with a damper. */
static void a_breaking_body_takes_energy(void **state) {
  (void)state;
  double taken[2];
  for (int damper = 0; damper < 2; damper++) {
    small_run r;
    open_busy(&r, 2, damper ? "S_t = 1e-4 tau = 1e-7" : "S_t = 1e-4", "/");
    assert_int_equal(small_go(&r), STEP_END);
    const double external = small_largest(&r, "energy/external");
    const double *damage;
    simulation_series(r.simulation, small_series(&r, "energy/dissipated_damage"), NULL, &damage);
    const long samples = simulation_history(r.simulation, NULL);
    for (long k = 1; k < samples; k++)
      assert_true(damage[k] >= damage[k - 1] - 1e-3 * external);
    taken[damper] = damage[samples - 1];
    assert_true(taken[damper] > 0.1 * external);
    assert_true(small_largest(&r, "energy/imbalance") <= 1e-12 * external);
    assert_true(small_last(&r, "cracks") > 0);
    small_close(&r);
  }
  assert_true(taken[0] != taken[1]);
}

/* --- same bits -------------------------------------------------------------------------------- */

static const char broken[] = "S_t = 1e-4 tau = 1e-7";

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  small_run one, many;
  open_busy(&one, 1, broken, "/");
  small_go(&one);
  assert_true(small_last(&one, "cracks") > 0);
  for (int threads = 2; threads <= 3; threads++) {
    open_busy(&many, threads, broken, "/");
    assert_int_equal(simulation_threads(many.simulation), threads);
    small_go(&many);
    same_runs(&one, &many);
    small_close(&many);
  }
  small_close(&one);
}

static void a_resumed_run_gives_the_same_bits(void **state) {
  (void)state;
  small_run straight;
  open_busy(&straight, 2, broken, "/");
  const long total = simulation_step_count(straight.simulation);
  small_go(&straight);
  const long stops[] = {0, 7, total / 2 + 1, total - 1};
  for (int k = 0; k < 4; k++) {
    small_run first, second;
    open_busy(&first, 1, broken, "/");
    open_busy(&second, 3, broken, "/");
    hand_over(first.simulation, stops[k], second.simulation);
    small_close(&first);
    small_go(&second);
    same_runs(&straight, &second);
    small_close(&second);
  }
  small_close(&straight);
}

/* --- what a run shows ------------------------------------------------------------------------- */

static int field_named(const small_run *r, const char *name, const frame_field **field) {
  const int count = simulation_frame_fields(r->simulation, field);
  for (int k = 0; k < count; k++)
    if (strcmp((*field)[k].name, name) == 0) {
      *field += k;
      return k;
    }
  return -1;
}

static double *frame_of(const small_run *r, const char *name, const char *kind, bool on_bonds) {
  const frame_field *field;
  const rows *g = simulation_rows(r->simulation, 0);
  const int k = field_named(r, name, &field);
  assert_true(k >= 0);
  assert_string_equal(field->kind, kind);
  assert_int_equal(field->on_bonds, on_bonds);
  const long count = (on_bonds ? g->bond_count : g->particle_count) * field->components;
  double *values = must_calloc((size_t)count, sizeof *values);
  simulation_frame_values(r->simulation, k, values);
  return values;
}

static void frames_hold_fields_where_they_stand(void **state) {
  (void)state;
  small_run r;
  open_busy(&r, 2, broken,
            "fields = 'displacement', 'force', 'damage', 'most', 'stretches', 'xx', 'energy' /");
  small_go(&r);
  const rows *g = simulation_rows(r.simulation, 0);
  const sweep *w = simulation_state(r.simulation, 0);
  double *damage = frame_of(&r, "damage", "damage", false);
  double *omega = frame_of(&r, "omega", "damage", false);
  double *most = frame_of(&r, "most", "state", true);
  double *stretch = frame_of(&r, "stretches", "output", true);
  double *energy = frame_of(&r, "energy", "output", false);
  double *force = frame_of(&r, "force", "other", false);
  double stored = 0, largest = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    assert_true(damage[p] == w->field[0][site] && omega[p] == damage[p]);
    assert_true(force[2 * p] == w->body->force[0][site]);
    stored += energy[p];
    largest = fmax(largest, damage[p]);
  }
  assert_true(largest > 0.1);
  assert_true(fabs(stored - small_last(&r, "energy/stored")) <= 1e-12 * stored);
  rows_bond *bonds = rows_bonds(g);
  for (long m = 0; m < g->bond_count; m++) {
    const long i = g->particle_site[bonds[m].i], j = g->particle_site[bonds[m].j];
    const double dx = g->x[j] - g->x[i] + w->body->displacement[0][j] - w->body->displacement[0][i];
    const double dy = g->y[j] - g->y[i] + w->body->displacement[1][j] - w->body->displacement[1][i];
    assert_true(fabs(stretch[m] - (hypot(dx, dy) / 0.01 - 1)) < 1e-13);
    assert_true(most[m] > -1);
  }
  double *const all[] = {damage, omega, most, stretch, energy, force};
  for (int k = 0; k < 6; k++)
    free(all[k]);
  free(bonds);
  small_close(&r);
}

static void monitors_watch_fields_and_outputs(void **state) {
  (void)state;
  small_run r;
  const char *unit_text;
  open_busy(&r, 2, broken, "fields = 'xx' /");
  small_go(&r);
  const rows *g = simulation_rows(r.simulation, 0);
  long middle = -1, damaged = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    const double far = hypot(g->x[site] - 0.05, g->y[site] - 0.03);
    if (middle < 0 ||
        far < hypot(g->x[g->particle_site[middle]] - 0.05, g->y[g->particle_site[middle]] - 0.03))
      middle = p;
    damaged += simulation_state(r.simulation, 0)->field[0][site] > 0;
  }
  double *strain = frame_of(&r, "xx", "output", false);
  assert_true(small_last(&r, "strain") == strain[middle] && strain[middle] != 0);
  assert_true(small_last(&r, "worst") ==
              simulation_state(r.simulation, 0)->field[0][g->particle_site[middle]]);
  assert_true(small_last(&r, "cracks") == (double)damaged); /* particles: no damage on bonds */
  simulation_series(r.simulation, small_series(&r, "worst"), &unit_text, NULL);
  assert_string_equal(unit_text, "1");
  free(strain);
  small_close(&r);
}

/* Outputs are found once for a state: with the energies, or else by the first monitor that asks, in
   a step or in a sample. */
static void watched_outputs_are_of_the_present_state(void **state) {
  (void)state;
  static const char mean[] = "/\n&monitor name = 'mean' kind = 'field' field = 'xx' region = 'mid' "
                             "average = 1e-5 /\n&monitor name = 'W' kind = 'field' field = "
                             "'energy' region = 'mid' /";
  static const char *const watched[] = {"strain", "mean", "W"};
  char without[400];
  small_run r[2];
  snprintf(without, sizeof without, "energy = .false. %s", mean);
  open_busy(&r[0], 2, broken, mean);
  open_busy(&r[1], 2, broken, without);
  for (int k = 0; k < 2; k++)
    assert_int_equal(small_go(&r[k]), STEP_END);
  const long samples = simulation_history(r[0].simulation, NULL);
  assert_int_equal(simulation_history(r[1].simulation, NULL), samples);
  for (int m = 0; m < 3; m++) {
    const double *values[2];
    for (int k = 0; k < 2; k++)
      simulation_series(r[k].simulation, small_series(&r[k], watched[m]), NULL, &values[k]);
    assert_memory_equal(values[0], values[1], (size_t)samples * sizeof(double));
    assert_true(values[0][samples - 1] != 0);
    assert_true(values[0][samples - 1] != values[0][samples - 2]);
  }
  small_close(&r[0]);
  small_close(&r[1]);
}

static void unknown_fields_are_refused(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon,
             "&simulation end_time = 1e-4 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'm' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
             "&region name = 'all' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
             "&monitor name = 'a' kind = 'field' field = 'most' region = 'all' /\n");
  assert_null(r.simulation);
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  diag_print(&r.said, out);
  fclose(out);
  assert_non_null(strstr(text, "has no `most` on particles"));
  assert_non_null(strstr(text, "`omega`"));
  free(text);
  small_close(&r);
}

/* A law's own state of that name among the fields of a deck: how many errors there are. */
static int errors_with(const char *name, const char *fields) {
  pl_law law = family_hexagon;
  pl_field named[2] = {family_fields[0], family_fields[1]};
  char text[512];
  named[0].name = name;
  named[0].kind = PL_FIELD_STATE;
  law.fields = named;
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
           "&output fields = %s /\n",
           fields);
  small_run r;
  small_open(&r, &law, text);
  const int errors = r.said.errors;
  assert_true((r.simulation == NULL) == (errors > 0));
  if (errors > 0) assert_int_equal(r.said.items[r.said.count - 1].code, DIAG_RESERVED_NAME);
  small_close(&r);
  return errors;
}

static void fields_that_a_result_has_already_are_refused(void **state) {
  (void)state;
  assert_int_equal(errors_with("omega", "'omega', 'most'"), 0);
  assert_int_equal(errors_with("velocity", "'velocity'"), 1);
  assert_int_equal(errors_with("velocity", "'displacement'"), 0);
  assert_int_equal(errors_with("time", "'time'"), 1);
  assert_int_equal(errors_with("c", "'c', 'most'"), 1); /* /frames/c is the folder of `most` */
  assert_int_equal(errors_with("c", "'c'"), 0);
}

static void protection_holds_damage(void **state) {
  (void)state;
  small_run r;
  open_busy(
      &r, 2, broken,
      "/\n&protect region = 'right' radius = 1.01 /\n&protect region = 'left' radius = 1.01 /");
  small_go(&r);
  const rows *g = simulation_rows(r.simulation, 0);
  const sweep *w = simulation_state(r.simulation, 0);
  double inside = 0, outside = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long site = g->particle_site[p];
    double *most = g->held[site] ? &inside : &outside;
    *most = fmax(*most, w->field[0][site]);
  }
  assert_true(inside == 0 && outside > 0.1);
  small_close(&r);
}

static void a_state_gone_bad_is_named_with_its_family(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    small_run r;
    open_busy(&r, threads, broken, "/");
    assert_int_equal(simulation_advance(r.simulation, 20, NULL), STEP_OK);
    sweep *w = simulation_state(r.simulation, 0);
    const rows *g = w->body->lattice;
    const long particle = g->particle_count / 2, site = g->particle_site[particle];
    w->field[0][site] = NAN;
    assert_int_equal(simulation_advance(r.simulation, 10, NULL), STEP_BAD);
    assert_int_equal(simulation_step_done(r.simulation), 20);
    const bad_state bad = simulation_bad(r.simulation);
    assert_string_equal(bad.what, "not a number");
    assert_int_equal(bad.bond_particle, -1);
    assert_true(bad.family_count >= 3);
    bool named = bad.particle == particle;
    for (int k = 0; k < bad.family_count; k++) {
      named |= bad.family[k].particle == particle && isnan(bad.family[k].fields[0]);
      assert_true(fabs(bad.family[k].stretch) < 1e-3);
      assert_true(bad.family[k].fields[1] > -1 && bad.family[k].fields[1] < 1e-3);
    }
    assert_true(named);
    small_close(&r);
  }
}

/* --- stable step ------------------------------------------------------------------------------ */

/* Largest displacement after some hundred steps from a random start, over that of the first ten. */
static double growth(double part) {
  uint64_t seed = 88172645463325252;
  small_run r;
  small_open(&r, &family_hexagon,
             "&simulation end_time = 1 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'm' tau = 1e-7 /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 1, 1 /\n"
             "&output frames = 0 energy = .false. sample = 1 /\n");
  assert_non_null(r.simulation);
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  w->body->time_step = part * simulation_step_limit(r.simulation)->limit;
  double first = 0, last = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      seed ^= seed << 13;
      seed ^= seed >> 7;
      seed ^= seed << 17;
      w->body->velocity[d][g->particle_site[p]] = 1e-9 * (double)(int64_t)seed * 0x1p-63;
    }
  for (int n = 0; n < 400; n++) {
    sweep_step(w);
    for (long p = 0; p < g->particle_count; p++)
      *(n < 10 ? &first : &last) = fmax(n < 10    ? first
                                        : n < 390 ? 0
                                                  : last,
                                        fabs(w->body->velocity[0][g->particle_site[p]]));
  }
  small_close(&r);
  return last / first;
}

static void the_step_limit_is_sharp(void **state) {
  (void)state;
  assert_true(growth(0.999) < 2);
  assert_true(growth(1.001) > 100);
}

/* A solver keeps its kernel when its deck is given another lattice. */
static void a_kernel_of_six_neighbours_takes_no_more(void **state) {
  (void)state;
  static const char plate[] =
      "&simulation end_time = 1e-4 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 shells = %d /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n";
  pl_law six = family_hexagon;
  six.neighbours = 6;
  for (int shells = 1; shells <= 2; shells++) {
    char text[1024];
    small_run r;
    snprintf(text, sizeof text, plate, shells);
    small_open(&r, &six, text);
    assert_int_equal(r.simulation != NULL, shells == 1);
    if (shells == 2) assert_non_null(strstr(r.said.items[0].message, "6 neighbours, not 12"));
    small_close(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_kernel_of_six_neighbours_takes_no_more),
      cmocka_unit_test(an_elastic_body_loses_nothing),
      cmocka_unit_test(a_breaking_body_takes_energy),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(a_resumed_run_gives_the_same_bits),
      cmocka_unit_test(frames_hold_fields_where_they_stand),
      cmocka_unit_test(monitors_watch_fields_and_outputs),
      cmocka_unit_test(watched_outputs_are_of_the_present_state),
      cmocka_unit_test(unknown_fields_are_refused),
      cmocka_unit_test(fields_that_a_result_has_already_are_refused),
      cmocka_unit_test(protection_holds_damage),
      cmocka_unit_test(a_state_gone_bad_is_named_with_its_family),
      cmocka_unit_test(the_step_limit_is_sharp),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
