/* A lattice tied to meshes on either side: a uniform strain and a rigid turn through the edge, what
   it throws back of a pulse, momentum, energies, the stable step, the same bits. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/continuum/mesh_ties.h"
#include "runtime/interaction/half_bonds.h"
#include "runtime/loads/tie_steps.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/runtime/hand_over.h"
#include "tests/verification/case.h"

enum { CORE, LEFT, RIGHT, BODIES };
static const double spacing = 5e-3, thickness = 0.01, E = 30e9;

/* Columns of a hexagonal lattice that is turned by 90 degrees stand on the edges. */
typedef struct strip {
  int columns;
  double height, length, cell; /* m: of all; of each mesh; of its cells, about */
  const char *law;
  int beyond; /* columns of the lattice inside the right mesh */
} strip;

/* Of the meshes: density and stiffness over the lattice's; how far the lattice reaches into them,
   mm. */
static double light = 1, overlap = 0;

static double width_of(const strip *s) {
  return s->columns * spacing * sqrt(3) / 2;
}

static void write_strip(const strip *s, const char *head, char *text, size_t size) {
  const int nx = (int)lround(s->length / s->cell) + 1, ny = (int)lround(s->height / s->cell) + 1;
  const double w = 1e3 * width_of(s), h = 1e3 * s->height, l = 1e3 * s->length;
  snprintf(
      text, size,
      "%s"
      "&lattice name = 'core' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' rotation = "
      "90 /\n&material lattice = 'core' %s rho = 2400 /\n"
      "&body lattice = 'core' shape = 'rectangle' corner = 0, 0 size = '%.14g mm', '%g mm' /\n"
      "&mesh name = 'left' corner = '-%g mm', 0 size = '%g mm', '%g mm' nodes = %d, %d "
      "thickness = '10 mm' method = 'finite_elements' /\n"
      "&mesh name = 'right' corner = '%.14g mm', 0 size = '%g mm', '%g mm' nodes = %d, %d "
      "thickness = '10 mm' method = 'finite_elements' /\n"
      "&material mesh = 'left' model = 'elastic' E = %g nu = 0.2 rho = %g /\n"
      "&material mesh = 'right' model = 'elastic' E = %g nu = 0.2 rho = %g /\n"
      "&tie lattice = 'core' mesh = 'left' /\n&tie lattice = 'core' mesh = 'right' /\n",
      head, s->law, w + 1e3 * s->beyond * spacing * sqrt(3) / 2, h, l, l + overlap, h, nx, ny,
      w - overlap, l, h, nx, ny, light * 30e9, light * 2400, light * 30e9, light * 2400);
}

#define MICROPOLAR "model = 'elastic_micropolar' E = 30e9 nu = 0.2"

static void open_strip(deck_case *c, const strip *s, const char *head) {
  char text[8192];
  write_strip(s, head, text, sizeof text);
  deck_case_open(c, text);
}

static body *body_of(const deck_case *c, int number) {
  return simulation_state(c->simulation, number)->body;
}

/* --- what is tied ----------------------------------------------------------------------------- */

/* Two columns of the lattice stand inside the right mesh, and one on the edge of either. */
static void particles_and_bonds_are_sorted(void **state) {
  (void)state;
  const strip s = {6, 0.08, 0.04, 10e-3, MICROPOLAR, 2};
  int count;
  deck_case c;
  open_strip(&c, &s, "&simulation end_time = '1 us' /\n&output frames = 0 /\n");
  const mesh_tie *ties = simulation_ties(c.simulation, CORE, &count);
  const rows *g = simulation_rows(c.simulation, CORE);
  assert_int_equal(count, 2);
  assert_int_equal(ties[0].count, 17);
  assert_int_equal(ties[1].count, 17 + 16 + 17);
  assert_int_equal(ties[0].half_count, 16);
  assert_int_equal(ties[1].half_count, 16);
  assert_int_equal(ties[0].left_out, 0);
  assert_int_equal(ties[1].left_out, 2 * 32 + 15 + 16);
  for (int n = 0; n < 2; n++)
    for (long p = 0; p < ties[n].count; p++) {
      const tied_particle *of = &ties[n].particles[p];
      const long site = g->particle_site[of->particle];
      const bool inside = n == 1 && g->x[site] > width_of(&s) + 1e-6,
                 corner = g->y[site] < 1e-6 || g->y[site] > s.height - 1e-6;
      double sum = 0;
      for (int k = 0; k < of->count; k++)
        sum += of->weight[k];
      assert_true(fabs(sum - 1) < 1e-12);
      if (inside)
        assert_true(of->outside <= (corner ? 0.5 : 0) + 1e-12);
      else
        assert_true(fabs(of->outside - (corner ? 0.75 : 0.5)) < 0.01);
    }
  assert_true(fabs(mesh_tie_mass(&ties[0], g) / g->mass - (15 * 0.5 + 2 * 0.75)) < 0.05);
  deck_case_close(&c);
}

