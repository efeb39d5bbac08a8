/* Micropolar laws on any lattice: bonds that bend and twist in the plane and in space, against
   strips, closed forms, balance and their own energy, on the interpreter and compiled. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/semantics/law_variant.h"
#include "generator/kernel/model.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/patch.h"
#include "runtime/body/motion.h"
#include "tests/generator/law_text.h"

static uint64_t seed = 20261123;

static const double SPACING = 0.01, THICKNESS = 0.1;

/* A law on a free body of a few particles. */
typedef struct turning_body {
  model m;
  const pl_law *law;
  rows *lattice;
  patch *p;
  double *parameters;
} turning_body;

enum { INTERPRETED, COMPILED };

static rows *lattice_of(const char *kind, int shells) {
  const bool space = bravais_dimensions(kind) == 3;
  const double t = space ? 0 : THICKNESS;
  rows *w = implied_lattice_like(&(deck_lattice){.kind = kind,
                                                 .spacing = SPACING,
                                                 .shells = shells,
                                                 .rotation = space ? 0 : 0.3,
                                                 .thickness = t,
                                                 .stiffness_thickness = t,
                                                 .mass_thickness = t,
                                                 .setting = space ? "space" : "plane_stress"},
                                 2300);
  assert_non_null(w);
  return w;
}

static double *defaults(const pl_law *kernel) {
  double *v = must_calloc((size_t)kernel->parameter_count + 1, sizeof *v);
  for (int k = 0; k < kernel->parameter_count; k++)
    v[k] = kernel->parameters[k].initial;
  return v;
}

static const pl_law *kernel_of(model *m, int how) {
  char error[2000];
  const char *note;
  const pl_law *kernel = model_kernel(m, how == INTERPRETED, &note, error, sizeof error);
  if (!kernel) fail_msg("%s", error);
  return kernel;
}

/* Takes away the bonds that lead out of the period. */
static void set_free(patch *p) {
  for (long q = 0; q < p->inside_count; q++)
    for (int k = 0; k < p->lattice->directions; k++) {
      const long site = p->inside[q], far = site + p->offset[k];
      if (p->image[far] != far) patch_cut(p, site, k);
    }
}

static turning_body *open_body(const char *name, const char *kind, int shells, int how,
                               const long period[3]) {
  turning_body *b = must_calloc(1, sizeof *b);
  char path[4096];
  snprintf(path, sizeof path, "%s/%s.plm", SOURCE_DIR, name);
  b->lattice = lattice_of(kind, shells);
  const law_setting setting = b->lattice->dimensions == 3 ? SETTING_SPACE : SETTING_PLANE_STRESS;
  assert_true(model_open(&b->m, path, NULL, 0));
  b->m.law = law_on_lattice(b->m.law, setting, false, 2 * b->lattice->directions);
  assert_true(model_plan_of_families(&b->m, &(law_variation){.varying_count = 0}));
  b->law = kernel_of(&b->m, how);
  assert_int_equal(b->law->kind, PL_STATE);
  assert_true(b->law->pairwise);
  assert_int_equal(b->law->dof, setting == SETTING_SPACE ? 6 : 3);
  assert_int_equal(b->law->sum_count, b->law->dof); /* each end of a bond gets its own moment */
  assert_int_equal(b->law->step.pass_count,
                   setting == SETTING_SPACE ? 2 : 1); /* quaternions first */
  b->parameters = defaults(b->law);
  b->p = patch_new(b->law, b->parameters, b->lattice, period, 0, 0);
  return b;
}

static const long PLANE[3] = {4, 4, 1}, SPACE[3] = {3, 3, 3};

static turning_body *open_free(const char *name, const char *kind, int shells, int how) {
  turning_body *b =
      open_body(name, kind, shells, how, bravais_dimensions(kind) == 3 ? SPACE : PLANE);
  set_free(b->p);
  return b;
}

static void close_body(turning_body *b) {
  patch_free(b->p);
  rows_free(b->lattice);
  free(b->parameters);
  model_close(&b->m);
  free(b);
}

static double parameter(const turning_body *b, const char *name) {
  for (int k = 0; k < b->law->parameter_count; k++)
    if (strcmp(b->law->parameters[k].name, name) == 0) return b->parameters[k];
  fail_msg("no parameter %s", name);
  return 0;
}

