#include "generator/study/study_info.h"

#include <math.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/units.h"
#include "generator/study/study_read.h"

/* --- telling ---------------------------------------------------------------------------------- */

static void print_column(const study_column *c, int rows) {
  double least = INFINITY, largest = -INFINITY;
  printf("  %s", name_shown(c->name));
  if (c->texts) {
    puts(": texts");
    return;
  }
  for (int k = 0; k < rows; k++) {
    if (c->values[k] < least) least = c->values[k];
    if (c->values[k] > largest) largest = c->values[k];
  }
  if (least <= largest)
    printf(": %.6g to %.6g%s%s\n", least, largest, unit_is_pure(c->unit) ? "" : " ",
           unit_is_pure(c->unit) ? "" : c->unit);
  else
    puts(": no values");
}

static void print_table(const char *path, const study_reading *r) {
  const study_table *t = &r->table;
  const study_column *names = study_reading_column(r, "case"),
                     *ended = study_reading_column(r, "ended");
  const size_t length = strlen(path);
  printf("The table of a study: %d case%s, whose results are in %.*s/\n\nColumns (/table/NAME)\n",
         t->rows, t->rows == 1 ? "" : "s",
         (int)(length > 3 && strcmp(path + length - 3, ".h5") == 0 ? length - 3 : length), path);
  for (int k = 0; k < t->column_count; k++)
    print_column(&t->columns[k], t->rows);
  puts("\nCases (curves: /cases/NAME/{time, x, y})");
  for (int k = 0; k < t->rows && names && names->texts; k++)
    printf("  %s%s%s\n", name_shown(names->texts[k]), ended && ended->texts ? ": " : "",
           ended && ended->texts ? name_shown(ended->texts[k]) : "");
}

bool study_info(const char *path, json *w) {
  arena *memory = arena_new();
  study_reading r;
  const bool read = study_read(memory, path, &r);
  if (read && w) {
    json_put_text(w, "table", path);
    study_table_json(&r.table, "cases", w);
  } else if (read)
    print_table(path, &r);
  arena_free(memory);
  return read;
}
