#include "runtime/simulation/monitor_values.h"

#include <math.h>

#include "runtime/interaction/damage.h"
#include "runtime/loads/load_steps.h"
#include "runtime/simulation/monitor_field.h"

static double reaction_sum(const monitor *m, int list) {
  double sum = 0;
  for (long c = 0; c < m->index_count[list]; c++)
    sum += m->of[list]->loads->constraints[m->indices[list][c]].reaction;
  return sum;
}

static double applied_sum(const monitor *m) {
  double sum = 0;
  for (long c = 0; c < m->index_count[0]; c++)
    sum += m->of[0]->loads->forces[m->indices[0][c]].now;
  return sum;
}

static double contact_sum(const monitor *m) {
  double sum = 0;
  for (long p = 0; p < m->index_count[0]; p++)
    sum += body_outer(m->of[0]->body, m->deck->component, m->indices[0][p]);
  return sum;
}

/* The largest in size. */
static double slip_now(const monitor *m) {
  double largest = 0;
  for (long n = 0; n < m->index_count[0]; n++) {
    const double slip = run_link_slip(m->link, m->indices[0][n]);
    if (fabs(slip) > fabs(largest)) largest = slip;
  }
  return largest;
}

static bool is_counted(const monitor *m, double damage) {
  return m->deck->kind == MONITOR_BROKEN ? damage >= m->deck->above : damage > m->deck->above;
}

/* Place by place: several times as fast as bond by bond. */
static long count_in_places(const rows *g, const monitor *m, const double *damage) {
  const bool broken = m->deck->kind == MONITOR_BROKEN;
  const double above = m->deck->above;
  long count = 0;
  for (int k = 0; k < g->directions; k++, damage += g->size)
    for (long q = 0; q < g->size; q++)
      count += (long)(g->bonds[q] >> k & 1) & (broken ? damage[q] >= above : damage[q] > above);
  return count;
}

/* Of a bond that two laws of families bear the mean of what they say; it counts for that of its
   first end, and for the other not at all (-1). */
static double damage_once(const run_body *on, const run_law *of, const rows_bond *bond) {
  const int32_t *site = of->rows->particle_site;
  const double here = damage_of_bond(of->state, bond);
  if (!of->share || (of->share[site[bond->i]] > 0 && of->share[site[bond->j]] > 0)) return here;
  if (!(of->share[site[bond->i]] > 0)) return -1;
  double sum = here;
  for (int n = 0; n < on->law_count; n++)
    if (on->laws[n].share[site[bond->j]] > 0) sum += damage_of_bond(on->laws[n].state, bond);
  return 0.5 * sum;
}

/* Bonds, or particles where the law's damage is on particles alone. */
static long count_damaged(const run_body *on, const run_law *of, const monitor *m) {
  const rows *g = of->rows;
  const bool bonds = damage_on_bonds(of->law);
  const double *in_places = damage_of_all_bonds(of->state);
  long count = 0;
  if (in_places) return count_in_places(g, m, in_places);
  for (long b = 0; bonds && b < g->bond_count; b++) {
    const double damage = damage_once(on, of, &of->bonds[b]);
    count += damage >= 0 && is_counted(m, damage);
  }
  for (long p = 0; !bonds && p < g->particle_count; p++)
    if (!of->share || of->share[g->particle_site[p]] > 0)
      count += is_counted(m, damage_of_site(of->state, g->particle_site[p]));
  return count;
}

static double count_all_damaged(const monitors *all, const monitor *m) {
  long count = 0;
  for (int b = 0; b < all->body_count; b++)
    for (int n = 0; n < all->bodies[b].law_count && monitor_watches(all, m, b); n++)
      if (damage_on_any(all->bodies[b].laws[n].law))
        count += count_damaged(&all->bodies[b], &all->bodies[b].laws[n], m);
  return (double)count;
}

static double velocity_mean(const monitor *m, long step) {
  const run_body *of = m->of[0];
  double sum = 0;
  for (long p = 0; p < m->index_count[0]; p++)
    sum += load_steps_velocity(of->loads, of->body, m->deck->component, m->indices[0][p], step);
  return m->index_count[0] ? sum / (double)m->index_count[0] : 0;
}

