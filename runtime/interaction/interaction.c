#include "runtime/interaction/interaction.h"

#include <assert.h>

#include "runtime/interaction/family.h"
#include "runtime/interaction/joint.h"
#include "runtime/interaction/pairwise.h"

/* Blocks of laws of families read some of each other's rows: they have as many each. */
sweep *interaction_new(const rows *lattice, const pl_law *law, const double *parameters,
                       double time_step, int threads, bool ledger, bool forces) {
  const bool families = law->kind == PL_STATE;
  body *of = body_new(lattice, law->dof, time_step, threads,
                      families ? BODY_SHARE_ROWS : BODY_SHARE_SITES);
  of->ledger = ledger;
  of->forces = ledger || forces;
  of->works = ledger && !sweep_knows_losses(law);
  return sweep_new(of, law, parameters, families ? family_engine : pairwise_engine);
}

sweep *interaction_joint(const rows *lattice, const interaction_law *laws, int count,
                         double time_step, int threads, bool ledger, sweep **parts) {
  body *of = body_new(lattice, laws[0].law->dof, time_step, threads, BODY_SHARE_ROWS);
  of->ledger = ledger;
  for (int k = 0; k < count; k++)
    of->works = of->works || (ledger && !sweep_knows_losses(laws[k].law));
  of->forces = true;
  for (int k = 0; k < count; k++) {
    const interaction_law *l = &laws[k];
    assert(l->law->kind == PL_STATE);
    parts[k] = sweep_beside(of, l->lattice, l->law, l->parameters, l->share, family_engine);
    parts[k]->parameter = l->varying;
  }
  return joint_new(of, parts, count);
}