/* Of each direction in turn, all bonds by halves: half of what the lattice's bonds exert and store.
   */
static void halves_are_half_of_a_bond(void **state) {
  (void)state;
  deck_case c;
  deck_case_open(
      &c, "&simulation end_time = '1 us' /\n&output frames = 0 /\n"
          "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"
          "&material lattice = 'l' model = 'elastic_micropolar' E = 30e9 nu = 0.2 rho = 2400 /\n"
          "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '40 mm', '30 mm' /\n");
  sweep *w = simulation_state(c.simulation, 0);
  const rows *g = w->lattice;
  double *plane[4], *found[PL_MAX_DOF];
  for (int k = 0; k < 4; k++)
    plane[k] = calloc((size_t)(g->directions * g->size), sizeof(double));
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 3; d++)
      w->body->displacement[d][g->particle_site[p]] = 1e-6 * sin(1.7 * (double)p + 2 * d);
  all_bond_forces(w, plane);
  half_bond *bonds = calloc((size_t)g->bond_count, sizeof *bonds);
  for (int k = 0; k < g->directions; k++) {
    long count = 0;
    double most = 0;
    for (long p = 0; p < g->particle_count; p++) {
      const long i = g->particle_site[p];
      if (rows_has_bond(g, i, k))
        bonds[count++] = (half_bond){i, k, {(int32_t)p, g->site_particle[rows_partner(g, i, k)]}};
    }
    half_bonds *h = half_bonds_new(w, c.law.parameters, bonds, count);
    for (int d = 0; d < 3; d++)
      found[d] = calloc((size_t)g->particle_count, sizeof(double));
    half_bonds_find(h, false);
    half_bonds_add(h, found);
    for (long n = 0; n < count; n++) {
      const long at = k * g->size + bonds[n].site;
      for (int d = 0; d < 2; d++) {
        found[d][bonds[n].end[0]] -= 0.5 * plane[d][at];
        found[d][bonds[n].end[1]] += 0.5 * plane[d][at];
        most = fmax(most, fabs(plane[d][at]));
      }
      found[2][bonds[n].end[0]] += 0.5 * plane[2][at];
      found[2][bonds[n].end[1]] += 0.5 * plane[3][at];
    }
    assert_true(count > 0 && most > 0);
    for (long p = 0; p < g->particle_count; p++)
      for (int d = 0; d < 3; d++)
        assert_true(fabs(found[d][p]) < 1e-12 * most);
    assert_true(half_bonds_stored(h) > 0 && half_bonds_taken(h) == 0);
    half_bonds_free(h);
    for (int d = 0; d < 3; d++)
      free(found[d]);
  }
  for (int k = 0; k < 4; k++)
    free(plane[k]);
  free(bonds);
  deck_case_close(&c);
}

/* --- patches ---------------------------------------------------------------------------------- */

/* u = a x, with the turn of its antisymmetric part. */
static void strain_all(const deck_case *c, double a[2][2]) {
  for (int n = 0; n < BODIES; n++) {
    body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      for (int d = 0; d < 2; d++)
        b->displacement[d][q] = a[d][0] * b->lattice->x[q] + a[d][1] * b->lattice->y[q];
      if (n == CORE) b->displacement[2][q] = 0.5 * (a[1][0] - a[0][1]);
    }
  }
}

