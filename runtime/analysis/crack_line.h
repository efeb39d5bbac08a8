/* Openings of cracks along a line through a body: how far the two sides of damaged bonds have moved
   apart along the line, less what the bonds stretch elastically.

     from o----+----+----+----+----+----+----o to      stations, four a spacing, that move with
             \   u_k      u_(k+1)                      the cell of sites that holds them (tied.h)

   Between two stations the line is longer by T (u_(k+1) - u_k), with T its present direction, from
   its first to its last station, as a whole: what turns or slides is not counted. Bonds between the
   sites of both stations' cells say what of it is elastic: of a bond with the damage D and the
   stretch S the part (1 - D) S, where it is pressed all of it. The strain that fits these parts
   best, along the line, times the length, is taken off. (That is exact for each cell whose bonds
   fix all strains, where the force of a damaged bond is (1 - D) of an intact one's.)

   The core of a crack are neighbouring parts with a bond of more damage than `above` beside them,
   or a cut through the cell. What opens around it belongs to it as far as bonds are damaged at all,
   or half of the way to the next core. Where all is whole, or damaged without a core, nothing
   opens.

   Where rigid pieces part the width is their way along the line, to rounding; around a crack of a
   strained body the strain over a cell comes on top. */
#ifndef PERILAT_RUNTIME_CRACK_LINE_H
#define PERILAT_RUNTIME_CRACK_LINE_H

#include "runtime/interaction/damage.h"

typedef struct crack {
  double place, width; /* m: along the line from its beginning, in the reference state; opening */
  double weight;       /* m: of the parts that open, by which the place is their mean */
} crack;

typedef struct line_station { /* moves as these sites' weighted mean */
  int count;
  int32_t site[ROWS_MOST_COPIED];
  double weight[ROWS_MOST_COPIED];
} line_station;

typedef struct line_bond {
  int32_t i, j;         /* sites */
  rows_bond bond;       /* the same as laws know it */
  double length, share; /* m; of its elastic stretch in the strain along the line */
} line_bond;

typedef enum line_part { PART_WHOLE, PART_DAMAGED, PART_CORE } line_part;

typedef struct crack_line {
  const body *of;
  damage_law *laws; /* [law_count] */
  int law_count;
  double above, part, along[3]; /* part: m between stations; along the line, of length 1 */
  line_station *stations;       /* [parts + 1] */
  long parts;
  long *first;      /* [parts + 1] of the bonds of a part; in `bonds`, one part after the other */
  line_bond *bonds; /* of all parts */
  bool *cut;        /* [parts] some bond was cut away */
  /* in the state looked at last */
  line_part *what;    /* [parts] */
  double *opening;    /* [parts] m */
  long *owner, *away; /* [parts] crack that it belongs to, or -1; parts from its core */
  crack *cracks;      /* as many as there can be */
} crack_line;

/* Between two places; laws of damage are all at work on the body. NULL where some of it lies
   outside of all cells: the first such place is in outside[3] then. */
crack_line *crack_line_new(const body *of, const damage_law *laws, int law_count,
                           const double from[3], const double to[3], double above,
                           double outside[3]);
void crack_line_free(crack_line *l);
/* As many as there can be. */
long crack_line_most(const crack_line *l);
/* Cracks of the state observed, *count of them, from the line's beginning on; the line's own. */
const crack *crack_line_find(crack_line *l, long *count);
/* Width of the widest, m; 0 without. */
double crack_line_widest(crack_line *l);

#endif
