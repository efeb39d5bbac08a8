#include "generator/drive/drive_table.h"

#include <string.h>

int drive_column_find(const drive_table *t, const char *name) {
  for (int k = 0; k < t->column_count; k++)
    if (strcmp(t->columns[k].name, name) == 0) return k;
  return -1;
}

void drive_add_column(drive_table *t, const char *name, const char *unit_text, long room) {
  if (drive_column_find(t, name) >= 0) name = arena_printf(t->memory, "law_%s", name);
  t->columns[t->column_count++] =
      (drive_column){arena_text(t->memory, name, strlen(name)),
                     arena_text(t->memory, unit_text, strlen(unit_text)),
                     arena_alloc(t->memory, (size_t)room * sizeof(double))};
}

void drive_table_free(drive_table *t) {
  arena_free(t->memory);
  *t = (drive_table){.memory = NULL};
}
