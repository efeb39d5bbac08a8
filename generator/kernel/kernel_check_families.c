#include "generator/kernel/kernel_check_families.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/ir/random_values.h"

/* Sites lie in one array; neighbours are up to REACH away, and so are those of the sites from
   which bonds reach them. */
enum { SITES = 200, CUT = 128, REACH = 96, MARGIN = 2 * REACH, SIZE = MARGIN + SITES + MARGIN };

/* --- arrays ----------------------------------------------------------------------------------- */

enum { OLD_FILLED, NEW_FILLED, SETTLED, MARKS };

/* What the passes read, and twice, for either reader, what they write. Planes toward neighbours
   stand in one piece. */
typedef struct body {
  const pl_law *law;
  int neighbours;
  double **motion;    /* [2 * dof][SIZE] displacements and rotations, their rates */
  double **shape;     /* [PL_SHAPE_PLANES][SIZE] */
  double **parameter; /* [varying][SIZE], on bonds as many for each neighbour */
  double *share;      /* [SIZE] */
  double *own_size;   /* [SIZE] */
  double **before;    /* [fields] */
  double **after[2], **link[2], **bond_link[2], **force[2], **observed[2], **lost[2], **sum[2];
  double **force_state[2];                     /* [dof][neighbours * SIZE] */
  uint64_t **marks[MARKS];                     /* [fields][SIZE] as in pl_family */
  uint64_t *bonds, *incoming, *held, *unusual; /* [SIZE] */
  long offset[2 * PL_MAX_DIRECTIONS];          /* rows */
  int32_t *neighbour;                          /* [neighbours][SIZE] lists; NULL on rows */
  double **chord;    /* [dimensions][neighbours * SIZE] lists: m, and their lengths behind them */
  double **particle; /* [2][SIZE] volumes, masses */
  double advance;    /* s: short, then long, in turns */
} body;

static bool is_list(const body *b) {
  return b->law->topology == PL_LIST;
}

static long planes_of(const body *b, const pl_field *f) {
  return f->place == PL_ON_PARTICLE ? 1 : b->neighbours;
}

/* Of a varying parameter. */
static long parameter_planes(const body *b) {
  return b->law->varying_place == PL_ON_PARTICLE ? 1 : b->neighbours;
}

static double **values_new(const body *b, const pl_field *fields, int count) {
  double **v = must_calloc((size_t)count + 1, sizeof *v);
  for (int k = 0; k < count; k++) {
    double **one = planes_new(1, planes_of(b, &fields[k]) * SIZE);
    v[k] = one[0];
    free(one);
  }
  return v;
}

/* The stored energy, then the outputs. */
static double **observed_new(const body *b) {
  double **outputs = values_new(b, b->law->outputs, b->law->output_count);
  double **v = must_calloc((size_t)b->law->output_count + 1, sizeof *v);
  double **energy = planes_new(1, SIZE);
  v[0] = energy[0];
  memcpy(v + 1, outputs, (size_t)b->law->output_count * sizeof *v);
  free(energy);
  free(outputs);
  return v;
}

static uint64_t **marks_new(const pl_law *law) {
  uint64_t **marks = must_calloc((size_t)law->field_count + 1, sizeof *marks);
  for (int f = 0; f < law->field_count; f++)
    marks[f] = must_calloc(SIZE, sizeof **marks);
  return marks;
}

static body body_new(const pl_law *law, int neighbours) {
  body b = {.law = law, .neighbours = neighbours};
  b.motion = planes_new(2 * law->dof, SIZE);
  b.shape = planes_new(PL_SHAPE_PLANES(law->dimensions), SIZE);
  b.parameter = planes_new(law->varying_count, parameter_planes(&b) * SIZE);
  b.share = must_calloc(SIZE, sizeof *b.share);
  b.own_size = must_calloc(SIZE, sizeof *b.own_size);
  b.before = values_new(&b, law->fields, law->field_count);
  for (int side = 0; side < 2; side++) {
    b.after[side] = values_new(&b, law->fields, law->field_count);
    b.link[side] = planes_new(law->link_count, SIZE);
    b.bond_link[side] = planes_new(law->bond_link_count, (long)neighbours * SIZE);
    b.force[side] = planes_new(law->dof, SIZE);
    b.force_state[side] = planes_new(law->dof, (long)neighbours * SIZE);
    b.observed[side] = observed_new(&b);
    b.lost[side] = planes_new(PL_LOSSES, SIZE);
    b.sum[side] = planes_new(law->sum_count, SIZE);
  }
  for (int k = 0; k < MARKS; k++)
    b.marks[k] = marks_new(law);
  b.bonds = must_calloc(SIZE, sizeof *b.bonds);
  b.incoming = must_calloc(SIZE, sizeof *b.incoming);
  b.held = must_calloc(SIZE, sizeof *b.held);
  b.unusual = must_calloc(SIZE, sizeof *b.unusual);
  b.particle = planes_new(2, SIZE);
  if (!is_list(&b)) return b;
  b.neighbour = must_calloc((size_t)neighbours * SIZE, sizeof *b.neighbour);
  b.chord = planes_new(law->dimensions + 1, (long)neighbours * SIZE);
  return b;
}

