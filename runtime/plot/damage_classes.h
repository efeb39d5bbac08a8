/* The classes in which damage is shown: those of Asadollahi (2014, table 4.3), up to 0.3 yellow,
   0.6 orange, 0.8 brown, below 1 red; separated bonds black. */
#ifndef PERILAT_RUNTIME_DAMAGE_CLASSES_H
#define PERILAT_RUNTIME_DAMAGE_CLASSES_H

#include "runtime/plot/canvas.h"

typedef struct damage_class {
  double up_to;
  colour ink;
  const char *text; /* of two damages: what stands behind the name of one */
  int of;           /* of two damages: 0, 1 */
} damage_class;

/* The worse below the better; the last is that of separated bonds. */
enum { DAMAGE_CLASSES = 6 };
extern const damage_class damage_classes[DAMAGE_CLASSES];
int damage_class_of(double damage);

#endif