/* Something lies around the particle on all sides, so that nothing should act on it: in y, and in
   x. */
static bool is_inside(const strip *s, int number, double x, double y) {
  const double away = 1.01 * (number == CORE ? spacing : fmax(s->cell, spacing));
  if (y < away || y > s->height - away) return false;
  return x > -s->length + 1e-6 && x < width_of(s) + s->length - 1e-6;
}

/* Forces after half a step from rest, of +a less of -a: what is of the second order goes out.
   Per particle in the mean of N; *moment of tied and free particles, N m. */
static double worst_force(const strip *s, double a[2][2], double *moment) {
  double *found[BODIES][3], worst = 0;
  *moment = 0;
  for (int sign = 1; sign >= -1; sign -= 2) {
    deck_case c;
    double signed_a[2][2];
    for (int k = 0; k < 4; k++)
      signed_a[k / 2][k % 2] = sign * a[k / 2][k % 2];
    open_strip(&c, s, "&simulation end_time = '1 us' step = '0.1 us' /\n&output frames = 0 /\n");
    strain_all(&c, signed_a);
    assert_int_equal(simulation_advance(c.simulation, 1, NULL), STEP_OK);
    for (int n = 0; n < BODIES; n++) {
      const body *b = body_of(&c, n);
      for (int d = 0; d < b->dof; d++) {
        if (sign > 0) found[n][d] = calloc((size_t)b->lattice->size, sizeof(double));
        for (long p = 0; p < b->lattice->particle_count; p++) {
          const long q = b->lattice->particle_site[p];
          const double force = b->velocity[d][q] * body_mass(b, d, q) / (0.5 * b->time_step);
          found[n][d][q] += 0.5 * sign * force;
          if (sign > 0 || !is_inside(s, n, b->lattice->x[q], b->lattice->y[q])) continue;
          double *most = d < 2 ? &worst : moment;
          *most = fmax(*most, fabs(found[n][d][q]));
        }
        if (sign < 0) free(found[n][d]);
      }
    }
    deck_case_close(&c);
  }
  return worst;
}

static void a_uniform_strain_goes_through(void **state) {
  (void)state;
  static const double sizes[] = {5e-3, 10e-3, 15e-3};
  for (int n = 0; n < 3; n++)
    for (int k = 0; k < 4; k++) {
      const strip s = {6, 0.12, 0.06, sizes[n], MICROPOLAR, 0};
      double a[2][2] = {{0, 0}, {0, 0}}, moment;
      a[k / 2][k % 2] = 1e-6;
      const double scale = E * 1e-6 * spacing * thickness, worst = worst_force(&s, a, &moment);
      print_message("cells of %g mm, du_%d/dx_%d: %.1e, moments %.1e of a spacing's force\n",
                    1e3 * sizes[n], k / 2, k % 2, worst / scale, moment / (scale * spacing));
      assert_true(worst < 1e-8 * scale && moment < 1e-8 * scale * spacing);
    }
}

static const double *stress_yy(deck_case *c, double *values) {
  const frame_field *fields;
  const int count = simulation_frame_fields(c->simulation, &fields);
  for (int f = 0; f < count; f++)
    if (strcmp(fields[f].name, "stress_yy") == 0) {
      simulation_frame_values(c->simulation, f, values);
      return values;
    }
  fail_msg("no stress");
  return NULL;
}

/* In a uniform strain a free particle has the stress of the solid, and a tied one none rather than
   that of the half of its bonds. */
static void tied_particles_show_no_stress(void **state) {
  (void)state;
  const strip s = {8, 0.12, 0.06, 10e-3, MICROPOLAR, 0};
  double a[2][2] = {{-0.2e-6, 0}, {0, 1e-6}};
  long tied = 0, inner = 0;
  deck_case c;
  open_strip(&c, &s,
             "&simulation end_time = '1 us' step = '0.1 us' /\n"
             "&output frames = 1 fields = 'stress' /\n");
  strain_all(&c, a);
  const rows *g = simulation_rows(c.simulation, CORE);
  unsigned char *of = run_body_tied_sites(&c.simulation->bodies[CORE]);
  double *values = calloc(10000, sizeof *values);
  stress_yy(&c, values);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    tied += of[q];
    if (of[q]) assert_true(isnan(values[p]));
    if (of[q] || g->y[q] < 1.01 * spacing || g->y[q] > s.height - 1.01 * spacing) continue;
    inner++;
    assert_true(fabs(values[p] / (E * 1e-6) - 1) < 1e-5);
  }
  assert_true(tied > 40 && inner > 100);
  free(values);
  free(of);
  deck_case_close(&c);
}

