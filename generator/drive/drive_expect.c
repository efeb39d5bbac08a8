/* What a path expects: which number of the table is meant, what it should be, and whether it is. */
#include "generator/drive/drive_expect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/law_variant.h"
#include "dsl/syntax/parse.h"
#include "generator/drive/drive_bond.h"
#include "generator/drive/drive_family.h"
#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_point.h"
#include "generator/drive/drive_table.h"
#include "runtime/deck/deck_value.h"

#define CLOSED_FORM "closed_form_of_expectation_"

/* What one &expect asks for. */
typedef struct asked {
  int column;
  int extreme_of; /* the column that is largest (sign 1) or smallest (-1) then; -1: at `time` */
  double sign;
  double time;            /* s; infinite: the end */
  double value, absolute; /* in the column's unit; value: not of a closed form */
  int output;             /* of the closed form in the law, or -1 */
} asked;

/* The law with one more output for each closed form, and where each stands in its text. */
typedef struct closed_forms {
  model model;
  bool opened;
  const pl_law *law;
  char *text;
  uint32_t *begin; /* [expect_count] */
} closed_forms;

struct drive_expectations {
  const drive_input *in;
  const model *model;
  const drive_table *columns;
  arena *memory;
  diagnostics *d;
  closed_forms forms;
  asked *asked; /* [expect_count] */
};
typedef drive_expectations judge;

/* --- which number ----------------------------------------------------------------------------- */

static span quantity_where(const drive_expect *e) {
  return deck_where(&e->item, "quantity");
}

static int find_column(const judge *j, const drive_expect *e, const char *name) {
  const drive_table *t = j->columns;
  int c = drive_column_find(t, name);
  if (c >= 0) return c;
  const char **names = arena_alloc(j->memory, (size_t)t->column_count * sizeof *names);
  for (int k = 0; k < t->column_count; k++)
    names[k] = t->columns[k].name;
  diag_report(j->d, DIAG_UNKNOWN_NAME, quantity_where(e), "the table has no column `%s`",
              deck_shown(j->memory, name));
  if (strcmp(name, "stretch") == 0 && j->model->law->rest)
    diag_hint(j->d, "the law's `stretch` is less its rest stretch: give it an output, `output e = "
                    "stretch`; that of the path is `total_stretch`");
  else
    deck_suggest(j->d, name, names, t->column_count, "the columns are");
  return -1;
}

/* Row of the largest (sign 1) or smallest (-1) value; the first of equals. */
static long extreme(const drive_table *t, int column, double sign) {
  long best = 0;
  const double *v = t->columns[column].values;
  for (long k = 1; k < t->rows; k++)
    if (sign * v[k] > sign * v[best]) best = k;
  return best;
}

/* The time is one of the rows. */
static long row_at(const drive_table *t, double time) {
  long best = 0;
  const double *times = t->columns[DRIVE_COLUMN_TIME].values;
  if (isinf(time)) return t->rows - 1;
  for (long k = 1; k < t->rows; k++)
    if (fabs(times[k] - time) < fabs(times[best] - time)) best = k;
  return best;
}

static bool find_time(const judge *j, const drive_expect *e, double *time) {
  *time = isnan(e->at_time) ? INFINITY : e->at_time;
  if (isnan(e->at_stretch)) return true;
  *time = drive_time_of_stretch(j->in, e->at_stretch, e->after);
  if (!isnan(*time)) return true;
  diag_report(j->d, DIAG_OUT_OF_BOUNDS, deck_where(&e->item, "at_stretch"),
              "the stretch never is %.6g%s", e->at_stretch, e->after > 0 ? " after that time" : "");
  return false;
}

typedef struct phrase {
  char words[4][NAMELIST_LONGEST_NAME + 1];
  int count;
} phrase;