static void set_parameter(const turning_body *b, const char *name, double value) {
  for (int k = 0; k < b->law->parameter_count; k++)
    if (strcmp(b->law->parameters[k].name, name) == 0) b->parameters[k] = value;
  patch_prepare(b->p, b->parameters);
}

static int dimensions_of(const turning_body *b) {
  return b->law->dimensions;
}

/* Displacements of `strain` spacings and rotations of that many radians, at random. */
static void shake(turning_body *b, double strain, double turn) {
  for (int d = 0; d < b->law->dof; d++) {
    const double size = d < dimensions_of(b) ? strain * SPACING : turn;
    for (long k = 0; k < b->p->inside_count; k++) {
      const long site = b->p->inside[k];
      b->p->displacement[d][site] = size * random_uniform(&seed, -1, 1);
      b->p->velocity[d][site] = size * random_uniform(&seed, -1, 1);
    }
    patch_repeat(b->p, b->p->displacement[d]);
    patch_repeat(b->p, b->p->velocity[d]);
  }
}

/* --- rotations of a body in space ------------------------------------------------------------- */

/* R = exp(r), Rodrigues. */
static void matrix_of(const double r[3], double R[3][3]) {
  const double angle = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]), size = angle > 0 ? angle : 1;
  const double n[3] = {r[0] / size, r[1] / size, r[2] / size}, c = cos(angle), s = sin(angle);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      const int l = 3 - i - k;
      const double cross = i == k ? 0 : ((k - i + 3) % 3 == 1 ? -1 : 1) * n[l] * s;
      R[i][k] = (i == k) * c + (1 - c) * n[i] * n[k] + cross;
    }
}

