#include "runtime/analysis/body_limit.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/stencil.h"
#include "runtime/base/lane_sum.h"
#include "runtime/interaction/interaction.h"

/* LAPACK: eigenvalues and vectors of a symmetric tridiagonal matrix, ascending. */
void dstev_(const char *job, const int *n, double *diagonal, double *beside, double *vectors,
            const int *leading, double *work, int *info, size_t job_length);

/* Small against any strain that a law makes a difference at; with central differences what is left
   is of the second order. */
static const double tiny = 1e-7;         /* spacings */
static const double tiny_rate = 1e-3;    /* spacings a second */
static const double nominal_step = 1e-9; /* s; what a step is to a law at rest */
static const double accuracy = BODY_ACCURACY;
enum { BONDS_A_THREAD = 50000, MOST_STEPS = 240, STEPS_NOW = 16, LOOK_EVERY = 8, MOST_ROUNDS = 6 };

/* --- forces ----------------------------------------------------------------------------------- */

/* Of a body, over the masses of its particles: what a vector is multiplied with. */
typedef struct stiffness {
  sweep *sweep;
  body *body;
  long size, length;   /* of an array over sites; of a vector: dof of these */
  double *scale;       /* [length] 1/sqrt(mass), 0 at absent sites */
  double *probe;       /* [length] */
  double *base;        /* [length] displacements that it is about; NULL: at rest */
  double stiffer;      /* one side of a kink at rest than the mean of both; 1 without a kink */
  double acceleration; /* m/s^2: the largest at rest */
} stiffness;

static double *vector_of(const stiffness *b) {
  return must_calloc((size_t)b->length, sizeof(double));
}

static int threads_for(const rows *w) {
  const long offered = omp_get_max_threads(), sensible = 1 + w->bond_count / BONDS_A_THREAD;
  return (int)(offered < sensible ? offered : sensible);
}

static stiffness stiffness_new(sweep *of) {
  const rows *w = of->body->lattice;
  stiffness b = {.sweep = of,
                 .body = of->body,
                 .size = w->size,
                 .length = of->body->dof * w->size,
                 .stiffer = 1};
  b.scale = vector_of(&b);
  b.probe = vector_of(&b);
  for (int d = 0; d < b.body->dof; d++)
    for (long q = 0; q < w->size; q++)
      if (w->present[q] && body_mass(b.body, d, q) > 0)
        b.scale[d * w->size + q] = 1 / sqrt(body_mass(b.body, d, q));
  return b;
}

static void stiffness_free(stiffness *b) {
  free(b->scale);
  free(b->probe);
}

/* The longest way of the probe, m; of a rotation that of what is a spacing off. */
static double longest_way(const stiffness *b) {
  const long moving = b->body->dimensions * b->size;
  const double spacing = b->body->lattice->spacing;
  double most = 0;
  for (long k = 0; k < b->length; k++)
    most = pl_fmax(most, (k < moving ? 1 : spacing) * fabs(b->probe[k]));
  return most;
}

static void move(const stiffness *b, double *const *moving, double factor) {
  for (int d = 0; d < b->body->dof; d++)
    for (long q = 0; q < b->size; q++) {
      const long k = d * b->size + q;
      moving[d][q] = b->base ? b->base[k] + factor * b->probe[k] : factor * b->probe[k];
    }
}

static void add_forces(const stiffness *b, double factor, double *result) {
  for (int d = 0; d < b->body->dof; d++)
    for (long q = 0; q < b->size; q++) {
      const long k = d * b->size + q;
      if (b->scale[k] > 0) result[k] += factor * b->scale[k] * b->body->force[d][q];
    }
}

/* Largest acceleration, m/s^2, by what bonds carry at rest. */
static double acceleration_of(const stiffness *b, const double *rest) {
  double most = 0;
  for (long q = 0; q < b->size; q++) {
    double square = 0;
    for (int d = 0; d < b->body->dimensions; d++) {
      const double component = b->scale[d * b->size + q] * rest[d * b->size + q];
      square += component * component;
    }
    most = pl_fmax(most, square);
  }
  return sqrt(most);
}

