#include "runtime/mesh/crack_lines.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

void crack_lines_open(crack_lines *c) {
  *c = (crack_lines){.count = 0};
}

void crack_lines_close(crack_lines *c) {
  free(c->pieces);
  free(c->tips);
  crack_lines_open(c);
}

void crack_lines_add(crack_lines *c, const double a[2], const double b[2]) {
  if (c->count == c->room) {
    c->room = c->room ? 2 * c->room : 16;
    c->pieces = must_realloc(c->pieces, (size_t)c->room * sizeof *c->pieces);
  }
  crack_piece *p = &c->pieces[c->count++];
  memcpy(p->a, a, sizeof p->a);
  memcpy(p->b, b, sizeof p->b);
}

int crack_lines_near(const crack_lines *c, const double lower[2], const double upper[2], int *near,
                     int most) {
  int count = 0;
  for (int k = 0; k < c->count; k++) {
    const crack_piece *p = &c->pieces[k];
    bool apart = false;
    for (int a = 0; a < 2; a++)
      apart = apart || pl_max(p->a[a], p->b[a]) < lower[a] || pl_min(p->a[a], p->b[a]) > upper[a];
    if (apart) continue;
    if (count < most) near[count] = k;
    count++;
  }
  return count;
}
