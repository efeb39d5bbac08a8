/* What an example's page says: its figures are those that the program has. */
#ifndef PERILAT_TESTS_PAGE_H
#define PERILAT_TESTS_PAGE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/model.h"

/* The first line of the page (a path in the sources) with `beginning` holds `figure`, too. */
static inline void page_line_says(const char *page_path, const char *beginning,
                                  const char *figure) {
  char error[512], path[512], line[1024];
  size_t length;
  snprintf(path, sizeof path, SOURCE_DIR "/%s", page_path);
  char *page = read_text_file(path, 1 << 20, &length, error, sizeof error);
  assert_non_null(page);
  const char *row = strstr(page, beginning);
  if (!row) fail_msg("%s has no line with %s", page_path, beginning);
  snprintf(line, sizeof line, "%.*s", (int)strcspn(row, "\n"), row);
  if (!strstr(line, figure)) fail_msg("%s\nshould say %s", line, figure);
  free(page);
}

#endif
