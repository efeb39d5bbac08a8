/* What is known of a law: its text, its cost, and what it implies on a lattice. */
#ifndef PERILAT_GENERATOR_LAW_FACTS_H
#define PERILAT_GENERATOR_LAW_FACTS_H

#include "dsl/base/diagnostics_json.h"
#include "generator/kernel/model.h"
#include "generator/plan/plan.h"
#include "runtime/analysis/implied.h"
#include "runtime/analysis/stability.h"
#include "runtime/deck/deck.h"

typedef struct implied {
  implied_elasticity elastic;
  bool stiff;
  double strength[2], strain[2]; /* under uniform uniaxial strain along x, y */
  implied_bond bond;
  double crack[2]; /* N/m; opening along x, y */
  implied_waves waves;
  step_limit step;
  bool has_mass;
  int neighbours;
} implied;

typedef struct law_facts {
  arena *memory;
  source_set sources;
  diagnostics said;
  diag_json *report; /* or NULL */
  model model;
  deck_material material;
  pl_law *law;         /* interpreted */
  double *values;      /* [parameters] */
  bool *given;         /* a default or a setting */
  const char *missing; /* a parameter without a value, or NULL */
  deck_lattice lattice;
  implied implied;
} law_facts;

/* Whether a lattice of such bonds says something: not without all values, nor of laws of slip. */
bool law_facts_has_implied(const law_facts *f);
/* "micropolar bond" */
const char *law_kind_text(const law *l);
bool law_facts_of_families(const law_facts *f);
/* Passes over the bonds in a step. */
int law_facts_passes(const kernel_plan *p);
/* Bytes that one bond reads and writes in a step, most of them from a cache: neighbouring bonds
   share their ends. */
long law_facts_bytes(const kernel_plan *p);

#endif
