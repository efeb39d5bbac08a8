#include "runtime/loads/tie_steps.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* --- set-up ----------------------------------------------------------------------------------- */

static double *values(long count) {
  return must_calloc((size_t)count + 1, sizeof(double));
}

static void number_nodes(tie_steps *t, int nodes) {
  t->node_number = must_calloc((size_t)nodes, sizeof *t->node_number);
  t->node = must_calloc((size_t)nodes, sizeof *t->node);
  for (int n = 0; n < nodes; n++)
    t->node_number[n] = -1;
  for (long p = 0; p < t->of->count; p++)
    for (int k = 0; k < t->of->particles[p].count; k++) {
      const int node = t->of->particles[p].node[k];
      if (t->node_number[node] >= 0) continue;
      t->node_number[node] = t->node_count;
      t->node[t->node_count++] = node;
    }
}

static void open_halves(tie_steps *t, const sweep *law, const double *parameters) {
  const rows *g = t->lattice.body->lattice;
  if (t->of->half_count == 0) return;
  half_bond *bonds = must_calloc((size_t)t->of->half_count, sizeof *bonds);
  int32_t *number = must_calloc((size_t)g->particle_count, sizeof *number);
  for (long p = 0; p < t->of->count; p++)
    number[t->of->particles[p].particle] = (int32_t)p;
  for (long n = 0; n < t->of->half_count; n++) {
    const tied_bond *b = &t->of->halves[n];
    const long other = rows_partner(g, b->site, b->direction);
    bonds[n] = (half_bond){b->site,
                           b->direction,
                           {number[g->site_particle[b->site]], number[g->site_particle[other]]}};
  }
  t->halves = half_bonds_new(law, parameters, bonds, t->of->half_count);
  free(number);
  free(bonds);
}

/* Forces on nodes, and moments of what is borne by halves on what turns. */
static void become_loads(tie_steps *t, const cells *c) {
  for (int n = 0; n < t->node_count; n++)
    for (int d = 0; d < 2; d++)
      loads_add_tie(t->mesh.loads, cells_site(c, t->node[n]), d, t->number, 1,
                    &t->node_force[d][n]);
  for (long p = 0; p < t->of->count && t->halves && t->lattice.body->dof > 2; p++)
    loads_add_tie(t->lattice.loads, t->site[p], 2, t->number, 1, &t->half[2][p]);
}

/* A point mass that a particle carries goes to the nodes as a whole. */
static void give_masses(const tie_steps *t, const cells *c) {
  body *lattice = t->lattice.body;
  const rows *g = lattice->lattice;
  for (long p = 0; p < t->of->count; p++) {
    const tied_particle *from = &t->of->particles[p];
    const double own = g->site_mass ? g->site_mass[t->site[p]] : g->mass,
                 carried = body_mass(lattice, 0, t->site[p]) - own,
                 mass = from->outside * own + carried;
    body_give_away(lattice, t->site[p]);
    for (int k = 0; k < from->count; k++)
      body_add_mass(t->mesh.body, cells_site(c, from->node[k]), from->weight[k] * mass, 0);
  }
}

void tie_steps_open(tie_steps *t, const mesh_tie *of, int number, tied_body lattice,
                    tied_body of_mesh, const cells *c, const sweep *law, const double *parameters) {
  *t = (tie_steps){.of = of, .number = number, .lattice = lattice, .mesh = of_mesh};
  t->site = must_calloc((size_t)of->count, sizeof *t->site);
  for (long p = 0; p < of->count; p++)
    t->site[p] = lattice.body->lattice->particle_site[of->particles[p].particle];
  number_nodes(t, mesh_node_count(&c->mesh));
  for (int d = 0; d < lattice.body->dof; d++) {
    t->force[d] = values(of->count);
    t->half[d] = values(of->count);
  }
  for (int d = 0; d < 2; d++) {
    t->velocity[d] = values(of->count);
    t->node_force[d] = values(t->node_count);
  }
  t->node_ahead = values(t->node_count);
  open_halves(t, law, parameters);
  become_loads(t, c);
  give_masses(t, c);
  for (int n = 0; n < t->node_count; n++)
    t->node[n] = (int)cells_site(c, t->node[n]);
}