/* Turns a rotation vector further by a, as the time loop does. */
static void turn_further(double r[3], const double a[3]) {
  double length = 0, angle = 0, q[4], p[4], v[4];
  for (int k = 0; k < 3; k++)
    length += r[k] * r[k], angle += a[k] * a[k];
  length = fmax(sqrt(length), 1e-150), angle = fmax(sqrt(angle), 1e-150);
  q[0] = cos(length / 2), p[0] = cos(angle / 2);
  for (int k = 0; k < 3; k++) {
    q[k + 1] = r[k] * (sin(length / 2) / length);
    p[k + 1] = a[k] * (sin(angle / 2) / angle);
  }
  v[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
  for (int k = 1; k < 4; k++) {
    const int l = k % 3 + 1, m = l % 3 + 1;
    v[k] = p[0] * q[k] + q[0] * p[k] + p[l] * q[m] - p[m] * q[l];
  }
  const double size = sqrt(v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  const double scale = size > 0 ? 2 * atan2(size, v[0]) / size : 0;
  for (int k = 0; k < 3; k++)
    r[k] = scale * v[k + 1];
}

/* All particles, and their bonds, by r about the first one. */
static void turn_body(turning_body *b, const double r[3]) {
  double R[3][3], at[3];
  const int rotations = b->law->dof - dimensions_of(b);
  matrix_of(r, R);
  for (long k = 0; k < b->p->inside_count; k++) {
    const long site = b->p->inside[k];
    patch_position(b->p, site, at);
    for (int d = 0; d < dimensions_of(b); d++)
      b->p->displacement[d][site] = R[d][0] * at[0] + R[d][1] * at[1] + R[d][2] * at[2] - at[d];
    for (int d = 0; d < rotations; d++)
      b->p->displacement[dimensions_of(b) + d][site] = r[rotations == 1 ? 2 : d];
  }
}

static double largest_force(const turning_body *b) {
  double most = 0;
  for (int d = 0; d < b->law->dof; d++)
    for (long k = 0; k < b->p->inside_count; k++) {
      const double f = fabs(b->p->force[d][b->p->inside[k]]);
      most = fmax(most, d < dimensions_of(b) ? f : f / SPACING);
    }
  return most;
}

/* Every other particle has turned by a whole turn less: it stands the same. */
static void take_whole_turns(turning_body *b) {
  for (long k = 0; k < b->p->inside_count; k += 2) {
    const long site = b->p->inside[k];
    double square = 0;
    for (int d = dimensions_of(b); d < b->law->dof; d++)
      square += b->p->displacement[d][site] * b->p->displacement[d][site];
    for (int d = dimensions_of(b); d < b->law->dof; d++)
      b->p->displacement[d][site] *= 1 - 2 * acos(-1) / sqrt(square);
  }
}

static void assert_rotation_is_free(const char *kind, int shells, const double r[3]) {
  turning_body *b = open_free("tests/generator/laws/frame", kind, shells, INTERPRETED);
  turn_body(b, r);
  for (int apart = 0; apart < 2; apart++) {
    patch_step(b->p);
    const double left = largest_force(b) / parameter(b, "EA");
    if (!(left < 1e-12)) fail_msg("%s turned by %g, %g, %g: %.3g EA", kind, r[0], r[1], r[2], left);
    take_whole_turns(b);
  }
  close_body(b);
}

static void rotation_leaves_no_force(void **state) {
  (void)state;
  static const double about[][3] = {{0, 0, 14},   {0, 0, -0.2},      {0, 0, 3.14159},
                                    {8, -9, 7.4}, {0.1, 0.1, -0.05}, {3, -0.9, 0}};
  static const char *const plane[] = {"hexagonal", "square"};
  for (size_t k = 0; k < sizeof about / sizeof *about; k++) {
    for (int q = 0; q < 2 && about[k][0] == 0; q++)
      for (int shells = 1; shells <= 2; shells++)
        assert_rotation_is_free(plane[q], shells, about[k]);
    assert_rotation_is_free("cubic", 1, about[k]);
    assert_rotation_is_free("fcc", 2, about[k]);
  }
}

/* The first output toward all neighbours, summed with weights that tell them apart. */
static double sum_of_output(turning_body *b) {
  double sum = 0;
  patch_observe(b->p);
  for (int k = 0; k < 2 * b->lattice->directions; k++)
    for (long n = 0; n < b->p->inside_count; n++)
      sum += (1 + k + sqrt((double)n)) * b->p->observed[1][k * b->p->size + b->p->inside[n]];
  return sum;
}

/* Neither forces nor the law's `twist`. */
static void whole_turns_change_nothing(void **state) {
  (void)state;
  static const char *const kinds[] = {"square", "fcc"};
  for (int q = 0; q < 2; q++) {
    turning_body *b = open_free("tests/generator/laws/frame", kinds[q], 1, INTERPRETED);
    shake(b, 0.05, 0.4);
    patch_step(b->p);
    const long n = b->p->inside_count;
    double *before = must_calloc((size_t)(b->law->dof * n), sizeof *before);
    for (long k = 0; k < b->law->dof * n; k++)
      before[k] = b->p->force[k / n][b->p->inside[k % n]];
    const double output = sum_of_output(b);
    take_whole_turns(b);
    patch_step(b->p);
    const double most = largest_force(b);
    assert_true(fabs(sum_of_output(b) - output) <= 1e-12 * fabs(output));
    assert_true((output != 0) == (b->law->dof == 6));
    for (long k = 0; k < b->law->dof * n; k++)
      assert_true(fabs(b->p->force[k / n][b->p->inside[k % n]] - before[k]) < 1e-12 * most);
    free(before);
    close_body(b);
  }
}

/* --- balance ---------------------------------------------------------------------------------- */

static void assert_balance(turning_body *b) {
  double sum[3] = {0}, moment[3] = {0}, size = 0, at[3];
  const int dimensions = dimensions_of(b), rotations = b->law->dof - dimensions;
  for (long k = 0; k < b->p->inside_count; k++) {
    const long site = b->p->inside[k];
    double f[3] = {0}, m[3] = {0};
    patch_position(b->p, site, at);
    for (int d = 0; d < dimensions; d++) {
      f[d] = b->p->force[d][site];
      at[d] += b->p->displacement[d][site];
      size = fmax(size, fabs(f[d]));
    }
    for (int d = 0; d < rotations; d++)
      m[rotations == 1 ? 2 : d] = b->p->force[dimensions + d][site];
    for (int d = 0; d < 3; d++) {
      const int i = (d + 1) % 3, j = (d + 2) % 3;
      sum[d] += f[d];
      moment[d] += m[d] + at[i] * f[j] - at[j] * f[i];
    }
  }
  assert_true(size > 0);
  for (int d = 0; d < 3; d++) {
    if (!(fabs(sum[d]) <= 1e-13 * size)) fail_msg("force %d: %g of %g", d, sum[d], size);
    if (!(fabs(moment[d]) <= 1e-13 * size * SPACING))
      fail_msg("moment %d: %g of %g", d, moment[d], size * SPACING);
  }
}

/* However far bodies are deformed, and whatever is damaged. */
static void forces_and_moments_are_in_balance(void **state) {
  (void)state;
  static const struct {
    const char *law, *kind;
    int shells;
  } bodies[] = {
      {"models/mplm_bilinear", "square", 2},       {"models/mplm_concrete", "hexagonal", 2},
      {"tests/generator/laws/frame", "square", 1}, {"tests/generator/laws/frame", "fcc", 1},
      {"tests/generator/laws/shear", "cubic", 2},  {"models/mplm_space", "fcc", 2}};
  for (size_t k = 0; k < sizeof bodies / sizeof *bodies; k++)
    for (int how = INTERPRETED; how <= COMPILED; how++) {
      turning_body *b = open_free(bodies[k].law, bodies[k].kind, bodies[k].shells, how);
      for (int round = 0; round < 6; round++) {
        const double size = pow(10, -round);
        shake(b, 0.2 * size, 2 * size);
        patch_step(b->p);
        assert_balance(b);
      }
      close_body(b);
    }
}

/* --- strips ----------------------------------------------------------------------------------- */

enum { LANES = PL_LANES };

/* One bond on the strips of the hexagon; its first lane. */
typedef struct strip_bond {
  double end[4][3][LANES]; /* displacement, velocity of i, of j */
  double field[LANES], force[4][LANES];
} strip_bond;

static void strip_forces(const pl_law *strips, const double *uniforms, const patch *p, long i,
                         long j, double damage, strip_bond *s) {
  int64_t flags[LANES] = {PL_PRESENT(0)};
  double *fields[] = {s->field}, *forces[4];
  pl_strip strip = {.size = sizeof(pl_strip),
                    .count = LANES,
                    .flags = flags,
                    .unheld = 1,
                    .field = fields,
                    .force = forces};
  memset(s, 0, sizeof *s);
  s->field[0] = damage;
  for (int d = 0; d < 3; d++) {
    s->end[0][d][0] = p->displacement[d][i], s->end[1][d][0] = p->velocity[d][i];
    s->end[2][d][0] = p->displacement[d][j], s->end[3][d][0] = p->velocity[d][j];
    strip.displacement_i[d] = s->end[0][d], strip.velocity_i[d] = s->end[1][d];
    strip.displacement_j[d] = s->end[2][d], strip.velocity_j[d] = s->end[3][d];
  }
  for (int d = 0; d < 4; d++)
    forces[d] = s->force[d];
  strips->rows(strips, uniforms, &strip);
}

/* Forces of all bonds, [3][size], and the largest difference of the new damage. */
static double by_strips(const turning_body *b, const pl_law *strips, double **force) {
  const patch *p = b->p;
  double *uniforms = must_calloc((size_t)strips->uniform_count + 1, sizeof *uniforms), apart = 0;
  strip_bond s;
  for (int k = 0; k < b->lattice->directions; k++) {
    const pl_bond_class bond = rows_bond_class(b->lattice, k);
    strips->prepare(strips, b->parameters, &bond, uniforms);
    for (long n = 0; n < p->inside_count; n++) {
      const long i = p->inside[n], j = i + p->offset[k];
      if (!patch_has_bond(p, i, k)) continue;
      strip_forces(strips, uniforms, p, i, j, p->field[0][k * p->size + i], &s);
      for (int d = 0; d < 2; d++)
        force[d][i] += s.force[d][0], force[d][j] -= s.force[d][0];
      force[2][i] -= s.force[2][0], force[2][j] -= s.force[3][0];
      apart = fmax(apart, fabs(s.field[0] - p->new_field[0][k * p->size + i]));
    }
  }
  free(uniforms);
  return apart;
}

static void draw_damage(patch *p, int directions) {
  for (int k = 0; k < directions; k++)
    for (long n = 0; n < p->inside_count; n++) {
      const long i = p->inside[n], j = i + p->offset[k];
      const double damage = random_uniform(&seed, -1, 1);
      p->field[0][k * p->size + i] = p->field[0][(k + directions) * p->size + j] =
          damage > 0 ? damage : 0;
    }
}

static void assert_strips_agree(const turning_body *b, const pl_law *strips, double EA) {
  const patch *p = b->p;
  double *force[3];
  for (int d = 0; d < 3; d++)
    force[d] = must_calloc((size_t)p->sites, sizeof **force);
  assert_true(by_strips(b, strips, force) < 1e-12);
  for (int d = 0; d < 3; d++)
    for (long n = 0; n < p->inside_count; n++) {
      const long q = p->inside[n];
      const double apart = fabs(force[d][q] - p->force[d][q]) / (d == 2 ? SPACING : 1);
      if (!(apart < 1e-12 * EA)) fail_msg("component %d: %g of EA", d, apart / EA);
    }
  for (int d = 0; d < 3; d++)
    free(force[d]);
}

/* On the hexagon a law of bonds runs on strips; as one of families it gives the same. */
static void families_give_what_strips_give(void **state) {
  (void)state;
  model m;
  assert_true(model_open(&m, SOURCE_DIR "/models/mplm_bilinear.plm", NULL, 0) && model_plan(&m));
  const pl_law *strips = kernel_of(&m, COMPILED);
  for (int how = INTERPRETED; how <= COMPILED; how++) {
    turning_body *b = open_free("models/mplm_bilinear", "hexagonal", 1, how);
    const double EA = parameter(b, "E") * SPACING * THICKNESS / (sqrt(3) * 0.8);
    for (int round = 0; round < 12; round++) {
      const double size = pow(10, -round / 2.0);
      shake(b, 0.3 * size, 3 * size);
      draw_damage(b->p, b->lattice->directions);
      patch_step(b->p);
      assert_strips_agree(b, strips, EA);
    }
    close_body(b);
  }
  model_close(&m);
}

/* --- energy ----------------------------------------------------------------------------------- */

static double stored(turning_body *b) {
  double sum = 0;
  patch_observe(b->p);
  for (long k = 0; k < b->p->inside_count; k++)
    sum += b->p->observed[0][b->p->inside[k]];
  return sum;
}

/* Moves all particles by `way` [dof][particles]; rotations in space turn further. */
static void move(turning_body *b, const double *way, double share) {
  const int dimensions = dimensions_of(b);
  const long n = b->p->inside_count;
  for (long k = 0; k < n; k++) {
    double *at[PL_MAX_DOF] = {NULL}, r[3], a[3];
    for (int d = 0; d < b->law->dof; d++)
      at[d] = &b->p->displacement[d][b->p->inside[k]];
    for (int d = 0; d < (b->law->dof == 6 ? 3 : b->law->dof); d++)
      *at[d] += share * way[d * n + k];
    if (b->law->dof < 6) continue;
    for (int d = 0; d < 3; d++)
      r[d] = *at[dimensions + d], a[d] = share * way[(dimensions + d) * n + k];
    turn_further(r, a);
    for (int d = 0; d < 3; d++)
      *at[dimensions + d] = r[d];
  }
}

/* Forces and moments are the slopes of the energy, at any deformation. */
static void assert_work_is_stored(const char *name, const char *kind, int shells, double size) {
  turning_body *b = open_free(name, kind, shells, INTERPRETED);
  const long n = b->p->inside_count, values = b->law->dof * n;
  double *way = must_calloc((size_t)values, sizeof *way), work = 0, scale = 0;
  shake(b, 0.5 * size, size);
  for (long k = 0; k < values; k++)
    way[k] = random_uniform(&seed, -1, 1) * (k / n < dimensions_of(b) ? SPACING : 1);
  for (int d = 0; d < b->law->dof; d++)
    memset(b->p->velocity[d], 0, (size_t)b->p->sites * sizeof(double));
  patch_step(b->p);
  for (long k = 0; k < values; k++) {
    const double part = -b->p->force[k / n][b->p->inside[k % n]] * way[k];
    work += part;
    scale += fabs(part);
  }
  const double h = 1e-4 * size;
  move(b, way, h);
  double slope = 8 * stored(b);
  move(b, way, h);
  slope -= stored(b);
  move(b, way, -3 * h);
  slope -= 8 * stored(b);
  move(b, way, -h);
  slope = (slope + stored(b)) / (12 * h);
  if (!(fabs(slope - work) < 1e-8 * scale))
    fail_msg("%s, %s at %g: slope %.12g, work %.12g, apart %.3g", name, kind, size, slope, work,
             fabs(slope - work) / scale);
  free(way);
  close_body(b);
}

static void work_is_the_energys(void **state) {
  (void)state;
  static const double sizes[] = {0.4, 0.1, 0.01, 1e-4};
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    assert_work_is_stored("models/elastic_micropolar", "square", 2, sizes[k]);
    assert_work_is_stored("models/mplm_space", "fcc", 2, sizes[k]);
    assert_work_is_stored("tests/generator/laws/solid_beam", "cubic", 1, sizes[k]);
  }
}

/* --- the plane in space ----------------------------------------------------------------------- */

/* One text: of a layer that moves in its plane the law in space gives what the law in the plane
   gives. */
static void motion_in_a_plane_is_that_of_the_plane(void **state) {
  (void)state;
  static const long layer[3] = {4, 4, 1};
  turning_body *plane = open_body("tests/generator/laws/frame", "square", 1, INTERPRETED, layer),
               *space = open_body("tests/generator/laws/frame", "cubic", 1, INTERPRETED, layer);
  rows_free(plane->lattice);
  plane->lattice = implied_lattice_like(&(deck_lattice){.kind = "square",
                                                        .spacing = SPACING,
                                                        .shells = 1,
                                                        .thickness = THICKNESS,
                                                        .stiffness_thickness = THICKNESS,
                                                        .mass_thickness = THICKNESS,
                                                        .setting = "plane_stress"},
                                        2300);
  patch_free(plane->p);
  plane->p = patch_new(plane->law, plane->parameters, plane->lattice, layer, 0, 0);
  set_free(plane->p);
  set_free(space->p);
  static const int of_space[3] = {0, 1, 5};
  for (int round = 0; round < 8; round++) {
    const double size = pow(10, -round);
    shake(plane, 0.3 * size, 2 * size);
    for (long k = 0; k < space->p->inside_count; k++) {
      double at[3], there[3];
      long n = 0;
      patch_position(space->p, space->p->inside[k], at);
      for (; n < plane->p->inside_count; n++) {
        patch_position(plane->p, plane->p->inside[n], there);
        if (hypot(at[0] - there[0], at[1] - there[1]) < 1e-9) break;
      }
      assert_true(n < plane->p->inside_count);
      assert_int_equal(n, k);
      for (int d = 0; d < 3; d++) {
        space->p->displacement[of_space[d]][space->p->inside[k]] =
            plane->p->displacement[d][plane->p->inside[k]];
        space->p->velocity[of_space[d]][space->p->inside[k]] =
            plane->p->velocity[d][plane->p->inside[k]];
      }
    }
    patch_step(plane->p);
    patch_step(space->p);
    const double most = largest_force(plane);
    for (long k = 0; k < space->p->inside_count; k++)
      for (int d = 0; d < 3; d++) {
        const double a = plane->p->force[d][plane->p->inside[k]],
                     c = space->p->force[of_space[d]][space->p->inside[k]];
        if (!(fabs(a - c) <= 1e-13 * most * (d == 2 ? SPACING : 1)))
          fail_msg("at %g component %d: %.17g is not %.17g of %g", size, d, c, a, most);
      }
  }
  close_body(plane);
  close_body(space);
}

/* --- closed forms of one bond ----------------------------------------------------------------- */

/* Bond 0 of site 0 alone. */
static long leave_one_bond(patch *p) {
  const long first = p->inside[0];
  for (long n = 0; n < p->inside_count; n++)
    for (int k = 0; k < p->lattice->directions; k++)
      if ((p->inside[n] != first || k != 0) && patch_has_bond(p, p->inside[n], k))
        patch_cut(p, p->inside[n], k);
  return patch_neighbour(p, first, 0);
}

/* Ends turned about the bond, and across it by unlike small angles; m: moments on i and j. */
static void one_bond_has_its_closed_form(void **state) {
  (void)state;
  turning_body *b = open_body("tests/generator/laws/solid_beam", "fcc", 1, INTERPRETED, SPACE);
  const long i = b->p->inside[0], j = leave_one_bond(b->p);
  const pl_bond_class bond = rows_bond_class(b->lattice, 0);
  const double EI = parameter(b, "EI"), GJ = parameter(b, "GJ"), s = bond.s, angle = 0.3;
  double e[3], n[3], across[3];
  for (int d = 0; d < 3; d++)
    e[d] = bond.chord[d] / s;
  const double some[3] = {0.3, -0.5, 0.7}, along = some[0] * e[0] + some[1] * e[1] + some[2] * e[2];
  for (int d = 0; d < 3; d++)
    n[d] = some[d] - along * e[d];
  const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int d = 0; d < 3; d++)
    n[d] /= size;
  for (int d = 0; d < 3; d++)
    across[d] = n[(d + 1) % 3] * e[(d + 2) % 3] - n[(d + 2) % 3] * e[(d + 1) % 3];
  /* twist: T = GJ/s angle along the bond, nothing else */
  for (int d = 0; d < 3; d++)
    b->p->displacement[3 + d][j] = angle * e[d];
  patch_step(b->p);
  for (int d = 0; d < 3; d++) {
    assert_true(fabs(b->p->force[d][i]) < 1e-12 * GJ / s / s);
    assert_true(fabs(b->p->force[3 + d][i] - GJ / s * angle * e[d]) < 1e-14 * GJ / s);
    assert_true(fabs(b->p->force[3 + d][j] + GJ / s * angle * e[d]) < 1e-14 * GJ / s);
  }
  /* bending by -a and 2 a about one axis: moments -(2 EI/s) 0 and (2 EI/s) 3 a, of any size */
  for (int d = 0; d < 3; d++) {
    b->p->displacement[3 + d][i] = -angle * n[d];
    b->p->displacement[3 + d][j] = 2 * angle * n[d];
  }
  patch_step(b->p);
  const double M = 2 * EI / s * 3 * angle;
  for (int d = 0; d < 3; d++) {
    assert_true(fabs(b->p->force[3 + d][i]) < 1e-13 * M);
    assert_true(fabs(b->p->force[3 + d][j] + M * n[d]) < 1e-13 * M);
    assert_true(fabs(b->p->force[d][i] + M / s * across[d]) < 1e-13 * M / s);
    assert_true(fabs(b->p->force[d][j] - M / s * across[d]) < 1e-13 * M / s);
  }
  close_body(b);
}