/* Half of a bond's damage counts, of those that end at a tied particle alone. */
static void damage_at_ties_is_counted(void **state) {
  (void)state;
  const strip s = {6, 0.08, 0.04, 10e-3, "model = 'mplm_bilinear'", 0};
  deck_case c;
  open_strip(&c, &s, "&simulation end_time = '1 us' /\n&output frames = 0 /\n");
  const run_body *b = &c.simulation->bodies[CORE];
  const run_law *l = &b->laws[0];
  const rows *g = simulation_rows(c.simulation, CORE);
  unsigned char *tied = run_body_tied_sites(b);
  assert_int_equal(run_body_damaged_ties(b), 0);
  long at_ties = 0;
  int damage = 0;
  while (l->law->fields[damage].kind != PL_FIELD_DAMAGE)
    damage++;
  for (long m = 0; m < l->rows->bond_count; m++) {
    l->state->field[damage][l->bonds[m].slot] = m % 2 ? 0.6 : 0.4;
    at_ties +=
        m % 2 && (tied[g->particle_site[l->bonds[m].i]] || tied[g->particle_site[l->bonds[m].j]]);
  }
  assert_true(at_ties > 10 && at_ties < l->rows->bond_count / 4);
  assert_int_equal(run_body_damaged_ties(b), at_ties);
  free(tied);
  deck_case_close(&c);
}

/* However far all has turned, the lattice asks nothing of the nodes; a mesh is for small turns. */
static void a_rigid_turn_asks_nothing_of_the_mesh(void **state) {
  (void)state;
  const strip s = {6, 0.08, 0.04, 10e-3, MICROPOLAR, 0};
  const double angle = 0.7, turned = cos(angle) - 1, sine = sin(angle);
  double a[2][2] = {{turned, -sine}, {sine, turned}};
  deck_case c;
  open_strip(&c, &s, "&simulation end_time = '1 us' step = '0.1 us' /\n&output frames = 0 /\n");
  strain_all(&c, a);
  body *core = body_of(&c, CORE);
  for (long p = 0; p < core->lattice->particle_count; p++)
    core->displacement[2][core->lattice->particle_site[p]] = angle;
  assert_int_equal(c.simulation->tie_count, 2);
  for (int n = 0; n < c.simulation->tie_count; n++) {
    tie_steps *t = &c.simulation->ties[n];
    tie_steps_follow(t, false);
    sweep_find_forces(simulation_state(c.simulation, CORE));
    tie_steps_see(t, 0);
    for (int k = 0; k < t->node_count; k++)
      for (int d = 0; d < 2; d++)
        assert_true(fabs(t->node_force[d][k]) < 1e-12 * E * spacing * thickness);
  }
  deck_case_close(&c);
}

/* --- waves ------------------------------------------------------------------------------------ */

/* One raised cosine as long as `length`, from the left. Of a strip with lattice what differs from
   one that is mesh alone, at the middle of the left mesh, over the largest of the pulse. */
#define PULSE                                                                                      \
  "&simulation end_time = '130 us' step = '0.25 us' threads = 2 /\n"                               \
  "&output frames = 0 energy = F sample = '0.25 us' /\n"                                           \
  "&traction mesh = 'left' from = -0.3, 0 to = -0.3, %g component = 'x' stress = 1e6 "             \
  "formula = '(1 - cos(360 [deg]*t/%.6g [us]))/2' end = '%.6g us' /\n"                             \
  "&monitor name = 'v' kind = 'velocity' lattice = 'left' at = -0.1, %g component = 'x' /\n"
