#include "generator/results/measured.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "runtime/base/quantity.h"

enum { PAIR = 2 };

/* An option as a source of its own, so that messages show it. */
static span option_text(const char *name, const char *text, diagnostics *d) {
  const int file = source_add(d->sources, name, text, strlen(text));
  return (span){0, (uint32_t)strlen(text), (uint16_t)file};
}

static void name_after_file(measured *m) {
  const char *slash = strrchr(m->table.file.path, '/'),
             *name = slash ? slash + 1 : m->table.file.path;
  const char *dot = strrchr(name, '.');
  snprintf(m->label, sizeof m->label, "%.*s",
           (int)(dot && dot > name ? dot - name : (long)strlen(name)), name);
}

/* --- columns ---------------------------------------------------------------------------------- */

/* Two names in "a,b". False after a message. */
static bool pair_of(const char *text, char *names[PAIR], span where, const char *words,
                    diagnostics *d) {
  names[0] = names[1] = NULL;
  if (text_table_names(text, names, PAIR) == PAIR) return true;
  diag_report(d, DIAG_BAD_VALUE, where, "%s", words);
  return false;
}

static bool columns_of(text_table *t, const char *text, int column[PAIR], span where,
                       const char *words, diagnostics *d) {
  char *names[PAIR];
  bool good = pair_of(text, names, where, words, d);
  for (int k = 0; k < PAIR; k++) {
    if (good) column[k] = text_table_column(t, names[k], where, d);
    good = good && column[k] >= 0;
    free(names[k]);
  }
  return good;
}

/* The column of a history's name, or of the last part of it. */
static int column_of_history(text_table *t, const char *history, diagnostics *d) {
  const char *slash = strrchr(history, '/');
  const int found = text_table_find(t, history, d);
  return found == TEXT_TABLE_NONE && slash ? text_table_find(t, slash + 1, d) : found;
}

static bool report_unmatched(text_table *t, const char *history, span where, diagnostics *d) {
  text_table_column(t, history, where, d);
  char listed[400];
  snprintf(listed, sizeof listed, "%s",
           d->items[d->count - 1].hint ? d->items[d->count - 1].hint : "");
  diag_hint(d, "%s%ssay which it is: FILE:X,Y", listed, *listed ? "; " : "");
  return false;
}

static bool match_columns(text_table *t, const measured_axes *axes, bool band, int column[PAIR],
                          span where, diagnostics *d) {
  column[0] = column_of_history(t, axes->x, d);
  column[1] = TEXT_TABLE_NONE;
  for (int k = 0; k < axes->y_count && column[1] == TEXT_TABLE_NONE; k++)
    column[1] = column_of_history(t, axes->ys[k], d);
  if (column[0] == TEXT_TABLE_TWO || column[1] == TEXT_TABLE_TWO) return false;
  if (column[0] < 0) return report_unmatched(t, axes->x, where, d);
  return column[1] >= 0 || band || report_unmatched(t, axes->ys[0], where, d);
}

/* Given, or matched by name; a band may do without a column for y. */
static bool find_columns(measured *m, const char *given, bool band, const measured_axes *axes,
                         int column[PAIR], span where, diagnostics *d) {
  if (!given) return match_columns(&m->table, axes, band, column, where, d);
  if (!band || strchr(given, ','))
    return columns_of(&m->table, given, column, where, "a curve has two columns: FILE:X,Y", d);
  column[0] = text_table_column(&m->table, given, where, d);
  column[1] = TEXT_TABLE_NONE;
  return column[0] >= 0;
}

/* --- values ----------------------------------------------------------------------------------- */

static bool read_column(measured *m, int column, const char *unit_text, double **values,
                        diagnostics *d) {
  *values = text_table_values(&m->table, column, unit_text, true, d);
  return *values != NULL;
}

static bool band_stands(measured *m, int low, diagnostics *d) {
  for (long k = 0; k < m->count; k++) {
    if (!(m->low[k] > m->high[k])) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, text_table_cell(&m->table, k, low, d),
                "here the lower side of the band is above the upper one");
    return false;
  }
  return true;
}

static bool read_band(measured *m, const char *band, const measured_axes *axes, diagnostics *d) {
  int column[PAIR];
  const span where = option_text("--band", band, d);
  return columns_of(&m->table, band, column, where,
                    "a band of a table has two columns: --band LOW,HIGH", d) &&
         read_column(m, column[0], axes->y_unit, &m->low, d) &&
         read_column(m, column[1], axes->y_unit, &m->high, d) && band_stands(m, column[0], d);
}

static bool has_rows(measured *m, span where, diagnostics *d) {
  if (m->table.rows > 0) return true;
  diag_report(d, DIAG_BAD_VALUE, where, "`%s` holds no numbers", m->table.file.path);
  return false;
}

bool measured_read(measured *m, const char *option, const char *given, const char *band,
                   const measured_axes *axes, diagnostics *d) {
  const char *columns;
  int column[PAIR];
  *m = (measured){.count = 0};
  const span where = option_text(option, given, d);
  if (!text_table_read(&m->table, text_table_split(given, &columns), where, d) ||
      !has_rows(m, where, d))
    return false;
  m->count = m->table.rows;
  name_after_file(m);
  if (!find_columns(m, columns, band != NULL, axes, column, where, d)) return false;
  return read_column(m, column[0], axes->x_unit, &m->x, d) &&
         (column[1] < 0 || read_column(m, column[1], axes->y_unit, &m->y, d)) &&
         (!band || read_band(m, band, axes, d));
}

void measured_free(measured *m) {
  text_table_free(&m->table);
  free(m->x);
  free(m->y);
  free(m->low);
  free(m->high);
}

/* --- constants -------------------------------------------------------------------------------- */

/* Behind the label, "f_t A = 58.88 kN". */
static const char *without_label(const char *given) {
  const char *equals = strrchr(given, '=');
  return equals ? equals + 1 : given;
}

bool measured_line(const char *given, const char *si_unit, double *value) {
  const char *text = without_label(given);
  if (quantity_read(text, strlen(text), si_unit, value)) return true;
  say_error("--line needs a value in a unit of `%s`, and perhaps a label before it, e.g. 'f_t A = "
            "5 %s', not `%s`",
            si_unit, si_unit, given);
  return false;
}

bool measured_levels(const char *given, const char *si_unit, double value[2]) {
  const char *text = without_label(given), *comma = strchr(text, ',');
  if (comma && quantity_read(text, (size_t)(comma - text), si_unit, &value[0]) &&
      quantity_read(comma + 1, strlen(comma + 1), si_unit, &value[1]) && value[0] <= value[1])
    return true;
  say_error("--band needs two columns of the table before it, or two ascending values in a unit of "
            "`%s`, e.g. '4 %s, 5 %s', not `%s`",
            si_unit, si_unit, si_unit, given);
  return false;
}
