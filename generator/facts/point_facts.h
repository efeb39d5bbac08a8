/* What a law of a continuum implies at rest: moduli and speeds of waves, in a setting. */
#ifndef PERILAT_GENERATOR_POINT_FACTS_H
#define PERILAT_GENERATOR_POINT_FACTS_H

#include "dsl/semantics/law.h"

typedef struct point_facts {
  law_setting setting;
  bool linear;          /* a mesh keeps its stiffness */
  bool isotropic;       /* what follows is known */
  double E, nu;         /* Pa, 1 */
  bool has_mass;        /* there are waves */
  double c_d, c_s, c_R; /* m/s: dilatational, shear, along a surface */
} point_facts;

enum { POINT_SETTINGS = 3 };

/* Of the settings that the law names, with these parameters (SI). Returns how many; a setting in
   which the law cannot be compiled is left out. */
int point_facts_of(const law *l, const double *values, point_facts found[POINT_SETTINGS]);

#endif
