/* Programs of families: what they compute, against the same computed here from positions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/interpreter/interpreted.h"
#include "generator/plan/program_facts.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/patch.h"
#include "tests/generator/plan/family_text.h"

/* --- patches ---------------------------------------------------------------------------------- */

static uint64_t seed = 77;

static rows *lattice_of(const char *kind, int shells) {
  const bool space = bravais_dimensions(kind) == 3;
  const double t = space ? 0 : 0.1;
  rows *w = implied_lattice_like(&(deck_lattice){.kind = kind,
                                                 .spacing = 0.01,
                                                 .shells = shells,
                                                 .rotation = 0.3,
                                                 .thickness = t,
                                                 .stiffness_thickness = t,
                                                 .mass_thickness = t,
                                                 .setting = space ? "space" : "plane_stress"},
                                 2300);
  assert_non_null(w);
  return w;
}

static void shake(patch *p, double size) {
  for (int d = 0; d < p->law->dimensions; d++) {
    for (long k = 0; k < p->inside_count; k++)
      p->displacement[d][p->inside[k]] = size * p->lattice->spacing * random_uniform(&seed, -1, 1);
    patch_repeat(p, p->displacement[d]);
  }
}

static const long period[3] = {4, 4, 1}, period_in_space[3] = {3, 3, 3};

static patch *shaken_patch(const tested_law *t, const rows *w, double size) {
  patch *p =
      patch_new(t->kernel, t->parameters, w, w->dimensions == 3 ? period_in_space : period, 0, 0);
  shake(p, size);
  return p;
}

/* What a particle has of its bonds, from positions. */
typedef struct family {
  int count; /* bonds that exist */
  double stretch[2 * PL_MAX_DIRECTIONS], s[2 * PL_MAX_DIRECTIONS], n[2 * PL_MAX_DIRECTIONS][3];
  long neighbour[2 * PL_MAX_DIRECTIONS];
} family;

static family look(const patch *p, long site) {
  family f = {.count = 0};
  for (int k = 0; k < 2 * p->lattice->directions; k++) {
    if (!patch_has_bond(p, site, k)) continue;
    const pl_bond_class c = rows_bond_class(p->lattice, k);
    double now = 0;
    for (int d = 0; d < p->law->dimensions; d++) {
      const double part =
          c.chord[d] + p->displacement[d][site + p->offset[k]] - p->displacement[d][site];
      now += part * part;
      f.n[f.count][d] = c.chord[d] / c.s;
    }
    f.s[f.count] = c.s;
    f.neighbour[f.count] = patch_neighbour(p, site, k);
    f.stretch[f.count++] = sqrt(now) / c.s - 1;
  }
  return f;
}

static double sum_over(const family *f, const double *x) {
  double sum = 0;
  for (int k = 0; k < f->count; k++)
    sum += x[k];
  return sum;
}

static int output_index(const pl_law *kernel, const char *name) {
  for (int k = 0; k < kernel->output_count; k++)
    if (strcmp(kernel->outputs[k].name, name) == 0) return 1 + k;
  fail_msg("no output %s", name);
  return 0;
}

static double observed(const patch *p, const char *name, long site) {
  return p->observed[output_index(p->law, name)][site];
}

static void assert_near(double value, double expected, double size, const char *what) {
  if (!(fabs(value - expected) <= 1e-11 * (fabs(expected) + size)))
    fail_msg("%s: %.17g is not %.17g", what, value, expected);
}

/* --- reductions ------------------------------------------------------------------------------- */

