#include "runtime/analysis/lowest_modes.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/cholesky.h"
#include "runtime/base/random_number.h"

/* LAPACK: eigenvalues and vectors of a symmetric tridiagonal matrix, ascending. */
void dstev_(const char *job, const int *n, double *diagonal, double *beside, double *vectors,
            const int *leading, double *work, int *info, size_t job_length);

/* Of A's size: so small that few vectors do, so large that what rounding leaves of eigenvalues that
   are 0 is positive with it, and that the others are not lost beside them. Larger ones are tried
   where one is not large enough. */
static const double least_shift = 1e-9, largest_shift = 1e-4, next_shift = 100;
static const double accuracy = 1e-10; /* of (A + shift)^-1, relative */
enum { LOOK_EVERY = 5, SPARE_VECTORS = 200 };

/* --- the inverse ------------------------------------------------------------------------------ */

typedef struct inverse {
  sparse_upper upper;
  cholesky *factors;
  double shift;
} inverse;

static const char no_memory[] = "there is not enough memory to factorise their stiffness",
                  unstable[] = "the bodies are unstable at rest",
                  no_convergence[] = "the method of Lanczos did not converge";

static const char *factorise(inverse *v) {
  const cholesky_end end = cholesky_factorise(v->factors, &v->upper, v->shift);
  if (end == CHOLESKY_NO_MEMORY) return no_memory;
  return end == CHOLESKY_DONE ? NULL : unstable;
}

/* --- vectors ---------------------------------------------------------------------------------- */

static double dot(long n, const double *x, const double *y) {
  double sum = 0;
  for (long k = 0; k < n; k++)
    sum += x[k] * y[k];
  return sum;
}

static void add(long n, double factor, const double *x, double *y) {
  for (long k = 0; k < n; k++)
    y[k] += factor * x[k];
}

static double normalise(long n, double *x) {
  const double length = sqrt(dot(n, x, x));
  for (long k = 0; length > 0 && k < n; k++)
    x[k] /= length;
  return length;
}

/* Nothing that a mode could be at right angles to. */
static void take_any(long n, uint64_t *asked, double *x) {
  for (long k = 0; k < n; k++)
    x[k] = random_unit(random_mix((*asked)++)) - 0.5;
}

/* --- a pass ----------------------------------------------------------------------------------- */

typedef struct mode_list { /* ascending */
  lowest_mode *modes;
  int count, most;
} mode_list;

/* Eigenvalues that are 0, and the others. */
typedef struct known_modes {
  mode_list zeros, others;
  double nothing;
} known_modes;

typedef struct lanczos {
  inverse *of;
  long order;
  const known_modes *known;
  double **vector;           /* [steps + 1] */
  double *diagonal, *beside; /* [steps] */
  int steps, room;
  double *values, *parts; /* of the tridiagonal matrix, ascending; [steps] and [steps][steps] */
} lanczos;

static void remove_list(const mode_list *list, long order, double *x) {
  for (int k = 0; k < list->count; k++)
    add(order, -dot(order, list->modes[k].vector, x), list->modes[k].vector, x);
}

static void reorthogonalise(const lanczos *l, double *x) {
  for (int twice = 0; twice < 2; twice++) {
    remove_list(&l->known->zeros, l->order, x);
    remove_list(&l->known->others, l->order, x);
    for (int k = 0; k < l->steps; k++)
      add(l->order, -dot(l->order, l->vector[k], x), l->vector[k], x);
  }
}

static double *vector_of(long order) {
  return must_calloc((size_t)order + 1, sizeof(double));
}

static void make_room(lanczos *l) {
  if (l->steps + 1 < l->room) return;
  const size_t room = (size_t)(l->room = 2 * l->room + 32);
  l->vector = must_realloc(l->vector, room * sizeof *l->vector);
  l->diagonal = must_realloc(l->diagonal, room * sizeof *l->diagonal);
  l->beside = must_realloc(l->beside, room * sizeof *l->beside);
}

