#include "generator/drive/drive_point.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/law_limits.h"
#include "dsl/semantics/law_variant.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/driven_fields.h"
#include "generator/drive/point_control.h"

enum { MOST = PL_MAX_STRAINS };

/* --- the table -------------------------------------------------------------------------------- */

static const char *const energy_names[] = {
#define X(code, name) name,
    DRIVE_LAST_COLUMNS(X)
#undef X
};

static void add_components(drive_table *t, const char *what, const char *unit_text, int dimensions,
                           int count, long room) {
  for (int k = 0; k < count; k++)
    drive_add_column(t, arena_printf(t->memory, "%s_%s", what, point_component_name(dimensions, k)),
                     unit_text, room);
}

/* The component that the path's first piece drives: the picture is of it. */
static int first_driven(const drive_input *in, int dimensions) {
  point_control control;
  diagnostics unheard;
  source_set sources = {NULL, 0};
  int k = 0;
  diag_begin(&unheard, &sources);
  if (point_control_read(in, dimensions, &control, &unheard) && in->piece_count > 0)
    while (k < control.strains - 1 && control.follows[k] != (int)in->pieces[0].quantity)
      k++;
  diag_clear(&unheard);
  return k;
}

static void table_open(drive_table *t, const drive_input *in, const pl_law *kernel, long room) {
  const int dimensions = kernel->dimensions, strains = PL_STRAINS(dimensions),
            stresses = PL_STRESSES(dimensions), driven = first_driven(in, dimensions);
  const int count = 2 + 2 * strains + stresses + kernel->field_count + kernel->output_count +
                    driven_fields_count(kernel) + DRIVE_ENERGY_COUNT;
  *t = (drive_table){.memory = arena_new(), .of = DRIVE_OF_POINTS, .bad_row = -1};
  t->columns = arena_alloc(t->memory, (size_t)count * sizeof *t->columns);
  drive_add_column(t, "time", "s", room);
  add_components(t, "strain", "1", dimensions, strains, room);
  add_components(t, "strain_rate", "1/s", dimensions, strains, room);
  add_components(t, "stress", "Pa", dimensions, stresses, room);
  t->way = 1 + driven;
  t->force = 1 + 2 * strains + driven;
  drive_add_column(t, "ellipticity", "Pa", room);
  t->law_column = t->column_count;
  t->fields = kernel->field_count;
  for (int f = 0; f < kernel->field_count; f++)
    drive_add_column(t, kernel->fields[f].name, kernel->fields[f].unit, room);
  for (int f = 0; f < kernel->output_count; f++)
    drive_add_column(t, kernel->outputs[f].name, kernel->outputs[f].unit, room);
  driven_fields_add(t, kernel, room);
  for (int k = 0; k < DRIVE_ENERGY_COUNT; k++)
    drive_add_column(t, energy_names[k], "J/m^3", room);
}

void drive_point_columns(const drive_input *in, const pl_law *kernel, drive_table *out) {
  table_open(out, in, kernel, 0);
}

/* --- the march -------------------------------------------------------------------------------- */

typedef struct marching {
  const drive_input *in;
  point_control control;
  driven_point point;
  drive_table *table;
  drive_band *band;
  strained at; /* of the last row */
  stressed answer;
  double tangent[MOST][MOST];
  ellipticity ellipticity; /* of that tangent */
  double energy[DRIVE_ENERGY_COUNT];
  double *parameters; /* at hand */
} marching;

static void put(drive_table *t, int *column, const double *values, int count) {
  for (int k = 0; k < count; k++)
    t->columns[(*column)++].values[t->rows] = values[k];
}

static void put_row(marching *m, double time) {
  drive_table *t = m->table;
  const pl_law *kernel = m->point.kernel;
  double *e = m->energy;
  int c = 0;
  e[DRIVE_ENERGY_DISSIPATED] =
      e[DRIVE_ENERGY_DISSIPATED_DAMAGE] + e[DRIVE_ENERGY_DISSIPATED_DAMPING];
  e[DRIVE_ENERGY_IMBALANCE] =
      e[DRIVE_ENERGY_EXTERNAL] - e[DRIVE_ENERGY_STORED] - e[DRIVE_ENERGY_DISSIPATED];
  put(t, &c, &time, 1);
  put(t, &c, m->at.strain, m->point.strains);
  put(t, &c, m->at.rate, m->point.strains);
  put(t, &c, m->answer.stress, m->point.stresses);
  put(t, &c, &m->ellipticity.least, 1);
  for (int f = 0; f < kernel->field_count; f++)
    put(t, &c, m->point.old_field[f], 1);
  for (int f = 0; f < kernel->output_count; f++)
    put(t, &c, m->point.observed[1 + f], 1);
  c = driven_fields_put(t, kernel, m->parameters, c, t->rows);
  put(t, &c, e, DRIVE_ENERGY_COUNT);
  for (int k = 0; k < t->column_count; k++)
    if (!isfinite(t->columns[k].values[t->rows])) t->bad_row = t->rows;
  if (m->band->row < 0 && m->ellipticity.least <= 0)
    *m->band = (drive_band){t->rows, m->ellipticity};
  t->rows++;
}

