/* Stress and strain of particles and the force through a section against the theory: uniform
   strains of elastic laws on all lattices, rigid rotations, the balance of a part of a body. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/particle_tensors.h"
#include "runtime/analysis/section.h"
#include "tests/verification/case.h"

#define HEAD  "&simulation end_time = 1e-4 /\n&output sample = 1e-5 /\n"
#define PLATE "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = 0.1 /\n"
#define BALL  "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = 0.06 /\n"
#define PLANE(kind)                                                                                \
  HEAD "&lattice name = 'l' spacing = 0.01 thickness = 0.02 mass_thickness = 0.03 kind = " kind    \
       " /\n" PLATE
#define SPACE(kind) HEAD "&lattice name = 'l' spacing = 0.01 kind = " kind " /\n" BALL
#define OF(model)   "&material lattice = 'l' model = '" model "' E = '30 GPa' /\n"

typedef struct elastic_case {
  const char *deck;
  double nu; /* of an isotropic law whose modulus is E; NAN: not isotropic, or E is another */
} elastic_case;

static const elastic_case cases[] = {
    {PLANE("'hexagonal' rotation = 17") OF("elastic_central"), 1.0 / 3},
    {PLANE("'hexagonal' rotation = 17") OF("elastic_micropolar"), 0.2},
    {PLANE("'hexagonal' rotation = 5") OF("splm_elastic"), 0.2},
    {PLANE("'hexagonal' horizon = 2") OF("correspondence"), NAN}, /* not linear */
    {PLANE("'hexagonal'") OF("mplm_bilinear"), 0.2},
    {PLANE("'hexagonal'") OF("pmb"), NAN},
    {PLANE("'square' horizon = 3.015") OF("pmb"), NAN},
    {PLANE("'square' horizon = 1.5") OF("lps"), NAN},
    {SPACE("'cubic' shells = 2") OF("pmb"), NAN},
    {SPACE("'fcc' rotation = 30 axis = 1, 2, 0") OF("pmb"), NAN},
    {SPACE("'fcc' shells = 2") OF("splm_elastic"), NAN},
    {SPACE("'fcc' shells = 2") OF("eps"), NAN},
    {SPACE("'fcc' shells = 2") OF("correspondence"), NAN},
    {SPACE("'fcc' shells = 2 rotation = 30 axis = 1, 2, 0") OF("mplm_space"), NAN},
};

typedef struct tensor_case {
  deck_case deck;
  sweep *w;
  const rows *g;
  bond_forces *forces;
  const tensor_component *component;
  int components;
  double *stress[TENSOR_MOST];
} tensor_case;

static void open_case(tensor_case *c, const char *text) {
  assert_true(deck_case_text(&c->deck, text));
  c->w = simulation_state(c->deck.simulation, 0);
  c->g = c->w->body->lattice;
  c->forces = bond_forces_new(c->w);
  c->components = tensor_components(c->g->dimensions, &c->component);
  for (int k = 0; k < c->components; k++)
    c->stress[k] = calloc((size_t)c->g->size, sizeof(double));
}

static void close_case(tensor_case *c) {
  for (int k = 0; k < c->components; k++)
    free(c->stress[k]);
  bond_forces_free(c->forces);
  deck_case_close(&c->deck);
}

/* u = (F - 1) x; rotations stay. */
static void deform(tensor_case *c, double F[3][3]) {
  for (long q = 0; q < c->g->size; q++) {
    double at[3];
    rows_place(c->g, q, at);
    for (int a = 0; a < c->g->dimensions && c->g->present[q]; a++) {
      c->w->body->displacement[a][q] = -at[a];
      for (int b = 0; b < c->g->dimensions; b++)
        c->w->body->displacement[a][q] += F[a][b] * at[b];
    }
  }
}

/* In small strains, so that what is taken from a place and added again is not felt. */
static void strain_by(tensor_case *c, const double e[3][3], double size) {
  for (long q = 0; q < c->g->size; q++) {
    double at[3];
    rows_place(c->g, q, at);
    for (int a = 0; a < c->g->dimensions && c->g->present[q]; a++) {
      c->w->body->displacement[a][q] = 0;
      for (int b = 0; b < c->g->dimensions; b++)
        c->w->body->displacement[a][q] += size * e[a][b] * at[b];
    }
  }
}

static bool is_inside(const tensor_case *c, long site) {
  double at[3];
  rows_place(c->g, site, at);
  const double r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
  return c->g->present[site] && r < (c->g->dimensions == 2 ? 0.1 : 0.06) - 2 * c->g->horizon;
}

static const double uniform[3][3] = {{1, 0.4, -0.2}, {0.4, -0.7, 0.3}, {-0.2, 0.3, 0.5}};

/* Half the difference of both signs: of the third order in the strain. */
static void find_stress(tensor_case *c, const double e[3][3], double size, double *const *out) {
  for (int side = 1; side >= -1; side -= 2) {
    strain_by(c, e, side * size);
    bond_forces_find(c->forces, -1);
    particle_stress(c->forces, c->w->body, c->stress);
    for (int k = 0; k < c->components; k++)
      for (long q = 0; q < c->g->size; q++)
        out[k][q] = (side > 0 ? 0 : out[k][q]) + side * c->stress[k][q] / (2 * size);
  }
}