/* --- isotropy --------------------------------------------------------------------------------- */

/* The energy of a particle of `mplm_space` under uniform strains of any orientation is that of the
   isotropic body: W = V (lambda/2 tr(e)^2 + mu e:e), which with 18 neighbours stands for E, nu and
   G in all directions. Of the mean of e and -e, which has no term of third order. */
static void lattice_in_space_is_isotropic(void **state) {
  (void)state;
  turning_body *b = open_body("models/mplm_space", "fcc", 2, INTERPRETED, SPACE);
  static const double ratios[] = {0, 0.1, 0.2, 0.25};
  const double volume = SPACING * SPACING * SPACING / sqrt(2), size = 1e-6;
  for (size_t n = 0; n < sizeof ratios / sizeof *ratios; n++)
    for (int round = 0; round < 12; round++) {
      double e[3][3], trace = 0, square = 0, found = 0;
      set_parameter(b, "nu", ratios[n]);
      for (int r = 0; r < 3; r++)
        for (int c = r; c < 3; c++)
          e[r][c] = e[c][r] = size * random_uniform(&seed, -1, 1);
      for (int r = 0; r < 3; r++) {
        trace += e[r][r];
        for (int c = 0; c < 3; c++)
          square += e[r][c] * e[r][c];
      }
      for (int sign = 0; sign < 2; sign++) {
        patch_deform(b->p, (const double(*)[3])e, NULL, b->p->displacement);
        patch_observe(b->p);
        found += b->p->observed[0][b->p->inside[0]] / 2;
        for (int k = 0; k < 9; k++)
          e[k / 3][k % 3] *= -1;
      }
      const double E = parameter(b, "E"), nu = ratios[n];
      const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
      const double expected = volume * (lambda / 2 * trace * trace + mu * square);
      if (!(fabs(found / expected - 1) < 1e-10))
        fail_msg("nu = %g: %.12g is not %.12g", nu, found, expected);
    }
  close_body(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rotation_leaves_no_force),
                                     cmocka_unit_test(whole_turns_change_nothing),
                                     cmocka_unit_test(forces_and_moments_are_in_balance),
                                     cmocka_unit_test(families_give_what_strips_give),
                                     cmocka_unit_test(work_is_the_energys),
                                     cmocka_unit_test(motion_in_a_plane_is_that_of_the_plane),
                                     cmocka_unit_test(one_bond_has_its_closed_form),
                                     cmocka_unit_test(lattice_in_space_is_isotropic)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
