#include "generator/against/difference_words.h"

#include <math.h>
#include <string.h>

#include "dsl/base/units.h"

static const char *const side_words[] = {
#define X(code, name, words) words,
    DIFFERENCE_SIDES(X)
#undef X
};
static const char *const side_names[] = {
#define X(code, name, words) name,
    DIFFERENCE_SIDES(X)
#undef X
};
static const char *const total_words[] = {
#define X(code, name, words) words,
    DIFFERENCE_TOTALS(X)
#undef X
};
static const char *const total_names[] = {
#define X(code, name, words) name,
    DIFFERENCE_TOTALS(X)
#undef X
};
static const char *const kind_names[] = {
#define X(code, name) name,
    DIFFERENCE_KINDS(X)
#undef X
};

static const struct {
  const char *name, *words;
} spoken[] = {{"N", "the force N"},
              {"M_i", "the moment M_i"},
              {"M_j", "the moment M_j"},
              {"T", "the twisting moment T"},
              {"stored", "the stored energy"},
              {"dissipated_damage", "the energy that damage or yield takes"},
              {"dissipated_damping", "the energy that damping takes"},
              {"dissipated", "the energy that it dissipates"},
              {"external", "the work done on it"}};

const char *column_words(const char *name) {
  for (size_t k = 0; k < sizeof spoken / sizeof *spoken; k++)
    if (strcmp(spoken[k].name, name) == 0) return spoken[k].words;
  return name;
}

static const char *sign_words(double ratio) {
  return ratio < 0 ? "minus " : "";
}

static void number_say(double ratio, const char *should, FILE *out) {
  fprintf(out, "%s%.4g times %s", sign_words(ratio), fabs(ratio), should);
}

void ratio_say(double ratio, const char *should, FILE *out) {
  const char *known = ratio_words(fabs(ratio));
  if (fabs(ratio) < 1e-9) {
    fputs("0", out);
    return;
  }
  if (ratio_is_rounding(ratio)) {
    fprintf(out, "off by %.2g %%", 100 * fabs(ratio - 1));
    return;
  }
  if (known)
    fprintf(out, "%s%s %s", sign_words(ratio), known, should);
  else
    number_say(ratio, should, out);
}

void exact_ratio_say(double ratio, const char *should, FILE *out) {
  char formula[64];
  if (ratio_words(fabs(ratio)) || ratio_is_rounding(ratio) ||
      !ratio_formula(fabs(ratio), formula, sizeof formula)) {
    ratio_say(ratio, should, out);
    return;
  }
  fprintf(out, "%s%s times %s", sign_words(ratio), formula, should);
}

void plain_ratio_say(double ratio, const char *should, FILE *out) {
  if (ratio_is_closed(fabs(ratio)))
    number_say(ratio, should, out);
  else
    exact_ratio_say(ratio, should, out);
}

void rounding_say(double ratio, FILE *out) {
  if (ratio_is_rounding(ratio))
    fputs(": is a constant rounded? write sqrt(2)/3 or pi, say, not their digits", out);
}

static const char *unit_shown(const char *unit_text) {
  return unit_is_pure(unit_text) ? "" : unit_text;
}

static const drive_column *driven_way(const drive_table *t) {
  int way, force;
  driven_columns(t, &way, &force);
  return &t->columns[way];
}

static void say_place(const drive_table *t, long row, FILE *out) {
  const drive_column *way = driven_way(t);
  fprintf(out, "at %.6g s, %s %.6g", t->columns[DRIVE_COLUMN_TIME].values[row], way->name,
          way->values[row]);
}

/* Where it begins to yield or to break, if that is elsewhere. */
static void say_beginning(const table_difference *d, FILE *out) {
  const double answer = d->begins[0], reference = d->begins[1];
  const char *name = d->begins_of, *unit_text = d->begins_unit ? unit_shown(d->begins_unit) : "";
  if (!name || (isnan(answer) && isnan(reference)) || answer == 0 || reference == 0) return;
  const char *gap = *unit_text ? " " : "";
  if (isnan(answer))
    fprintf(out, "; it loses no energy, and should from %s = %.4g%s%s on", name, reference, gap,
            unit_text);
  else if (isnan(reference))
    fprintf(out, "; it loses energy from %s = %.4g%s%s on, and should lose none", name, answer, gap,
            unit_text);
  else if (fabs(answer - reference) > 0.02 * reference)
    fprintf(out, "; it begins to lose energy at %s = %.4g, not %.4g%s%s", name, answer, reference,
            gap, unit_text);
}

