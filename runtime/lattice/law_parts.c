#include "runtime/lattice/law_parts.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/lattice/rows_select.h"

typedef struct law_owners {
  const deck *deck;
  const deck_interaction *laws; /* [count] the first is that of the whole lattice */
  int count;
  const rows *rows;
  const deck_material **material; /* [size] of the region of the particle there; NULL: of none */
  int *of_site;                   /* [size] law of the particle there */
  unsigned char **inside[2]; /* [count] of laws between regions: [size] 1 in its first, second */
  diagnostics *said;
} law_owners;

/* --- whose a particle is ---------------------------------------------------------------------- */

static bool report_two(const law_owners *o, const deck_material *first, const deck_material *second,
                       int64_t site) {
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(o->rows, site, at);
  diag_report(o->said, DIAG_CONFLICT, deck_where(&second->item, "region"),
              "the particle at %s has two materials: it is in the region `%s`, too",
              rows_place_text(o->rows->dimensions, at, text), first->region);
  diag_note(o->said, deck_where(&first->item, "region"), "its first material is given here");
  diag_hint(o->said, "give the regions shapes that have no particle in common");
  return false;
}

/* Particles of a region of another law, or of one with the law of the lattice. */
static bool take_region(law_owners *o, const deck_material *m, int law) {
  int32_t *particles;
  const int region = deck_find_region(o->deck, m->region);
  const long count = rows_select(o->rows, &o->deck->regions[region].shape, &particles);
  bool good = true;
  for (long n = 0; n < count && good; n++) {
    const int32_t site = o->rows->particle_site[particles[n]];
    if (o->material[site]) good = report_two(o, o->material[site], m, site);
    o->material[site] = m;
    o->of_site[site] = law;
  }
  free(particles);
  return good;
}

static bool find_owners(law_owners *o) {
  const deck_material *whole = o->laws[0].material;
  bool good = true;
  o->of_site = must_calloc((size_t)o->rows->size, sizeof *o->of_site);
  o->material = must_calloc((size_t)o->rows->size, sizeof(const deck_material *));
  for (int n = 0; n < whole->regional_count; n++)
    good = take_region(o, whole->regional[n], 0) && good;
  for (int law = 1; law < o->count; law++)
    if (o->laws[law].material->region) good = take_region(o, o->laws[law].material, law) && good;
  return good;
}

/* --- whose a bond is -------------------------------------------------------------------------- */

static unsigned char *inside_of(const law_owners *o, const char *name) {
  int32_t *particles;
  unsigned char *inside = must_calloc((size_t)o->rows->size, 1);
  const int region = deck_find_region(o->deck, name);
  const long count = rows_select(o->rows, &o->deck->regions[region].shape, &particles);
  for (long n = 0; n < count; n++)
    inside[o->rows->particle_site[particles[n]]] = 1;
  free(particles);
  return inside;
}

/* A bond between two regions leads from one into the other. */
static bool are_apart(const law_owners *o, int law) {
  const deck_material *m = o->laws[law].material;
  for (long p = 0; p < o->rows->particle_count; p++) {
    const long site = o->rows->particle_site[p];
    double at[3];
    char text[ROWS_PLACE_TEXT];
    if (!o->inside[0][law][site] || !o->inside[1][law][site]) continue;
    rows_place(o->rows, site, at);
    diag_report(o->said, DIAG_CONFLICT, deck_where(&m->item, "between"),
                "the particle at %s is in both regions, `%s` and `%s`",
                rows_place_text(o->rows->dimensions, at, text), m->between[0], m->between[1]);
    diag_hint(o->said, "give the regions shapes that have no particle in common");
    return false;
  }
  return true;
}

static bool find_insides(law_owners *o) {
  bool good = true;
  for (int end = 0; end < 2; end++) {
    o->inside[end] = must_calloc((size_t)o->count, sizeof *o->inside[end]);
    for (int law = 1; law < o->count; law++)
      if (o->laws[law].material->between[0])
        o->inside[end][law] = inside_of(o, o->laws[law].material->between[end]);
  }
  for (int law = 1; law < o->count; law++)
    good = (!o->inside[0][law] || are_apart(o, law)) && good;
  return good;
}

/* Both ends stand in one region that has a material. */
static bool is_inside(const law_owners *o, long i, long j) {
  return o->material[i] && o->material[i] == o->material[j];
}

static bool joins(const law_owners *o, int law, long i, long j) {
  const unsigned char *a = o->inside[0][law], *b = o->inside[1][law];
  return a && !is_inside(o, i, j) && ((a[i] && b[j]) || (a[j] && b[i]));
}

/* The second law between regions that claims the bond, or 0. */
static int second_claim(const law_owners *o, long i, long j) {
  int claims = 0;
  for (int law = 1; law < o->count; law++)
    if (joins(o, law, i, j) && claims++ > 0) return law;
  return 0;
}

