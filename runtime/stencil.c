#include "runtime/stencil.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "runtime/family.h"
#include "runtime/shape_matrix.h"

/* Small against any strain that a law makes a difference at; with central differences what is left
   is of the second order. */
static const double tiny = 1e-7;         /* spacings */
static const double tiny_rate = 1e-3;    /* spacings a second */
static const double nominal_step = 1e-9; /* s; what a step is to a law at rest */

/* A periodic lattice in whole multiples of its primitive vectors. Sites stand in one array, so that
   neighbour k is an offset away everywhere; a margin on all sides repeats what is inside. Nothing
   that happens at the middle comes round to itself: the period is longer than the passes reach. */
typedef struct patch {
  const pl_law *law;
  const rows *lattice;
  double primitive[3][3];
  long reach[3], period[3], width[3]; /* of all passes; sites without, with the margins */
  long cell[PL_MAX_DIRECTIONS][3];    /* of the chords */
  long offset[2 * PL_MAX_DIRECTIONS];
  long sites, lead, size; /* in the lattice; before the first, in an array */
  long middle;
  long *image; /* [sites] the site inside that this one repeats */
  double *uniforms;
  uint64_t *bonds, *held;
  double *displacement[3], *velocity[3], *force[3], *shape[PL_SHAPE_VALUES(3)];
  double **old_field, **new_field, **link; /* [size] each, [neighbours * size] on neighbours */
} patch;

/* --- the lattice ------------------------------------------------------------------------------ */

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whole coordinates of the chords, by the dual vectors of the primitive ones. */
static void find_cells(patch *p) {
  const rows *w = p->lattice;
  double(*a)[3] = p->primitive;
  lattice_primitive(w, a);
  for (int n = 0; n < 3; n++) {
    const double *b = a[(n + 1) % 3], *c = a[(n + 2) % 3];
    const double dual[3] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2],
                            b[0] * c[1] - b[1] * c[0]};
    for (int k = 0; k < w->directions; k++)
      p->cell[k][n] = lround(dot(dual, w->chord[k]) / dot(dual, a[n]));
  }
}

static long site_at(const patch *p, const long at[3]) {
  return (at[2] * p->width[1] + at[1]) * p->width[0] + at[0];
}

static void place_of(const patch *p, long site, long at[3]) {
  at[0] = site % p->width[0];
  at[1] = site / p->width[0] % p->width[1];
  at[2] = site / p->width[0] / p->width[1];
}

static void find_sizes(patch *p) {
  const int half = p->lattice->directions;
  long margin[3] = {0, 0, 0}, at[3];
  for (int n = 0; n < 3; n++) {
    for (int k = 0; k < half; k++)
      margin[n] = labs(p->cell[k][n]) > margin[n] ? labs(p->cell[k][n]) : margin[n];
    p->reach[n] = p->law->step.pass_count * margin[n];
    p->period[n] = 2 * p->reach[n] + 1;
    p->width[n] = p->period[n] + 2 * margin[n];
  }
  p->sites = p->width[0] * p->width[1] * p->width[2];
  for (int k = 0; k < half; k++) {
    p->offset[k] = site_at(p, p->cell[k]);
    p->offset[half + k] = -p->offset[k];
    if (labs(p->offset[k]) > p->lead) p->lead = labs(p->offset[k]);
  }
  p->lead = (p->lead + PL_LANES - 1) / PL_LANES * PL_LANES;
  p->size = (p->sites + 2 * p->lead + 2 * PL_LANES) / PL_LANES * PL_LANES;
  p->image = must_calloc((size_t)p->sites, sizeof *p->image);
  for (long q = 0; q < p->sites; q++) {
    place_of(p, q, at);
    for (int n = 0; n < 3; n++)
      at[n] = (at[n] - margin[n] + p->period[n]) % p->period[n] + margin[n];
    p->image[q] = site_at(p, at);
  }
  for (int n = 0; n < 3; n++)
    at[n] = margin[n] + p->reach[n];
  p->middle = site_at(p, at);
}

