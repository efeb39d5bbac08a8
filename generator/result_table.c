#include "generator/result_table.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "generator/model.h"

result_file *table_open(const char *command, const char *path) {
  const file_kind kind = kind_of_file(path);
  if (kind == FILE_LAW || kind == FILE_DECK) {
    fprintf(stderr,
            "perilat: error: `%s` is a %s; `%s` needs a result, which `perilat run` makes\n", path,
            kind == FILE_LAW ? "law" : "deck", command);
    return NULL;
  }
  char error[1024];
  result_file *f = result_read(path, error, sizeof error);
  if (!f) fprintf(stderr, "perilat: error: %s\n", error);
  return f;
}

table_names table_names_of(result_file *f, const char *group) {
  table_names n = {.text = result_members(f, group)};
  size_t most = 1;
  for (const char *c = n.text; *c; c++)
    most += *c == ',';
  n.items = must_calloc(most, sizeof *n.items);
  char *rest = NULL;
  for (char *name = strtok_r(n.text, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest))
    if (strcmp(name, "time") != 0) n.items[n.count++] = name;
  return n;
}

void table_names_free(table_names *n) {
  free(n->text);
  free(n->items);
}

int table_names_find(const table_names *n, const char *name) {
  for (int k = 0; k < n->count; k++)
    if (strcmp(n->items[k], name) == 0) return k;
  return -1;
}

bool table_read(result_file *f, const char *name, long frame, table_values *out, char *error,
                size_t size) {
  *out = (table_values){.name = name, .components = 1};
  if (frame < 0)
    out->values =
        result_read_series(f, name, &out->count, out->unit, sizeof out->unit, error, size);
  else
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
