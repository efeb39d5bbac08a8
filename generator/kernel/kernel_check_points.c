#include "generator/kernel/kernel_check_points.h"

#include "generator/ir/random_values.h"

enum { BATCH = 512 };

/* What one reader of a law is handed, and what it writes. */
typedef struct point_arrays {
  const pl_law *of;
  int strains, stresses, inputs;
  double **in, **rate, **size, **field; /* shared */
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
  for (int side = 0; side < 2; side++) {
    planes_free(a->new_field[side], a->of->field_count);
    planes_free(a->stress[side], a->stresses);
    planes_free(a->tangent[side], a->strains * a->strains);
    planes_free(a->observed[side], 1 + a->of->output_count);
    planes_free(a->lost[side], PL_LOSSES);
  }
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
                       .old_field = (const double *const *)a->field,
                       .new_field = a->new_field[side],
                       .stress = a->stress[side],
                       .tangent = a->tangent[side],
                       .observed = a->observed[side],
                       .lost = a->lost[side],
                       .time_step = 1e-6};
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
                       .old_field = (const double *const *)a->field,
                       .new_field = a->new_field[1],
                       .stress = a->stress[1],
                       .time_step = 1e-6};
  planes_poison(a->stress[1], a->stresses, BATCH);
  planes_poison(a->new_field[1], reader->field_count, BATCH);
  reader->point_step(reader, uniforms, &p);
  compare(a, "stress of a step", a->stress[0], a->stress[1], a->stresses, c);
  compare(a, "field of a step", a->new_field[0], a->new_field[1], reader->field_count, c);
}

void kernel_check_points(const pl_law *const readers[2], const double *const uniforms[2],
                         long states, uint64_t *seed, comparison *c) {
  const bool tip = readers[0]->kind == PL_CRACK;
  point_arrays a = arrays_new(readers[0]);
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
  arrays_free(&a);
}
