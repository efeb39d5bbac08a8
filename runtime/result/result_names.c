#include "runtime/result/result_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"

void result_names_add(result_names *n, const char *folder, const char *name) {
  const size_t size = strlen(folder) + strlen(name) + 2;
  if ((n->count & (n->count - 1)) == 0) /* room is the power of two at or above the count */
    n->items = must_realloc(n->items, (n->count ? 2 * (size_t)n->count : 1) * sizeof *n->items);
  char *item = n->items[n->count++] = must_alloc(size);
  snprintf(item, size, "%s%s%s", folder, *folder ? "/" : "", name);
}

void result_names_free(result_names *n) {
  for (int k = 0; k < n->count; k++)
    free(n->items[k]);
  free(n->items);
  name_index_clear(&n->whole);
  name_index_clear(&n->last);
  *n = (result_names){0};
}

const char *result_names_last(const char *name) {
  const char *slash = strrchr(name, '/');
  return slash ? slash + 1 : name;
}

static bool is_sum(const char *name) {
  return strncmp(name, "energy/", 7) == 0;
}

void result_names_index(result_names *n) {
  for (int k = 0; k < n->count; k++) {
    name_index_add(&n->whole, n->items[k], k);
    int *of_part = name_index_add(&n->last, result_names_last(n->items[k]), k);
    if (*of_part == k || (*of_part >= 0 && is_sum(n->items[*of_part]))) continue;
    *of_part = is_sum(n->items[k]) ? k : -1;
  }
}

int result_names_find(const result_names *n, const char *given) {
  const int found = name_index_find(&n->whole, given);
  return found >= 0 ? found : name_index_find(&n->last, given);
}

const char *result_names_near(const result_names *n, const char *given) {
  const char **candidates = must_calloc(2 * (size_t)n->count + 1, sizeof *candidates);
  for (int k = 0; k < n->count; k++) {
    candidates[k] = n->items[k];
    candidates[n->count + k] = result_names_last(n->items[k]);
  }
  const char *near = nearest_name(given, candidates, 2 * n->count);
  free(candidates);
  return near;
}