static void reductions_are_those_of_the_family(void **state) {
  (void)state;
  tested_law *t = open_program(
      "  for space\n", "  force state F[j] = a*stretch[j]\n  output total = sum(stretch[j])\n"
                       "  output average = mean(stretch[j])\n  output weighted = mean(stretch[j], "
                       "weight = s/spacing)\n"
                       "  output largest = max(stretch[j])\n  output smallest = min(stretch[j])\n"
                       "  output size = norm(stretch)\n  output uneven = norm(deviator(stretch))\n"
                       "  output bonds = n\n  output longer = sum(s*stretch[j])\n");
  rows *w = lattice_of("fcc", 2);
  patch *p = shaken_patch(t, w, 0.02);
  for (int k = 0; k < 20; k++)
    patch_cut(p, p->inside[k], (5 * k) % 18);
  patch_observe(p);
  for (long q = 0; q < p->inside_count; q++) {
    const long site = p->inside[q];
    const family f = look(p, site);
    double total = sum_over(&f, f.stretch), largest = -INFINITY, smallest = INFINITY, square = 0;
    double longer = 0, weights = 0, uneven = 0;
    for (int k = 0; k < f.count; k++) {
      largest = fmax(largest, f.stretch[k]);
      smallest = fmin(smallest, f.stretch[k]);
      square += f.stretch[k] * f.stretch[k];
      longer += f.s[k] * f.stretch[k];
      weights += f.s[k];
      uneven += pow(f.stretch[k] - total / f.count, 2);
    }
    assert_int_equal((int)observed(p, "bonds", site), f.count);
    assert_near(observed(p, "total", site), total, 1, "total");
    assert_near(observed(p, "average", site), total / f.count, 1, "average");
    assert_near(observed(p, "weighted", site), longer / weights, 1, "weighted");
    assert_near(observed(p, "largest", site), largest, 1, "largest");
    assert_near(observed(p, "smallest", site), smallest, 1, "smallest");
    assert_near(observed(p, "size", site), sqrt(square), 1, "size");
    assert_near(observed(p, "uneven", site), sqrt(uneven), 1, "uneven");
    assert_near(observed(p, "longer", site), longer, w->spacing, "longer"); /* s differs by shell */
  }
  patch_free(p);
  rows_free(w);
  close_law(t);
}

static void a_particle_without_bonds_has_means_of_0(void **state) {
  (void)state;
  tested_law *t = open_program("", "  force state F[j] = a*stretch[j] + b*mean(stretch[j])\n"
                                   "  output average = mean(stretch[j])\n"
                                   "  output largest = max(stretch[j])\n");
  rows *w = lattice_of("hexagonal", 1);
  patch *p = shaken_patch(t, w, 0.02);
  for (int k = 0; k < 6; k++)
    patch_cut(p, p->inside[5], k);
  patch_observe(p);
  patch_step(p);
  assert_true(observed(p, "average", p->inside[5]) == 0);
  assert_true(observed(p, "largest", p->inside[5]) == 0);
  assert_true(p->force[0][p->inside[5]] == 0 && p->force[1][p->inside[5]] == 0);
  assert_true(fabs(p->force[0][p->inside[6]]) > 1);
  patch_free(p);
  rows_free(w);
  close_law(t);
}

/* --- tensors ---------------------------------------------------------------------------------- */

typedef double tensor[3][3];

/* Jacobi's method; largest first. */
static void principal_values(const tensor given, double value[3]) {
  tensor a;
  memcpy(a, given, sizeof a);
  for (int round = 0; round < 30; round++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) {
        const double turn = 0.5 * atan2(2 * a[p][q], a[q][q] - a[p][p]), c = cos(turn),
                     s = sin(turn);
        for (int k = 0; k < 3; k++) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        for (int k = 0; k < 3; k++) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y;
          a[q][k] = s * x + c * y;
        }
      }
  for (int k = 0; k < 3; k++)
    value[k] = a[k][k];
  for (int p = 0; p < 2; p++)
    for (int q = p + 1; q < 3; q++)
      if (value[q] > value[p]) {
        const double kept = value[p];
        value[p] = value[q];
        value[q] = kept;
      }
}

static double trace_of(const tensor a) {
  return a[0][0] + a[1][1] + a[2][2];
}

static double second_invariant(const tensor a) {
  double sum = 0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      const double s = a[p][q] - (p == q ? trace_of(a) / 3 : 0);
      sum += 0.5 * s * s;
    }
  return sum;
}

/* Virtual work of the stretches as if they were forces of `scale`. */
static void stress_of(const patch *p, const family *f, double scale, tensor out) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      out[r][c] = 0;
      for (int k = 0; k < f->count; k++)
        out[r][c] +=
            scale * f->s[k] * f->stretch[k] * f->n[k][r] * f->n[k][c] / (2 * p->lattice->volume);
    }
}