/* One vector more; `beside` is 0 when there is none. False without memory. */
static bool extend(lanczos *l) {
  make_room(l);
  const double *now = l->vector[l->steps];
  double *next = vector_of(l->order);
  if (!cholesky_solve(l->of->factors, now, next)) {
    free(next);
    return false;
  }
  const double before = sqrt(dot(l->order, next, next));
  l->diagonal[l->steps] = dot(l->order, now, next);
  l->vector[++l->steps] = next;
  reorthogonalise(l, next);
  const double left = normalise(l->order, next);
  l->beside[l->steps - 1] = left > 1e-13 * before ? left : 0;
  return true;
}

static bool diagonalise(lanczos *l) {
  const int n = l->steps;
  const size_t room = (size_t)n;
  double *beside = must_alloc(room * sizeof *beside), *work = must_alloc(2 * room * sizeof *work);
  int info = 0;
  l->values = must_realloc(l->values, room * sizeof *l->values);
  l->parts = must_realloc(l->parts, room * room * sizeof *l->parts);
  memcpy(l->values, l->diagonal, room * sizeof *l->values);
  memcpy(beside, l->beside, room * sizeof *beside);
  dstev_("V", &n, l->values, beside, l->parts, &n, work, &info, 1);
  free(beside);
  free(work);
  return info == 0;
}

/* Of the eigenvalues of the inverse, from the largest on, the first that are exact enough. */
static int converged(const lanczos *l) {
  int count = 0;
  for (int k = l->steps - 1; k >= 0; k--, count++) {
    const double part = l->parts[(size_t)k * (size_t)l->steps + (size_t)l->steps - 1];
    if (fabs(l->beside[l->steps - 1] * part) > accuracy * l->values[k]) break;
  }
  return count;
}

static double value_of(const lanczos *l, int number) {
  return 1 / l->values[l->steps - 1 - number] - l->of->shift;
}

/* Which of the first `count` are to be kept, as bits of `kept`, counted in `many`: zeros as long as
   there is room, others that are wanted or lower than some known. False when no further one can
   be. */
static bool choose(const lanczos *l, int count, unsigned char *kept, int *many) {
  const mode_list *zeros = &l->known->zeros, *others = &l->known->others;
  int new_zeros = 0, new_others = 0;
  for (int k = 0; k < count && new_others < others->most; k++) {
    const bool is_zero = value_of(l, k) <= l->known->nothing;
    const int rival = others->most - 1 - new_others;
    if (!is_zero && rival < others->count && !(value_of(l, k) < others->modes[rival].value)) {
      *many = new_zeros + new_others;
      return false;
    }
    kept[k] = !is_zero || zeros->count + new_zeros < zeros->most;
    new_zeros += is_zero && kept[k];
    new_others += !is_zero;
  }
  *many = new_zeros + new_others;
  return new_others < others->most;
}

/* Steps until no further eigenvalue can be kept: which are, as `choose` says. Returns how many, or
   -1. */
static int run_pass(lanczos *l, unsigned char *kept) {
  const int most = 4 * l->known->others.most + SPARE_VECTORS;
  const long dimensions = l->order - l->known->zeros.count - l->known->others.count;
  while (l->steps < most) {
    if (!extend(l)) return -1;
    const bool last = l->beside[l->steps - 1] == 0 || l->steps >= dimensions;
    if (!last && l->steps % LOOK_EVERY != 0) continue;
    if (last) l->beside[l->steps - 1] = 0;
    int many;
    if (!diagonalise(l)) return -1;
    memset(kept, 0, (size_t)most);
    if (!choose(l, converged(l), kept, &many) || last) return many;
  }
  return -1;
}

/* --- modes ------------------------------------------------------------------------------------ */

/* A x, and x A x / x x. */
static double product_of(const sparse_matrix *a, const double *x, long double *y) {
  long double energy = 0, square = 0;
  memset(y, 0, (size_t)a->order * sizeof *y);
  for (long c = 0; c < a->order; c++)
    for (int64_t k = a->begin[c]; k < a->begin[c + 1]; k++) {
      const int64_t r = a->row[k];
      y[r] += (long double)a->value[k] * x[c];
      if (r != c) y[c] += (long double)a->value[k] * x[r];
    }
  for (long k = 0; k < a->order; k++) {
    energy += y[k] * x[k];
    square += (long double)x[k] * x[k];
  }
  return (double)(energy / square);
}

