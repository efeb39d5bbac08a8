#include "runtime/body/advance.h"

#include "runtime/base/clock.h"
#include "runtime/base/lane_sum.h"
#include "runtime/body/motion.h"

/* All components in one loop, with a literal number of them and what is the same for most bodies
   left out:

     next = decay v + part dt/m f (motion.h)

   Not 0 when a velocity is not below the limit (NaN is not below anything). */
static inline __attribute__((always_inline)) int64_t kick(const body *w, const body_block *b,
                                                          int row,
                                                          const double *const force[PL_MAX_DOF],
                                                          int dimensions, int dof, bool each_mass) {
  const long start = body_start(w, row), count = w->count[row], pitch = w->lattice->pitch;
  const double decay = w->decay, *v[PL_MAX_DOF], *mobility[2] = {NULL, NULL};
  double factor[PL_MAX_DOF], *restrict next = b->next;
  int64_t bad = 0;
  for (int d = 0; d < dof; d++) {
    v[d] = w->velocity[d] + start;
    factor[d] = motion_force_part(w) * w->time_step / w->mass[d];
    if (each_mass) mobility[d >= dimensions] = w->mobility[d >= dimensions] + start;
  }
  INDEPENDENT
  for (long q = 0; q < count; q++)
    for (int d = 0; d < dof; d++) {
      const double push = each_mass ? factor[d] * mobility[d >= dimensions][q] * force[d][q]
                                    : factor[d] * force[d][q];
      const double after = decay * v[d][q] + push;
      next[d * pitch + q] = after;
      bad |= __builtin_fabs(after) < w->limit[d] ? INT64_C(0) : INT64_C(1);
    }
  return bad;
}

/* With literal numbers of dimensions and components: without rotations and with them. */
static inline __attribute__((always_inline)) int64_t
kick_components(const body *of, const body_block *b, int row, const double *const force[PL_MAX_DOF],
                bool each_mass) {
  if (of->dof == 2) return kick(of, b, row, force, 2, 2, each_mass);
  if (of->dof == 6) return kick(of, b, row, force, 3, 6, each_mass);
  return of->dimensions == 2 ? kick(of, b, row, force, 2, 3, each_mass)
                             : kick(of, b, row, force, 3, 3, each_mass);
}

int64_t advance_kick(const body *of, const body_block *b, int row,
                     const double *const force[PL_MAX_DOF]) {
  const row_part whole = whole_row(of, row);
  int64_t bad = of->mobility[0] ? kick_components(of, b, row, force, true)
                                : kick_components(of, b, row, force, false);
  for (int d = 0; d < of->dof; d++)
    bad |= motion_push(of, &whole, d, b->next + d * of->lattice->pitch);
  return bad;
}

/* Work against the bonds: the force of a state counts over half of the way to it and half of the
   way from it (ledger.h). */
static double work_over(const body *of, int row, int component, const double *v) {
  return -0.5 * of->time_step *
         lane_dot(of->count[row], NULL, of->force[component] + body_start(of, row), v);
}

void advance_row(body *of, body_block *b, int row, const double *const force[PL_MAX_DOF]) {
  const row_part whole = whole_row(of, row);
  if (advance_kick(of, b, row, force)) {
    motion_note_bad(of, b, row, 0);
    return;
  }
  for (int d = 0; d < of->dof && of->works; d++)
    of->row_internal[row] += work_over(of, row, d, of->velocity[d] + body_start(of, row)) +
                             work_over(of, row, d, b->next + d * of->lattice->pitch);
  motion_drift(of, b, &whole);
}
