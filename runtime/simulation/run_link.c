#include "runtime/simulation/run_link.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/interaction/joint.h"

/* The only law of the link's body. */
static sweep *law_of(const run_link *link) {
  return link->own->laws[0].state;
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void take_copies(run_link *link, run_body *bodies) {
  const rows *g = link->own->lattice_rows;
  link->copies = must_calloc((size_t)g->particle_count + 1, sizeof *link->copies);
  for (long p = 0; p < g->particle_count; p++) {
    const run_body *from = &bodies[g->copies[p].lattice];
    link->copies[p] =
        (link_copy){from->body, from->lattice_rows->particle_site[g->copies[p].particle]};
  }
}

static void load_bodies(const run_link *link, int number, run_body *bodies) {
  const rows *g = link->own->lattice_rows;
  const sweep *law = law_of(link);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < law->body->dof; d++)
      loads_add_link(bodies[g->copies[p].lattice].loads, link->copies[p].site, d, number,
                     &law->force[d][g->particle_site[p]]);
}

run_link *run_links_new(run_body *bodies, int body_count, int *count) {
  run_link *links = must_calloc((size_t)body_count + 1, sizeof *links);
  *count = 0;
  for (int b = 0; b < body_count; b++) {
    if (!bodies[b].lattice_rows->copies) continue;
    run_link *link = &links[(*count)++];
    *link = (run_link){.own = &bodies[b]};
    take_copies(link, bodies);
    load_bodies(link, *count - 1, bodies);
  }
  for (int b = 0; b<body_count && * count> 0; b++)
    loads_links_added(bodies[b].loads);
  return links;
}

void run_links_free(run_link *links, int count) {
  for (int k = 0; k < count; k++)
    free(links[k].copies);
  free(links);
}

/* --- forces ----------------------------------------------------------------------------------- */

static void follow(const run_link *link) {
  const rows *g = link->own->lattice_rows;
  body *copy = link->own->body;
  for (long p = 0; p < g->particle_count; p++) {
    const long here = g->particle_site[p];
    const link_copy *c = &link->copies[p];
    for (int d = 0; d < copy->dof; d++) {
      copy->displacement[d][here] = c->of->displacement[d][c->site];
      copy->velocity[d][here] = c->of->velocity[d][c->site];
    }
  }
}

/* Of the forces over half of the way that the last step took. */
static void add_work(run_link *link) {
  const rows *g = link->own->lattice_rows;
  const sweep *law = law_of(link);
  double power = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long here = g->particle_site[p];
    for (int d = 0; d < law->body->dof; d++)
      power += law->force[d][here] * law->body->velocity[d][here];
  }
  link->work -= 0.5 * law->body->time_step * power;
}

/* What the law took in the last state becomes part of what it has taken. */
static void book_losses(const sweep *law) {
  for (long q = 0; law->lost_state && q < law->lattice->size; q++) {
    law->dissipated_state[q] += law->lost_state[q];
    law->dissipated_rate[q] += law->lost_rate[q];
  }
}

static void find_forces(run_link *link) {
  sweep *law = law_of(link);
  law->body->blocks[0].aside = true;
  for (int stage = 0; stage < law->engine.force_stages; stage++)
    law->engine.forces(law, stage, 0);
}

void run_link_begin(run_link *link) {
  if (link->known) return;
  follow(link);
  find_forces(link);
  link->known = true;
}

void run_link_step(run_link *link) {
  book_losses(law_of(link));
  follow(link);
  add_work(link);
  find_forces(link);
  add_work(link);
}