/* Where that is a multiple with a name. */
static void say_dissipated(const table_difference *d, const char *should, FILE *out) {
  const double ratio = d->totals[TOTAL_DISSIPATED];
  if (isnan(ratio) || fabs(ratio - 1) <= 2e-3 || ratio < 1e-9 || !ratio_is_known(ratio)) return;
  fprintf(out, "; %s is ", total_words[TOTAL_DISSIPATED]);
  exact_ratio_say(ratio, should, out);
}

static void say_total(const table_difference *d, const char *should, FILE *out) {
  if (d->total != TOTAL_PEAK && !isnan(d->totals[TOTAL_PEAK]))
    fprintf(out, "%s agrees, but ", total_words[TOTAL_PEAK]);
  fprintf(out, "%s is ", total_words[d->total]);
  ratio_say(d->totals[d->total], should, out);
}

static void say_side(const table_difference *d, const char *should, FILE *out) {
  fprintf(out, "%s is wrong only %s", column_words(d->columns[d->of].name), side_words[d->side]);
  const bool minus = fabs(d->ratio + 1) <= 1e-6,
             known = !isnan(d->ratio) && ratio_is_known(fabs(d->ratio));
  if (minus) fputs(": there it has the wrong sign", out);
  if (!minus && known) {
    fputs(": there it is ", out);
    exact_ratio_say(d->ratio, should, out);
  }
  const double far = 100 * d->columns[d->of].worst;
  if (!minus && !known)
    fprintf(out, ": there it is %s by up to %.*g %% of the largest",
            d->larger > 0   ? "too large"
            : d->larger < 0 ? "too small"
                            : "off",
            far < 100 ? 2 : 4, far < 100 ? far : rint(far));
  say_beginning(d, out);
  say_dissipated(d, should, out);
}

static void say_ratio_of_all(const table_difference *d, const char *should, FILE *out) {
  const column_difference *q = &d->columns[d->of];
  if (q->energy) fputs("the forces agree, but ", out);
  fprintf(out, "%s is ", column_words(q->name));
  exact_ratio_say(d->ratio, should, out);
  fputs(" in all states", out);
  rounding_say(d->ratio, out);
}

static void say_state(const table_difference *d, const drive_table *answer, const char *should,
                      FILE *out) {
  const column_difference *q = &d->columns[d->of];
  if (q->energy) fputs("the forces agree, but ", out);
  fprintf(out, "%s%s first differs ", column_words(q->name),
          q->minor ? ", which is small beside the largest of its kind," : "");
  say_place(answer, d->row, out);
  const double a = q->answer[d->row] + 0.0, b = q->reference[d->row] + 0.0;
  const int digits = fabs(a - b) < 1e-4 * fabs(b) ? 9 : 6; /* so many tell them apart */
  fprintf(out, ": it is %.*g, not %.*g%s%s", digits, a, digits, b, *unit_shown(q->unit) ? " " : "",
          unit_shown(q->unit));
  if (!q->minor && q->differing > 1 && d->larger)
    fprintf(out, ", and %s in all states that differ", d->larger > 0 ? "too large" : "too small");
  say_beginning(d, out);
  if (!q->energy) say_dissipated(d, should, out);
}

void difference_say(const table_difference *d, const drive_table *answer, const char *should,
                    FILE *out) {
  const char *name = d->column_count ? column_words(d->columns[d->of].name) : "";
  switch (d->kind) {
  case DIFFERENCE_NONE:
    fprintf(out, "equal within %.3g in %ld rows", d->tolerance, d->rows - d->skipped);
    return;
  case DIFFERENCE_NO_NUMBER:
    fprintf(out, "`%s` is not a number ", d->bad);
    say_place(answer, d->row, out);
    return;
  case DIFFERENCE_RATIO:
    say_ratio_of_all(d, should, out);
    return;
  case DIFFERENCE_SIGN:
    fprintf(out, "%s has the wrong sign in all states", name);
    return;
  case DIFFERENCE_LATE:
    fprintf(out, "%s is one step late: each state answers with what belongs to the one before it",
            name);
    return;
  case DIFFERENCE_EARLY:
    fprintf(out, "%s is one step early: each state answers with what belongs to the one after it",
            name);
    return;
  case DIFFERENCE_TOTAL:
    say_total(d, should, out);
    return;
  case DIFFERENCE_SIDE:
    say_side(d, should, out);
    return;
  case DIFFERENCE_STATE:
    say_state(d, answer, should, out);
  }
}

