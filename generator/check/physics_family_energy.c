/* Work of the forces of a law of families with states and damages held. */
#include "generator/check/physics_family_energy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/ir/random_values.h"
#include "generator/lower/lower_family.h"
#include "runtime/analysis/implied.h"

static const double REST_TOLERANCE = 1e-9;   /* of the force at a strain of 1e-3 */
static const double ENERGY_TOLERANCE = 1e-9; /* of the work of the absolute forces */
static const double GAIN_TOLERANCE = 1e-6;   /* of the path's peak energy */
static const double SLOPE_TOLERANCE = 1e-6;  /* central differences of the energy */

static double largest(const double *v, long count) {
  double most = 0;
  for (long k = 0; k < count; k++)
    if (!(fabs(v[k]) <= most)) most = fabs(v[k]);
  return most;
}

/* Forces along the reference bonds have an energy in the limit of small strains only. */
static double draw_strain(family_bench *b) {
  const bool small = b->step.along_reference;
  return pl_pow(10, small ? draw_uniform(&b->seed, -8, -7) : draw_uniform(&b->seed, -5, -2));
}

/* --- at rest ---------------------------------------------------------------------------------- */

/* The body turned about its first particle, in space about a random axis. */
static void turn(family_bench *b, double angle, double *u) {
  const patch *p = b->whole;
  double n[3] = {0, 0, 1}, at[3];
  if (p->law->dimensions == 3) {
    double length = 0;
    for (int d = 0; d < 3; d++) {
      n[d] = draw_uniform(&b->seed, -1, 1);
      length += n[d] * n[d];
    }
    for (int d = 0; d < 3; d++)
      n[d] /= sqrt(length);
  }
  for (long q = 0; q < p->inside_count; q++) {
    patch_position(p, p->inside[q], at);
    const double along = n[0] * at[0] + n[1] * at[1] + n[2] * at[2];
    const double across[3] = {n[1] * at[2] - n[2] * at[1], n[2] * at[0] - n[0] * at[2],
                              n[0] * at[1] - n[1] * at[0]};
    for (int d = 0; d < p->law->dimensions; d++)
      u[d * p->inside_count + q] =
          (pl_cos(angle) - 1) * (at[d] - along * n[d]) + pl_sin(angle) * across[d];
    for (int d = p->law->dimensions; d < p->law->dof; d++)
      u[d * p->inside_count + q] = angle * n[d % 3] * p->lattice->spacing;
  }
}

void family_check_rest(family_bench *b) {
  enum { ROUNDS = 4 };
  double *u = family_bench_values(b), *force = family_bench_values(b);
  for (int round = 0; round < ROUNDS && !(round && family_bench_tired(b)); round++) {
    family_bench_draw(b, round == 0);
    family_bench_deform(b, 1e-3, u);
    family_bench_move(b, u, NULL);
    family_bench_forces(b, b->frozen, force);
    double scale = largest(force, b->values);
    family_bench_forces(b, b->whole, force); /* a law may carry its strain in states */
    scale = pl_fmax(scale, largest(force, b->values));
    turn(b, round % 2 ? draw_uniform(&b->seed, -3, 3) : 0, u);
    family_bench_move(b, u, NULL);
    family_bench_forces(b, b->whole, force);
    const double found = largest(force, b->values);
    const bool said = b->failed[DIAG_REST_FORCE];
    if (!(found <= REST_TOLERANCE * scale))
      family_bench_say(b, DIAG_REST_FORCE, family_bench_force(b), 0,
                       "a particle of the virgin body at rest feels a force of %.6g N%s", found,
                       round % 2 ? " once the body is turned" : "");
    if (!said && b->failed[DIAG_REST_FORCE] && b->law->tree->law == LAW_STATE && round % 2 == 0)
      diag_hint(b->said,
                "what bonds have grown by goes into `rest stretch[j] = ...`, and a prestress "
                "that is meant is told by `accept rest-force \"why\"`");
  }
  free(u);
  free(force);
}