/* Least squares through the normal equations of all bonds, solved by elimination. */
static void strain_of(const patch *p, const family *f, tensor out) {
  const int size = p->law->dimensions == 2 ? 3 : 6;
  static const int plane[3][2] = {{0, 0}, {1, 1}, {0, 1}};
  static const int space[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  const int(*pair)[2] = size == 3 ? plane : space;
  double m[6][7] = {{0}};
  for (int k = 0; k < f->count; k++)
    for (int r = 0; r < size; r++) {
      const double here = f->n[k][pair[r][0]] * f->n[k][pair[r][1]];
      for (int c = 0; c < size; c++)
        m[r][c] += here * f->n[k][pair[c][0]] * f->n[k][pair[c][1]];
      m[r][size] += here * f->stretch[k];
    }
  for (int r = 0; r < size; r++)
    for (int q = 0; q < size; q++) {
      if (q == r) continue;
      const double share = m[q][r] / m[r][r];
      for (int c = r; c <= size; c++)
        m[q][c] -= share * m[r][c];
    }
  memset(out, 0, sizeof(tensor));
  for (int r = 0; r < size; r++) {
    const int x = pair[r][0], y = pair[r][1];
    out[x][y] = out[y][x] = (x == y ? 1 : 0.5) * m[r][size] / m[r][r];
  }
}

static const char tensor_lines[] =
    "  force state F[j] = a*stretch[j]\n  stress sigma = virtual_work(F)\n"
    "  strain eps = fit(stretch)\n"
    "  output s1 = principal(sigma, 1)\n  output s2 = principal(sigma, 2)\n"
    "  output s3 = principal(sigma, 3)\n  output e1 = principal(eps, 1)\n"
    "  output e2 = principal(eps, 2)\n  output e3 = principal(eps, 3)\n"
    "  output second = J2(sigma)\n  output mises = von_mises(sigma)\n"
    "  output third = von_mises(dev(eps))\n  output volume = trace(eps)\n"
    "  output work = sigma : eps\n";

static void check_tensors(const patch *p, long site, law_setting setting) {
  const double nu = 0.2;
  const family f = look(p, site);
  tensor sigma, eps;
  double s[3], e[3], work = 0;
  stress_of(p, &f, 40e6, sigma);
  strain_of(p, &f, eps);
  if (setting == SETTING_PLANE_STRAIN) sigma[2][2] = nu * (sigma[0][0] + sigma[1][1]);
  if (setting == SETTING_PLANE_STRESS) eps[2][2] = -nu / (1 - nu) * (eps[0][0] + eps[1][1]);
  principal_values((const double(*)[3])sigma, s);
  principal_values((const double(*)[3])eps, e);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      work += sigma[r][c] * eps[r][c];
  const double size = fabs(s[0]) + fabs(s[2]);
  static const char *const names[] = {"s1", "s2", "s3", "e1", "e2", "e3"};
  for (int k = 0; k < 3;
       k++) { /* the formula of roots in space loses half of the digits where two meet */
    assert_near(observed(p, names[k], site), s[k], 1e3 * size, names[k]);
    assert_near(observed(p, names[3 + k], site), e[k], 10, names[3 + k]);
  }
  const double second = second_invariant((const double(*)[3])sigma);
  assert_near(observed(p, "second", site), second, size * size, "J2");
  assert_near(observed(p, "mises", site), sqrt(3 * second), size, "von Mises");
  assert_near(observed(p, "third", site), sqrt(3 * second_invariant((const double(*)[3])eps)), 1,
              "von Mises of strain");
  assert_near(observed(p, "volume", site), trace_of((const double(*)[3])eps), 1, "trace");
  assert_near(observed(p, "work", site), work, size, "work");
}

static void tensors_are_those_of_theory(void **state) {
  (void)state;
  static const char *const settings[] = {"  for plane_stress\n", "  for plane_strain\n",
                                         "  for space\n"};
  static const char *const kinds[] = {"hexagonal", "square", "fcc"};
  for (int k = 0; k < 3; k++) {
    tested_law *t = open_program(settings[k], tensor_lines);
    rows *w = lattice_of(kinds[k], 2);
    for (int round = 0; round < 4; round++) {
      patch *p = shaken_patch(t, w, pow(10, -1 - round));
      patch_observe(p);
      for (long q = 0; q < p->inside_count; q++)
        check_tensors(p, p->inside[q], (law_setting)k);
      patch_free(p);
    }
    rows_free(w);
    close_law(t);
  }
}

/* --- forces ----------------------------------------------------------------------------------- */

static double force_state(const family *f, int k) {
  return 40e6 * f->stretch[k] + 3e6 * sum_over(f, f->stretch);
}

/* Mean of both sides along the present bond. */
static void bond_forces_are_means_of_both_sides(void **state) {
  (void)state;
  tested_law *t = open_program("", "  force state F[j] = a*stretch[j] + b*sum(stretch[j])\n");
  rows *w = lattice_of("hexagonal", 1);
  patch *p = shaken_patch(t, w, 0.1);
  patch_step(p);
  for (long q = 0; q < p->inside_count; q++) {
    const long site = p->inside[q];
    const family mine = look(p, site);
    double expected[2] = {0, 0};
    for (int k = 0; k < 6; k++) { /* all bonds are there: bond k is number k */
      const family other = look(p, mine.neighbour[k]);
      const double force = 0.5 * (force_state(&mine, k) + force_state(&other, (k + 3) % 6));
      const pl_bond_class c = rows_bond_class(w, k);
      for (int d = 0; d < 2; d++)
        expected[d] +=
            force *
            (c.chord[d] + p->displacement[d][site + p->offset[k]] - p->displacement[d][site]) /
            (c.s * (1 + mine.stretch[k]));
    }
    for (int d = 0; d < 2; d++)
      assert_near(p->force[d][site], expected[d], 1e6, "force");
  }
  patch_free(p);
  rows_free(w);
  close_law(t);
}

/* --- steps ------------------------------------------------------------------------------------ */

/* Values of the law below, of the particle and toward its six neighbours. */
typedef struct remembered {
  double q, p[6];
} remembered;

static const char remembering_lines[] =
    "  state q on particle = 0\n  state p on neighbour = 0\n"
    "  inner = sum(stretch[j])\n  before[j] = q[j] - 2*q + p'[j]/8\n"
    "  q = q/4 + max(inner[j])\n  p[j] = q[j] - q/2 + p'[j]/4 + before'[j]\n"
    "  force state F[j] = a*stretch[j]\n"
    "  state seen on neighbour = 0\n"
    "  seen[j] = previous(q[j]) + 3*previous(p'[j]) + 5*p'[j] + 7*q[j] + 11*previous(q) + "
    "13*previous(p[j])\n";

enum { REMEMBERING = 16 }; /* particles */

/* A step of that law in plain C: what is read above its rule is old, below it new, and `previous`
   is always old. */
static void remember(const patch *p, const int *number, remembered now[REMEMBERING],
                     double seen[REMEMBERING][6]) {
  remembered old[REMEMBERING];
  double inner[REMEMBERING];
  int other[REMEMBERING][6];
  memcpy(old, now, sizeof old);
  for (int k = 0; k < REMEMBERING; k++) {
    const family f = look(p, p->inside[k]);
    inner[k] = sum_over(&f, f.stretch);
    for (int n = 0; n < 6; n++)
      other[k][n] = number[f.neighbour[n]];
  }
  for (int k = 0; k < REMEMBERING; k++) {
    double most = -INFINITY;
    for (int n = 0; n < 6; n++)
      most = fmax(most, inner[other[k][n]]);
    now[k].q = old[k].q / 4 + most;
  }
  for (int k = 0; k < REMEMBERING; k++)
    for (int n = 0; n < 6; n++) {
      const int m = other[k][n];
      const double before =
          old[k].q - 2 * old[m].q + old[k].p[n] / 8; /* the neighbour's, toward me */
      now[k].p[n] = now[m].q - now[k].q / 2 + old[m].p[(n + 3) % 6] / 4 + before;
    }
  for (int k = 0; k < REMEMBERING; k++)
    for (int n = 0; n < 6; n++) {
      const int m = other[k][n], back = (n + 3) % 6;
      seen[k][n] = old[m].q + 3 * old[m].p[back] + 5 * now[m].p[back] + 7 * now[m].q +
                   11 * old[k].q + 13 * old[k].p[n];
    }
}

static void old_and_new_values_are_those_of_both_sides(void **state) {
  (void)state;
  tested_law *t = open_program("", remembering_lines);
  rows *w = lattice_of("hexagonal", 1);
  patch *p = shaken_patch(t, w, 0.1);
  remembered now[REMEMBERING] = {{0}};
  double seen[REMEMBERING][6];
  int *number = calloc((size_t)p->sites, sizeof *number);
  assert_int_equal(p->inside_count, REMEMBERING);
  for (int k = 0; k < REMEMBERING; k++)
    number[p->inside[k]] = k;
  for (int step = 0; step < 3; step++) {
    remember(p, number, now, seen);
    patch_step(p);
    patch_accept(p);
    for (int k = 0; k < REMEMBERING; k++) {
      const long site = p->inside[k];
      assert_near(p->field[0][site], now[k].q, 1, "q");
      for (int n = 0; n < 6; n++) {
        assert_near(p->field[1][n * p->size + site], now[k].p[n], 10, "p");
        assert_near(p->field[2][n * p->size + site], seen[k][n], 100, "seen");
      }
    }
    shake(p, 0.1);
  }
  free(number);
  patch_free(p);
  rows_free(w);
  close_law(t);
}

/* A flow toward each neighbour ends on its own guard; one that moves the sums in the guards of all
   others is refused. */
static void flows_toward_neighbours_return_one_by_one(void **state) {
  (void)state;
  const char *lines = "  law state\n  parameter y = 1e-3 in (0, 1)\n  state p on neighbour = 0\n"
                      "  left[j] = abs(stretch[j] - p[j])%s\n"
                      "  flow p[j] along sign(stretch[j] - p[j]) returned when left[j] >= y\n"
                      "  force state F[j] = 1 [MN]*(stretch[j] - p[j])\nend model\n";
  char text[1000], own[1000], shared[1000];
  snprintf(text, sizeof text, "model tested\n%s", lines);
  snprintf(own, sizeof own, text, "*(1 + mean(abs(stretch[j])))");
  snprintf(shared, sizeof shared, text, " + sum(abs(stretch[j] - p[j]))");
  tested_law *t = open_law(shared);
  assert_null(t->plan);
  assert_int_equal(t->said.items[t->said.count - 1].code, DIAG_NOT_SUPPORTED);
  close_law(t);
  t = open_law(own);
  rows *w = lattice_of("hexagonal", 1);
  patch *p = shaken_patch(t, w, 0.01);
  patch_step(p);
  for (long q = 0; q < p->inside_count; q++) {
    const family f = look(p, p->inside[q]);
    double mean = 0;
    for (int k = 0; k < 6; k++)
      mean += fabs(f.stretch[k]) / 6;
    for (int k = 0; k < 6; k++) {
      const double most = 1e-3 / (1 + mean), S = f.stretch[k];
      const double slip = fabs(S) > most ? S - copysign(most, S) : 0;
      assert_near(p->new_field[0][k * p->size + p->inside[q]], slip, 1e-3, "slip");
    }
  }
  patch_free(p);
  rows_free(w);
  close_law(t);
}

/* With one bond left, what its ends feel is opposite to the bit, whatever the law. */
static void both_ends_of_a_bond_feel_the_same_bits(void **state) {
  (void)state;
  static const char *const files[] = {SOURCE_DIR "/models/splm_concrete.plm",
                                      SOURCE_DIR "/tests/generator/families/solid.plm",
                                      SOURCE_DIR "/tests/generator/families/brittle.plm",
                                      SOURCE_DIR "/tests/generator/families/stored.plm"};
  for (int k = 0; k < 4; k++) {
    tested_law *t = open_law_file(files[k]);
    assert_non_null(t->kernel);
    rows *w = t->kernel->dimensions == 3 ? lattice_of("fcc", 2) : lattice_of("hexagonal", 1);
    int loaded = 0;
    for (int round = 0; round < 8; round++) {
      patch *p = shaken_patch(t, w, pow(10, -round));
      const long kept = p->inside[3];
      for (long q = 0; q < p->inside_count; q++)
        for (int n = 0; n < w->directions; n++)
          if (p->inside[q] != kept || n != round % w->directions) patch_cut(p, p->inside[q], n);
      patch_step(p);
      const long other = patch_neighbour(p, kept, round % w->directions);
      for (int d = 0; d < p->law->dimensions; d++) {
        assert_true(p->force[d][kept] == -p->force[d][other]);
        loaded += p->force[d][kept] != 0;
      }
      patch_free(p);
    }
    assert_true(loaded > 3);
    rows_free(w);
    close_law(t);
  }
}

static void assert_same_forces(const char *setting, const char *kind, const char *one,
                               const char *other) {
  tested_law *t[2] = {open_program(setting, one), open_program(setting, other)};
  rows *w = lattice_of(kind, 2);
  double largest = 0;
  for (int round = 0; round < 4; round++) {
    patch *p[2];
    const uint64_t start = seed;
    for (int k = 0; k < 2; k++) {
      seed = start;
      p[k] = shaken_patch(t[k], w, pow(10, -1 - round));
      patch_cut(p[k], p[k]->inside[2], 1);
      patch_step(p[k]);
    }
    for (int d = 0; d < w->dimensions; d++)
      for (long q = 0; q < p[0]->inside_count; q++) {
        const long site = p[0]->inside[q];
        assert_near(p[1]->force[d][site], p[0]->force[d][site], 1e8 * pow(10, -1 - round), "force");
        largest = fmax(largest, fabs(p[0]->force[d][site]));
      }
    for (int k = 0; k < 2; k++)
      patch_free(p[k]);
  }
  assert_true(largest > 1e4);
  rows_free(w);
  for (int k = 0; k < 2; k++)
    close_law(t[k]);
}

/* A bond's energy is shared by both ends: half of what F does over s. */
static void an_energy_gives_the_force_state(void **state) {
  (void)state;
  assert_same_forces("", "hexagonal", "  energy W = spacing*a*sum(s/spacing*stretch[j]**2)/4\n",
                     "  force state F[j] = a*stretch[j]\n");
}

/* The length of a bond moves with its stretch. */
static void an_energy_of_lengths_gives_the_force_state(void **state) {
  (void)state;
  assert_same_forces("  for space\n", "fcc", "  energy W = sum(a/s*(length[j] - s)**2)/4\n",
                     "  force state F[j] = a*stretch[j]\n");
  assert_same_forces(
      "  for space\n", "fcc",
      "  energy W = sum(a*stretch[j]*(length[j] - s))/4 + b*spacing*sum(length[j]/s - 1)**2/4\n",
      "  force state F[j] = a*stretch[j] + b*spacing/s*sum(length[j]/s - 1)\n");
}

static double stored_by(const char *lines) {
  tested_law *t = open_program("", lines);
  rows *w = lattice_of("hexagonal", 1);
  seed = 5;
  patch *p = shaken_patch(t, w, 0.1);
  patch_observe(p);
  const double stored = p->observed[0][p->inside[0]];
  patch_free(p);
  rows_free(w);
  close_law(t);
  return stored;
}

/* Without an energy half of force times stretch is known to be one only where the force is
   proportional. */
static void a_proportional_force_stores_half_of_its_work(void **state) {
  (void)state;
  const double energy = stored_by("  energy W = sum(s*a*stretch[j]**2)/4\n");
  assert_true(energy > 0);
  assert_near(stored_by("  force state F[j] = a*stretch[j]\n"), energy, 0, "stored");
  assert_true(stored_by("  force state F[j] = a*stretch[j]*length[j]/s\n") == 0);
  assert_true(stored_by("  force state F[j] = a*stretch[j]**3\n") == 0);
}

/* A sum of stretches weighted by s: what is the same for a bond class stays in the sum. */
static void weights_of_a_bond_class_stay_in_the_sum(void **state) {
  (void)state;
  assert_same_forces(
      "  for space\n", "fcc",
      "  energy W = spacing*(a*sum(s/spacing*stretch[j]**2) + b*sum(s/spacing*stretch[j])**2)/4\n",
      "  force state F[j] = a*stretch[j] + b*sum(s/spacing*stretch[j])\n");
}

/* T V_i V_j on each side; the bond feels the sum of both. */
static void densities_of_force_count_both_volumes(void **state) {
  (void)state;
  assert_same_forces("  for space\n", "fcc",
                     "  force state T[j] = (a*stretch[j] + b*sum(stretch[j]))/V**2\n",
                     "  force state F[j] = 2*(a*stretch[j] + b*sum(stretch[j]))\n");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(reductions_are_those_of_the_family),
      cmocka_unit_test(a_particle_without_bonds_has_means_of_0),
      cmocka_unit_test(tensors_are_those_of_theory),
      cmocka_unit_test(bond_forces_are_means_of_both_sides),
      cmocka_unit_test(both_ends_of_a_bond_feel_the_same_bits),
      cmocka_unit_test(old_and_new_values_are_those_of_both_sides),
      cmocka_unit_test(flows_toward_neighbours_return_one_by_one),
      cmocka_unit_test(an_energy_gives_the_force_state),
      cmocka_unit_test(an_energy_of_lengths_gives_the_force_state),
      cmocka_unit_test(a_proportional_force_stores_half_of_its_work),
      cmocka_unit_test(weights_of_a_bond_class_stay_in_the_sum),
      cmocka_unit_test(densities_of_force_count_both_volumes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
