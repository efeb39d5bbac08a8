#include "generator/page/law_curve.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/law_reads.h"
#include "generator/drive/drive_bond.h"
#include "generator/drive/drive_family.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_point.h"

typedef struct driver {
  const model *m;
  const pl_law *kernel;
  const double *parameters;
  const deck_lattice *l;
  drive_kind of;
  double size;
} driver;

/* A cell of a mesh in a grid; of others a hundredth of a metre. */
static double cell_size(const deck_lattice *l) {
  const double x = l->size[0] / (l->nodes[0] - 1), y = l->size[1] / (l->nodes[1] - 1);
  return x > 0 && y > 0 && isfinite(x * y) ? sqrt(x * y) : 0.01;
}

/* --- paths ------------------------------------------------------------------------------------ */

/* A path as `perilat drive` reads it; to be freed. Strain rises to `most` in a second. */
static char *path_text(const driver *r, double most, bool returns) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  fputs("&simulation steps = 480 /\n", out);
  if (r->of == DRIVE_OF_BONDS)
    fprintf(out, "&bond spacing = '%.17g m'", r->size);
  else if (r->of == DRIVE_OF_FAMILIES)
    fprintf(out, "&particle spacing = '%.17g m'", r->size);
  else
    fprintf(out, "&point test = 'uniaxial stress' setting = '%s' size = '%.17g m'",
            law_setting_name(r->m->law->setting), r->size);
  const bool reads_area = law_reads(r->m->law, QUANTITY_AREA);
  if (r->of == DRIVE_OF_BONDS && reads_area)
    fprintf(out, " area = '%.17g m^2'", r->l->area > 0 ? r->l->area : r->size * r->size);
  else if (r->of != DRIVE_OF_POINTS && r->l->thickness > 0)
    fprintf(out, " thickness = '%.17g m'", r->l->thickness);
  fprintf(out, " /\n&path quantity = '%s' ", r->of == DRIVE_OF_BONDS ? "stretch" : "strain_xx");
  if (returns)
    fprintf(out, "times = 0, '1 s', '2 s', '5 s' values = 0, %.17g, 0, %.17g /\n", most / 3, most);
  else
    fprintf(out, "times = 0, '3 s' values = 0, %.17g /\n", most);
  must_close_text(out);
  return text;
}

static bool run(const driver *r, const drive_input *in, const double *initial, drive_table *t,
                diagnostics *d) {
  drive_band band;
  if (r->of == DRIVE_OF_FAMILIES) {
    family_gauge gauge = {.plan = NULL};
    const bool good =
        drive_family_run(in, r->m->law, r->kernel, &gauge, r->parameters, initial, t, d);
    family_gauge_close(&gauge);
    return good;
  }
  if (r->of == DRIVE_OF_POINTS)
    return drive_point_suits(in, r->kernel, d) &&
           drive_point_run(in, r->kernel, r->parameters, initial, t, &band, d);
  return drive_run(in, r->m->law, r->kernel, r->parameters, initial, t, d);
}

/* False where the path is none, or its answer no number. The table is to be freed where it has
   memory. */
static bool drive_to(const driver *r, double most, bool returns, drive_table *t) {
  arena *memory = arena_new();
  source_set sources = {.count = 0};
  diagnostics said;
  diag_begin(&said, &sources);
  *t = (drive_table){.memory = NULL};
  char *text = path_text(r, most, returns);
  const int file = source_add(&sources, "path", text, strlen(text));
  const drive_input *in = drive_read(memory, &sources, file, NULL, 0, &said);
  double *initial = must_calloc((size_t)r->kernel->field_count + 1, sizeof *initial);
  for (int f = 0; f < r->kernel->field_count; f++)
    initial[f] = r->kernel->fields[f].initial;
  const bool good = in && run(r, in, initial, t, &said) && t->bad_row < 0 && t->rows > 1;
  free(initial);
  free(text);
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return good;
}

static void let_go(drive_table *t) {
  if (t->memory) drive_table_free(t);
  t->memory = NULL;
}

/* --- how far ---------------------------------------------------------------------------------- */

typedef struct answer { /* of what answers on the way out */
  double peak, at;      /* the largest answer, and the strain there */
  double end;           /* the last answer in parts of it */
  double bend;          /* the strain at which the secant has lost a fiftieth; infinite */
} answer;

static answer answer_of(const drive_table *t) {
  const double *x = t->columns[t->way].values, *y = t->columns[t->force].values;
  answer s = {.bend = INFINITY};
  const double first = y[1] / x[1];
  for (long k = 1; k < t->rows; k++) {
    if (fabs(y[k]) > s.peak) {
      s.peak = fabs(y[k]);
      s.at = fabs(x[k]);
    }
    if (!isfinite(s.bend) && !(fabs(y[k] / x[k] - first) <= 0.02 * fabs(first)))
      s.bend = fabs(x[k]);
  }
  s.end = s.peak > 0 ? fabs(y[t->rows - 1]) / s.peak : 1;
  return s;
}

/* `way` is 1 (drawn) or -1 (pressed). Far enough to see it soften, or bend; a thousandth where it
   does neither. */
static double choose_most(const driver *r, double way) {
  enum { LEAST = 1, MOST = 13 };
  double bend = INFINITY, softens = INFINITY, most = 1e-5;
  for (int k = LEAST; k <= MOST; k++, most *= 2) {
    drive_table t;
    const bool good = drive_to(r, way * most, false, &t);
    const answer s = good ? answer_of(&t) : (answer){.bend = INFINITY};
    let_go(&t);
    if (!good) break;
    if (s.bend < bend) bend = s.bend;
    if (s.at < 0.9 * most && s.at < softens) softens = s.at;
    if (s.end < 0.1) return most;
    if (most > 20 * softens) return most;
  }
  if (isfinite(softens)) return pl_fmin(10 * softens, most);
  return isfinite(bend) ? pl_fmin(4 * bend, most) : pl_fmin(1e-3, most);
}

bool law_curve_read(law_curve *c, const model *m, const pl_law *kernel, const double *parameters,
                    const deck_lattice *l) {
  *c = (law_curve){.of = kernel->kind == PL_STATE       ? DRIVE_OF_FAMILIES
                         : kernel->kind == PL_CONTINUUM ? DRIVE_OF_POINTS
                                                        : DRIVE_OF_BONDS};
  if (kernel->kind == PL_CRACK) return false;
  c->size = c->of == DRIVE_OF_POINTS ? cell_size(l) : l->spacing > 0 ? l->spacing : 0.01;
  const driver r = {m, kernel, parameters, l, c->of, c->size};
  if (!drive_to(&r, choose_most(&r, 1), true, &c->drawn)) return false;
  c->was_pressed = drive_to(&r, -choose_most(&r, -1), true, &c->pressed);
  return true;
}

void law_curve_free(law_curve *c) {
  let_go(&c->drawn);
  let_go(&c->pressed);
}