/* Along a component, of the stored energy of each particle over its volume; both signs likewise. */
static void find_energy_slope(tensor_case *c, const double e[3][3], double size, int component,
                              double *slope) {
  static const double step = 0.5; /* energies are quadratic */
  const int a = c->component[component].first, b = c->component[component].second;
  double *stored = calloc((size_t)c->g->size, sizeof *stored), more[3][3];
  memset(slope, 0, (size_t)c->g->size * sizeof *slope);
  for (int side = 1; side >= -1; side -= 2)
    for (int way = 1; way >= -1; way -= 2) {
      memcpy(more, e, sizeof more);
      more[a][b] += 0.5 * way * step;
      more[b][a] += 0.5 * way * step;
      strain_by(c, (const double(*)[3])more, side * size);
      sweep_observe(c->w);
      sweep_stored(c->w, stored);
      for (long q = 0; q < c->g->size; q++)
        slope[q] += way * stored[q] / (4 * step * size * size * rows_stressed_volume(c->g, q));
    }
  free(stored);
}

static double trace(const double e[3][3], int dimensions) {
  return e[0][0] + e[1][1] + (dimensions == 3 ? e[2][2] : 0);
}

/* Plane stress. */
static double hooke(const double e[3][3], double nu, int a, int b) {
  const double E = 30e9;
  return E / (1 + nu) * (e[a][b] + (a == b ? nu / (1 - nu) * trace(e, 2) : 0));
}

/* Wherever families are whole: Hooke's law of isotropic lattices, the slope of the stored energy
   of all. */
static void stress_is_that_of_hooke_and_of_the_energy(void **state) {
  (void)state;
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    tensor_case c;
    double *found[TENSOR_MOST], worst = 0, off_hooke = 0, largest = 0;
    long inside = 0;
    open_case(&c, cases[n].deck);
    double *slope = calloc((size_t)c.g->size, sizeof *slope);
    for (int k = 0; k < c.components; k++)
      found[k] = calloc((size_t)c.g->size, sizeof(double));
    find_stress(&c, uniform, 1e-6, found);
    for (int k = 0; k < c.components; k++) {
      const int a = c.component[k].first, b = c.component[k].second;
      find_energy_slope(&c, uniform, 1e-6, k, slope);
      for (long q = 0; q < c.g->size; q++) {
        if (!is_inside(&c, q)) continue;
        inside++;
        largest = fmax(largest, fabs(slope[q]));
        worst = fmax(worst, fabs(found[k][q] - slope[q]));
        if (cases[n].nu > 0)
          off_hooke = fmax(off_hooke, fabs(found[k][q] - hooke(uniform, cases[n].nu, a, b)));
      }
    }
    assert_true(inside > 100 * c.components / c.g->dimensions / 3);
    assert_true(largest > 1e10);
    assert_true(worst < 1e-11 * largest);
    assert_true(off_hooke < 1e-11 * largest);
    for (int k = 0; k < c.components; k++)
      free(found[k]);
    free(slope);
    close_case(&c);
  }
}

/* Everywhere where bonds span, whatever the deformation; not at all in a rotation. */
static void strain_is_green_s_of_a_linear_motion(void **state) {
  (void)state;
  double F[3][3] = {{1.3, 0.2, -0.1}, {-0.1, 0.8, 0.15}, {0.05, 0.1, 1.1}},
         turned[3][3] = {{cos(0.7), -sin(0.7), 0}, {sin(0.7), cos(0.7), 0}, {0, 0, 1}};
  static const char *const decks[] = {PLANE("'hexagonal' rotation = 17") OF("elastic_central"),
                                      PLANE("'square'") OF("splm_elastic"),
                                      PLANE("'blue_noise' seed = 4") OF("pmb"),
                                      SPACE("'cubic' shells = 2") OF("pmb"),
                                      SPACE("'fcc'") OF("pmb"),
                                      SPACE("'blue_noise' setting = 'space' seed = 4") OF("pmb")};
  for (size_t n = 0; n < sizeof decks / sizeof *decks; n++)
    for (int turn = 0; turn < 2; turn++) {
      tensor_case c;
      double worst = 0;
      long found = 0;
      open_case(&c, decks[n]);
      deform(&c, turn ? turned : F);
      for (long p = 0; p < c.g->particle_count; p++) {
        double strain[TENSOR_MOST];
        particle_strain(c.w->body, c.g->particle_site[p], strain);
        found += isfinite(strain[0]);
        for (int k = 0; k < c.components && isfinite(strain[0]); k++) {
          const int a = c.component[k].first, b = c.component[k].second;
          double expected = a == b ? -0.5 : 0;
          for (int i = 0; i < c.g->dimensions && !turn; i++)
            expected += 0.5 * F[i][a] * F[i][b];
          worst = fmax(worst, fabs(strain[k] - (turn ? 0 : expected)));
        }
      }
      assert_true(found > 0.98 * (double)c.g->particle_count); /* corners of squares */
      assert_true(worst < 1e-14);
      close_case(&c);
    }
}