static void body_free(body *b) {
  planes_free(b->motion, 2 * b->law->dof);
  planes_free(b->shape, PL_SHAPE_PLANES(b->law->dimensions));
  planes_free(b->parameter, b->law->varying_count);
  free(b->share);
  free(b->own_size);
  planes_free(b->before, b->law->field_count);
  for (int side = 0; side < 2; side++) {
    planes_free(b->after[side], b->law->field_count);
    planes_free(b->link[side], b->law->link_count);
    planes_free(b->bond_link[side], b->law->bond_link_count);
    planes_free(b->force[side], b->law->dof);
    planes_free(b->force_state[side], b->law->dof);
    planes_free(b->observed[side], 1 + b->law->output_count);
    planes_free(b->lost[side], PL_LOSSES);
    planes_free(b->sum[side], b->law->sum_count);
  }
  for (int k = 0; k < MARKS; k++) {
    for (int f = 0; f < b->law->field_count; f++)
      free(b->marks[k][f]);
    free(b->marks[k]);
  }
  free(b->bonds);
  free(b->incoming);
  free(b->held);
  free(b->unusual);
  planes_free(b->particle, 2);
  if (!is_list(b)) return;
  free(b->neighbour);
  planes_free(b->chord, b->law->dimensions + 1);
}

/* --- a random body ---------------------------------------------------------------------------- */

/* Displacements are of one order in a body, so that a family is nearly at rest or torn as a
   whole. The largest rotations are beyond half a turn. */
static void draw_motion(body *b, double s, uint64_t *seed) {
  const double order = draw_uniform(seed, -9, 0), largest_rotation = 4;
  for (int d = 0; d < b->law->dof; d++)
    for (int q = 0; q < SIZE; q++) {
      const double unit = d < b->law->dimensions ? s : largest_rotation;
      b->motion[d][q] = unit * draw_size(seed, order - 1, order);
      b->motion[b->law->dof + d][q] = draw_size(seed, -6, 3);
    }
}

/* Some particles are whole, some have lost bonds, some all; in half of the bodies some are held. */
static void draw_bonds(body *b, uint64_t *seed) {
  const bool holds = draw_bits(seed) % 2;
  for (int q = 0; q < SIZE; q++) {
    const uint64_t kind = draw_bits(seed) % 4;
    b->bonds[q] = kind == 0 ? 0 : kind == 1 ? draw_bits(seed) : UINT64_MAX;
    b->held[q] = holds && draw_bits(seed) % 4 == 0;
  }
}

static void draw_offsets(body *b, uint64_t *seed) {
  const int half = b->neighbours / 2;
  for (int k = 0; k < half; k++) {
    b->offset[k] = 1 + (long)(draw_bits(seed) % REACH);
    b->offset[k + half] = -b->offset[k];
  }
}

/* Bond k of site q leads to site q of a random permutation, or nowhere. */
static void draw_permutation(body *b, int k, uint64_t *seed) {
  const int back = k + b->neighbours / 2;
  const uint64_t bit = UINT64_C(1) << k;
  int32_t to[SIZE];
  for (int32_t q = 0; q < SIZE; q++)
    to[q] = q;
  for (int q = SIZE - 1; q > 0; q--) {
    const int other = (int)(draw_bits(seed) % (uint64_t)(q + 1));
    const int32_t kept = to[q];
    to[q] = to[other];
    to[other] = kept;
  }
  for (int32_t q = 0; q < SIZE; q++) {
    b->neighbour[k * SIZE + q] = to[q] - q;
    b->neighbour[back * SIZE + to[q]] = q - to[q];
    if (to[q] == q) b->bonds[q] &= ~bit;
    b->incoming[to[q]] |= b->bonds[q] & bit;
  }
}