/* False when there are more than four words, or very long ones. */
static bool split(const char *text, phrase *p) {
  for (p->count = 0; *(text += strspn(text, " "));) {
    size_t n = strcspn(text, " ");
    if (p->count == 4 || n > NAMELIST_LONGEST_NAME) return false;
    memcpy(p->words[p->count], text, n);
    p->words[p->count++][n] = 0;
    text += n;
  }
  return p->count > 0;
}

static double sign_of(const char *word) {
  return strcmp(word, "peak") == 0 ? 1 : strcmp(word, "lowest") == 0 ? -1 : 0;
}

static bool refuse(const judge *j, const drive_expect *e) {
  diag_report(j->d, DIAG_BAD_VALUE, quantity_where(e), "`%s` is not a quantity of the table",
              deck_shown(j->memory, e->quantity));
  diag_hint(j->d, "write a column, 'peak N', 'lowest N', 'final N', or 'stretch at peak N'");
  return false;
}

/* "N", "final N", "peak N", "stretch at peak", "stretch at peak N". */
static bool choose(const judge *j, const drive_expect *e, asked *c) {
  phrase p;
  if (!split(e->quantity, &p)) return refuse(j, e);
  bool at_extreme = p.count >= 3 && strcmp(p.words[1], "at") == 0 && sign_of(p.words[2]) != 0;
  bool of_extreme = p.count == 2 && sign_of(p.words[0]) != 0;
  bool final = p.count == 2 && strcmp(p.words[0], "final") == 0;
  if (p.count > 1 && !at_extreme && !of_extreme && !final) return refuse(j, e);
  c->column = find_column(j, e, at_extreme ? p.words[0] : p.words[p.count - 1]);
  if (c->column < 0) return false;
  if (p.count == 1) return find_time(j, e, &c->time);
  if (!isnan(e->at_time) || !isnan(e->at_stretch)) {
    diag_report(j->d, DIAG_CONFLICT, quantity_where(e), "`%s` says itself when", e->quantity);
    diag_hint(j->d, "leave out `at_time` and `at_stretch`");
    return false;
  }
  c->time = INFINITY;
  if (final) return true;
  c->extreme_of =
      at_extreme ? p.count == 4 ? find_column(j, e, p.words[3]) : j->columns->force : c->column;
  c->sign = sign_of(p.words[at_extreme ? 2 : 0]);
  return c->extreme_of >= 0;
}

/* --- closed forms ----------------------------------------------------------------------------- */

