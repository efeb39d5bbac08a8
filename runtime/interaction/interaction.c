#include "runtime/interaction/interaction.h"

#include "runtime/interaction/family.h"
#include "runtime/interaction/pairwise.h"

/* Blocks of laws of families read some of each other's rows: they have as many each. */
sweep *interaction_new(const rows *lattice, const pl_law *law, const double *parameters,
                       double time_step, int threads, bool ledger, bool forces) {
  const bool families = law->kind == PL_STATE;
  body *of = body_new(lattice, law->dof, time_step, threads,
                      families ? BODY_SHARE_ROWS : BODY_SHARE_SITES);
  of->ledger = ledger;
  of->forces = ledger || forces;
  of->works = ledger && !sweep_books_losses(law);
  return sweep_new(of, law, parameters, families ? family_engine : pairwise_engine);
}