/* Of the tangent of the step that leads here; most rows have that of the row before. */
static void find_ellipticity(marching *m, const strained *to) {
  double tangent[MOST][MOST] = {{0}};
  driven_point_tangent(&m->point, to, tangent);
  if (m->table->rows > 0 && memcmp(tangent, m->tangent, sizeof tangent) == 0) return;
  memcpy(m->tangent, tangent, sizeof tangent);
  m->ellipticity = ellipticity_of(m->point.kernel->dimensions, (const double(*)[MOST])m->tangent);
}

/* J/m^3; shears count on either side of the diagonal. */
static double work_between(const driven_point *p, const stressed *before, const stressed *after,
                           const strained *from, const strained *to) {
  double sum = 0;
  for (int k = 0; k < p->strains; k++)
    sum += (point_is_shear(p->kernel->dimensions, k) ? 2 : 1) * 0.5 *
           (before->stress[k] + after->stress[k]) * (to->strain[k] - from->strain[k]);
  return sum;
}

/* The law with what its fields are at a time. */
static void take_given(marching *m, double time) {
  if (driven_fields_at(m->in, m->point.kernel, time, m->parameters))
    driven_point_take(&m->point, m->parameters);
}

/* What the change of the fields between two times adds to the stored energy at a state, J/m^3; the
   law is left with those of the second. */
static double given_by_fields(marching *m, const strained *at, double before, double after) {
  if (m->in->given_count == 0) return 0;
  take_given(m, before);
  const double stored = driven_point_observe(&m->point, at);
  take_given(m, after);
  return driven_point_observe(&m->point, at) - stored;
}

/* What the first row holds counts as work done before it. */
static void first_row(marching *m, const strained *to, double time) {
  double *e = m->energy;
  find_ellipticity(m, to);
  driven_point_accept(&m->point);
  e[DRIVE_ENERGY_STORED] = driven_point_observe(&m->point, to);
  e[DRIVE_ENERGY_DISSIPATED_DAMAGE] = m->answer.lost[PL_LOST_TO_STATES];
  e[DRIVE_ENERGY_EXTERNAL] = e[DRIVE_ENERGY_STORED] + e[DRIVE_ENERGY_DISSIPATED_DAMAGE];
  m->at = *to;
  put_row(m, time);
}

/* Where the step begins, at the rates that it has there. */
static strained beginning(const marching *m, const strained *to, double inside) {
  strained from = m->at;
  from.step = to->step;
  from.advance = 0;
  for (int k = 0; k < m->control.strains; k++)
    from.rate[k] = m->control.by_stress[k] || m->control.follows[k] < 0
                       ? to->rate[k]
                       : drive_slope(m->in, (drive_quantity)m->control.follows[k], inside);
  return from;
}

/* Trapezoids, as of a bond: work and rate losses between the step's ends; what states cost is that
   halfway, as the law books it. */
static void next_row(marching *m, const strained *from, const strained *to, const stressed *after,
                     double time) {
  double *e = m->energy;
  take_given(m, time - to->step);
  const stressed before = driven_point_step(&m->point, from);
  e[DRIVE_ENERGY_EXTERNAL] += 0.5 * given_by_fields(m, from, time - to->step, time);
  (void)driven_point_step(&m->point, to);
  find_ellipticity(m, to);
  driven_point_accept(&m->point);
  e[DRIVE_ENERGY_DISSIPATED_DAMAGE] += after->lost[PL_LOST_TO_STATES];
  e[DRIVE_ENERGY_DISSIPATED_DAMPING] +=
      0.5 * (before.lost[PL_LOST_TO_RATES] + after->lost[PL_LOST_TO_RATES]);
  e[DRIVE_ENERGY_EXTERNAL] += after->lost[PL_GIVEN_BY_REST];
  e[DRIVE_ENERGY_EXTERNAL] += work_between(&m->point, &before, after, from, to) +
                              0.5 * given_by_fields(m, to, time - to->step, time);
  e[DRIVE_ENERGY_STORED] = driven_point_observe(&m->point, to);
  m->at = *to;
  m->answer = *after;
  put_row(m, time);
}