/* --- memory ----------------------------------------------------------------------------------- */

/* Points at the first site. */
static void *site_array(const patch *p, long planes, size_t each) {
  const size_t bytes = (size_t)(planes * p->size) * each;
  char *memory =
      aligned_alloc(PL_ALIGNMENT, (bytes + PL_ALIGNMENT - 1) / PL_ALIGNMENT * PL_ALIGNMENT);
  if (!memory) must_alloc(SIZE_MAX); /* ends the program with the usual message */
  memset(memory, 0, bytes);
  return memory + (size_t)p->lead * each;
}

static void free_array(const patch *p, void *array, size_t each) {
  if (array) free((char *)array - (size_t)p->lead * each);
}

static long planes_of(const patch *p, int field) {
  return p->law->fields[field].place == PL_ON_PARTICLE ? 1 : 2 * p->lattice->directions;
}

static void new_arrays(patch *p) {
  const pl_law *law = p->law;
  double shape[PL_SHAPE_VALUES(3)];
  p->bonds = site_array(p, 1, sizeof *p->bonds);
  p->held = site_array(p, 1, sizeof *p->held);
  for (long q = -p->lead; q < p->size - p->lead; q++)
    p->bonds[q] = UINT64_MAX;
  for (int d = 0; d < law->dimensions; d++) {
    p->displacement[d] = site_array(p, 1, sizeof(double));
    p->velocity[d] = site_array(p, 1, sizeof(double));
    p->force[d] = site_array(p, 1, sizeof(double));
  }
  shape_matrix_full(p->lattice, shape);
  for (int v = 0; v < PL_SHAPE_VALUES(law->dimensions); v++) {
    p->shape[v] = site_array(p, 1, sizeof(double));
    for (long q = -p->lead; q < p->size - p->lead; q++)
      p->shape[v][q] = shape[v];
  }
  p->old_field = must_calloc((size_t)law->field_count + 1, sizeof *p->old_field);
  p->new_field = must_calloc((size_t)law->field_count + 1, sizeof *p->new_field);
  for (int f = 0; f < law->field_count; f++) {
    p->old_field[f] = site_array(p, planes_of(p, f), sizeof(double));
    p->new_field[f] = site_array(p, planes_of(p, f), sizeof(double));
    for (long q = -p->lead; q < planes_of(p, f) * p->size - p->lead; q++)
      p->old_field[f][q] = law->fields[f].initial;
  }
  p->link = must_calloc((size_t)law->link_count + 1, sizeof *p->link);
  for (int k = 0; k < law->link_count; k++)
    p->link[k] = site_array(p, 1, sizeof(double));
}

static void patch_free(patch *p) {
  for (int d = 0; d < 3; d++) {
    free_array(p, p->displacement[d], sizeof(double));
    free_array(p, p->velocity[d], sizeof(double));
    free_array(p, p->force[d], sizeof(double));
  }
  for (int v = 0; v < PL_SHAPE_VALUES(3); v++)
    free_array(p, p->shape[v], sizeof(double));
  for (int f = 0; f < p->law->field_count; f++) {
    free_array(p, p->old_field[f], sizeof(double));
    free_array(p, p->new_field[f], sizeof(double));
  }
  for (int k = 0; k < p->law->link_count; k++)
    free_array(p, p->link[k], sizeof(double));
  free_array(p, p->bonds, sizeof *p->bonds);
  free_array(p, p->held, sizeof *p->held);
  free(p->old_field);
  free(p->new_field);
  free(p->link);
  free(p->image);
  free(p->uniforms);
}

static patch patch_new(const pl_law *law, const double *parameters, const rows *w) {
  patch p = {.law = law, .lattice = w};
  find_cells(&p);
  find_sizes(&p);
  new_arrays(&p);
  p.uniforms = family_uniforms(law, w, parameters);
  return p;
}

/* --- forces ----------------------------------------------------------------------------------- */

static void repeat(const patch *p, double *values) {
  for (long q = 0; q < p->sites; q++)
    values[q] = values[p->image[q]];
}