/* Offset of the line `end model`: the last line that begins with that word. */
static size_t end_line(const char *text) {
  size_t found = strlen(text);
  for (const char *line = text; *line;) {
    const char *first = line + strspn(line, " \t\r");
    if (strncmp(first, "end", 3) == 0 &&
        !strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", first[3]))
      found = (size_t)(line - text);
    line += strcspn(line, "\n");
    line += *line == '\n';
  }
  return found;
}

static void write_text(const judge *j, closed_forms *f) {
  const char *law_text = j->model->sources.items[0].text;
  size_t length, cut = end_line(law_text);
  FILE *out = must_open_text(&f->text, &length);
  fprintf(out, "%.*s\n", (int)cut, law_text);
  for (int k = 0; k < j->in->expect_count; k++) {
    if (!j->in->expects[k].formula) continue;
    fprintf(out, "output %s%d = ", CLOSED_FORM, k);
    fflush(out);
    f->begin[k] = (uint32_t)length;
    fprintf(out, "%s\n", j->in->expects[k].formula);
  }
  fputs(law_text + cut, out);
  must_close_text(out);
}

/* A message about a closed form, at the path's line. */
static void pass_on(const judge *j, const closed_forms *f, const diagnostic *m) {
  for (int k = 0; k < j->in->expect_count; k++) {
    const drive_expect *e = &j->in->expects[k];
    uint32_t size = e->formula ? (uint32_t)strlen(e->formula) : 0;
    if (!e->formula || m->where.begin < f->begin[k] || m->where.begin > f->begin[k] + size)
      continue;
    uint32_t written = e->formula_where.end - e->formula_where.begin;
    span where = e->formula_where;
    if (written == size) { /* no doubled quotes have shifted it */
      where.begin += m->where.begin - f->begin[k];
      where.end = where.begin + (m->where.end > m->where.begin ? m->where.end - m->where.begin : 1);
      if (where.end > e->formula_where.end) where.end = e->formula_where.end;
      if (where.begin >= where.end) where = e->formula_where;
    }
    const bool hole = m->code == DIAG_HOLE; /* the output's name is nobody's */
    diag_report(j->d, m->code, where, "%s",
                hole ? "this formula is still to be written" : m->message);
    if (m->hint && !hole) diag_hint(j->d, "%s", m->hint);
    return;
  }
  diag_report(j->d, m->code, quantity_where(&j->in->expects[0]),
              "with its closed forms the law cannot be compiled: %s", m->message);
}

static bool open_forms(const judge *j, closed_forms *f) {
  const law *l = j->model->law;
  law_choice *choices = must_calloc((size_t)l->options.count + 1, sizeof *choices);
  for (int k = 0; k < l->options.count; k++)
    choices[k] = (law_choice){l->options.items[k]->name, l->chosen[k]};
  f->opened = true;
  bool good = model_open_text(&f->model, j->model->path, f->text, strlen(f->text), choices,
                              l->options.count);
  if (good) f->model.law = law_on_lattice(f->model.law, l->setting, false, 0);
  good = good && model_plan(&f->model);
  int errors = 0;
  for (int k = 0; k < f->model.said.count && !good; k++)
    if (diag_severity(f->model.said.items[k].code) == SEVERITY_ERROR) {
      pass_on(j, f, &f->model.said.items[k]);
      errors++;
    }
  free(choices);
  if (!good) return false;
  char error[128];
  const char *note;
  f->law = model_kernel(&f->model, true, &note, error, sizeof error);
  return f->law != NULL;
}

static bool closed_forms_open(const judge *j, closed_forms *f) {
  bool any = false;
  for (int k = 0; k < j->in->expect_count; k++)
    any = any || j->in->expects[k].formula;
  if (!any) return true;
  f->begin = must_calloc((size_t)j->in->expect_count, sizeof *f->begin);
  write_text(j, f);
  return open_forms(j, f);
}

static void closed_forms_close(closed_forms *f) {
  if (f->opened) model_close(&f->model);
  free(f->text);
  free(f->begin);
}

/* Index of the output that is the closed form of expectation k. */
static int form_output(const closed_forms *f, int k) {
  char name[64];
  snprintf(name, sizeof name, "%s%d", CLOSED_FORM, k);
  for (int o = 0; o < f->law->output_count; o++)
    if (strcmp(f->law->outputs[o].name, name) == 0) return o;
  return -1;
}

static bool units_agree(const judge *j, const drive_expect *e, dimension form,
                        const char *column_unit) {
  dimension wanted = dimension_of(column_unit);
  char has[96], needs[96];
  if (dim_equal(form, wanted)) return true;
  dim_describe(form, has, sizeof has);
  dim_describe(wanted, needs, sizeof needs);
  diag_report(j->d, DIAG_UNITS, e->formula_where, "`%s` is %s, but this is %s", e->quantity, needs,
              has);
  return false;
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool plain_value(const judge *j, const namelist_key *key, const char *unit_text,
                        deck_bound bound, double *value) {
  if (!key) return true;
  return deck_values_counted(key, 1, j->d) &&
         deck_real_read(&key->values[0], key->name, unit_text, bound, value, j->d);
}

static bool read_one(const judge *j, int k, asked *a) {
  const drive_expect *e = &j->in->expects[k];
  *a = (asked){.extreme_of = -1, .output = -1};
  if (!choose(j, e, a)) return false;
  const char *unit_text = j->columns->columns[a->column].unit;
  if (e->formula) a->output = form_output(&j->forms, k);
  bool good = e->formula
                  ? units_agree(j, e, j->forms.model.law->outputs.items[a->output]->dim, unit_text)
                  : plain_value(j, e->value, unit_text, BOUND_NONE, &a->value);
  return plain_value(j, e->absolute, unit_text, BOUND_NOT_NEGATIVE, &a->absolute) && good;
}

drive_expectations *drive_expectations_read(const drive_input *in, const model *m,
                                            const drive_table *columns, diagnostics *d) {
  arena *memory = arena_new();
  drive_expectations *j = arena_alloc(memory, sizeof *j);
  *j = (drive_expectations){.in = in, .model = m, .columns = columns, .memory = memory, .d = d};
  j->asked = arena_alloc(memory, ((size_t)in->expect_count + 1) * sizeof *j->asked);
  const bool formed = closed_forms_open(j, &j->forms);
  bool good = formed;
  for (int k = 0; k < in->expect_count; k++)
    if (formed || !in->expects[k].formula) good = read_one(j, k, &j->asked[k]) && good;
  if (good) return j;
  drive_expectations_free(j);
  return NULL;
}

void drive_expectations_free(drive_expectations *x) {
  closed_forms_close(&x->forms);
  arena_free(x->memory);
}

/* --- judging ---------------------------------------------------------------------------------- */

static double form_value(const judge *j, const double *parameters, const drive_table *t, int output,
                         long row) {
  const pl_law *kernel = j->forms.law;
  double *outputs = must_calloc((size_t)kernel->output_count, sizeof *outputs);
  if (t->of == DRIVE_OF_FAMILIES)
    drive_family_observe(j->in, j->forms.model.law, kernel, parameters, t, row, outputs);
  else if (t->of == DRIVE_OF_POINTS)
    drive_point_observe(j->in, kernel, parameters, t, row, outputs);
  else
    drive_observe(j->in, kernel, parameters, t, row, outputs);
  const double value = outputs[output];
  free(outputs);
  return value;
}

/* The column of what the path drives first: a bond's rotation, a component of strain. A rate drives
   the stretch; of points the table says it. */
static const drive_column *driven_column(const judge *j, const drive_table *t) {
  static const char *const names[] = {
#define X(code, name, unit) [DRIVE_##code] = name,
      DRIVE_QUANTITIES(X)
#undef X
  };
  for (int k = 0; t->of != DRIVE_OF_POINTS && j->in->piece_count && k < t->column_count; k++)
    if (strcmp(t->columns[k].name, names[j->in->pieces[0].quantity]) == 0 &&
        j->in->pieces[0].quantity != DRIVE_STRETCH_RATE)
      return &t->columns[k];
  return &t->columns[t->way];
}

static drive_verdict judge_one(const judge *j, const double *parameters, const drive_table *t,
                               const drive_expect *e, const asked *a) {
  const double *time = t->columns[DRIVE_COLUMN_TIME].values;
  const bool at_extreme = a->extreme_of >= 0;
  const long row = at_extreme ? extreme(t, a->extreme_of, a->sign) : row_at(t, a->time);
  const drive_column *way = driven_column(j, t);
  drive_verdict v = {.found = t->columns[a->column].values[row],
                     .unit = t->columns[a->column].unit,
                     .time = time[row],
                     .way = way->values[row],
                     .way_name = way->name,
                     .extreme = at_extreme,
                     .beside = {time[row ? row - 1 : 0], time[row < t->rows - 1 ? row + 1 : row]}};
  v.expected = e->formula ? form_value(j, parameters, t, a->output, row) : a->value;
  v.allowed = pl_fmax(e->tolerance * fabs(v.expected), a->absolute);
  v.passed = fabs(v.found - v.expected) <= v.allowed; /* NaN does not */
  return v;
}

void drive_judge(const drive_expectations *x, const double *parameters, const drive_table *t,
                 drive_verdict *verdicts) {
  for (int k = 0; k < x->in->expect_count; k++)
    verdicts[k] = judge_one(x, parameters, t, &x->in->expects[k], &x->asked[k]);
}