void family_check_stiffness(family_bench *b) {
  enum { ROUNDS = 16 };
  double *u = family_bench_values(b), *force = family_bench_values(b);
  for (int round = 0; round < ROUNDS && !(round && family_bench_tired(b)); round++) {
    double size = 0;
    if (round % 4 == 0) family_bench_draw(b, round == 0);
    family_bench_deform(b, 1e-7, u);
    family_bench_move(b, u, NULL);
    family_bench_forces(b, b->whole, force);
    const double work = 0.5 * family_work(force, u, b->values, &size);
    if (work < -1e-7 * size) /* the geometry is of the order of the strain */
      family_bench_say(b, DIAG_STIFFNESS, family_bench_force(b), 1e-7,
                       "the virgin body stores a negative energy, %.4g J: it would fly apart",
                       work);
  }
  free(u);
  free(force);
}

/* The moment about bond k on its particle, when the other one alone turns about the bond: of all
   the particle's bonds none else moves. Over the turn, N m; *size: of the largest force in the
   body, times the spacing. */
static double twisting_stiffness(family_bench *b, long particle, int k, double *size) {
  enum { FIRST = 3 };
  const double turn = 1e-7;
  const patch *p = b->whole;
  const pl_bond_class bond = rows_bond_class(p->lattice, k);
  const long site = p->inside[particle], other = patch_neighbour(p, site, k);
  double *u = family_bench_values(b), *force = family_bench_values(b), moment = 0;
  for (long q = 0; q < p->inside_count; q++)
    for (int d = 0; d < 3 && p->inside[q] == other; d++)
      u[(FIRST + d) * p->inside_count + q] = turn * p->lattice->spacing * bond.chord[d] / bond.s;
  family_bench_move(b, u, NULL);
  family_bench_forces(b, b->whole, force);
  for (int d = 0; d < 3; d++)
    moment += force[(FIRST + d) * p->inside_count + particle] * bond.chord[d] / bond.s;
  *size = largest(force, b->values) * p->lattice->spacing / turn;
  free(u);
  free(force);
  return moment * p->lattice->spacing / turn;
}

void family_check_twist(family_bench *b) {
  double size;
  family_bench_draw(b, true);
  for (long q = 0; q < b->whole->inside_count; q++)
    for (int k = 0; k < b->lattice->directions; k++) {
      if (!patch_has_bond(b->whole, b->whole->inside[q], k)) continue;
      const double stiffness = twisting_stiffness(b, q, k, &size);
      if (stiffness >= -1e-9 * size) continue;
      family_bench_say(b, DIAG_STIFFNESS, family_bench_force(b), 0,
                       "a virgin bond that is twisted twists on: T over the twist is %.4g N m",
                       stiffness);
      return;
    }
}

/* --- work with the fields held ---------------------------------------------------------------- */

static const double gauss_at[8] = {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290,
                                   -0.1834346424956498, 0.1834346424956498,  0.5255324099163290,
                                   0.7966664774136267,  0.9602898564975363};
static const double gauss_weight[8] = {0.1012285362903763, 0.2223810344533745, 0.3137066458778873,
                                       0.3626837833783620, 0.3626837833783620, 0.3137066458778873,
                                       0.2223810344533745, 0.1012285362903763};

static double leg_work(family_bench *b, const double *from, const double *to, int panels,
                       double *size) {
  double *u = family_bench_values(b), *way = family_bench_values(b),
         *force = family_bench_values(b), sum = 0;
  for (long k = 0; k < b->values; k++)
    way[k] = to[k] - from[k];
  for (int point = 0; point < 8 * panels; point++) {
    const double at = (point / 8 + 0.5 * (1 + gauss_at[point % 8])) / panels;
    const double weight = 0.5 * gauss_weight[point % 8] / panels;
    double part = 0;
    for (long k = 0; k < b->values; k++)
      u[k] = from[k] + at * way[k];
    family_bench_move(b, u, NULL);
    family_bench_forces(b, b->frozen, force);
    sum += weight * family_work(force, way, b->values, &part);
    *size += weight * part;
  }
  free(u);
  free(way);
  free(force);
  return sum;
}