/* Of chord and length the two sides have the same. */
static void draw_chords(body *b, int k, double s, uint64_t *seed) {
  const int back = k + b->neighbours / 2, dimensions = b->law->dimensions;
  for (int q = 0; q < SIZE; q++) {
    const long here = (long)k * SIZE + q, there = (long)back * SIZE + q + b->neighbour[here];
    double square = 0;
    for (int d = 0; d < dimensions; d++) {
      const double component = s * draw_uniform(seed, d ? -1 : 0.5, 1);
      b->chord[d][here] = component;
      b->chord[d][there] = -component;
      square += component * component;
    }
    b->chord[dimensions][here] = b->chord[dimensions][there] = sqrt(square);
  }
}

static void draw_list(body *b, double s, uint64_t *seed) {
  memset(b->incoming, 0, SIZE * sizeof *b->incoming);
  for (int k = 0; k < b->neighbours / 2; k++) {
    draw_permutation(b, k, seed);
    draw_chords(b, k, s, seed);
  }
}

static void draw_particles(body *b, double s, double mass, uint64_t *seed) {
  for (int q = 0; q < SIZE; q++) {
    b->particle[0][q] = s * s * s * draw_uniform(seed, 0.5, 1.5);
    b->particle[1][q] = mass * draw_uniform(seed, 0.5, 1.5);
  }
}

static long neighbour_of(const body *b, long k, long q) {
  return q + (is_list(b) ? b->neighbour[k * SIZE + q] : b->offset[k]);
}

/* A field on bonds has one value, which stands at both ends. */
static void match_ends(const body *b, double *field) {
  const long half = b->neighbours / 2;
  for (long k = 0; k < half; k++)
    for (long q = 0; q < SIZE; q++) {
      const long other = neighbour_of(b, k, q);
      if (other < SIZE) field[(k + half) * SIZE + other] = field[k * SIZE + q];
    }
}

static void mark_filled(uint64_t *filled, const double *values, long k) {
  for (long q = 0; q < SIZE; q++)
    if (values[k * SIZE + q] != 0) filled[q / PL_LANES] |= UINT64_C(1) << k;
}

/* Half of the bonds of laws that look where fields are 0 begin at 0 along the whole array. */
static void clear_pieces(const body *b, uint64_t *seed) {
  for (int f = 0; f < b->law->field_count && b->law->sum_count; f++) {
    memset(b->marks[OLD_FILLED][f], 0, SIZE * sizeof **b->marks[0]);
    for (int k = 0; k < b->neighbours / 2 && b->law->fields[f].place != PL_ON_PARTICLE; k++) {
      if (draw_bits(seed) % 2) memset(b->before[f] + (long)k * SIZE, 0, SIZE * sizeof **b->before);
      mark_filled(b->marks[OLD_FILLED][f], b->before[f], k);
    }
    if (b->law->fields[f].place != PL_ON_PARTICLE) match_ends(b, b->before[f]);
  }
}

/* Owners that no run comes to have left 0 for both ends of bonds that are absent
   (pl_program.shared). */
static void clear_shared(const body *b) {
  const pl_program *p = &b->law->step;
  const long half = b->neighbours / 2;
  uint64_t shared = 0;
  for (int pass = 0; pass < p->pass_count && p->shared; pass++)
    shared |= p->shared[pass];
  for (int s = 0; s < 64; s++)
    for (long k = 0; k < half && (shared >> s & 1); k++)
      for (long q = 0; q < SIZE; q++) {
        const long at = (s % 2 * half + k) * SIZE + q;
        if (!(b->bonds[q] >> k & 1)) b->bond_link[0][s / 2][at] = b->bond_link[1][s / 2][at] = 0;
      }
}