static const double pulse_height = 0.54;

static void go_with_pulse(deck_case *c, const strip *s, double length, bool whole) {
  char head[2048], text[8192];
  const double lasts = 1e6 * length / 3608;
  snprintf(head, sizeof head, PULSE, s->height, lasts, lasts, 0.5 * s->height);
  if (!whole) {
    open_strip(c, s, head);
  } else {
    const int nx = (int)lround(2.5 * s->length / s->cell) + 1,
              ny = (int)lround(s->height / s->cell) + 1;
    snprintf(text, sizeof text,
             "%s&mesh name = 'left' corner = -0.3, 0 size = %g, %g nodes = %d, %d thickness = "
             "0.01 method = 'finite_elements' /\n"
             "&material mesh = 'left' model = 'elastic' E = 30e9 nu = 0.2 rho = 2400 /\n",
             head, 2.5 * s->length, s->height, nx, ny);
    deck_case_open(c, text);
  }
  assert_int_equal(deck_case_go(c), STEP_END);
}

static double thrown_back(const strip *s, double length) {
  deck_case c, whole;
  go_with_pulse(&c, s, length, false);
  go_with_pulse(&whole, s, length, true);
  const double *v = deck_case_series(&c, "v"), *w = deck_case_series(&whole, "v");
  double most = 0;
  for (long k = 0; k < simulation_history(c.simulation, NULL); k++)
    most = fmax(most, fabs(v[k] - w[k]));
  const double part = most / deck_case_largest(&whole, "v");
  deck_case_close(&c);
  deck_case_close(&whole);
  return part;
}

static void little_of_a_pulse_is_thrown_back(void **state) {
  (void)state;
  for (int ratio = 1; ratio <= 3; ratio++) {
    const strip s = {36, pulse_height, 0.3, ratio * spacing, MICROPOLAR, 0};
    const double length = 12 * ratio * spacing, part = thrown_back(&s, length);
    print_message("cells of %d spacings, a pulse of %d: %.2f %% thrown back\n", ratio, 12 * ratio,
                  100 * part);
    assert_true(part > 1e-4 && part < 0.02);
  }
}

/* --- balances --------------------------------------------------------------------------------- */

/* The left mesh flies into the lattice and turns a little. */
#define FLIES                                                                                      \
  "&simulation end_time = '%g us' step_safety = %g threads = %d /\n"                               \
  "&output frames = 0 energy = T losses = T sample = '1 us' /\n"                                   \
  "&region name = 'all' lattice = 'left' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"      \
  "&initial_velocity region = 'all' component = 'x' value = '%g [m/s]*(1 - y/0.1 [m])' /\n"        \
  "&initial_velocity region = 'all' component = 'y' value = '%g [m/s]*x/0.04 [m]' /\n"

static void open_flying(deck_case *c, const strip *s, double us, double safety, int threads,
                        double speed) {
  char head[2048];
  snprintf(head, sizeof head, FLIES, us, safety, threads, speed, speed);
  open_strip(c, s, head);
}

#define BREAKS                                                                                     \
  "model = 'mplm_bilinear' E = 30e9 nu = 0.2 S_t = 1e-4 zeta = 0.05 alpha1 = 0.13 alpha2 = 20 "    \
  "alpha3 = 415 beta = 0.1 rate_0 = 10"

/* Momenta of all, and angular momentum about the origin, of places at the instant and velocities
   half a step before. */
static double momenta_of(const deck_case *c, double sum[3]) {
  double scale = 0;
  sum[0] = sum[1] = sum[2] = 0;
  for (int n = 0; n < BODIES; n++) {
    const body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      const double at[2] = {b->lattice->x[q] + b->displacement[0][q],
                            b->lattice->y[q] + b->displacement[1][q]},
                   m = body_mass(b, 0, q);
      for (int d = 0; d < 2; d++) {
        sum[d] += m * b->velocity[d][q];
        scale += m * fabs(b->velocity[d][q]);
      }
      sum[2] += m * (at[0] * b->velocity[1][q] - at[1] * b->velocity[0][q]);
      if (b->dof > 2) sum[2] += body_mass(b, 2, q) * b->velocity[2][q];
    }
  }
  return scale;
}