/* Of the start vector, which pushes and pulls all bonds: forces that do not change their sign with
   the motion, beside those at rest. */
static void find_kink(stiffness *b, const double *x) {
  double *sum = vector_of(b), *difference = vector_of(b);
  sweep_find_forces(b->sweep);
  add_forces(b, 1, sum);
  b->acceleration = acceleration_of(b, sum);
  for (long k = 0; k < b->length; k++)
    sum[k] *= -2;
  for (long k = 0; k < b->length; k++)
    b->probe[k] = b->scale[k] * x[k];
  const double size = tiny * b->body->lattice->spacing / longest_way(b);
  for (int side = 1; side >= -1; side -= 2) {
    move(b, b->body->displacement, side * size);
    sweep_find_forces(b->sweep);
    add_forces(b, 1, sum);
    add_forces(b, side, difference);
  }
  move(b, b->body->displacement, 0);
  const double even = lane_dot(b->length, NULL, sum, sum),
               odd = lane_dot(b->length, NULL, difference, difference);
  if (even > STENCIL_KINK * STENCIL_KINK * odd) b->stiffer = 1 + sqrt(even / odd);
  free(sum);
  free(difference);
}

/* result += factor M^-1/2 K M^-1/2 x, or C for K: central differences of the forces by
   displacements or velocities. */
static void add_product(stiffness *b, bool rates, double factor, const double *x, double *result) {
  double *const *moving = rates ? b->body->velocity : b->body->displacement;
  for (long k = 0; k < b->length; k++)
    b->probe[k] = b->scale[k] * x[k];
  const double largest = longest_way(b);
  if (!(largest > 0)) return;
  const double size = (rates ? tiny_rate : tiny) * b->body->lattice->spacing / largest;
  if (!rates) factor *= b->stiffer;
  for (int side = 1; side >= -1; side -= 2) {
    move(b, moving, side * size);
    sweep_find_forces(b->sweep);
    add_forces(b, -side * factor / (2 * size), result);
  }
  move(b, moving, 0);
}

/* --- ends of the spectrum --------------------------------------------------------------------- */

typedef struct lanczos {
  stiffness *matrix;
  double rate; /* 1/s: of K + rate C */
  double *now, *before, *next;
  double diagonal[MOST_STEPS], beside[MOST_STEPS];
  double part[MOST_STEPS]; /* of the vectors so far in the eigenvector */
  int steps, most;     /* done; at most, as many as there are between looks or several times that */
  double value, error; /* largest eigenvalue, and how far from it there surely is one */
  double least;        /* smallest eigenvalue, or a little more than that */
} lanczos;

static double dot(const stiffness *b, const double *x, const double *y) {
  return lane_dot(b->length, NULL, x, y);
}

static void add(const stiffness *b, double factor, const double *x, double *y) {
  for (long k = 0; k < b->length; k++)
    y[k] += factor * x[k];
}

static void normalise(const stiffness *b, double *x) {
  const double size = sqrt(dot(b, x, x));
  for (long k = 0; size > 0 && k < b->length; k++)
    x[k] /= size;
}

/* Nothing that a mode could be at right angles to. */
static void start_vector(const stiffness *b, double *x) {
  uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
  for (long k = 0; k < b->length; k++) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    x[k] = b->scale[k] > 0 ? (double)(bits >> 11) * 0x1p-52 - 1 : 0;
  }
  normalise(b, x);
}

static void begin(lanczos *l) {
  start_vector(l->matrix, l->now);
  memset(l->before, 0, (size_t)l->matrix->length * sizeof(double));
}