/* Forces of the virgin lattice in the present displacements and velocities. */
static void run_step(patch *p) {
  const pl_law *law = p->law;
  pl_family run = {.count = (p->sites + PL_LANES - 1) / PL_LANES * PL_LANES,
                   .neighbours = 2 * p->lattice->directions,
                   .plane = p->size,
                   .offset = p->offset,
                   .bonds = p->bonds,
                   .held = p->held,
                   .shape = (const double *const *)p->shape,
                   .old_field = (const double *const *)p->old_field,
                   .new_field = p->new_field,
                   .link = p->link,
                   .force = p->force,
                   .time_step = nominal_step};
  for (int d = 0; d < law->dimensions; d++) {
    run.displacement[d] = p->displacement[d];
    run.velocity[d] = p->velocity[d];
  }
  for (int k = 0; k < law->step.pass_count; k++) {
    law->step.pass[k](law, p->uniforms, &run);
    for (int l = 0; l < law->link_count; l++)
      repeat(p, p->link[l]);
  }
}

/* Column b of the blocks, -df/d(moved), of the particle in the middle; who feels it R ahead stands at
   -R. */
static void probe(patch *p, double *moved, double size, int b, bool rates, stencil *out) {
  long at[3];
  for (int side = 1; side >= -1; side -= 2) {
    moved[p->middle] = side * size;
    run_step(p);
    for (int n = 0; n < out->count; n++) {
      stencil_block *block = &out->blocks[n];
      place_of(p, p->middle, at);
      for (int k = 0; k < 3; k++)
        at[k] -= block->cell[k];
      for (int a = 0; a < out->dimensions; a++) {
        double *value = rates ? &block->damping[a][b] : &block->stiffness[a][b];
        *value -= side * p->force[a][site_at(p, at)] / (2 * size);
      }
    }
  }
  moved[p->middle] = 0;
}

/* --- blocks ----------------------------------------------------------------------------------- */

static void add_block(const patch *p, stencil *s, const long cell[3], int sign) {
  stencil_block *b = &s->blocks[s->count++];
  for (int n = 0; n < 3; n++) {
    b->cell[n] = sign * cell[n];
    for (int c = 0; c < 3; c++)
      b->R[c] += (double)b->cell[n] * p->primitive[n][c];
  }
}

static void add_blocks(const patch *p, stencil *s) {
  const long all = p->period[0] * p->period[1] * p->period[2];
  s->blocks = must_calloc((size_t)all, sizeof *s->blocks);
  add_block(p, s, (const long[3]){0, 0, 0}, 1);
  for (long n = all / 2 + 1; n < all; n++) { /* the half above the middle */
    const long cell[3] = {n % p->period[0] - p->reach[0],
                          n / p->period[0] % p->period[1] - p->reach[1],
                          n / p->period[0] / p->period[1] - p->reach[2]};
    add_block(p, s, cell, 1);
    add_block(p, s, cell, -1);
  }
}

/* a becomes the mean of itself and b transposed, b its transpose. */
static void pair_up(double a[3][3], double b[3][3]) {
  double mean[3][3];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      mean[p][q] = 0.5 * (a[p][q] + b[q][p]);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      a[p][q] = mean[p][q];
      b[q][p] = mean[p][q];
    }
}

static double largest_of(const double block[3][3]) {
  double most = 0;
  for (int k = 0; k < 9; k++)
    if (!(fabs(block[k / 3][k % 3]) <= most)) most = fabs(block[k / 3][k % 3]);
  return most;
}

static void balance(stencil *s) {
  double sum[3][3] = {{0}};
  stencil_block *own = &s->blocks[0];
  for (int n = 0; n < s->count; n++)
    for (int k = 0; k < 9; k++)
      sum[k / 3][k % 3] += s->blocks[n].stiffness[k / 3][k % 3];
  s->finite = isfinite(largest_of((const double(*)[3])sum));
  s->imbalance =
      largest_of((const double(*)[3])sum) / largest_of((const double(*)[3])own->stiffness);
  for (int k = 0; k < 9; k++)
    own->stiffness[k / 3][k % 3] -= sum[k / 3][k % 3];
}

