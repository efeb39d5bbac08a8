#include "runtime/deck/lattice_kind.h"

#include <string.h>

#define ROW(name, dimensions, square, shift_by) {#name, dimensions, BRACED square, BRACED shift_by},
#define BRACED(...)                                                                                \
  { __VA_ARGS__ }
const lattice_kind lattice_kinds[LATTICE_KIND_COUNT] = {LATTICE_KINDS(ROW)};

const lattice_kind *lattice_kind_find(const char *name) {
  for (int k = 0; k < LATTICE_KIND_COUNT; k++)
    if (strcmp(lattice_kinds[k].name, name) == 0) return &lattice_kinds[k];
  return NULL;
}

int lattice_kind_axes(const lattice_kind *kind) {
  int axes = 0;
  while (axes < 3 && kind->square[axes] > 0)
    axes++;
  return axes;
}

bool deck_lattice_is_chain(const deck_lattice *l) {
  const lattice_kind *kind = lattice_kind_find(l->kind);
  return kind && (lattice_kind_axes(kind) == 1 || deck_lattice_is_bar(l));
}

bool deck_lattice_is_bar(const deck_lattice *l) {
  return l->kind && strcmp(l->kind, lattice_kinds[LATTICE_KIND_bar].name) == 0;
}

bool deck_lattice_is_link(const deck_lattice *l) {
  return l->kind && strcmp(l->kind, lattice_kinds[LATTICE_KIND_link].name) == 0;
}

bool deck_lattice_is_mesh(const deck_lattice *l) {
  return l->kind && strcmp(l->kind, lattice_kinds[LATTICE_KIND_mesh].name) == 0;
}

/* None named are all but bars and links. */
static bool is_one_of(const deck_lattice *l, const char *const *lattices, int count) {
  bool named = count == 0 && !deck_lattice_is_bar(l) && !deck_lattice_is_link(l);
  for (int n = 0; n < count; n++)
    named = named || strcmp(lattices[n], l->name) == 0;
  return named;
}

bool deck_lattice_touches(const deck_lattice *l, const deck_contact *by) {
  return is_one_of(l, by->lattices, by->lattice_count);
}

bool deck_lattice_is_stamped(const deck_lattice *l, const deck_stamp *by) {
  return is_one_of(l, by->lattices, by->lattice_count);
}

const char *deck_lattice_word(const deck_lattice *l) {
  return deck_lattice_is_bar(l)    ? "bar"
         : deck_lattice_is_link(l) ? "link"
         : deck_lattice_is_mesh(l) ? "mesh"
                                   : "lattice";
}

int lattice_usual_neighbours(int dimensions) {
  return dimensions == 2 ? 12 : 18;
}

const char *deck_particle_word(const deck_lattice *l) {
  return deck_lattice_is_mesh(l) ? "node" : "particle";
}

bool deck_lattice_is_irregular(const deck_lattice *l) {
  const lattice_kind *kind = lattice_kind_find(l->kind);
  return kind && kind->dimensions == 0;
}

bool deck_lattice_is_listed(const deck_lattice *l) {
  return deck_lattice_is_irregular(l) || l->edges == EDGES_EXACT;
}

static bool is_space(const char *setting) {
  return setting && strcmp(setting, "space") == 0;
}

int deck_lattice_dimensions(const deck_lattice *l) {
  const lattice_kind *kind = lattice_kind_find(l->kind);
  if (!kind) return 0;
  return kind->dimensions ? kind->dimensions : is_space(l->setting) ? 3 : 2;
}

deck_lattice lattice_default(const char *setting, double spacing, double thickness) {
  const bool space = is_space(setting);
  const double t = space ? 0 : thickness;
  return (deck_lattice){.name = "lattice",
                        .kind = space ? "fcc" : "hexagonal",
                        .spacing = spacing,
                        .shells = space ? 2 : 0,
                        .thickness = t,
                        .stiffness_thickness = t,
                        .mass_thickness = t,
                        .setting = setting};
}

deck_lattice lattice_default_bars(const char *setting, double spacing, double area) {
  if (!is_space(setting)) return lattice_default_chain(spacing, area);
  deck_lattice l = lattice_default(setting, spacing, 0);
  l.shells = 0;
  l.area = area;
  return l;
}

deck_lattice lattice_default_chain(double spacing, double area) {
  return (deck_lattice){.name = "lattice",
                        .kind = lattice_kinds[LATTICE_KIND_chain].name,
                        .spacing = spacing,
                        .area = area,
                        .setting = "plane_stress"};
}