/* One vector more; `beside` is 0 when there is none. */
static void extend(lanczos *l, int step) {
  stiffness *b = l->matrix;
  memset(l->next, 0, (size_t)b->length * sizeof(double));
  add_product(b, false, 1, l->now, l->next);
  if (l->rate > 0) add_product(b, true, l->rate, l->now, l->next);
  l->diagonal[step] = dot(b, l->now, l->next);
  add(b, -l->diagonal[step], l->now, l->next);
  if (step > 0) add(b, -l->beside[step - 1], l->before, l->next);
  l->beside[step] = sqrt(dot(b, l->next, l->next));
  double *const free_now = l->before;
  l->before = l->now;
  l->now = l->next;
  l->next = free_now;
  normalise(b, l->now);
}

static void look(lanczos *l) {
  const int n = l->steps;
  const size_t room = (size_t)n;
  double *values = must_alloc(room * sizeof *values), *beside = must_alloc(room * sizeof *beside);
  double *vectors = must_alloc(room * room * sizeof *vectors);
  double *work = must_alloc(2 * room * sizeof *work);
  int info = 0;
  memcpy(values, l->diagonal, room * sizeof *values);
  memcpy(beside, l->beside, room * sizeof *beside);
  dstev_("V", &n, values, beside, vectors, &n, work, &info, 1);
  l->value = info == 0 ? values[n - 1] : NAN;
  l->least = values[0];
  memcpy(l->part, vectors + room * (room - 1), room * sizeof *l->part);
  l->error = fabs(l->beside[n - 1] * l->part[n - 1]);
  free(values);
  free(beside);
  free(vectors);
  free(work);
}

static double size_of(const lanczos *l) {
  return pl_fmax(fabs(l->value), fabs(l->least));
}

/* False when forces are not finite. */
static bool find_largest(lanczos *l) {
  begin(l);
  for (l->steps = 0; l->steps < l->most;) {
    extend(l, l->steps);
    const bool last = !(l->beside[l->steps] > 1e-12 * fabs(l->diagonal[0]));
    if (!isfinite(l->diagonal[l->steps]) || !isfinite(l->beside[l->steps])) return false;
    l->steps++;
    if (!last && l->steps % LOOK_EVERY != 0) continue;
    look(l);
    if (last || l->error <= accuracy * size_of(l)) break;
  }
  return isfinite(l->value);
}

/* The same vectors again, summed up. */
static void find_vector(lanczos *l, double *x) {
  const int steps = l->steps;
  double part[MOST_STEPS];
  memcpy(part, l->part, sizeof part);
  memset(x, 0, (size_t)l->matrix->length * sizeof *x);
  begin(l);
  for (int k = 0; k < steps; k++) {
    add(l->matrix, part[k], l->now, x);
    extend(l, k);
  }
  normalise(l->matrix, x);
}

/* --- the step --------------------------------------------------------------------------------- */

static double quotient(stiffness *b, bool rates, const double *x) {
  double *y = vector_of(b);
  add_product(b, rates, 1, x, y);
  const double value = dot(b, x, y);
  free(y);
  return value;
}

/* Some of all there is. */
static bool is_damped(stiffness *b, double omega) {
  const double nothing = 1e-12;
  double *x = vector_of(b);
  start_vector(b, x);
  const double rates = quotient(b, true, x);
  free(x);
  return rates > nothing * omega;
}

/* A mode x is stable up to dt = 2/p, p^2 = k + p c with k = x K x, c = x C x. The largest p of all
   is where the largest eigenvalue of K + p C is p^2; each round begins with the p of the last one's
   mode, the first with one that waves have. */
static bool find_damped(lanczos *l, double omega, double known, step_limit *out) {
  double p = known > 0 ? pl_fmax(omega, 2 / known) : omega, *x = vector_of(l->matrix);
  bool good = true;
  for (int round = 0; round < MOST_ROUNDS && good; round++) {
    const double last = p;
    l->rate = p;
    good = find_largest(l);
    if (!good || (known > 0 && l->value <= p * p)) break;
    find_vector(l, x);
    const double k = pl_fmax(quotient(l->matrix, false, x), 0), c = quotient(l->matrix, true, x);
    p = pl_fmax(p, 0.5 * (c + sqrt(c * c + 4 * k)));
    out->damping_ratio = k > 0 ? c / (2 * sqrt(k)) : INFINITY;
    if (p <= last * (1 + accuracy / 4)) break;
  }
  out->limit = 2 / (p * (1 + accuracy / 2));
  free(x);
  return good;
}