/* --- two rows --------------------------------------------------------------------------------- */

enum { MOST_SHOWN = 5 };

/* Columns that differ in the row, the one that is spoken of first. */
static int shown_columns(const table_difference *d, const column_difference **shown) {
  int count = 0;
  for (int c = d->of; c < d->column_count && count < MOST_SHOWN; c++) {
    const column_difference *q = &d->columns[c];
    const double apart = fabs(q->answer[d->row] - q->reference[d->row]);
    if (c == d->of || !(apart <= d->tolerance * q->scale)) shown[count++] = q;
  }
  return count;
}

static void head(const column_difference *q, FILE *out) {
  char text[80];
  snprintf(text, sizeof text, "%s%s%s%s", q->name, *unit_shown(q->unit) ? " [" : "",
           unit_shown(q->unit), *unit_shown(q->unit) ? "]" : "");
  fprintf(out, "  %16s", text);
}

void difference_rows(const table_difference *d, const drive_table *t, const char *const names[2],
                     const char *indent, FILE *out) {
  const column_difference *shown[MOST_SHOWN];
  if (d->kind == DIFFERENCE_NONE || d->kind == DIFFERENCE_NO_NUMBER) return;
  const int count = shown_columns(d, shown);
  const drive_column *way = driven_way(t);
  fprintf(out, "%sfirst differs%11s  %13s", indent, "time [s]", way->name);
  for (int k = 0; k < count; k++)
    head(shown[k], out);
  for (int of = 0; of < 2; of++) {
    fprintf(out, "\n%s%-11s  %11.6g  %13.6g", indent, names[of],
            t->columns[DRIVE_COLUMN_TIME].values[d->row], way->values[d->row] + 0.0);
    for (int k = 0; k < count; k++)
      fprintf(out, "  %16.9g", (of ? shown[k]->reference : shown[k]->answer)[d->row] + 0.0);
  }
  fputc('\n', out);
}

/* --- for other programs ----------------------------------------------------------------------- */

static void put_first(const table_difference *d, const drive_table *t, json *j) {
  const drive_column *way = driven_way(t);
  json_put_object(j, "first");
  json_put_integer(j, "row", d->row);
  json_put_number(j, "time", t->columns[DRIVE_COLUMN_TIME].values[d->row]);
  json_put_number(j, way->name, way->values[d->row]);
  for (int of = 0; of < 2; of++) {
    json_put_object(j, of ? "reference" : "answer");
    for (int c = 0; c < d->column_count; c++)
      json_put_number(j, d->columns[c].name,
                      (of ? d->columns[c].reference : d->columns[c].answer)[d->row]);
    json_object_end(j);
  }
  json_object_end(j);
}

void difference_json(const table_difference *d, const drive_table *t, json *j) {
  const bool any = d->kind != DIFFERENCE_NONE, column = any && d->column_count > 0;
  json_put_text(j, "difference", kind_names[d->kind]);
  json_put_text(j, "of", column ? d->columns[d->of].name : d->bad);
  json_put_number(j, "ratio",
                  d->kind == DIFFERENCE_RATIO || d->kind == DIFFERENCE_SIGN ||
                          d->kind == DIFFERENCE_SIDE
                      ? d->ratio
                      : NAN);
  json_put_text(j, "side", d->kind == DIFFERENCE_SIDE ? side_names[d->side] : NULL);
  json_put_text(j, "total", d->kind == DIFFERENCE_TOTAL ? total_names[d->total] : NULL);
  json_put_object(j, "totals");
  for (int k = 0; k < TOTAL_COUNT; k++)
    json_put_number(j, total_names[k], d->totals[k]);
  json_object_end(j);
  json_put_number(j, "tolerance", d->tolerance);
  json_put_integer(j, "rows", d->rows);
  json_put_integer(j, "skipped", d->skipped);
  json_put_object(j, "worst");
  for (int c = 0; c < d->column_count; c++)
    json_put_number(j, d->columns[c].name, d->columns[c].worst);
  json_object_end(j);
  if (column && d->row >= 0)
    put_first(d, t, j);
  else
    json_key(j, "first"), json_null(j);
}
