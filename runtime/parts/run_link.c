#include "runtime/parts/run_link.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/interaction/joint.h"

/* The only law of the link's body. */
static sweep *law_of(const run_link *link) {
  return link->own->laws[0].state;
}

/* --- set-up ----------------------------------------------------------------------------------- */

static int64_t site_of(const run_body *of, int32_t particle) {
  return of->lattice_rows->particle_site[particle];
}

static link_copy follower_of(const rows_copy *c, run_body *bodies, int bar) {
  const run_body *from = &bodies[c->lattice], *along = &bodies[bar];
  link_copy f = {.of = from->body, .count = c->count};
  for (int k = 0; k < c->count; k++) {
    f.site[k] = site_of(from, c->particle[k]);
    f.weight[k] = c->weight[k];
  }
  if (!c->along) return f;
  double start[3], end[3];
  f.bar = along->body;
  f.at = site_of(along, c->at);
  f.before = site_of(along, c->before);
  f.after = site_of(along, c->after);
  f.ahead = c->ahead;
  rows_place(along->lattice_rows, f.before, start);
  rows_place(along->lattice_rows, f.after, end);
  for (int a = 0; a < 3; a++)
    f.tangent[a] = end[a] - start[a];
  return f;
}

static void take_copies(run_link *link, run_body *bodies) {
  const rows *g = link->own->lattice_rows;
  link->copies = must_calloc((size_t)g->particle_count + 1, sizeof *link->copies);
  for (int d = 0; d < g->dimensions; d++)
    link->couple[d] = must_calloc((size_t)g->particle_count + 1, sizeof(double));
  for (long p = 0; p < g->particle_count; p++)
    link->copies[p] = follower_of(&g->copies[p], bodies, g->copies[0].lattice);
}

/* End moments of copies that turn with a bar act on nothing (tied.h). */
static int components_of(const run_link *link, const link_copy *c) {
  return c->bar ? link->own->body->dimensions : link->own->body->dof;
}

static bool has_couple(const link_copy *c) {
  return c->ahead > 0;
}

static void load_bar(const run_link *link, int number, loads *bar, long p) {
  const link_copy *c = &link->copies[p];
  for (int d = 0; d < link->own->body->dimensions && has_couple(c); d++) {
    loads_add_link(bar, c->after, d, number, 1, &link->couple[d][p]);
    loads_add_link(bar, c->before, d, number, -1, &link->couple[d][p]);
  }
}

static void load_bodies(const run_link *link, int number, run_body *bodies) {
  const rows *g = link->own->lattice_rows;
  const sweep *law = law_of(link);
  for (long p = 0; p < g->particle_count; p++) {
    const link_copy *c = &link->copies[p];
    load_bar(link, number, bodies[g->copies[0].lattice].loads, p);
    for (int k = 0; k < c->count; k++)
      for (int d = 0; d < components_of(link, c); d++)
        loads_add_link(bodies[g->copies[p].lattice].loads, c->site[k], d, number, c->weight[k],
                       &law->force[d][g->particle_site[p]]);
  }
}

/* Of a body's particles, which a tie moves; NULL: none. */
static unsigned char *tied_of(const run_body *b) {
  if (b->tie_count == 0) return NULL;
  unsigned char *tied = must_calloc((size_t)b->lattice_rows->particle_count + 1, 1);
  for (int n = 0; n < b->tie_count; n++)
    for (long p = 0; p < b->ties[n].count; p++)
      tied[b->ties[n].particles[p].particle] = 1;
  return tied;
}

static void refuse_tied(const deck *k, const run_body *link, const run_body *to, int32_t particle,
                        diagnostics *d) {
  const deck_item *item = &k->lattices[link->lattice].item;
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(to->lattice_rows, site_of(to, particle), at);
  for (int a = 0; a < 2; a++)
    if (fabs(at[a]) < 1e-9 * to->lattice_rows->spacing) at[a] = 0; /* rounding */
  diag_report(d, DIAG_CONFLICT, item->where,
              "the link `%s` reaches the particle of `%s` at %s, which is tied to a mesh",
              link->name, to->name, rows_place_text(2, at, text));
  diag_hint(d, "end the bar farther from the mesh, or choose other particles of it: `first`, "
               "`every`; a smaller `within` reaches less far");
}

