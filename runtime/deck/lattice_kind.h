/* The kinds of lattices that a deck can name, in one table, and what follows from the kind: a new
   kind of lattice is a row. */
#ifndef PERILAT_RUNTIME_LATTICE_KIND_H
#define PERILAT_RUNTIME_LATTICE_KIND_H

#include <stdbool.h>

#include "dsl/base/c_linkage.h"
#include "runtime/deck/deck.h"

C_LINKAGE_BEGIN

/* X(name, dimensions, squares of the steps along a row, across rows, across layers in spacings,
   half steps by which a row and a layer are shifted against the one before). Particles that stand
   on no lattice have no steps: 0 dimensions, the setting says whether they are in the plane or in
   space. Without a step across rows there is but one row.

       o   o   o   o         hexagonal: rows are sqrt(3)/2 = sqrt(0.75) apart,
         o   o   o   o       each shifted by one half step
       o   o   o   o
 */
#define LATTICE_KINDS(X) KINDS_OF_DECKS(X) KINDS_OF_GROUPS(X)
#define KINDS_OF_GROUPS(X)                                                                         \
  X(bar, 0, (0, 0, 0), (0, 0))  /* of a &bar */                                                    \
  X(link, 0, (0, 0, 0), (0, 0)) /* of a &link */                                                   \
  X(mesh, 2, (1, 1, 0), (0, 0)) /* nodes of a &mesh, whose steps need not be alike */
#define KINDS_OF_DECKS(X) KINDS_OF_SITES(X) KINDS_WITHOUT_SITES(X)
#define KINDS_OF_SITES(X)                                                                          \
  KINDS_OF_FAMILIES(X)                                                                             \
  X(chain, 2, (1, 0, 0), (0, 0)) /* the axis of a bar or a beam */
#define KINDS_OF_FAMILIES(X)                                                                       \
  X(hexagonal, 2, (1, 0.75, 0), (1, 0))                                                            \
  X(square, 2, (1, 1, 0), (0, 0))                                                                  \
  X(cubic, 3, (1, 1, 1), (0, 0))                                                                   \
  X(fcc, 3, (2, 0.5, 0.5), (1, 1)) /* cube edges along the axes */
#define KINDS_WITHOUT_SITES(X)                                                                     \
  X(blue_noise, 0, (0, 0, 0), (0, 0))                                                              \
  X(particles, 0, (0, 0, 0), (0, 0))

typedef struct lattice_kind {
  const char *name;
  int dimensions;   /* 2, 3; 0: particles on no lattice */
  double square[3]; /* of the steps, in spacings: exact */
  int shift_by[2];  /* half steps */
} lattice_kind;

/* "hexagonal|square|..." */
/* clang-format off */
#define LATTICE_KIND_CHOICE(name, dimensions, square, shift_by) "|" #name
#define LATTICE_KIND_CHOICES (&(KINDS_OF_DECKS(LATTICE_KIND_CHOICE))[1])
#define LATTICE_KIND_QUOTED(name, dimensions, square, shift_by) ", `'" #name "'`"
/* Those that have sites, and so in sentences: "`'hexagonal'`, `'square'`, ..." */
#define LATTICE_KINDS_OF_SITES        (&(KINDS_OF_SITES(LATTICE_KIND_CHOICE))[1])
/* Those whose families resolve all strains. */
#define LATTICE_KINDS_OF_FAMILIES_QUOTED (&(KINDS_OF_FAMILIES(LATTICE_KIND_QUOTED))[2])
/* clang-format on */

enum {
#define X(name, dimensions, square, shift_by) LATTICE_KIND_##name,
  LATTICE_KINDS(X)
#undef X
      LATTICE_KIND_COUNT
};
extern const lattice_kind lattice_kinds[LATTICE_KIND_COUNT];
/* NULL for an unknown name. */
const lattice_kind *lattice_kind_find(const char *name);

/* With so many a family that stands on no lattice tells all strains apart. */
int lattice_usual_neighbours(int dimensions);

/* Directions in which sites follow each other: 1, a chain, to 3; 0 for particles on no lattice. */
int lattice_kind_axes(const lattice_kind *kind);

/* True for one row of particles, a chain or a bar, which has an area in place of a thickness. */
bool deck_lattice_is_chain(const deck_lattice *l);
/* True for particles that stand on no lattice, those of bars and links, too. */
bool deck_lattice_is_irregular(const deck_lattice *l);
/* True for particles whose families each are of their own: these, and those on a lattice with
   edges = 'exact'. */
bool deck_lattice_is_listed(const deck_lattice *l);
/* True for the particles of a &bar. */
bool deck_lattice_is_bar(const deck_lattice *l);
/* True for the copies of particles that a &link joins. */
bool deck_lattice_is_link(const deck_lattice *l);
/* True for the nodes of a &mesh. */
bool deck_lattice_is_mesh(const deck_lattice *l);
/* By the contact its particles touch: its own, or those of others, or both. */
bool deck_lattice_touches(const deck_lattice *l, const deck_contact *by);
/* Its particles are pushed by the stamp. */
bool deck_lattice_is_stamped(const deck_lattice *l, const deck_stamp *by);
/* What messages call it: "bar", "link", "mesh", or "lattice". */
const char *deck_lattice_word(const deck_lattice *l);
/* And what it consists of: "node" of a mesh, else "particle". */
const char *deck_particle_word(const deck_lattice *l);
/* 2 or 3: by the kind, where particles stand on no lattice by the setting; 0 for an unknown
   kind. */
int deck_lattice_dimensions(const deck_lattice *l);

/* The lattice that is meant where none is named: hexagonal in the plane, fcc with two shells in
   space. The thickness is that of both stiffness and mass, and 0 in space. */
deck_lattice lattice_default(const char *setting, double spacing, double thickness);
/* The one that is meant for laws of bars. */
deck_lattice lattice_default_chain(double spacing, double area);
/* The same, in space the face-centred lattice: there are no chains, each of its bonds is a bar. */
deck_lattice lattice_default_bars(const char *setting, double spacing, double area);

C_LINKAGE_END

#endif