/* The mode's share of the kinetic energy that turns. */
static double turning_share(lanczos *l) {
  const long moving = l->matrix->body->dimensions * l->matrix->size;
  double *x = vector_of(l->matrix), turning = 0;
  find_vector(l, x);
  for (long k = moving; k < l->matrix->length; k++)
    turning += x[k] * x[k];
  free(x);
  return turning;
}

static bool find_limit(lanczos *l, step_limit *out) {
  start_vector(l->matrix, l->now);
  find_kink(l->matrix, l->now);
  const double known = out->limit;
  if (!find_largest(l)) return false;
  const double size = size_of(l);
  out->least = size > 0 ? l->least / size : 0;
  out->prestrain =
      size > 0 ? l->matrix->acceleration / (size * l->matrix->body->lattice->spacing) : 0;
  out->omega_max = l->value > 0 ? sqrt(l->value + pl_fmin(l->error, accuracy * l->value)) : 0;
  out->limit = out->omega_max > 0 ? 2 / out->omega_max : INFINITY;
  if (l->matrix->body->dof > l->matrix->body->dimensions && turning_share(l) > 0.5)
    out->mode = "rotation";
  return !is_damped(l->matrix, out->omega_max) || find_damped(l, out->omega_max, known, out);
}

static lanczos lanczos_new(stiffness *b, int most) {
  return (lanczos){
      .matrix = b, .now = vector_of(b), .before = vector_of(b), .next = vector_of(b), .most = most};
}

static void lanczos_free(lanczos *l) {
  free(l->now);
  free(l->before);
  free(l->next);
}

static void limit_of(sweep *of, step_limit *out) {
  stiffness b = stiffness_new(of);
  lanczos l = lanczos_new(&b, MOST_STEPS);
  out->omega_max = NAN;
  out->damping_ratio = out->least = out->prestrain = 0;
  out->mode = "translation";
  if (!find_limit(&l, out)) out->limit = 0;
  lanczos_free(&l);
  stiffness_free(&b);
}

/* Of all displacements; to and fro. */
static void copy_places(const stiffness *b, bool back) {
  for (int d = 0; d < b->body->dof; d++) {
    double *here = b->body->displacement[d], *kept = b->base + d * b->size;
    memcpy(back ? here : kept, back ? kept : here, (size_t)b->size * sizeof *kept);
  }
}

double body_stiffness_now(sweep *of) {
  stiffness b = stiffness_new(of);
  lanczos l = lanczos_new(&b, STEPS_NOW);
  b.base = vector_of(&b);
  copy_places(&b, false);
  for (int k = 0; k < b.body->block_count; k++)
    b.body->blocks[k].aside = true;
  const double found = find_largest(&l) ? l.value : NAN;
  copy_places(&b, true);
  free(b.base);
  lanczos_free(&l);
  stiffness_free(&b);
  return found;
}

void body_limit(const pl_law *law, const double *parameters, double *const *varying, const rows *w,
                step_limit *out) {
  sweep *of = interaction_new(w, law, parameters, nominal_step, threads_for(w), false, true);
  of->parameter = varying;
  limit_of(of, out);
  sweep_free(of);
}

void body_limit_joint(const interaction_law *laws, int count, const rows *w, step_limit *out) {
  sweep **parts = must_calloc((size_t)count, sizeof(sweep *));
  sweep *of = interaction_joint(w, laws, count, nominal_step, threads_for(w), false, parts);
  limit_of(of, out);
  sweep_free(of);
  free(parts);
}
