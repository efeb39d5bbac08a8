/* The straight pieces of cracks, which hide nodes from points: node I does not act at x when the
   line from x to I meets a piece (visibility; Belytschko, Lu and Gu 1994; Karlsson 2006, 2.4).

            I
             \        The line x-I meets a -> b, ends included; a node on the crack's own line counts
       a------+---b   as on its left. The turn of three points a, b, c is
               \          o(a, b, c) = (b - a) x (c - a);
                x     x and I are on two sides where (o(a,b,x) >= 0) /= (o(a,b,I) >= 0), and the
                      piece is met where then o(x,I,a) o(x,I,b) <= 0. */
#ifndef PERILAT_RUNTIME_CRACK_LINES_H
#define PERILAT_RUNTIME_CRACK_LINES_H

#include <stdbool.h>

typedef struct crack_piece {
  double a[2], b[2]; /* m */
} crack_piece;

typedef struct crack_lines {
  crack_piece *pieces; /* [count] */
  int count, room;
  double (*tips)[2]; /* [tip_count] live tips, for the enriched basis */
  int tip_count;
} crack_lines;

void crack_lines_open(crack_lines *c);
void crack_lines_close(crack_lines *c);
void crack_lines_add(crack_lines *c, const double a[2], const double b[2]);

/* o(a, b, c) */
static inline double crack_turn(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
/* Whether the line from x to `node` meets the piece; `left`: o(a, b, x) >= 0. */
static inline bool crack_piece_parts(const crack_piece *p, bool left, const double x[2],
                                     const double node[2]) {
  if (left == (crack_turn(p->a, p->b, node) >= 0)) return false;
  return crack_turn(x, node, p->a) * crack_turn(x, node, p->b) <= 0;
}
static inline bool crack_piece_hides(const crack_piece *p, const double x[2],
                                     const double node[2]) {
  return crack_piece_parts(p, crack_turn(p->a, p->b, x) >= 0, x, node);
}

/* Those of `c` whose box meets that of lower .. upper: their numbers. Returns how many; at most
   `most` are written. */
int crack_lines_near(const crack_lines *c, const double lower[2], const double upper[2], int *near,
                     int most);

#endif