static bool bonds_have_one(const law_owners *o) {
  const rows *w = o->rows;
  for (long p = 0; p < w->particle_count; p++)
    for (int k = 0; k < w->directions; k++) {
      const long i = w->particle_site[p], j = rows_partner(w, i, k);
      const int second = rows_has_bond(w, i, k) ? second_claim(o, i, j) : 0;
      double at[3];
      char text[ROWS_PLACE_TEXT];
      if (second == 0) continue;
      const deck_material *m = o->laws[second].material;
      rows_place(w, i, at);
      diag_report(o->said, DIAG_CONFLICT, deck_where(&m->item, "between"),
                  "a bond of the particle at %s has two materials: it joins other regions, too",
                  rows_place_text(w->dimensions, at, text));
      diag_hint(o->said, "give the regions shapes that have no particle in common");
      return false;
    }
  return true;
}

static int owner_of_bond(const law_owners *o, long i, long j) {
  for (int law = 1; law < o->count; law++)
    if (joins(o, law, i, j)) return law;
  return o->of_site[i] == o->of_site[j] ? o->of_site[i] : 0;
}

static bool has_bond(const law_owners *o, bool families, int law, long i, long j) {
  return families ? o->of_site[i] == law || o->of_site[j] == law : owner_of_bond(o, i, j) == law;
}

static uint64_t *bonds_of(const law_owners *o, bool families, int law) {
  const rows *w = o->rows;
  uint64_t *bonds = rows_array(w->size, sizeof *bonds);
  for (long p = 0; p < w->particle_count; p++) {
    const long i = w->particle_site[p];
    for (int k = 0; k < w->directions; k++)
      if (rows_has_bond(w, i, k) && has_bond(o, families, law, i, rows_partner(w, i, k)))
        bonds[i] |= UINT64_C(1) << k;
  }
  return bonds;
}

static unsigned char *own_of(const law_owners *o, int law) {
  unsigned char *own = must_calloc((size_t)o->rows->size, 1);
  for (long p = 0; p < o->rows->particle_count; p++) {
    const long site = o->rows->particle_site[p];
    own[site] = o->of_site[site] == law;
  }
  return own;
}

static double *share_of(const rows *w, const unsigned char *own) {
  double *share = rows_array(w->size, sizeof *share);
  for (long q = 0; q < w->size; q++)
    share[q] = own[q];
  return share;
}

/* --- all of them ------------------------------------------------------------------------------ */

static bool suits_families(const law_owners *o) {
  for (int law = 1; law < o->count; law++) {
    const deck_material *m = o->laws[law].material;
    if (!m->between[0]) continue;
    diag_report(o->said, DIAG_NOT_SUPPORTED, deck_where(&m->item, "between"),
                "`between` is for laws of bonds: here a bond bears the mean of what the families "
                "of its two ends say");
    return false;
  }
  return true;
}

static bool is_for_something(const law_owners *o, int law, const rows *bonds) {
  const deck_material *m = o->laws[law].material;
  if (bonds->bond_count > 0) return true;
  if (law == 0)
    diag_report(o->said, DIAG_EMPTY_REGION, m->item.where,
                "this material is for nothing: all bonds of `%s` belong to other materials",
                o->laws[0].name);
  else if (m->region)
    diag_report(o->said, DIAG_EMPTY_REGION, deck_where(&m->item, "region"),
                "this material is for nothing: no bond has both ends in the region `%s`",
                m->region);
  else
    diag_report(o->said, DIAG_EMPTY_REGION, deck_where(&m->item, "between"),
                "this material is for nothing: no bond joins `%s` with `%s`", m->between[0],
                m->between[1]);
  return false;
}

static void owners_free(law_owners *o) {
  for (int end = 0; end < 2 && o->inside[end]; end++) {
    for (int law = 0; law < o->count; law++)
      free(o->inside[end][law]);
    free(o->inside[end]);
  }
  free(o->material);
  free(o->of_site);
}

law_part *law_parts_new(const deck *k, int first, int count, const rows *w, bool families,
                        diagnostics *d) {
  law_owners o = {.deck = k, .laws = k->interactions + first, .count = count, .rows = w, .said = d};
  law_part *parts = must_calloc((size_t)count, sizeof *parts);
  bool good = (!families || suits_families(&o)) && find_owners(&o);
  good = good && find_insides(&o) && bonds_have_one(&o);
  for (int law = 0; law < count && good; law++) {
    parts[law].bonds = rows_part(w, bonds_of(&o, families, law));
    parts[law].own = own_of(&o, law);
    if (families) parts[law].share = share_of(w, parts[law].own);
    good = is_for_something(&o, law, parts[law].bonds);
  }
  owners_free(&o);
  if (good) return parts;
  law_parts_free(parts, count);
  return NULL;
}

void law_parts_take_masses(law_part *parts, int count, const rows *w) {
  for (int n = 0; parts && n < count; n++) {
    parts[n].bonds->mass = w->mass;
    parts[n].bonds->inertia = w->inertia;
    parts[n].bonds->site_mass = w->site_mass;
  }
}

void law_parts_free(law_part *parts, int count) {
  for (int n = 0; parts && n < count; n++) {
    rows_part_free(parts[n].bonds);
    free(parts[n].own);
    free(parts[n].share);
  }
  free(parts);
}