/* From rest to a, to b, and back. */
typedef struct triangle {
  double *rest, *a, *b;
  double strain;
  double work[3], size, peak;
} triangle;

static void go_round(family_bench *b, triangle *t, int panels) {
  const double *corner[] = {t->rest, t->a, t->b, t->rest};
  double sum = 0;
  t->size = t->peak = 0;
  for (int leg = 0; leg < 3; leg++) {
    t->work[leg] = leg_work(b, corner[leg], corner[leg + 1], panels, &t->size);
    sum += t->work[leg];
    t->peak = pl_fmax(t->peak, fabs(sum));
  }
}

static double gain_of(const triangle *t) {
  return t->work[0] + t->work[1] + t->work[2];
}

static void say_closed_path(family_bench *b, const triangle *t, bool damaged) {
  family_bench_say(
      b, damaged ? DIAG_CLOSED_PATH_DAMAGED : DIAG_CLOSED_PATH, family_bench_force(b), t->strain,
      "a closed way %sgives %.3g %% of its peak energy back or takes it, by the "
      "direction it is gone: the forces have no stored energy",
      damaged ? "at a damage that stays the same " : "", 100 * fabs(gain_of(t)) / t->peak);
  diag_hint(b->said, "derive %s from an `energy W`%s",
            b->law->tree->law == LAW_STATE ? "the force state" : "forces and moments",
            damaged ? ", or say `nonconservative \"why\"`" : "");
}

/* Kinks make the work converge slowly: ever finer panels, until it vanishes or settles. */
static void judge_triangle(family_bench *b, triangle *t, bool damaged) {
  static const int panels[] = {1, 3, 7, 17};
  double before = NAN;
  int settled = 0;
  for (size_t k = 0; k < sizeof panels / sizeof *panels && settled < 2; k++) {
    go_round(b, t, panels[k]);
    const double gain = gain_of(t);
    const bool negative = t->work[0] < -ENERGY_TOLERANCE * t->size;
    if (negative && k > 0) {
      family_bench_say(b, DIAG_STORED_ENERGY, family_bench_force(b), t->strain,
                       "the body stores a negative energy, %.4g J: it would give work without "
                       "having taken any",
                       t->work[0]);
      return;
    }
    if (!negative && !(fabs(gain) > GAIN_TOLERANCE * t->peak)) return;
    settled = fabs(gain - before) <= 0.02 * fabs(gain) ? settled + 1 : 0;
    before = gain;
  }
  if (settled == 2) say_closed_path(b, t, damaged);
}

/* On bonds the same from either side; the whole body alike, or each damage on its own. */
static void draw_damage(family_bench *b, bool alike) {
  patch *p = b->whole;
  const double level = draw_uniform(&b->seed, 0.5, 1);
  const int half = p->lattice->directions;
  for (int f = 0; f < b->law->fields.count; f++) {
    const pl_field *field = &p->law->fields[f];
    if (field->kind != PL_FIELD_DAMAGE) continue;
    const int planes = field->place == PL_ON_PARTICLE ? 1 : half;
    for (int k = 0; k < planes; k++)
      for (long q = 0; q < p->inside_count; q++) {
        const long site = p->inside[q], far = patch_neighbour(p, site, k);
        const double drawn = alike ? level : draw_field(&b->seed, field);
        p->field[f][k * p->size + site] = drawn;
        if (field->place != PL_ON_PARTICLE) p->field[f][(k + half) * p->size + far] = drawn;
      }
  }
  family_bench_share_fields(b);
}

/* Half of what is left. */
static void raise_damage(family_bench *b, int f) {
  patch *p = b->frozen;
  for (long k = 0; k < patch_planes(p, &p->law->fields[f]); k++)
    for (long q = 0; q < p->inside_count; q++) {
      double *d = &p->field[f][k * p->size + p->inside[q]];
      *d += 0.5 * (1 - *d);
    }
}