static void judge(const sparse_matrix *a, lowest_mode *m) {
  long double *y = must_alloc(((size_t)a->order + 1) * sizeof *y);
  double square = 0;
  m->value = product_of(a, m->vector, y);
  for (long k = 0; k < a->order; k++) {
    const double left = (double)(y[k] - (long double)m->value * m->vector[k]);
    square += left * left;
  }
  m->residual = sqrt(square);
  free(y);
}

static lowest_mode mode_of(const lanczos *l, const sparse_matrix *a, int number) {
  lowest_mode m = {.vector = vector_of(l->order)};
  const double *part = l->parts + (size_t)(l->steps - 1 - number) * (size_t)l->steps;
  for (int k = 0; k < l->steps; k++)
    add(l->order, part[k], l->vector[k], m.vector);
  normalise(l->order, m.vector);
  judge(a, &m);
  return m;
}

static void forget(lanczos *l) {
  for (int k = 0; k <= l->steps && l->vector; k++)
    free(l->vector[k]);
  free(l->vector);
  free(l->diagonal);
  free(l->beside);
  free(l->values);
  free(l->parts);
}

/* The highest goes where there is no room. */
static void insert(mode_list *list, lowest_mode m) {
  int at = list->count < list->most ? list->count++ : list->most - 1;
  if (at < list->most && list->modes[at].vector) free(list->modes[at].vector);
  for (; at > 0 && list->modes[at - 1].value > m.value; at--)
    list->modes[at] = list->modes[at - 1];
  list->modes[at] = m;
}

static void take(const lanczos *l, const sparse_matrix *a, const unsigned char *kept,
                 known_modes *known) {
  for (int k = 0; k < l->steps; k++) {
    if (!kept[k]) continue;
    const bool is_zero = value_of(l, k) <= known->nothing;
    insert(is_zero ? &known->zeros : &known->others, mode_of(l, a, k));
  }
}

/* Returns how many modes a pass has found, or -1. */
static int pass(inverse *v, const sparse_matrix *a, uint64_t *asked, known_modes *known) {
  lanczos l = {.of = v, .order = a->order, .known = known};
  unsigned char *kept = must_calloc(4 * (size_t)known->others.most + SPARE_VECTORS, 1);
  make_room(&l);
  l.vector[0] = vector_of(l.order);
  take_any(l.order, asked, l.vector[0]);
  reorthogonalise(&l, l.vector[0]);
  normalise(l.order, l.vector[0]);
  const int many = run_pass(&l, kept);
  if (many > 0) take(&l, a, kept, known);
  forget(&l);
  free(kept);
  return many;
}

static void clear(mode_list *list) {
  lowest_modes_free(list->modes, list->count);
  memset(list->modes, 0, (size_t)list->most * sizeof *list->modes);
  list->count = 0;
}

static const char *find(inverse *v, const sparse_matrix *a, known_modes *known) {
  uint64_t asked = 0;
  const char *why = factorise(v);
  int found = 1;
  while (!why && found > 0 && known->zeros.count + known->others.count < a->order)
    found = pass(v, a, &asked, known);
  if (found < 0) why = no_convergence;
  if (!why) return NULL;
  clear(&known->zeros);
  clear(&known->others);
  return why;
}

const char *lowest_modes_find(const sparse_matrix *a, double nothing, int most, lowest_mode *modes,
                              int *count, int *zeros) {
  lowest_mode rigid[LOWEST_MOST_ZEROS] = {{0}};
  known_modes known = {
      .zeros = {rigid, 0, LOWEST_MOST_ZEROS}, .others = {modes, 0, most}, .nothing = nothing};
  inverse v = {.upper = {a->order, a->begin, a->row, a->value}};
  memset(modes, 0, (size_t)most * sizeof *modes);
  v.factors = cholesky_new(&v.upper);
  const char *why = v.factors ? NULL : no_memory;
  for (double s = least_shift; !(why == no_memory) && s <= largest_shift; s *= next_shift) {
    v.shift = s * a->size;
    why = find(&v, a, &known);
    if (!why) break;
  }
  cholesky_free(v.factors);
  lowest_modes_free(rigid, known.zeros.count);
  *zeros = known.zeros.count;
  *count = known.others.count;
  return why;
}

void lowest_modes_free(lowest_mode *modes, int count) {
  for (int k = 0; k < count; k++)
    free(modes[k].vector);
}