/* From the first step to the end: momentum is kept. Returns the size of what there is of it. */
static double go_by_momentum(deck_case *c, double before[3], double after[3]) {
  assert_int_equal(simulation_advance(c->simulation, 1, NULL), STEP_OK);
  momenta_of(c, before);
  assert_int_equal(deck_case_go(c), STEP_END);
  const double scale = momenta_of(c, after);
  for (int d = 0; d < 2; d++)
    assert_true(fabs(after[d] - before[d]) < 1e-12 * scale);
  return scale;
}

/* Angular momentum of a mesh is kept for small displacements: what it loses is of their square. */
static void momentum_is_kept(void **state) {
  (void)state;
  double lost[2];
  for (int n = 0; n < 2; n++) {
    const strip s = {7, 0.08, 0.04, 10e-3, MICROPOLAR, 0};
    deck_case c;
    double before[3], after[3];
    open_flying(&c, &s, 300, 0.5, 1, n == 0 ? 1e-3 : 1e-4);
    const double scale = go_by_momentum(&c, before, after);
    lost[n] = fabs(after[2] - before[2]) / (scale * 0.1);
    print_message("lost: momentum %.1e, %.1e, angular %.1e of what is there\n",
                  fabs(after[0] - before[0]) / scale, fabs(after[1] - before[1]) / scale, lost[n]);
    deck_case_close(&c);
  }
  assert_true(lost[0] < 1e-6 && lost[1] < 0.2 * lost[0]);
}

/* All that the ledger has; with the step's square it closes better, where bonds break with the
   step. What ties give and take goes out. */
static void energies_balance(void **state) {
  (void)state;
  static const struct {
    const char *law;
    double speed, least_lost;
  } cases[] = {{MICROPOLAR, 0.1, 0}, {BREAKS, 0.01, 5e-3}, {BREAKS, 2, 0.1}};
  for (int k = 0; k < 3; k++) {
    double imbalance[2];
    for (int n = 0; n < 2; n++) {
      const strip s = {7, 0.08, 0.04, 10e-3, cases[k].law, 0};
      deck_case c;
      open_flying(&c, &s, 100, n == 0 ? 0.8 : 0.1, 1, cases[k].speed);
      assert_int_equal(deck_case_go(&c), STEP_END);
      const double all = deck_case_largest(&c, "energy/kinetic"),
                   damage = deck_case_last(&c, "energy/dissipated_damage") / all,
                   damping = deck_case_last(&c, "energy/dissipated_damping") / all;
      imbalance[n] = deck_case_largest(&c, "energy/imbalance") / all;
      print_message("case %d: imbalance %.1e, external %.1e, damage %.1e, damping %.1e\n", k,
                    imbalance[n], deck_case_largest(&c, "energy/external") / all, damage, damping);
      assert_true(deck_case_largest(&c, "energy/external") < 1e-12 * all);
      assert_true(deck_case_largest(&c, "core/external") > 0.1 * all);
      assert_true(damage + damping >= cases[k].least_lost);
      deck_case_close(&c);
    }
    assert_true(imbalance[0] < 5e-2 && imbalance[1] < (k == 2 ? 0.2 : 0.02) * imbalance[0]);
  }
}

/* At just less than the stable step small motions stay small for long. */
static void the_step_is_stable(void **state) {
  (void)state;
  static const double sizes[] = {2.5e-3, 5e-3, 20e-3};
  for (int n = 0; n < 3; n++) {
    const strip s = {5, 0.04, 0.02, sizes[n], MICROPOLAR, 0};
    deck_case c;
    open_flying(&c, &s, 6000, 0.999, 1, 1e-6);
    assert_int_equal(deck_case_go(&c), STEP_END);
    assert_true(deck_case_stays_below(&c, 1.5));
    deck_case_close(&c);
  }
}

typedef void visitor(body *b, long site, int d, double scale, double *into);

static void visit_all(const deck_case *c, visitor *visit, double *into) {
  for (int n = 0; n < BODIES; n++) {
    body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++)
      for (int d = 0; d < b->dof; d++)
        visit(b, b->lattice->particle_site[p], d, d < 2 ? 1 : spacing, into);
  }
}

