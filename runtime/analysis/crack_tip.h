/* How far damage has come along a direction: the middle of the furthest damaged bond, in the
   reference place; of a law whose damage stands on particles alone, the furthest particle. */
#ifndef PERILAT_RUNTIME_CRACK_TIP_H
#define PERILAT_RUNTIME_CRACK_TIP_H

#include "runtime/interaction/damage.h"

typedef struct tip_place { /* where damage may be */
  double way;              /* m from the start, along the direction */
  int64_t index;           /* of a bond, or a site */
} tip_place;

typedef struct crack_tip {
  const sweep *state;
  const rows_bond *bonds; /* of the law, not owned */
  bool on_bonds;
  double above;      /* more damage than this counts */
  tip_place *places; /* [count] the furthest first; none behind the start */
  long count;
} crack_tip;

/* From `at` along `direction` (of any length), only where one end of the bond is `inside` ([size];
   NULL: everywhere). To be freed by crack_tip_free. */
crack_tip crack_tip_new(const damage_law *of, const double at[3], const double direction[3],
                        double above, const unsigned char *inside);
void crack_tip_free(crack_tip *t);
/* m; 0 where nothing is damaged. In the state observed, or `late` in that which the last step has
   left. */
double crack_tip_way(const crack_tip *t, bool late);

#endif