bool run_links_are_free(const run_body *bodies, int body_count, const deck *k, diagnostics *d) {
  bool good = true;
  for (int t = 0; t < body_count; t++) {
    unsigned char *tied = tied_of(&bodies[t]);
    for (int b = 0; b < body_count && tied; b++) {
      const rows *g = bodies[b].lattice_rows;
      bool free_here = true;
      for (long p = 0; g && g->copies && p < g->particle_count && free_here; p++)
        for (int n = 0; n < g->copies[p].count && free_here; n++) {
          const rows_copy *c = &g->copies[p];
          free_here = c->lattice != t || !tied[c->particle[n]];
          if (!free_here) refuse_tied(k, &bodies[b], &bodies[t], c->particle[n], d);
        }
      good = good && free_here;
    }
    free(tied);
  }
  return good;
}

run_link *run_links_new(run_body *bodies, int body_count, int *count) {
  run_link *links = must_calloc((size_t)body_count + 1, sizeof *links);
  *count = 0;
  for (int b = 0; b < body_count; b++) {
    if (!bodies[b].lattice_rows->copies) continue;
    run_link *link = &links[(*count)++];
    *link = (run_link){.own = &bodies[b], .number = *count - 1};
    take_copies(link, bodies);
    load_bodies(link, *count - 1, bodies);
  }
  if (*count == 0) return links;
  for (int b = 0; b < body_count; b++)
    loads_links_added(bodies[b].loads);
  return links;
}

void run_links_free(run_link *links, int count) {
  for (int k = 0; k < count; k++) {
    free(links[k].copies);
    for (int d = 0; d < 3; d++)
      free(links[k].couple[d]);
  }
  free(links);
}

/* --- where copies are ------------------------------------------------------------------------- */

typedef struct copy_range {
  long first, end;
} copy_range;

static copy_range part_of(long count, int part, int parts) {
  return (copy_range){count * part / parts, count * (part + 1) / parts};
}

static double mean_of(const link_copy *c, double *const *values, int d) {
  double sum = 0;
  for (int k = 0; k < c->count; k++)
    sum += c->weight[k] * values[d][c->site[k]];
  return sum;
}

/* The bar's unit tangent now. Returns how far apart the particles are that it goes through. */
static double find_tangent(const link_copy *c, double now[3]) {
  double length = 0;
  for (int a = 0; a < 3; a++)
    now[a] = c->tangent[a];
  for (int a = 0; a < c->bar->dimensions; a++)
    now[a] += c->bar->displacement[a][c->after] - c->bar->displacement[a][c->before];
  for (int a = 0; a < 3; a++)
    length += now[a] * now[a];
  length = sqrt(length);
  for (int a = 0; a < 3; a++)
    now[a] /= length;
  return length;
}

/* The unit tangent in the reference state, and how quickly it turns now. */
static void find_turning(link_copy *c, double then[3], double spin[3]) {
  double before = 0;
  c->chord = find_tangent(c, c->along);
  for (int a = 0; a < c->bar->dimensions; a++)
    c->chord_rate[a] = c->bar->velocity[a][c->after] - c->bar->velocity[a][c->before];
  for (int a = 0; a < 3; a++)
    before += c->tangent[a] * c->tangent[a];
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, e = (a + 2) % 3;
    spin[a] = (c->along[b] * c->chord_rate[e] - c->along[e] * c->chord_rate[b]) / c->chord;
    then[a] = c->tangent[a] / sqrt(before);
  }
}

double run_link_slip(const run_link *link, long particle) {
  const link_copy *c = &link->copies[particle];
  double now[3], slip = 0;
  find_tangent(c, now);
  for (int a = 0; a < c->bar->dimensions; a++)
    slip += now[a] * (mean_of(c, c->of->displacement, a) - c->bar->displacement[a][c->at]);
  return slip;
}

/* By the shortest turn that takes the tangent from what it was to what it is. */
static void turn_copy(body *copy, long here, const double then[3], const double now[3],
                      const double spin[3]) {
  double axis[3], sine = 0, cosine = 0;
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, e = (a + 2) % 3;
    axis[a] = then[b] * now[e] - then[e] * now[b];
    sine += axis[a] * axis[a];
    cosine += then[a] * now[a];
  }
  sine = sqrt(sine);
  const double angle = pl_atan2(sine, cosine), part = sine > 0 ? angle / sine : 1;
  for (int d = copy->dimensions; d < copy->dof; d++) {
    const int a = copy->dimensions == 2 ? 2 : d - copy->dimensions;
    copy->displacement[d][here] = part * axis[a];
    copy->velocity[d][here] = spin[a];
  }
}

/* A place is shown further along the bar's tangent, and turns with it. */
static void follow_bar(link_copy *c, body *copy, long here) {
  double then[3], spin[3];
  const double *now = c->along;
  find_turning(c, then, spin);
  turn_copy(copy, here, then, now, spin);
  for (int a = 0; a < copy->dimensions; a++) {
    const int b = (a + 1) % 3, e = (a + 2) % 3;
    copy->displacement[a][here] += c->ahead * (now[a] - then[a]);
    copy->velocity[a][here] += c->ahead * (spin[b] * now[e] - spin[e] * now[b]);
  }
}