static void put_anything(body *b, long site, int d, double scale, double *into) {
  (void)into;
  b->velocity[d][site] = sin(1.7 * (double)site * (d + 1)) / scale;
}

/* Velocities become displacements of that size, at rest. */
static void begin_with(body *b, long site, int d, double scale, double *size) {
  (void)scale;
  b->displacement[d][site] = *size * b->velocity[d][site];
  b->velocity[d][site] = 0;
}

static void add_square(body *b, long site, int d, double scale, double *sum) {
  sum[0] += scale * scale * b->displacement[d][site] * b->displacement[d][site];
  sum[1] += scale * scale * b->velocity[d][site] * b->velocity[d][site];
}

/* Square of the highest frequency of all, by power iteration on what a step from rest pushes. */
static double highest_square(deck_case *c) {
  const double dt = body_of(c, CORE)->time_step;
  double found = 0;
  visit_all(c, put_anything, NULL);
  for (int round = 0; round < 300; round++) {
    double before[2] = {0, 0}, after[2] = {0, 0};
    visit_all(c, add_square, before);
    double size = 1e-9 / sqrt(before[1]);
    visit_all(c, begin_with, &size);
    for (int k = 0; k < c->simulation->tie_count; k++)
      tie_steps_follow(&c->simulation->ties[k], false);
    before[0] = 0;
    visit_all(c, add_square, before);
    assert_int_equal(simulation_advance(c->simulation, 1, NULL), STEP_OK);
    visit_all(c, add_square, after);
    found = sqrt(after[1] / before[0]) / dt;
  }
  return found;
}

/* Below the longest one, and not below that part of it. */
static void step_is_near(const strip *s, double part) {
  deck_case c;
  open_flying(&c, s, 6000, 1, 1, 1e-9);
  const double step = body_of(&c, CORE)->time_step, longest = 2 / sqrt(highest_square(&c));
  print_message("step %.5g us of %.5g us, %.3f\n", 1e6 * step, 1e6 * longest, step / longest);
  assert_true(step < longest && step > part * longest);
  deck_case_close(&c);
  open_flying(&c, s, 600, 1, 1, 1e-6);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *kinetic = deck_case_series(&c, "energy/kinetic");
  assert_true(deck_case_largest(&c, "energy/stored") + deck_case_largest(&c, "energy/kinetic") <
              3 * kinetic[0]);
  deck_case_close(&c);
}

/* A lattice that is much stiffer, and one that is much softer than the mesh, whose own limits say
   little of the nodes between. */
static void the_step_is_near_the_longest(void **state) {
  (void)state;
  static const char *const laws[] = {MICROPOLAR, "model = 'elastic_micropolar' E = 30e11 nu = 0.2",
                                     "model = 'elastic_micropolar' E = 30e7 nu = 0.2"};
  for (int k = 0; k < 3; k++) {
    const strip s = {5, 0.04, 0.02, k == 1 ? 2.5e-3 : 5e-3, laws[k], 0};
    step_is_near(&s, 0.5);
  }
}

/* Bonds of particles that lie inside a mesh and give it little mass pull at nodes that have little
   of their own: faster than all that moves in the lattice or in the mesh alone. */
static void light_nodes_limit_the_step(void **state) {
  (void)state;
  const strip s = {5, 0.04, 0.02, 5e-3, MICROPOLAR, 0};
  light = 0.03;
  overlap = 2.3;
  step_is_near(&s, 1.0 / 3);
  light = 1;
  overlap = 0;
}

/* Mass of what moves by itself. */
static double free_mass(const deck_case *c) {
  double sum = 0;
  for (int n = 0; n < BODIES; n++) {
    const body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++)
      sum += body_mass(b, 0, b->lattice->particle_site[p]);
  }
  int count;
  const mesh_tie *ties = simulation_ties(c->simulation, CORE, &count);
  const body *core = body_of(c, CORE);
  for (int n = 0; n < count; n++)
    for (long p = 0; p < ties[n].count; p++)
      sum -= body_mass(core, 0, core->lattice->particle_site[ties[n].particles[p].particle]);
  return sum;
}