static void check_damage_force(family_bench *b, const triangle *t) {
  enum { PANELS = 3 };
  const double tolerance = 1e-3; /* of kinks that panels do not resolve */
  double size = 0;
  const double whole = leg_work(b, t->rest, t->a, PANELS, &size);
  for (int f = 0; f < b->law->fields.count; f++) {
    const symbol *s = b->law->fields.items[f];
    if (s->kind != SYMBOL_DAMAGE) continue;
    raise_damage(b, f);
    const double less = leg_work(b, t->rest, t->a, PANELS, &size);
    family_bench_share_fields(b);
    if (!(less - whole > tolerance * size)) continue;
    family_bench_say(b, DIAG_DAMAGE_FORCE, family_bench_force(b), t->strain,
                     "the stored energy rises from %.4g to %.4g J when damage `%s` grows: damage "
                     "would heal the body",
                     whole, less, s->name);
    diag_hint(b->said,
              "a damage of 0 leaves a particle whole, one of 1 leaves nothing: forces carry a "
              "factor such as (1 - %s)",
              s->name);
  }
}

static bool has_damage(const law *l) {
  for (int f = 0; f < l->fields.count; f++)
    if (l->fields.items[f]->kind == SYMBOL_DAMAGE) return true;
  return false;
}

void family_check_energy(family_bench *b, bool damaged) {
  enum { ROUNDS = 3 };
  triangle t = {
      .rest = family_bench_values(b), .a = family_bench_values(b), .b = family_bench_values(b)};
  for (int round = 0;
       round < ROUNDS && (!damaged || has_damage(b->law)) && !(round && family_bench_tired(b));
       round++) {
    family_bench_draw(b, round == 0);
    if (damaged) draw_damage(b, round == 0);
    t.strain = draw_strain(b);
    family_bench_deform(b, t.strain, t.a);
    family_bench_deform(b, t.strain, t.b);
    judge_triangle(b, &t, damaged);
    if (damaged && !b->failed[DIAG_STORED_ENERGY]) check_damage_force(b, &t);
  }
  free(t.rest);
  free(t.a);
  free(t.b);
}

/* --- energy and force ------------------------------------------------------------------------- */

/* Energy of the body at u + share v. */
static double energy_beside(family_bench *b, const double *u, const double *v, double share) {
  double *at = family_bench_values(b);
  for (long k = 0; k < b->values; k++)
    at[k] = u[k] + share * v[k];
  family_bench_move(b, at, NULL);
  free(at);
  return family_bench_energy(b);
}

/* Slope of the energy along v, against the work of the forces. Damaged bodies only where the law
   claims an energy for them. */
void family_check_energy_and_force(family_bench *b) {
  enum { ROUNDS = 4 };
  const double share = 1e-4;
  if (!b->has_energy || !law_force_state(b->law)) return;
  double *u = family_bench_values(b), *v = family_bench_values(b), *force = family_bench_values(b);
  for (int round = 0; round < ROUNDS && !(round && family_bench_tired(b)); round++) {
    double size = 0;
    family_bench_draw(b, round == 0);
    if (!b->law->nonconservative && round % 2) draw_damage(b, round == 1);
    family_bench_share_fields(b);
    const double strain = draw_strain(b);
    family_bench_deform(b, strain, u);
    family_bench_deform(b, strain, v);
    family_bench_move(b, u, NULL);
    family_bench_forces(b, b->frozen, force);
    const double work = family_work(force, v, b->values, &size);
    const double slope =
        (energy_beside(b, u, v, share) - energy_beside(b, u, v, -share)) / (2 * share);
    if (fabs(slope - work) <= SLOPE_TOLERANCE * (size + fabs(slope))) continue;
    family_bench_say(b, DIAG_ENERGY_FORCE, family_bench_force(b), strain,
                     "along a way on which the forces do %.6g J the law's energy grows by %.6g J",
                     work, slope);
    diag_hint(b->said, "the bond force is the mean of both sides; toward j it is "
                       "(dW_i/dstretch + dW_j/dstretch)/s");
  }
  free(u);
  free(v);
  free(force);
}
