#include "generator/kernel/kernel_check_points.h"

#include <string.h>

#include "generator/ir/random_values.h"
#include "runtime/mesh/rectangle_cells.h"

enum { BATCH = 512 };

/* What one reader of a law is handed, and what it writes. */
typedef struct point_arrays {
  const pl_law *of;
  int strains, stresses, inputs;
  double **in, **rate, **size, **field, **parameter; /* shared */
  double **new_field[2], **stress[2], **tangent[2], **observed[2], **lost[2];
} point_arrays;

static point_arrays arrays_new(const pl_law *reader) {
  point_arrays a = {.of = reader,
                    .strains = PL_STRAINS(reader->dimensions),
                    .stresses = PL_STRESSES(reader->dimensions)};
  a.inputs = reader->kind == PL_CRACK ? PL_TIP_INPUTS : a.strains;
  if (reader->kind == PL_CRACK) a.stresses = PL_TIP_RESULTS;
  a.in = planes_new(a.inputs, BATCH);
  a.rate = planes_new(a.strains, BATCH);
  a.size = planes_new(1, BATCH);
  a.field = planes_new(reader->field_count, BATCH);
  a.parameter = planes_new(reader->varying_count, BATCH);
  for (int side = 0; side < 2; side++) {
    a.new_field[side] = planes_new(reader->field_count, BATCH);
    a.stress[side] = planes_new(a.stresses, BATCH);
    a.tangent[side] = planes_new(a.strains * a.strains, BATCH);
    a.observed[side] = planes_new(1 + reader->output_count, BATCH);
    a.lost[side] = planes_new(PL_LOSSES, BATCH);
  }
  return a;
}

static void arrays_free(point_arrays *a) {
  planes_free(a->in, a->inputs);
  planes_free(a->rate, a->strains);
  planes_free(a->size, 1);
  planes_free(a->field, a->of->field_count);
  planes_free(a->parameter, a->of->varying_count);
  for (int side = 0; side < 2; side++) {
    planes_free(a->new_field[side], a->of->field_count);
    planes_free(a->stress[side], a->stresses);
    planes_free(a->tangent[side], a->strains * a->strains);
    planes_free(a->observed[side], 1 + a->of->output_count);
    planes_free(a->lost[side], PL_LOSSES);
  }
}

static void draw_parameters(const point_arrays *a, const double *parameters, uint64_t *seed) {
  for (int k = 0; k < a->of->varying_count; k++)
    for (int q = 0; q < BATCH; q++)
      a->parameter[k][q] = parameters[a->of->varying[k]] * draw_uniform(seed, 0.95, 1.05);
}

static void draw(const point_arrays *a, uint64_t *seed) {
  const bool tip = a->of->kind == PL_CRACK;
  for (int q = 0; q < BATCH; q++) {
    for (int k = 0; k < a->inputs; k++)
      a->in[k][q] = tip ? draw_size(seed, 0, 9) : draw_size(seed, -9, -1);
    for (int k = 0; k < a->strains; k++)
      a->rate[k][q] = draw_size(seed, -3, 6);
    a->size[0][q] = draw_uniform(seed, 1e-4, 1);
    for (int f = 0; f < a->of->field_count; f++)
      a->field[f][q] = draw_field(seed, &a->of->fields[f]);
    for (int k = 0; k < PL_LOSSES; k++) /* to be added to */
      a->lost[0][k][q] = a->lost[1][k][q] = 1;
  }
}

static void ask_points(const point_arrays *a, int side, const pl_law *reader,
                       const double *uniforms) {
  const pl_points p = {.size = sizeof p,
                       .count = BATCH,
                       .strain = (const double *const *)a->in,
                       .strain_rate = (const double *const *)a->rate,
                       .cell_size = a->size[0],
                       .parameter = (const double *const *)a->parameter,
                       .old_field = (const double *const *)a->field,
                       .new_field = a->new_field[side],
                       .stress = a->stress[side],
                       .tangent = a->tangent[side],
                       .observed = a->observed[side],
                       .lost = a->lost[side],
                       .time_step = 1e-6,
                       .advance = 0.3};
  planes_poison(a->stress[side], a->stresses, BATCH);
  planes_poison(a->new_field[side], reader->field_count, BATCH);
  planes_poison(a->tangent[side], a->strains * a->strains, BATCH);
  planes_poison(a->observed[side], 1 + reader->output_count, BATCH);
  reader->point_ledger(reader, uniforms, &p);
  reader->point_tangent(reader, uniforms, &p);
  reader->point_observe(reader, uniforms, &p);
}

static void ask_tips(const point_arrays *a, int side, const pl_law *reader,
                     const double *uniforms) {
  const pl_tips p = {.size = sizeof p,
                     .count = BATCH,
                     .in = (const double *const *)a->in,
                     .old_field = (const double *const *)a->field,
                     .new_field = a->new_field[side],
                     .out = a->stress[side],
                     .observed = a->observed[side],
                     .time_step = 1e-6};
  planes_poison(a->stress[side], a->stresses, BATCH);
  planes_poison(a->new_field[side], reader->field_count, BATCH);
  planes_poison(a->observed[side], reader->output_count, BATCH);
  reader->tip_look(reader, uniforms, &p);
}