static double largest_entry(double tangent[MOST][MOST], int order) {
  double most = 0;
  for (int a = 0; a < order; a++)
    for (int b = 0; b < order; b++)
      if (fabs(tangent[a][b]) > most) most = fabs(tangent[a][b]);
  return most;
}

/* Whether the law holds for the size of the cell. */
static bool size_fits(const drive_input *in, const pl_law *kernel, const double *parameters,
                      diagnostics *d) {
  if (!kernel->size_bounds) return true;
  law_limits limits;
  unsigned char low_open, high_open;
  kernel->size_bounds(kernel, parameters, &limits.lower, &limits.upper, &low_open, &high_open);
  limits.lower_open = low_open;
  limits.upper_open = high_open;
  if (limits_hold(limits, in->point.cell_size)) return true;
  char text[80];
  limits_text(limits_in(limits, 1e-3), text, sizeof text);
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&in->point.item, "size"),
              "a cell of %.6g mm is not in %s mm, the sizes that the law `%s` holds for%s%s",
              1e3 * in->point.cell_size, text, kernel->name, kernel->size_reason ? ": " : "",
              kernel->size_reason ? kernel->size_reason : "");
  return false;
}

static bool march_open(marching *m, const double *parameters, const double *initial,
                       const pl_law *kernel, diagnostics *d) {
  const strained rest = {.step = 1};
  double tangent[MOST][MOST] = {{0}};
  *m->band = (drive_band){.row = -1};
  if (!point_control_read(m->in, kernel->dimensions, &m->control, d) ||
      !size_fits(m->in, kernel, parameters, d))
    return false;
  driven_point_open(&m->point, kernel, parameters, m->in->point.cell_size);
  for (int f = 0; f < kernel->field_count; f++)
    driven_point_set(&m->point, f, initial[f]);
  driven_point_tangent(&m->point, &rest, tangent);
  m->control.stiffness = largest_entry(tangent, m->point.strains);
  return true;
}

bool drive_point_run(const drive_input *in, const pl_law *kernel, const double *parameters,
                     const double *initial, drive_table *out, drive_band *band, diagnostics *d) {
  static const double beside = 1e-6; /* of a step: rates have no corner there */
  marching m = {.in = in, .table = out, .band = band};
  if (!march_open(&m, parameters, initial, kernel, d)) return false;
  long count;
  double *t = drive_times(in, &count);
  bool good = true;
  table_open(out, in, kernel, count);
  m.parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof *m.parameters);
  memcpy(m.parameters, parameters, (size_t)kernel->parameter_count * sizeof *m.parameters);
  for (long k = 0; good && k < count && out->bad_row < 0; k++) {
    const double step = k ? t[k] - t[k - 1] : count > 1 ? t[1] : 1;
    strained to = {.step = step, .advance = k ? step : 0};
    stressed answer;
    take_given(&m, t[k]);
    good = point_control_reach(&m.control, in, &m.point, t[k], t[k] + (k ? -1 : 1) * beside * step,
                               k ? &m.at : NULL, &to, &answer, d);
    if (!good) break;
    if (k == 0) {
      m.answer = answer;
      first_row(&m, &to, t[k]);
      continue;
    }
    const strained from = beginning(&m, &to, t[k - 1] + beside * step);
    next_row(&m, &from, &to, &answer, t[k]);
  }
  driven_point_close(&m.point);
  free(m.parameters);
  free(t);
  return good;
}

void drive_point_observe(const drive_input *in, const pl_law *kernel, const double *parameters,
                         const drive_table *t, long row, double *outputs) {
  driven_point p;
  strained at = {.step = row ? t->columns[0].values[row] - t->columns[0].values[row - 1] : 1};
  double *values = must_calloc((size_t)kernel->parameter_count + 1, sizeof *values);
  memcpy(values, parameters, (size_t)kernel->parameter_count * sizeof *values);
  driven_fields_at(in, kernel, t->columns[0].values[row], values);
  driven_point_open(&p, kernel, values, in->point.cell_size);
  free(values);
  for (int k = 0; k < p.strains; k++) {
    at.strain[k] = t->columns[1 + k].values[row];
    at.rate[k] = t->columns[1 + p.strains + k].values[row];
  }
  for (int f = 0; f < kernel->field_count; f++)
    driven_point_set(&p, f, t->columns[t->law_column + f].values[row]);
  driven_point_observe(&p, &at);
  for (int k = 0; k < kernel->output_count; k++)
    outputs[k] = p.observed[1 + k][0];
  driven_point_close(&p);
}

/* --- what suits ------------------------------------------------------------------------------- */

bool drive_point_suits(const drive_input *in, const pl_law *kernel, diagnostics *d) {
  point_control control;
  return point_control_read(in, kernel->dimensions, &control, d);
}
