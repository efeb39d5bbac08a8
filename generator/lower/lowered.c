#include "generator/lower/lowered.h"

int lowered_forces(lowered_law *p, ir_node **forces) {
  ir_node *all[LOWERED_FORCES] = {&p->N};
  int count = 1, given = 0;
  for (int k = 0; k < BENDING_AXES; k++)
    all[count++] = &p->M_i[k];
  for (int k = 0; k < BENDING_AXES; k++)
    all[count++] = &p->M_j[k];
  all[count++] = &p->T;
  all[count++] = &p->F;
  for (int k = 0; k < FORCE_AXES; k++)
    all[count++] = &p->F_of[k];
  for (int k = 0; k < LOWERED_STRESSES; k++)
    all[count++] = &p->sigma[k];
  for (int k = 0; k < LOWERED_TIP; k++)
    all[count++] = &p->tip[k];
  for (int k = 0; k < count; k++)
    if (*all[k] != IR_NONE) forces[given++] = all[k];
  return given;
}