static void compare(const point_arrays *a, const char *what, double *const *kernel,
                    double *const *interpreter, int planes, comparison *c) {
  for (int k = 0; k < planes; k++)
    comparison_add(c, a->of->kind == PL_CRACK ? "tips" : "points", what, k, kernel[k],
                   interpreter[k], BATCH);
}

/* The step without its ledger gives the same bits as with it. */
static void compare_step(const point_arrays *a, const pl_law *reader, const double *uniforms,
                         comparison *c) {
  const pl_points p = {.size = sizeof p,
                       .count = BATCH,
                       .strain = (const double *const *)a->in,
                       .strain_rate = (const double *const *)a->rate,
                       .cell_size = a->size[0],
                       .parameter = (const double *const *)a->parameter,
                       .old_field = (const double *const *)a->field,
                       .new_field = a->new_field[1],
                       .stress = a->stress[1],
                       .time_step = 1e-6,
                       .advance = 0.3};
  planes_poison(a->stress[1], a->stresses, BATCH);
  planes_poison(a->new_field[1], reader->field_count, BATCH);
  reader->point_step(reader, uniforms, &p);
  compare(a, "stress of a step", a->stress[0], a->stress[1], a->stresses, c);
  compare(a, "field of a step", a->new_field[0], a->new_field[1], reader->field_count, c);
}

/* --- whole rectangles ------------------------------------------------------------------------- */

/* The last two vectors are one that is full and one that is not. */
enum { FULL = BATCH / 4, CELLS = FULL - 3, STRIDE = FULL + PL_LANES, AXES = 2 };

/* Forces of an axis: of lower nodes, from the row below and above; of right nodes. */
enum { OF_LOW, OF_ABOVE, OF_RIGHT, SUMS };

/* A row of rectangles, and how its nodes move. */
typedef struct rectangle_row {
  pl_rectangle slopes, push;
  double **displacement, **velocity; /* [AXES][2 STRIDE] */
  double **pushed;                   /* [RECTANGLE_PUSHES][FULL] by points */
  double **sum[2];                   /* [AXES * SUMS][CELLS] of these, by rectangles */
} rectangle_row;

static void draw_row(rectangle_row *r, uint64_t *seed) {
  for (int a = 0; a < 2; a++) {
    r->slopes.mean[a] = draw_uniform(seed, 1, 1e3);
    r->slopes.change[a] = draw_uniform(seed, 1, 1e3);
  }
  r->push = rectangle_slopes_times(&r->slopes, draw_uniform(seed, 1e-9, 1));
  for (int d = 0; d < AXES; d++)
    for (int n = 0; n < 2 * STRIDE; n++) {
      r->displacement[d][n] = draw_size(seed, -12, -3);
      r->velocity[d][n] = draw_size(seed, -6, 3);
    }
  for (int d = 0; d < AXES; d++)
    for (int n = 0; n < CELLS; n++) {
      r->sum[0][d * SUMS + OF_ABOVE][n] = r->sum[1][d * SUMS + OF_ABOVE][n] =
          draw_size(seed, -6, 6);
      r->sum[0][d * SUMS + OF_RIGHT][n] = r->sum[1][d * SUMS + OF_RIGHT][n] =
          n < 2 ? draw_size(seed, -6, 6) : 0;
    }
}

/* What a kernel sums, cell by cell. */
static void sum_row(const rectangle_row *r) {
  for (int d = 0; d < AXES; d++) {
    double *const *of = r->pushed + 4 * d, *const *sum = r->sum[0] + d * SUMS;
    double right[2] = {sum[OF_RIGHT][0], sum[OF_RIGHT][1]};
    for (int n = 0; n < CELLS; n++) {
      sum[OF_LOW][n] = (of[0][n] + right[0]) + sum[OF_ABOVE][n];
      sum[OF_ABOVE][n] = of[2][n] + right[1];
      right[0] = of[1][n];
      right[1] = of[3][n];
    }
    sum[OF_RIGHT][0] = right[0];
    sum[OF_RIGHT][1] = right[1];
  }
}

static void strains_of_row(const rectangle_row *r, double *const *nodes, double *const *strain) {
  for (int first = 0; first < FULL; first += PL_LANES)
    rectangle_cells_strain(
        &r->slopes, (const double *const[]){nodes[0] + first, nodes[1] + first}, STRIDE,
        (double *const[]){strain[0] + 4 * first, strain[1] + 4 * first, strain[2] + 4 * first});
}