static double displacement_mean(const monitor *m, int list) {
  return monitor_mean_at(m->of[list]->body->displacement[m->deck->component], m->indices[list],
                         m->index_count[list]);
}

typedef struct instant_velocities { /* what a velocity at an instant is known by */
  const run_body *of;
  long step;
} instant_velocities;

static velocity_instant velocities_at(const void *from, int component, long site) {
  const instant_velocities *v = from;
  return load_steps_velocities(v->of->loads, v->of->body, component, site, v->step);
}

/* What watched.h has. */
static double watched_now(const monitors *all, const monitor *m, long step, bool late) {
  const instant_velocities v = {m->of[0], step};
  bond_forces *forces = all->forces[m->of[0] - all->bodies];
  const watch_instant at = {.velocity = velocities_at,
                            .velocities = &v,
                            .forces = forces,
                            .late = late,
                            .scratch = all->values};
  if (watched_needs_forces(m->deck)) bond_forces_find(forces, step);
  return watched_value(m->own, &at);
}

static double stamp_now(const monitors *all, const monitor *m, long step) {
  const run_stamp *of = &all->stamps->items[m->stamp];
  const int c = m->deck->component;
  switch (m->deck->kind) {
  case MONITOR_STAMP_DISPLACEMENT:
    return of->state.at.place[c];
  case MONITOR_STAMP_VELOCITY:
    return run_stamp_velocity(all->stamps, m->stamp, c, step);
  case MONITOR_STAMP_MOMENT:
    return of->load.moment[c];
  default:
    return of->load.force[c];
  }
}

/* A value at the instant of the state observed. */
double monitor_value_now(const monitors *all, const monitor *m, long step) {
  if (m->gauge[1]) return mesh_gauge_value(m->gauge[1], step) - mesh_gauge_value(m->gauge[0], step);
  if (m->gauge[0]) return mesh_gauge_value(m->gauge[0], step);
  switch (m->deck->kind) {
  case MONITOR_REACTION:
    return reaction_sum(m, 0);
  case MONITOR_REACTIONS:
    return 0.5 * (reaction_sum(m, 1) - reaction_sum(m, 0));
  case MONITOR_APPLIED:
    return applied_sum(m);
  case MONITOR_DISPLACEMENT:
    return displacement_mean(m, 0);
  case MONITOR_VELOCITY:
    return velocity_mean(m, step);
  case MONITOR_OPENING:
    return displacement_mean(m, 1) - displacement_mean(m, 0);
  case MONITOR_SLIP:
    return slip_now(m);
  case MONITOR_CRACK:
    return tip_value_now(m->tips, &m->tips->items[m->tip], m->deck->value);
  case MONITOR_CONTACT_FORCE:
    return contact_sum(m);
  case MONITOR_STAMP_DISPLACEMENT:
  case MONITOR_STAMP_VELOCITY:
  case MONITOR_STAMP_FORCE:
  case MONITOR_STAMP_MOMENT:
    return stamp_now(all, m, step);
  case MONITOR_FIELD:
    return monitor_field_mean(all, m, false);
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
    return count_all_damaged(all, m);
  default:
    return watched_now(all, m, step, false);
  }
}

/* What a step has made known for a window: the velocity in it, the field of the state that it left;
   the same for all else. */
double monitor_value_of_step(const monitors *all, const monitor *m, long step) {
  const bool moves = m->deck->kind == MONITOR_VELOCITY || m->deck->kind == MONITOR_ACCELERATION;
  if (m->gauge[0] && moves) return mesh_gauge_velocity(m->gauge[0]);
  if (m->deck->kind == MONITOR_VELOCITY)
    return monitor_mean_at(m->of[0]->body->velocity[m->deck->component], m->indices[0],
                           m->index_count[0]);
  if (m->deck->kind == MONITOR_STAMP_VELOCITY)
    return all->stamps->items[m->stamp].state.at.velocity[m->deck->component];
  if (m->deck->kind == MONITOR_FIELD) return monitor_field_mean(all, m, true);
  if (m->deck->kind == MONITOR_ACCELERATION) return watched_velocity(m->own);
  if (m->own) return watched_now(all, m, step, true);
  return monitor_value_now(all, m, step);
}