stencil stencil_new(const pl_law *law, const double *parameters, const rows *w) {
  stencil s = {.dimensions = law->dimensions};
  patch p = patch_new(law, parameters, w);
  add_blocks(&p, &s);
  for (int b = 0; b < s.dimensions; b++) {
    probe(&p, p.displacement[b], tiny * w->spacing, b, false, &s);
    probe(&p, p.velocity[b], tiny_rate * w->spacing, b, true, &s);
  }
  patch_free(&p);
  pair_up(s.blocks[0].stiffness, s.blocks[0].stiffness);
  pair_up(s.blocks[0].damping, s.blocks[0].damping);
  for (int n = 1; n < s.count; n += 2) {
    pair_up(s.blocks[n].stiffness, s.blocks[n + 1].stiffness);
    pair_up(s.blocks[n].damping, s.blocks[n + 1].damping);
  }
  balance(&s);
  return s;
}

void stencil_free(stencil *s) {
  free(s->blocks);
}

/* --- what follows from them ------------------------------------------------------------------- */

static void set_term(wave_term *t, const stencil_block *ahead, const stencil_block *behind) {
  memcpy(t->R, ahead->R, sizeof t->R);
  memcpy(t->stiffness.forward, ahead->stiffness, sizeof(wave_block));
  memcpy(t->stiffness.backward, behind->stiffness, sizeof(wave_block));
  memcpy(t->damping.forward, ahead->damping, sizeof(wave_block));
  memcpy(t->damping.backward, behind->damping, sizeof(wave_block));
}

/* Blocks that rounding left count as none. */
crystal stencil_crystal(const pl_law *law, const double *parameters, const rows *w) {
  const double nothing = 1e-12;
  stencil s = stencil_new(law, parameters, w);
  crystal c = crystal_new(w, law->dof, (s.count + 1) / 2);
  const double stiff = largest_of((const double(*)[3])s.blocks[0].stiffness);
  const double critical = sqrt(stiff * w->mass);
  c.finite = c.finite && s.finite;
  memcpy(c.terms[0].stiffness.self, s.blocks[0].stiffness, sizeof(wave_block));
  memcpy(c.terms[0].damping.self, s.blocks[0].damping, sizeof(wave_block));
  c.term_count = 1;
  for (int n = 1; n < s.count; n += 2) {
    const bool stiffness = largest_of((const double(*)[3])s.blocks[n].stiffness) > nothing * stiff;
    const bool damping = largest_of((const double(*)[3])s.blocks[n].damping) > nothing * critical;
    if (stiffness || damping) set_term(&c.terms[c.term_count++], &s.blocks[n], &s.blocks[n + 1]);
  }
  c.damped = largest_of((const double(*)[3])s.blocks[0].damping) > nothing * critical;
  stencil_free(&s);
  return c;
}

/* -1/(2 V) sum of K_ab R_c R_d */
static double moment(const stencil *s, double volume, int a, int b, int c, int d) {
  double sum = 0;
  for (int n = 1; n < s->count; n++)
    sum -= s->blocks[n].stiffness[a][b] * s->blocks[n].R[c] * s->blocks[n].R[d];
  return sum / (2 * volume);
}

void stencil_elastic(const stencil *s, const rows *w, double *D) {
  static const int plane[][2] = {{0, 0}, {1, 1}, {0, 1}};
  static const int space[][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
  const int(*pair)[2] = s->dimensions == 2 ? plane : space;
  const int order = s->dimensions == 2 ? 3 : 6;
  const double V = s->dimensions == 2 ? w->site_area * w->stiffness_thickness : w->volume;
  for (int i = 0; i < order; i++)
    for (int j = 0; j < order; j++) {
      const int p = pair[i][0], q = pair[i][1], r = pair[j][0], t = pair[j][1];
      D[i * order + j] =
          moment(s, V, p, r, q, t) + moment(s, V, r, q, p, t) - moment(s, V, p, q, r, t);
    }
}