/* Points of rectangles one by one, and all in one loop. */
static void ask_row(const point_arrays *a, const rectangle_row *r, const pl_law *reader,
                    const double *uniforms, bool ledger) {
  pl_points p = {.size = sizeof p,
                 .count = BATCH,
                 .strain = (const double *const *)a->in,
                 .strain_rate = (const double *const *)a->rate,
                 .cell_size = a->size[0],
                 .parameter = (const double *const *)a->parameter,
                 .old_field = (const double *const *)a->field,
                 .new_field = a->new_field[0],
                 .stress = a->stress[0],
                 .lost = a->lost[0],
                 .time_step = 1e-6,
                 .advance = 0.3};
  double *const *sum = r->sum[1], *const low[] = {sum[OF_LOW], sum[SUMS + OF_LOW]},
                *const above[] = {sum[OF_ABOVE], sum[SUMS + OF_ABOVE]};
  double right[AXES][2];
  for (int d = 0; d < AXES; d++)
    memcpy(right[d], sum[d * SUMS + OF_RIGHT], sizeof right[d]);
  const pl_rectangles cells = {.size = sizeof cells,
                               .count = FULL,
                               .cells = CELLS,
                               .stride = STRIDE,
                               .displacement = (const double *const *)r->displacement,
                               .velocity = (const double *const *)r->velocity,
                               .slopes = &r->slopes,
                               .push = &r->push,
                               .force = low,
                               .above = above,
                               .right = right,
                               .points = &p};
  strains_of_row(r, r->displacement, a->in);
  strains_of_row(r, r->velocity, a->rate);
  (ledger ? reader->point_ledger : reader->point_step)(reader, uniforms, &p);
  rectangle_cells_push(&r->push, FULL / PL_LANES, (const double *const *)a->stress[0], r->pushed);
  sum_row(r);
  for (int f = 0; f < reader->field_count; f++)
    for (int q = 0; q < BATCH; q++)
      a->new_field[1][f][q] = reader->fields[f].initial;
  for (int d = 0; d < AXES; d++)
    planes_poison(&sum[d * SUMS + OF_LOW], 1, CELLS);
  p.new_field = a->new_field[1];
  p.lost = a->lost[1];
  (ledger ? reader->rectangle_ledger : reader->rectangle_step)(reader, uniforms, &cells);
  for (int d = 0; d < AXES; d++)
    memcpy(sum[d * SUMS + OF_RIGHT], right[d], sizeof right[d]);
}

static void compare_rectangles(const point_arrays *a, const pl_law *reader, const double *uniforms,
                               uint64_t *seed, comparison *c) {
  if (!PL_HAS(reader, rectangle_ledger) || !reader->rectangle_ledger) return;
  rectangle_row r = {.displacement = planes_new(AXES, 2 * STRIDE),
                     .velocity = planes_new(AXES, 2 * STRIDE)};
  r.pushed = planes_new(RECTANGLE_PUSHES, FULL);
  for (int side = 0; side < 2; side++)
    r.sum[side] = planes_new(AXES * SUMS, CELLS);
  for (int ledger = 0; ledger < 2; ledger++) {
    draw(a, seed);
    draw_row(&r, seed);
    ask_row(a, &r, reader, uniforms, ledger);
    for (int k = 0; k < AXES * SUMS; k++)
      comparison_add(c, "points", "force of rectangles", k, r.sum[0][k], r.sum[1][k], CELLS);
    compare(a, "field of a rectangle", a->new_field[0], a->new_field[1], reader->field_count, c);
    compare(a, "lost in a rectangle", a->lost[0], a->lost[1], PL_LOSSES, c);
  }
  planes_free(r.displacement, AXES);
  planes_free(r.velocity, AXES);
  planes_free(r.pushed, RECTANGLE_PUSHES);
  for (int side = 0; side < 2; side++)
    planes_free(r.sum[side], AXES * SUMS);
}

void kernel_check_points(const pl_law *const readers[2], const double *const uniforms[2],
                         const double *parameters, long states, uint64_t *seed, comparison *c) {
  const bool tip = readers[0]->kind == PL_CRACK;
  point_arrays a = arrays_new(readers[0]);
  draw_parameters(&a, parameters, seed);
  for (long done = 0; done < states; done += BATCH) {
    draw(&a, seed);
    for (int side = 0; side < 2; side++)
      (tip ? ask_tips : ask_points)(&a, side, readers[side], uniforms[side]);
    compare(&a, tip ? "result" : "stress", a.stress[0], a.stress[1], a.stresses, c);
    compare(&a, "field", a.new_field[0], a.new_field[1], readers[0]->field_count, c);
    compare(&a, "observed", a.observed[0], a.observed[1], readers[0]->output_count + !tip, c);
    if (tip) continue;
    compare(&a, "tangent", a.tangent[0], a.tangent[1], a.strains * a.strains, c);
    compare(&a, "lost", a.lost[0], a.lost[1], PL_LOSSES, c);
    compare_step(&a, readers[0], uniforms[0], c);
  }
  if (!tip) compare_rectangles(&a, readers[0], uniforms[0], seed, c);
  arrays_free(&a);
}