/* Near the uniform values. */
static void draw_parameters(body *b, const double *parameters, uint64_t *seed) {
  for (int k = 0; k < b->law->varying_count; k++) {
    for (long q = 0; q < parameter_planes(b) * SIZE; q++)
      b->parameter[k][q] = parameters[b->law->varying[k]] * draw_uniform(seed, 0.95, 1.05);
    if (b->law->varying_place == PL_ON_BOND) match_ends(b, b->parameter[k]);
  }
  for (int q = 0; q < SIZE && b->law->reads_own_size; q++)
    b->own_size[q] = draw_uniform(seed, 1, 1.5);
  for (int q = 0; q < SIZE && b->law->reads_share; q++)
    b->share[q] = (double)(draw_bits(seed) & 1);
}

static void draw_body(body *b, const pl_bond_class *bonds, const double *parameters,
                      uint64_t *seed) {
  const int resolved = PL_SHAPE_VALUES(b->law->dimensions);
  draw_motion(b, bonds->s, seed);
  draw_bonds(b, seed);
  if (is_list(b))
    draw_list(b, bonds->s, seed);
  else
    draw_offsets(b, seed);
  draw_particles(b, bonds->s, bonds->mass_i, seed);
  for (int v = 0; v <= resolved; v++)
    for (int q = 0; q < SIZE; q++)
      b->shape[v][q] = v == resolved ? (double)(draw_bits(seed) & 1) : draw_uniform(seed, -1, 1);
  for (int f = 0; f < b->law->field_count; f++)
    for (long q = 0; q < planes_of(b, &b->law->fields[f]) * SIZE; q++)
      b->before[f][q] = draw_field(seed, &b->law->fields[f]);
  for (int f = 0; f < b->law->field_count; f++)
    if (b->law->fields[f].place == PL_ON_BOND) match_ends(b, b->before[f]);
  draw_parameters(b, parameters, seed);
  clear_pieces(b, seed);
  for (int k = 0; k < b->law->link_count; k++)
    for (int q = 0; q < SIZE; q++)
      b->link[0][k][q] = b->link[1][k][q] = draw_size(seed, -6, 0);
  for (int k = 0; k < b->law->bond_link_count; k++)
    for (long q = 0; q < (long)b->neighbours * SIZE; q++)
      b->bond_link[0][k][q] = b->bond_link[1][k][q] = draw_size(seed, -6, 0);
  clear_shared(b);
  b->advance = b->advance < 1 ? 3e4 : 3e-4;
}

static bool has_bond(const body *b, int k, long q) {
  const int half = b->neighbours / 2;
  if (is_list(b) && k >= half) return b->incoming[q] >> (k - half) & 1;
  return k < half ? b->bonds[q] >> k & 1 : b->bonds[q + b->offset[k]] >> (k - half) & 1;
}

static bool has_any_bond(const body *b, long q) {
  for (int k = 0; k < b->neighbours; k++)
    if (has_bond(b, k, q)) return true;
  return false;
}

/* --- the programs ----------------------------------------------------------------------------- */

static void poison_values(double *const *v, const body *b, const pl_field *fields, int count) {
  for (int k = 0; k < count; k++)
    planes_poison(&v[k], 1, planes_of(b, &fields[k]) * SIZE);
}

/* Of every other bond of laws with marks the new value stands there already, unless it changes. */
static void settle_pieces(const body *b, int side) {
  const long half = b->neighbours / 2;
  for (int f = 0; f < b->law->field_count && b->law->sum_count; f++) {
    memset(b->marks[NEW_FILLED][f], 0xff, SIZE * sizeof **b->marks[0]);
    memset(b->marks[SETTLED][f], 0x55, SIZE * sizeof **b->marks[0]);
    for (long k = 0; k < half && b->law->fields[f].place != PL_ON_PARTICLE; k += 2)
      for (long end = 0; end < 2; end++)
        memcpy(b->after[side][f] + (k + end * half) * SIZE, b->before[f] + (k + end * half) * SIZE,
               SIZE * sizeof **b->after[side]);
  }
}

static void planes_clear(double **planes, int count) {
  for (int k = 0; k < count; k++)
    memset(planes[k], 0, SIZE * sizeof **planes);
}

