/* What ties a lattice to a mesh. Particles that lie in the mesh or on its edge have no motion of
   their own: they go where the functions of the nodes put them, u = sum N_I u_I, and give the nodes
   what acts on them by the same N_I. That keeps momentum, angular momentum and energy.

       lattice        mesh        o  free particle
       o   o   o   o   #---+---+  #  tied: on the edge, which is a row of the lattice
         o   o   o   o |   |   |
       o   o   o   o   #---+---+  Bonds from o to # count whole. Bonds from # to #
         o   o   o   o |   |   |  along the edge stand for half of a row, as the mesh
       o   o   o   o   #---+---+  has the other half; those inside the mesh are left out.

   So a uniform strain is borne exactly through an edge that is a row of the lattice: what the bonds
   on one side of a particle exert, with half of those along the row, is the traction on its part of
   the edge. A tied particle's mass goes to the nodes, as far as its cell lies outside of the mesh;
   its rotation stays free, and is in balance in a uniform strain for the same reason. */
#ifndef PERILAT_RUNTIME_MESH_TIES_H
#define PERILAT_RUNTIME_MESH_TIES_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"
#include "runtime/mesh/mesh.h"

enum { TIED_MOST_NODES = 8 };
typedef struct tied_particle {
  int32_t particle; /* of the lattice */
  int count;
  int node[TIED_MOST_NODES];
  double weight[TIED_MOST_NODES]; /* of sum 1 */
  double outside;                 /* part of its cell that lies outside of the mesh */
} tied_particle;

typedef struct tied_bond { /* along the edge: borne by the tie, not by the lattice */
  int64_t site;
  int direction;
} tied_bond;

typedef struct mesh_tie {
  const deck_tie *from;
  int mesh; /* number of the mesh's lattice in the deck */
  tied_particle *particles;
  long count;
  tied_bond *halves; /* [half_count] */
  long half_count;
  long left_out; /* bonds */
} mesh_tie;

/* Those of a deck's lattice; bonds that ties leave out or bear by halves are no longer the rows'.
   `halves`: the law's bonds along an edge can be borne by halves; else they count whole. NULL and
   *count = 0 without ties, or after diagnostics. */
mesh_tie *mesh_ties_new(const deck *k, int lattice, rows *w, bool halves, int *count,
                        diagnostics *d);
void mesh_ties_free(mesh_tie *ties, int count);

/* kg: of each particle what goes to the nodes. */
double mesh_tie_mass(const mesh_tie *t, const rows *w);

/* What is known of the highest frequencies of a mesh and of what is tied to it. Kinetic and elastic
   energies of both are sums, so that with M_I of the mesh's own mass, a_I of what ties add, and A_I
   of what the whole mass of tied particles would add,

     omega^2 <= max over I of (omega_mesh^2 M_I + omega_lattice^2 A_I)/(M_I + a_I), omega_lattice^2;

   likewise for dampers. */
typedef struct tied_node {
  double mass, added, whole; /* kg */
} tied_node;

/* Adds to node[nodes of the mesh] what the tie brings. */
void mesh_tie_add(const mesh_tie *t, const rows *w, tied_node *node);
/* Shortens `together`, the limit of the lattice, to what the mesh's nodes ask for. True: it did. */
bool mesh_tie_limit(const tied_node *node, int nodes, const step_limit *of_mesh,
                    const step_limit *of_lattice, step_limit *together);

#endif