void tie_steps_close(tie_steps *t) {
  for (int d = 0; d < PL_MAX_DOF; d++) {
    free(t->force[d]);
    free(t->half[d]);
  }
  for (int d = 0; d < 2; d++) {
    free(t->velocity[d]);
    free(t->node_force[d]);
  }
  half_bonds_free(t->halves);
  free(t->node_ahead);
  free(t->node_number);
  free(t->node);
  free(t->site);
}

/* --- a step ----------------------------------------------------------------------------------- */

static double mean_of(const tie_steps *t, const tied_particle *p, const double *of) {
  double sum = 0;
  for (int k = 0; k < p->count; k++)
    sum += p->weight[k] * of[t->node[t->node_number[p->node[k]]]];
  return sum;
}

/* The work against the bonds was counted over the way of a particle that is free. */
static void correct_way(tie_steps *t, long p, int d, double velocity) {
  const body *w = t->lattice.body;
  if (w->works)
    t->internal -=
        0.5 * w->time_step * w->force[d][t->site[p]] * (velocity - w->velocity[d][t->site[p]]);
}

void tie_steps_follow(tie_steps *t, bool stepped) {
  body *w = t->lattice.body;
  const body *nodes = t->mesh.body;
  for (long p = 0; p < t->of->count; p++)
    for (int d = 0; d < 2; d++) {
      const tied_particle *of = &t->of->particles[p];
      const double velocity = mean_of(t, of, nodes->velocity[d]);
      if (stepped) correct_way(t, p, d, velocity);
      w->displacement[d][t->site[p]] = mean_of(t, of, nodes->displacement[d]);
      w->velocity[d][t->site[p]] = t->velocity[d][p] = velocity;
    }
  if (!t->halves) return;
  half_bonds_find(t->halves, stepped);
  for (int d = 0; d < w->dof; d++)
    memset(t->half[d], 0, (size_t)t->of->count * sizeof(double));
  half_bonds_add(t->halves, t->half);
}

/* By the functions of the nodes, with what is borne by halves. */
static void share_out(tie_steps *t) {
  for (int d = 0; d < 2; d++) {
    memset(t->node_force[d], 0, (size_t)t->node_count * sizeof(double));
    for (long p = 0; p < t->of->count; p++) {
      const tied_particle *of = &t->of->particles[p];
      const double force = t->force[d][p] + t->half[d][p];
      for (int k = 0; k < of->count; k++)
        t->node_force[d][t->node_number[of->node[k]]] += of->weight[k] * force;
    }
  }
}

void tie_steps_give(tie_steps *t) {
  for (int d = 0; d < 2; d++)
    for (long p = 0; p < t->of->count; p++)
      t->force[d][p] = body_kicked_by(t->lattice.body, d, t->site[p], t->velocity[d][p]);
  share_out(t);
}

void tie_steps_see(tie_steps *t, long step) {
  const body *w = t->lattice.body;
  for (int d = 0; d < 2; d++)
    for (long p = 0; p < t->of->count; p++)
      t->force[d][p] = w->force[d][t->site[p]] + body_outer(w, d, t->site[p]);
  share_out(t);
  t->work = load_steps_see_tie(t->mesh.loads, t->mesh.body, t->number, step) +
            load_steps_see_tie(t->lattice.loads, w, t->number, step);
}

static void look_ahead(const tie_steps *t, int d, long step) {
  for (int n = 0; n < t->node_count; n++)
    t->node_ahead[n] =
        load_steps_velocities(t->mesh.loads, t->mesh.body, d, t->node[n], step).after;
  for (long p = 0; p < t->of->count; p++) {
    const tied_particle *of = &t->of->particles[p];
    double sum = 0;
    for (int k = 0; k < of->count; k++)
      sum += of->weight[k] * t->node_ahead[t->node_number[of->node[k]]];
    t->lattice.body->ahead[d][t->site[p]] = sum;
  }
}

void tie_steps_look(const tie_steps *t, load_look *look, long step) {
  for (int d = 0; d < 2; d++)
    look_ahead(t, d, step);
  const body *w = t->lattice.body;
  for (int d = 0; d < 2; d++)
    for (long p = 0; p < t->of->count; p++)
      look->free -= 0.5 * w->time_step * w->force[d][t->site[p]] * t->velocity[d][p];
  look->work -= t->work;
  look->internal += t->internal;
  if (!t->halves) return;
  look->stored += half_bonds_stored(t->halves);
  look->dissipated += half_bonds_taken(t->halves);
  look->given += half_bonds_given(t->halves);
}
