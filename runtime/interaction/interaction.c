#include "runtime/interaction/interaction.h"

#include <assert.h>

#include "runtime/interaction/family.h"
#include "runtime/interaction/joint.h"
#include "runtime/interaction/pairwise.h"

/* Blocks of laws of families read some of each other's rows: they have as many each. */
sweep *interaction_new(const rows *lattice, const pl_law *law, const double *parameters,
                       double time_step, int threads, body_ledger ledger, bool forces) {
  const bool families = law->kind == PL_STATE;
  body *of = body_new(lattice, law->dof, time_step, threads,
                      families ? BODY_SHARE_ROWS : BODY_SHARE_SITES);
  of->ledger = ledger != BODY_NO_LEDGER;
  of->forces = of->ledger || forces;
  of->works = of->ledger && !sweep_knows_losses(law, ledger == BODY_LOSSES);
  return sweep_new(of, law, parameters, families ? family_engine : pairwise_engine);
}

sweep *interaction_joint(const rows *lattice, const interaction_law *laws, int count,
                         double time_step, int threads, body_ledger ledger, sweep **parts) {
  body *of = body_new(lattice, laws[0].law->dof, time_step, threads, BODY_SHARE_ROWS);
  of->ledger = ledger != BODY_NO_LEDGER;
  for (int k = 0; k < count; k++)
    of->works =
        of->works || (of->ledger && !sweep_knows_losses(laws[k].law, ledger == BODY_LOSSES));
  of->forces = true;
  for (int k = 0; k < count; k++) {
    const interaction_law *l = &laws[k];
    assert(l->law->kind == PL_STATE);
    parts[k] = sweep_beside(of, l->lattice, l->law, l->parameters, l->share, family_engine);
    parts[k]->parameter = l->varying;
  }
  return joint_new(of, parts, count);
}
