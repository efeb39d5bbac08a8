#include "generator/results/result_table.h"

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

result_file *table_open(const char *command, const char *path) {
  if (!file_suits(path, FILES(RESULT), command, "a result, which `perilat run` makes")) return NULL;
  char error[1024];
  result_file *f = result_read(path, error, sizeof error);
  if (!f) say_error("%s", error);
  return f;
}

bool table_close(result_file *f, bool good) {
  const char *trouble = result_trouble(f);
  if (good && trouble) say_error("%s", trouble);
  good = good && !trouble;
  result_read_close(f);
  return good;
}

bool table_read(result_file *f, const char *name, long frame, table_values *out, char *error,
                size_t size) {
  *out = (table_values){.name = name, .components = 1};
  if (frame < 0) {
    out->values =
        result_read_series(f, name, &out->count, out->unit, sizeof out->unit, error, size);
    result_read_unchecked(f, name, out->unchecked, sizeof out->unchecked);
  } else
    out->values = result_read_frame(f, name, frame, &out->count, &out->components, out->unit,
                                    sizeof out->unit, error, size);
  return out->values != NULL;
}

bool table_on_bonds(const char *field) {
  return strchr(field, '/') != NULL;
}

const char *table_component(int components, int c) {
  static const char *const names[] = {"_x", "_y", "_z", "_4", "_5", "_6", "_7", "_8", "_9"};
  return components < 2 ? "" : names[c < 8 ? c : 8];
}