static void poison(const body *b, int side) {
  poison_values(b->after[side], b, b->law->fields, b->law->field_count);
  settle_pieces(b, side);
  planes_poison(b->force[side], b->law->dof, SIZE);
  planes_poison(b->force_state[side], b->law->dof, (long)b->neighbours * SIZE);
  planes_clear(b->lost[side], PL_LOSSES);
  planes_poison(b->observed[side], 1, SIZE);
  poison_values(b->observed[side] + 1, b, b->law->outputs, b->law->output_count);
}

enum { MOST_ARRAYS = 13 };

/* Arrays that begin at a site. */
typedef struct site_arrays {
  void *lists[MOST_ARRAYS];
  int count;
} site_arrays;

static double *const *from_site(site_arrays *s, double *const *arrays, int count, long site) {
  double **list = must_calloc((size_t)count + 1, sizeof *list);
  for (int k = 0; k < count; k++)
    list[k] = arrays[k] + site;
  s->lists[s->count++] = list;
  return list;
}

static uint64_t **marks_from_site(site_arrays *s, const body *b, uint64_t **marks, long site) {
  uint64_t **list = must_calloc((size_t)b->law->field_count + 1, sizeof *list);
  for (int f = 0; f < b->law->field_count; f++)
    list[f] = marks[f] + site / PL_LANES;
  s->lists[s->count++] = list;
  return list;
}

static void point_at_list(const body *b, long site, pl_family *f) {
  const int dimensions = b->law->dimensions;
  f->neighbour = b->neighbour + site;
  f->incoming = b->incoming + site;
  for (int d = 0; d < dimensions; d++)
    f->chord[d] = b->chord[d] + site;
  f->length = b->chord[dimensions] + site;
  f->volume = b->particle[0] + site;
}

static bool any_held(const body *b) {
  bool any = false;
  for (int q = 0; q < SIZE; q++)
    any = any || b->held[q];
  return any;
}

static void run_part(const law_readers *l, const body *b, int side, pl_family_function pass,
                     long first, long count, bool ahead_only) {
  const pl_law *law = b->law;
  const long site = MARGIN + first;
  site_arrays s = {.count = 0};
  const long rows = l->law[side]->neighbours && count % (2 * PL_LANES) == 0 ? 2 : 1;
  pl_family f = {.size = sizeof f,
                 .count = count / rows,
                 .rows = rows,
                 .row_stride = count / rows,
                 .neighbours = b->neighbours,
                 .plane = SIZE,
                 .new_plane = SIZE,
                 .link_plane = SIZE,
                 .offset = is_list(b) ? NULL : b->offset,
                 .link_offset = is_list(b) ? NULL : b->offset,
                 .bonds = b->bonds + site,
                 .held = b->held + site,
                 .new_field = from_site(&s, b->after[side], law->field_count, site),
                 .link = from_site(&s, b->link[side], law->link_count, site),
                 .bond_link = from_site(&s, b->bond_link[side], law->bond_link_count, site),
                 .force = from_site(&s, b->force[side], law->dof, site),
                 .force_state = from_site(&s, b->force_state[side], law->dof, site),
                 .observed = from_site(&s, b->observed[side], 1 + law->output_count, site),
                 .sum = from_site(&s, b->sum[side], law->sum_count, site),
                 .ahead_only = ahead_only,
                 .held_near = any_held(b),
                 .unusual = b->unusual + site / PL_LANES,
                 .share = b->share + site,
                 .own_size = b->own_size + site,
                 .mass = b->particle[1] + site,
                 .time_step = 1.7e-7,
                 .advance = b->advance,
                 .lost = {b->lost[side][0] + site, b->lost[side][1] + site}};
  f.shape = (const double *const *)from_site(&s, b->shape, PL_SHAPE_PLANES(law->dimensions), site);
  f.old_field = (const double *const *)from_site(&s, b->before, law->field_count, site);
  f.parameter = (const double *const *)from_site(&s, b->parameter, law->varying_count, site);
  f.old_filled = (const uint64_t *const *)marks_from_site(&s, b, b->marks[OLD_FILLED], site);
  f.new_filled = marks_from_site(&s, b, b->marks[NEW_FILLED], site);
  f.settled = marks_from_site(&s, b, b->marks[SETTLED], site);
  if (is_list(b)) point_at_list(b, site, &f);
  for (int d = 0; d < law->dof; d++) {
    f.displacement[d] = b->motion[d] + site;
    f.velocity[d] = b->motion[law->dof + d] + site;
  }
  pass(l->law[side], l->uniforms[side], &f);
  for (int k = 0; k < s.count; k++)
    free(s.lists[k]);
}