static void follow(const run_link *link, copy_range of) {
  const rows *g = link->own->lattice_rows;
  body *copy = link->own->body;
  for (long p = of.first; p < of.end; p++) {
    const long here = g->particle_site[p];
    link_copy *c = &link->copies[p];
    for (int d = 0; d < components_of(link, c); d++) {
      copy->displacement[d][here] = c->way[d] = mean_of(c, c->of->displacement, d);
      copy->velocity[d][here] = c->rate[d] = mean_of(c, c->of->velocity, d);
    }
    if (c->bar) follow_bar(c, copy, here);
  }
}

/* --- forces ----------------------------------------------------------------------------------- */

/* Of the forces known, with the present velocities. */
static void add_power(run_link *link, copy_range of) {
  const rows *g = link->own->lattice_rows;
  const sweep *law = law_of(link);
  for (long p = of.first; p < of.end; p++) {
    link_copy *c = &link->copies[p];
    for (int d = 0; d < components_of(link, c); d++)
      c->power += law->force[d][g->particle_site[p]] * c->rate[d];
    for (int d = 0; d < law->body->dimensions && has_couple(c); d++)
      c->power += link->couple[d][p] * c->chord_rate[d];
  }
}

/* Each of the forces over half of the way that the last step took. */
static void add_work(run_link *link) {
  double power = 0;
  for (long p = 0; p < link->own->lattice_rows->particle_count; p++) {
    power += link->copies[p].power;
    link->copies[p].power = 0;
  }
  link->work -= 0.5 * link->own->body->time_step * power;
}

/* What the law took in the last state becomes part of what it has taken. */
static void book_losses(const sweep *law) {
  for (long q = 0; law->lost_state && q < law->lattice->size; q++) {
    law->dissipated_state[q] += law->lost_state[q];
    law->dissipated_rate[q] += law->lost_rate[q];
    if (law->given_by_rest) law->given_by_rest[q] += law->given_now[q];
  }
}

static void find_forces(run_link *link) {
  sweep *law = law_of(link);
  law->body->blocks[0].aside = true;
  for (int stage = 0; stage < law->engine.force_stages; stage++)
    law->engine.forces(law, stage, 0);
}

/* The force F on a place and its opposite on the bar's particle, from which the place is now by r,
   turn the bodies by r x F. The bond's energy does not change where place and bar turn together:
   so it takes a couple -r x F to turn the bar's tangent alone, and momentum about any point stays.
 */
static void find_couples(run_link *link, copy_range of) {
  const rows *g = link->own->lattice_rows;
  const sweep *law = law_of(link);
  for (long p = of.first; p < of.end; p++) {
    const link_copy *c = &link->copies[p];
    double r[3] = {0, 0, 0}, f[3] = {0, 0, 0}, m[3];
    if (!has_couple(c)) continue;
    for (int a = 0; a < law->body->dimensions; a++) {
      r[a] = c->way[a] - c->bar->displacement[a][c->at];
      f[a] = law->force[a][g->particle_site[p]];
    }
    for (int a = 0; a < 3; a++) {
      const int b = (a + 1) % 3, e = (a + 2) % 3;
      m[a] = f[b] * r[e] - f[e] * r[b];
    }
    for (int a = 0; a < law->body->dimensions; a++) {
      const int b = (a + 1) % 3, e = (a + 2) % 3;
      link->couple[a][p] = (m[b] * c->along[e] - m[e] * c->along[b]) / c->chord;
    }
  }
}

/* --- a state ---------------------------------------------------------------------------------- */

static copy_range all_of(const run_link *link) {
  return (copy_range){0, link->own->lattice_rows->particle_count};
}

void run_link_begin(run_link *link) {
  if (link->known) return;
  follow(link, all_of(link));
  find_forces(link);
  find_couples(link, all_of(link));
  link->known = true;
}

/* A law's forces, and sums, are the business of one thread for each link. */
void run_link_step(run_link *link, int stage, int part, int parts) {
  const copy_range mine = part_of(all_of(link).end, part, parts);
  const bool whole = part == link->number % parts;
  if (stage == 0) {
    follow(link, mine);
    add_power(link, mine);
  } else if (stage == 1 && whole) {
    book_losses(law_of(link));
    find_forces(link);
  } else if (stage == 2) {
    find_couples(link, mine);
    add_power(link, mine);
  } else if (stage == 3 && whole) {
    add_work(link);
  }
}