/* What hangs on tied particles goes to the nodes as a whole, and its momentum is kept. */
static void point_masses_on_tied_particles_are_kept(void **state) {
  (void)state;
  const strip s = {7, 0.08, 0.04, 10e-3, MICROPOLAR, 0};
  static const char *const more[] = {
      "", "&region name = 'row' lattice = 'core' shape = 'rectangle' corner = -1e-4, -1e-4 size = "
          "2e-4, 1 /\n&point_mass region = 'row' total = 0.25 /\n"};
  double mass[2], before[3], after[3];
  for (int k = 0; k < 2; k++) {
    char head[2048];
    deck_case c;
    snprintf(head, sizeof head, FLIES "%s", 300.0, 0.5, 1, 1e-3, 1e-3, more[k]);
    open_strip(&c, &s, head);
    mass[k] = free_mass(&c);
    go_by_momentum(&c, before, after);
    deck_case_close(&c);
  }
  print_message("mass %.9g kg and %.9g kg more\n", mass[0], mass[1] - mass[0]);
  assert_true(fabs(mass[1] - mass[0] - 0.25) < 1e-12);
}

/* --- the same bits ---------------------------------------------------------------------------- */

static void same_histories(const deck_case *a, const deck_case *b) {
  const long count = simulation_history(a->simulation, NULL);
  assert_int_equal(simulation_history(b->simulation, NULL), count);
  for (int k = 0; k < simulation_series_count(a->simulation); k++) {
    const double *p, *q;
    simulation_series(a->simulation, k, NULL, &p);
    simulation_series(b->simulation, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)count * sizeof(double));
  }
}

static void threads_do_not_show(void **state) {
  (void)state;
  const strip s = {24, 0.2, 0.1, 10e-3, BREAKS, 0};
  deck_case one, more;
  open_flying(&one, &s, 60, 0.5, 1, 2);
  assert_int_equal(deck_case_go(&one), STEP_END);
  for (int threads = 2; threads <= 3; threads++) {
    open_flying(&more, &s, 60, 0.5, threads, 2);
    assert_int_equal(deck_case_go(&more), STEP_END);
    same_histories(&one, &more);
    deck_case_close(&more);
  }
  deck_case_close(&one);
}

static void a_run_goes_on_as_if_never_stopped(void **state) {
  (void)state;
  const strip s = {8, 0.08, 0.04, 10e-3, BREAKS, 0};
  deck_case whole, first, rest;
  open_flying(&whole, &s, 60, 0.5, 2, 2);
  assert_int_equal(deck_case_go(&whole), STEP_END);
  open_flying(&first, &s, 60, 0.5, 2, 2);
  open_flying(&rest, &s, 60, 0.5, 2, 2);
  hand_over(first.simulation, 37, rest.simulation);
  assert_int_equal(deck_case_go(&rest), STEP_END);
  same_histories(&whole, &rest);
  deck_case_close(&whole);
  deck_case_close(&first);
  deck_case_close(&rest);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(particles_and_bonds_are_sorted),
                                     cmocka_unit_test(halves_are_half_of_a_bond),
                                     cmocka_unit_test(a_uniform_strain_goes_through),
                                     cmocka_unit_test(tied_particles_show_no_stress),
                                     cmocka_unit_test(damage_at_ties_is_counted),
                                     cmocka_unit_test(a_rigid_turn_asks_nothing_of_the_mesh),
                                     cmocka_unit_test(little_of_a_pulse_is_thrown_back),
                                     cmocka_unit_test(momentum_is_kept),
                                     cmocka_unit_test(energies_balance),
                                     cmocka_unit_test(the_step_is_stable),
                                     cmocka_unit_test(the_step_is_near_the_longest),
                                     cmocka_unit_test(light_nodes_limit_the_step),
                                     cmocka_unit_test(point_masses_on_tied_particles_are_kept),
                                     cmocka_unit_test(threads_do_not_show),
                                     cmocka_unit_test(a_run_goes_on_as_if_never_stopped)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