static void clear_sums(const body *b, int side) {
  planes_clear(b->sum[side], b->law->sum_count);
}

/* Bonds of the sites before reach the others: their fields are written as another thread would,
   then their sums are found as by the thread at hand. */
static void run_before(const law_readers *l, const body *b, int side, pl_family_function pass) {
  run_part(l, b, side, pass, -REACH, REACH, false);
  clear_sums(b, side);
  run_part(l, b, side, pass, -REACH, REACH, true);
}

const pl_program *kernel_check_step(const pl_law *law) {
  return law->ledger.pass_count ? &law->ledger : &law->step;
}

static void run_program(const law_readers *l, const body *b, int side, const pl_program *p,
                        bool adds) {
  poison(b, side);
  for (int k = 0; k < p->pass_count; k++) {
    if (adds) run_before(l, b, side, p->pass[k]);
    if (side == 0) {
      run_part(l, b, side, p->pass[k], 0, CUT, false);
      run_part(l, b, side, p->pass[k], CUT, SITES - CUT, false);
    } else {
      run_part(l, b, side, p->pass[k], 0, SITES, false);
    }
    clear_sums(b, side); /* what was for sites beyond the run */
  }
}

/* --- what they wrote -------------------------------------------------------------------------- */

static void compare_values(comparison *c, const body *b, const char *program, const pl_field *f,
                           const double *kernel, const double *interpreter) {
  for (long k = 0; k < planes_of(b, f); k++)
    comparison_add(c, program, f->name, -1, kernel + k * SIZE + MARGIN,
                   interpreter + k * SIZE + MARGIN, SITES);
}

/* On lists nobody reads the links of bonds that are absent, and loops may pass these over. */
static void clear_absent(const body *b, double *link) {
  for (int k = 0; k < b->neighbours && is_list(b); k++)
    for (long q = 0; q < SIZE; q++)
      if (!has_bond(b, k, q)) link[k * SIZE + q] = 0;
}

static void compare_links(comparison *c, const body *b, const char *program) {
  for (int k = 0; k < b->law->link_count; k++)
    comparison_add(c, program, "link", k, b->link[0][k], b->link[1][k], SIZE);
  for (int k = 0; k < b->law->bond_link_count; k++) {
    for (int side = 0; side < 2; side++)
      clear_absent(b, b->bond_link[side][k]);
    comparison_add(c, program, "link of bonds", k, b->bond_link[0][k], b->bond_link[1][k],
                   (long)b->neighbours * SIZE);
  }
}

/* Particles without bonds lose nothing, whatever a law says that divides by what a family has. */
static void clear_lonely(const body *b, double *lost) {
  for (long q = MARGIN; q < MARGIN + SITES; q++)
    if (!has_any_bond(b, q)) lost[q] = 0;
}

static void compare_losses(comparison *c, const body *b) {
  for (int k = 0; k < PL_LOSSES && b->law->ledger.pass_count; k++) {
    clear_lonely(b, b->lost[0][k]);
    clear_lonely(b, b->lost[1][k]);
    comparison_add(c, "ledger", "lost", k, b->lost[0][k] + MARGIN, b->lost[1][k] + MARGIN, SITES);
  }
}

static void compare_fields(comparison *c, const body *b, const char *program) {
  for (int f = 0; f < b->law->field_count; f++)
    compare_values(c, b, program, &b->law->fields[f], b->after[0][f], b->after[1][f]);
}

static void compare_step(comparison *c, const body *b) {
  const pl_law *law = b->law;
  compare_links(c, b, "step");
  compare_fields(c, b, "step");
  for (int d = 0; d < law->dof; d++)
    comparison_add(c, "step", "force", d, b->force[0][d] + MARGIN, b->force[1][d] + MARGIN, SITES);
  compare_losses(c, b);
}

static void compare_observe(comparison *c, const body *b) {
  static const pl_field energy = {.name = "stored energy", .place = PL_ON_PARTICLE};
  const pl_law *law = b->law;
  compare_links(c, b, "observe");
  for (int k = 0; k <= law->output_count; k++)
    compare_values(c, b, "observe", k ? &law->outputs[k - 1] : &energy, b->observed[0][k],
                   b->observed[1][k]);
}