/* Rotations of particles go along. */
static void a_rigid_rotation_gives_no_stress(void **state) {
  (void)state;
  double turned[3][3] = {{cos(0.3), -sin(0.3), 0}, {sin(0.3), cos(0.3), 0}, {0, 0, 1}};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
    tensor_case c;
    double largest = 0;
    open_case(&c, cases[n].deck);
    deform(&c, turned);
    const int spin = c.g->dimensions == 2 ? 2 : 5; /* about z */
    for (long q = 0; q < c.g->size && c.w->body->dof > spin; q++)
      c.w->body->displacement[spin][q] = c.g->present[q] ? 0.3 : 0;
    bond_forces_find(c.forces, -1);
    particle_stress(c.forces, c.w->body, c.stress);
    for (int k = 0; k < c.components; k++)
      for (long q = 0; q < c.g->size; q++)
        largest = fmax(largest, fabs(c.stress[k][q]));
    assert_true(largest < 1e-13 * 30e9);
    close_case(&c);
  }
}

/* --- balance of parts ------------------------------------------------------------------------- */

static void shake(tensor_case *c) {
  for (long q = 0; q < c->g->size; q++)
    for (int d = 0; d < c->w->body->dof; d++) {
      const double phase =
          190 * c->g->x[q] + 130 * c->g->y[q] + (c->g->z ? 160 * c->g->z[q] : 0) + d;
      if (c->g->present[q]) c->w->body->displacement[d][q] = 2e-6 * sin(phase);
    }
}

/* The virial theorem: sum of V stress + f x over a body is 0, by components that are symmetric. */
static void stresses_add_up_to_what_forces_do(void **state) {
  (void)state;
  static const char *const irregular[] = {
      PLANE("'blue_noise' seed = 4") OF("pmb"), PLANE("'blue_noise' seed = 4") OF("splm_concrete"),
      SPACE("'blue_noise' setting = 'space' seed = 4") OF("eps")};
  enum { REGULAR = sizeof cases / sizeof *cases, ALL = REGULAR + 3 };
  for (size_t n = 0; n < ALL; n++) {
    tensor_case c;
    double largest = 0;
    open_case(&c, n < REGULAR ? cases[n].deck : irregular[n - REGULAR]);
    shake(&c);
    sweep_observe(c.w);
    bond_forces_find(c.forces, -1);
    particle_stress(c.forces, c.w->body, c.stress);
    for (int k = 0; k < c.components; k++) {
      const int a = c.component[k].first, b = c.component[k].second;
      double left = 0, size = 0;
      for (long q = 0; q < c.g->size; q++) {
        double at[3];
        if (!c.g->present[q]) continue;
        rows_place(c.g, q, at);
        for (int d = 0; d < c.g->dimensions; d++)
          at[d] += c.w->body->displacement[d][q];
        const double done = 0.5 * (c.w->body->force[a][q] * at[b] + c.w->body->force[b][q] * at[a]);
        left += c.stress[k][q] * rows_stressed_volume(c.g, q) + done;
        size += fabs(done);
      }
      assert_true(fabs(left) < 1e-13 * size);
      largest = fmax(largest, size);
    }
    assert_true(largest > 1);
    close_case(&c);
  }
}

/* What bonds across a plane exert on one side is all that bonds exert on it. */
static void a_section_carries_the_sum_of_the_forces_behind_it(void **state) {
  (void)state;
  const double normal[3] = {2, -1, 0};
  for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
    for (int through = 0; through < 2; through++) { /* between sites, and through one */
      tensor_case c;
      open_case(&c, cases[n].deck);
      const double at[3] = {through ? 0 : 0.0031, through ? 0 : 0.0012, 0};
      double force[3], sum[3] = {0}, largest = 0;
      section s = section_new(c.w->body, at, normal, NULL);
      assert_true(s.count > 20);
      shake(&c);
      sweep_observe(c.w);
      bond_forces_find(c.forces, -1);
      section_force(&s, c.forces, force);
      for (long q = 0; q < c.g->size; q++) {
        if (!c.g->present[q]) continue;
        if ((c.g->x[q] - at[0]) * normal[0] + (c.g->y[q] - at[1]) * normal[1] >= -1e-9) continue;
        for (int d = 0; d < c.g->dimensions; d++) {
          sum[d] += c.w->body->force[d][q];
          largest = fmax(largest, fabs(c.w->body->force[d][q]));
        }
      }
      for (int d = 0; d < c.g->dimensions; d++)
        assert_true(fabs(force[d] - sum[d]) < 1e-12 * largest);
      assert_true(fabs(force[0]) > 1e-2 * largest);
      section_free(&s);
      close_case(&c);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stress_is_that_of_hooke_and_of_the_energy),
      cmocka_unit_test(strain_is_green_s_of_a_linear_motion),
      cmocka_unit_test(a_rigid_rotation_gives_no_stress),
      cmocka_unit_test(stresses_add_up_to_what_forces_do),
      cmocka_unit_test(a_section_carries_the_sum_of_the_forces_behind_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
