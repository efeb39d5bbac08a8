#include "runtime/analysis/crack_tip.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/interaction/damage.h"

static int by_way(const void *a, const void *b) {
  const tip_place *x = a, *y = b;
  if (x->way > y->way || x->way < y->way) return x->way > y->way ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

static double way_to(const rows *g, long site, const double at[3], const double direction[3]) {
  double here[3], way = 0, square = 0;
  rows_place(g, site, here);
  for (int d = 0; d < 3; d++) {
    way += (here[d] - at[d]) * direction[d];
    square += direction[d] * direction[d];
  }
  return way / sqrt(square);
}

static void add(crack_tip *t, double way, int64_t index, bool inside) {
  if (way > 0 && inside) t->places[t->count++] = (tip_place){way, index};
}

crack_tip crack_tip_new(const damage_law *of, const double at[3], const double direction[3],
                        double above, const unsigned char *inside) {
  const rows *g = of->of->lattice;
  const rows_bond *bonds = of->bonds;
  crack_tip t = {
      .state = of->of, .bonds = bonds, .on_bonds = damage_on_bonds(of->of->law), .above = above};
  const long most = t.on_bonds ? of->bond_count : g->particle_count;
  t.places = must_calloc((size_t)most + 1, sizeof *t.places);
  for (long k = 0; k < most; k++) {
    const long i = g->particle_site[t.on_bonds ? bonds[k].i : k],
               j = t.on_bonds ? g->particle_site[bonds[k].j] : i;
    add(&t, 0.5 * (way_to(g, i, at, direction) + way_to(g, j, at, direction)), t.on_bonds ? k : i,
        (!inside || inside[i] || inside[j]) &&
            (!of->of->share || of->of->share[i] > 0 || of->of->share[j] > 0));
  }
  qsort(t.places, (size_t)t.count, sizeof *t.places, by_way);
  return t;
}

void crack_tip_free(crack_tip *t) {
  free(t->places);
}

double crack_tip_way(const crack_tip *t, bool late) {
  double *const *field = late ? t->state->field : t->state->new_field;
  for (long k = 0; k < t->count; k++) {
    const double damage = t->on_bonds
                              ? damage_of_bond_in(t->state, field, &t->bonds[t->places[k].index])
                              : damage_of_site_in(t->state, field, t->places[k].index);
    if (damage > t->above) return t->places[k].way;
  }
  return 0;
}