static const pl_field force_state = {.name = "toward the neighbour", .place = PL_ON_NEIGHBOUR};

static void compare_force_state(comparison *c, const body *b) {
  compare_links(c, b, "force_state");
  compare_fields(c, b, "force_state");
  for (int d = 0; d < b->law->dof; d++)
    compare_values(c, b, "force_state", &force_state, b->force_state[0][d], b->force_state[1][d]);
}

/* Both readers share one graph, so what it means to be absent or held is checked on its own. */

/* Values toward neighbours that are not there: 0. */
static long written_for_absent(const body *b, const pl_field *f, const double *values) {
  long count = 0;
  for (int k = 0; k < b->neighbours && f->place != PL_ON_PARTICLE; k++)
    for (long q = MARGIN; q < MARGIN + SITES; q++)
      count += !has_bond(b, k, q) && values[k * SIZE + q] != 0;
  return count;
}

/* The end that computes what both share was among the sites of the run. */
static bool owner_has_run(const body *b, long k, long q) {
  const long owner = k < b->neighbours / 2 ? q : neighbour_of(b, k, q);
  return owner >= MARGIN && owner < MARGIN + SITES;
}

/* A damage stays with its particle; on a bond with either. */
static long changed_where_held(const body *b, int field) {
  const pl_field *f = &b->law->fields[field];
  const double *before = b->before[field], *after = b->after[0][field];
  long count = 0;
  if (f->kind != PL_FIELD_DAMAGE) return 0;
  for (long k = 0; k < planes_of(b, f); k++)
    for (long q = MARGIN; q < MARGIN + SITES; q++) {
      const bool toward = f->place != PL_ON_PARTICLE;
      const bool held = b->held[q] || (toward && b->held[neighbour_of(b, k, q)]);
      if (!held || (toward && (!has_bond(b, (int)k, q) || !owner_has_run(b, k, q)))) continue;
      count += memcmp(&before[k * SIZE + q], &after[k * SIZE + q], sizeof *before) != 0;
    }
  return count;
}

static long loaded_without_bonds(const body *b) {
  long count = 0;
  for (long q = MARGIN; q < MARGIN + SITES; q++) {
    const bool any = has_any_bond(b, q);
    for (int d = 0; d < b->law->dof; d++)
      count += !any && b->force[0][d][q] != 0;
  }
  return count;
}

static void find_misplaced_fields(comparison *c, const body *b) {
  for (int f = 0; f < b->law->field_count; f++)
    c->misplaced +=
        written_for_absent(b, &b->law->fields[f], b->after[0][f]) + changed_where_held(b, f);
}

static void find_misplaced_forces(comparison *c, const body *b) {
  for (int d = 0; d < b->law->dof; d++)
    c->misplaced += written_for_absent(b, &force_state, b->force_state[0][d]);
}

static void find_misplaced_observe(comparison *c, const body *b) {
  for (int k = 0; k < b->law->output_count; k++)
    c->misplaced += written_for_absent(b, &b->law->outputs[k], b->observed[0][1 + k]);
}

static void check_force_state(const law_readers *l, const body *b, comparison *c) {
  for (int side = 0; side < 2; side++)
    run_program(l, b, side, &l->law[side]->force_state, false);
  compare_force_state(c, b);
  find_misplaced_fields(c, b);
  find_misplaced_forces(c, b);
}

long kernel_check_families(const law_readers *l, long wanted, uint64_t *seed, comparison *c) {
  body b = body_new(l->law[0], l->classes);
  long done = 0;
  for (; done < wanted; done += (long)SITES * l->classes) {
    draw_body(&b, l->bonds, l->parameters, seed);
    for (int side = 0; side < 2; side++)
      run_program(l, &b, side, kernel_check_step(l->law[side]), b.law->sum_count > 0);
    compare_step(c, &b);
    find_misplaced_fields(c, &b);
    c->misplaced += loaded_without_bonds(&b);
    for (int side = 0; side < 2; side++)
      run_program(l, &b, side, &l->law[side]->observe, false);
    compare_observe(c, &b);
    find_misplaced_observe(c, &b);
    if (b.law->force_state.pass_count) check_force_state(l, &b, c);
  }
  body_free(&b);
  return done;
}
