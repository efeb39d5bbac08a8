/* Where a compiled law and its host meet; nothing else crosses. A kernel is a table of facts about
   a law (pl_law) and a few functions over strips of bonds or runs of particles. It knows nothing of
   lattices, loads or files, keeps no state and allocates nothing. All arrays that it is handed are
   the host's, who keeps them while the call lasts; what pl_law points to is the kernel's and stays
   as long as that is loaded. Values are in SI. Of a shape [a][b] b is the inner index.

   Records say how long they are: who makes one sets `size` to its sizeof. To pl_law, pl_bond_class,
   pl_strip, pl_family and pl_states members are only appended, without a new PL_KERNEL_ABI; who
   reads one that came after this number asks PL_HAS(record, member) first. All others stay as they
   are while that number stays. A kernel is good for a host when `abi` is the same and its table
   reaches as far as what the host reads. No more is promised before the language's second edition.

   A host opens the kernel (PL_KERNEL_ENTRY), compares `abi` and looks at `size`, reads
   `parameters`, checks their values with `bounds`, and calls `prepare` once for each class of
   bonds. Step by step it calls `rows` for its strips (or the passes of `step` for its particles),
   adds up the forces, and moves the particles. HOST.md is one.

   A strip is a run of bonds of one direction on lattice rows: bond k joins particle k of the near
   ends to particle k of the far ends. With rows of 16 sites, of the bonds up and to the right:

     row r + 1         17     18     19          displacement_j[d] = u[d] + 17
                      /      /      /
     row r          0      1      2              displacement_i[d] = u[d] + 0

   and count = 8: five absent bonds fill the vector. Arrays hold, per degree of freedom,
   displacement (m) and velocity (m/s) components first, then rotations (rad, rad/s). Strips are of
   the plane; dof = 2 (central) or 3 (micropolar). Those of a micropolar law in space are for probes
   of single bonds, which bend in the plane and twist: dof = 4, the last rotation is about the bond.

   A law that reads a particle's whole family comes as programs instead: passes over runs of
   particles, one after the other over the whole body. A pass reads what neighbours had at the
   beginning of the step, and what earlier passes of the program left in links. In the plane or in
   space. Of a law of bonds that is micropolar particles rotate: dof = 3 in the plane (about z), 6
   in space (about x, y, z); of all others dof = dimensions. */
#ifndef PERILAT_RUNTIME_KERNEL_H
#define PERILAT_RUNTIME_KERNEL_H

#include <stdint.h>

#define PL_KERNEL_ABI 19
#define PL_MAX_DOF    6
#define PL_MAX_PLANES 12 /* force planes a bond */
#define PL_STATE_INPUTS                                                                            \
  6 /* of a state: stretch, stretch_rate (1/s), theta_i, theta_j (rad), length (m), dt (s) */
#define PL_STATE_RESULTS 3 /* N (N), M_i, M_j (N m; 0 for central laws) */
#define PL_STATE_RATES   4 /* inputs that the tangent is by: the first ones */
#define PL_TANGENTS      (PL_STATE_RESULTS * PL_STATE_RATES)
#define PL_LANES         8  /* strips on rows are multiples of this */
#define PL_ALIGNMENT     64 /* B, of arrays */

/* Whether the record pointed to is long enough to hold the member. */
#define PL_HAS(record, member)                                                                     \
  ((uint32_t)((const char *)(&(record)->member + 1) - (const char *)(record)) <= (record)->size)

/* What a law loses: to states and damage; to rate terms. And what it is given by a rest state, or
   fields, that change; of laws with `works_at_rest` alone. */
enum pl_loss { PL_LOST_TO_STATES = 0, PL_LOST_TO_RATES = 1, PL_GIVEN_BY_REST = 2, PL_LOSSES = 3 };
enum pl_law_kind {
  PL_CENTRAL = 0,
  PL_MICROPOLAR = 1,
  PL_STATE = 2,
  PL_CONTINUUM = 3,
  PL_CRACK = 4
};
enum pl_field_kind { PL_FIELD_STATE = 0, PL_FIELD_DAMAGE = 1, PL_FIELD_OUTPUT = 2 };
/* Where a field lives: one value a bond; one a particle; one for each neighbour of a particle; one
   a point of a continuum. */
enum pl_place {
  PL_ON_BOND = 0,
  PL_ON_PARTICLE = 1,
  PL_ON_NEIGHBOUR = 2,
  PL_ON_POINT = 3,
  PL_ON_TIP = 4
};

/* Where a particle's neighbours stand: on rows at offsets that are the same along a row; on lists
   each has its own. */
enum pl_topology { PL_ROWS = 0, PL_LIST = 1 };

/* Bits of a strip's flags. */
#define PL_PRESENT(direction)   (INT64_C(1) << (direction))        /* the bond exists */
#define PL_PROTECTED(direction) (INT64_C(1) << (32 + (direction))) /* its damage stays as it is */

/* Quantities that are the same for all bonds of one class (a direction of a lattice), in SI. */
typedef struct pl_bond_class {
  uint32_t size;
  double s;              /* reference length, m */
  double spacing;        /* m */
  double t;              /* stiffness thickness, m */
  double V;              /* particle volume, m^3 */
  double mass_i, mass_j; /* kg */
  double area;           /* m^2, bars */
  double shell;          /* 1, 2, ... */
  double n;              /* bonds of a full family */
  /* Reference chord from i to j, m; |chord| = s (rows only; lists of families carry their own). */
  double chord[3];
  double horizon; /* m: how far neighbours may be */
  double weight;  /* part of the volume of j that counts; 1 unless the lattice corrects volumes */
} pl_bond_class;

typedef struct pl_parameter {
  const char *name; /* "E"; upper and lower case differ */
  const char *unit; /* "GPa", "1": as the law writes it; values are in SI all the same */
  const char *doc;  /* "Young's modulus" */
  double initial;   /* default, SI */
  int has_default;  /* 0: a value must be given */
} pl_parameter;

/* What a law is told of a state. */
typedef struct pl_input {
  const char *name, *unit; /* "stretch_rate", "1/s" */
} pl_input;

/* A state or a damage, which steps change and the host keeps; or an output, computed when asked
   for. */
typedef struct pl_field {
  const char *name, *unit, *doc; /* "omega", "1", "damage of the bond" */
  double initial;                /* SI, when a run begins */
  int kind;                      /* pl_field_kind */
  int place;                     /* pl_place */
} pl_field;

typedef struct pl_strip {
  uint32_t size;
  long count;           /* bonds, a multiple of PL_LANES; those that fill it up are absent */
  long direction;       /* which bits of `flags` are meant */
  const int64_t *flags; /* [count] of the sites i */
  int unheld;           /* not 0: no bond of the strip is protected */
  /* [dof][count] at the ends i and j: m, rad; m/s, rad/s */
  const double *displacement_i[PL_MAX_DOF], *displacement_j[PL_MAX_DOF];
  const double *velocity_i[PL_MAX_DOF], *velocity_j[PL_MAX_DOF];
  /* [varying_count][count] SI: the parameters that differ from bond to bond */
  const double *const *parameter;
  double *const *field; /* [field_count][count] SI, read and written in place */
  double *const *force; /* [force_planes][count] N, N m, written; 0 where the bond is absent */
  /* Of rows_ledger: [count] J, added to: what is lost in this step to damage and plasticity, and to
     rate terms. */
  double *dissipated_state, *dissipated_rate;
  /* Of rows_observe: [1 + output_count][count], written: stored energy (J), then each output. */
  double *const *observed;
  double time, time_step; /* s: of the deformation, and to the next one; no law reads `time` yet */
  /* s: `dt` of laws, by which the host's time has gone on from the state that `field` is of to this
     deformation; 0 in the first step, which finds how quickly states begin to change */
  double advance;
  /* Of rows_ledger of a law with `works_at_rest`: [count] J, added to: what its rest state and
     fields that change have given it in this step. */
  double *given_by_rest;
} pl_strip;

/* Single states of a law of bonds. */
typedef struct pl_states {
  uint32_t size;
  long count;
  double time, time_step; /* s, as of a strip; no law reads them yet */
  /* [state_input_count][count] in the order of pl_law.state_inputs: find them by name */
  const double *const *in;
  const double *const *field; /* [field_count][count] */
  /* of `states` [PL_STATE_RESULTS][count]; of `tangent` [PL_TANGENTS][count]: dN/d(stretch, rate,
     theta_i, theta_j), dM_i/d..., dM_j/d... */
  double *const *out;
  double *const *new_field; /* [field_count][count] of `states` */
} pl_states;

struct pl_law;
typedef void (*pl_states_function)(const struct pl_law *law, const double *uniforms,
                                   const pl_states *states);
/* uniforms: [uniform_count], as `prepare` wrote them for the bonds of this direction */
typedef void (*pl_strip_function)(const struct pl_law *law, const double *uniforms,
                                  const pl_strip *strip);

/* What particles with lists have in common toward their neighbours of one number. */
typedef struct pl_way {
  int64_t to;              /* sites from each to its neighbour */
  double length, chord[3]; /* m */
} pl_way;
enum {
  PL_OWN_WAYS = -1, /* each has a way of its own */
  PL_NO_WAY = -2    /* none has such a neighbour */
};

#define PL_MAX_DIRECTIONS           64 /* pairs of opposite neighbours of a family */
#define PL_SHAPE_VALUES(dimensions) ((dimensions) == 2 ? 6 : 21)
#define PL_SHAPE_PLANES(dimensions) (PL_SHAPE_VALUES(dimensions) + 1)

/* A run of particles: a row, or some that go on in memory with absent sites between; of laws with
   `neighbours` also rows whose neighbours stand alike, `row_stride` sites apart in all arrays.
   Arrays begin at the run's first site. On rows neighbour k of site q is site q + offset[k], on
   lists site q + neighbour[k * plane + q]. A bond has opposite numbers at its two ends: when b is
   neighbour k of a, a is neighbour k + neighbours/2 of b, or k - neighbours/2. On a square lattice,
   rows of 16 sites, neighbours of site 20:

                 site 36, k = 1
                      |
     site 19, k = 2 --20-- site 21, k = 0        offset = {1, 16, -1, -16}
                      |
                 site 4, k = 3

   In a law of families a bond's field, too, has a value on either side. Fields on particles have
   one plane, all others one for each neighbour, `plane` doubles apart: that of particle q toward
   neighbour k is old_field[f][k * plane + q]; what is written stands `new_plane` apart. Links may
   stand in a window of rows: on rows the neighbour's are at q + link_offset[k], and their planes
   `link_plane` apart. */
typedef struct pl_family {
  uint32_t size;
  long count;            /* sites of a row, a multiple of PL_LANES */
  long rows, row_stride; /* 1 where pl_law.neighbours is 0 */
  long neighbours;       /* of a full family; even */
  /* doubles between planes of a field, or of what lists know of bonds */
  long plane;
  /* the same of new fields, force states and what is observed; of links of bonds */
  long new_plane, link_plane;
  const long *offset, *link_offset; /* [neighbours] sites; of rows only */
  /* [count] bit k: the bond to neighbour k < neighbours/2 exists; that to its opposite is a bit
     there. */
  const uint64_t *bonds;
  /* [count] not 0: the damage of this particle, and of its bonds, stays as it is. */
  const uint64_t *held;
  /* [dof][count]: displacements, then rotations (m, rad); velocities, then rates of rotation (m/s,
     rad/s). In space a rotation vector, and how quickly the particle turns about x, y and z: in a
     step of h it turns by h w, after what it has turned. */
  const double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF];
  /* Lists. Where there is no neighbour, `neighbour` leads to a site that is absent, and the chord
     is some vector that is not 0. */
  const int32_t *neighbour; /* [neighbours][plane] sites from here to the neighbour */
  const uint64_t *incoming; /* [count] bit k: the bond to neighbour k + neighbours/2 exists */
  const double *length;     /* [neighbours][plane] m */
  const double *chord[3];   /* [neighbours][plane] reference chord to the neighbour, m */
  const double *volume;     /* [count] of the particles, m^3 */
  const double *mass;       /* [count] of laws that read it: of the particles, kg */
  /* [varying_count] SI: the parameters that are not the same everywhere. On particles one plane, a
     particle's own; on bonds one for each neighbour, `plane` doubles apart, the same from both
     ends. Finite everywhere. */
  const double *const *parameter;
  /* [count] of laws that read it: 1 where the particle is of this law, 0 where of another. What a
     bond bears and stores is half of each of its particles; this law's part of a half is the
     particle's share. */
  const double *share;
  /* Inverse (or pseudo-inverse) of the shape matrix over the reference bonds that exist: sum(n n^T)
     on rows, on lists sum(s n n^T) with the bonds' lengths s; n = (x^2, y^2, x y) or (x^2, y^2,
     z^2, x y, y z, x z) of the bond's reference direction: upper triangle, row by row; shear counts
     twice. Behind it a plane that is 1 where the bonds resolve all strains (condition of the matrix
     at most 1e3), else 0. */
  const double *const *shape;     /* [PL_SHAPE_PLANES][count] */
  const double *const *old_field; /* [field_count] at the beginning of the step */
  /* [field_count] written by the pass that finds them; never the same memory as old_field */
  double *const *new_field;
  /* [link_count][count] values of particles, written by one pass and read by later ones */
  double *const *link;
  /* [bond_link_count] the same of values toward each neighbour, in planes like a field's */
  double *const *bond_link;
  /* [dof][count]: sums over the bonds, written by the last pass of the step: forces (N), then
     moments (N m) on the particle */
  double *const *force;
  /* [1 + output_count]: stored energy (J), then each output; on particles one plane, else planes */
  double *const *observed;
  double time, time_step; /* s: of the deformation, and to the next one; no law reads `time` yet */
  /* Of laws with sums (pl_law.sum_count): a bond adds to both of its ends. A run is one row, or a
     part of it that begins at its start or where the last run ended, and runs go from lower to
     higher sites; neighbours k < neighbours/2 stand at higher sites. sum[s] is what earlier runs
     have added to these particles; a run adds to particles ahead, and what it has used is 0 again.
     With `ahead_only` it writes nothing else, and passes without such bonds nothing at all: whoever
     begins in the middle of a body begins with the rows from which bonds reach its own. */
  int ahead_only;
  /* of the same laws: one of these particles, or one that their bonds reach, is held */
  int held_near;
  double *const *sum; /* [sum_count] */
  /* Of the same laws: sums of what is the same for all bonds of a class, which are the same in
     every step. A pass writes them, unless NULL, and once they are known reads them instead of
     adding up. */
  double *const *constant_sum; /* [constant_sum_count][count] */
  int constants_known;
  /* Of the same laws, unless NULL: word q/PL_LANES of the first of some particles that a pass takes
     together, bit k < neighbours/2: toward neighbour k not all is as is expected. The first pass
     that asks writes it, later ones read it; what stands there before, 0 or the last step's, only
     says what to try first. */
  uint64_t *unusual;
  /* Of the same laws: word q/PL_LANES, bit k < neighbours/2: of the values of PL_LANES particles
     toward neighbour k some may be other than 0 (filled), and old and new ones are the same
     (settled). Only for fields that such a bond writes; else NULL. */
  const uint64_t *const *old_filled; /* [field_count] of old_field */
  uint64_t *const *new_filled;       /* [field_count] of new_field; written with it */
  uint64_t *const *settled;          /* [field_count] read, and written with new_field */
  /* Of `ledger`: [count] J, added to: what the particle's halves of its bonds lose in this step.
     Where there is no particle, or one without bonds, it means nothing. */
  double *lost[PL_LOSSES];
  /* Of `force_state`: [dof] N, then N m; planes one for each neighbour, `new_plane` apart, written:
     what the particle's own side of the bond does to it. 0 where the bond is absent. */
  double *const *force_state;
  /* [count] of laws that read it (pl_law.reads_own_size): spacing of each particle over that of the
     bond class, and so its horizon over that. */
  const double *own_size;
  /* Of lists, unless NULL: [count/PL_LANES][neighbours]: of each PL_LANES particles toward
     neighbour k PL_OWN_WAYS, PL_NO_WAY, or which way all of these go that have it; from those that
     have none that way leads to a site, too. */
  const int32_t *alike;
  const pl_way *way;
  double advance; /* s, as of a strip: from the state that old_field is of */
} pl_family;

/* uniforms: rows: [neighbours][uniform_count], as `prepare` wrote them for the bond class of each
   neighbour; lists: [uniform_count] */
typedef void (*pl_family_function)(const struct pl_law *law, const double *uniforms,
                                   const pl_family *family);
typedef struct pl_program {
  int pass_count;
  const pl_family_function *pass; /* [pass_count] */
  /* On rows. Bit p: of neighbours pass p reads nothing that earlier passes left but what the bond's
     owner shares; so they must have done its row and those below, not those above. */
  unsigned at_hand;
  /* On rows. Bit p: pass p reads links of higher rows and of the particle's own only. */
  unsigned upward;
  /* On rows. While passes follow each other, each that is not at hand one reach of rows behind the
     one before, links must be kept of one reach more than the last is behind the first; or of so
     many reaches less. */
  int spared;
  /* On rows, unless NULL. [pass_count] bit s: pass p leaves plane k, or k + neighbours/2 for odd s,
     of bond_link[s/2] for both ends of its particles' bonds k < neighbours/2. Whoever runs the
     passes keeps these planes 0 where no run has come. */
  const uint64_t *shared;
} pl_program;

/* Points of a continuum. Components of strains and stresses stand in this order:

       in the plane   strain xx, yy, xy              stress xx, yy, xy, zz
       in space       strain xx, yy, zz, xy, yz, xz  stress the same

   A shear xy of a strain is the tensor's: half of the change of angle. In plane strain nothing is
   strained along z; in plane stress the law finds the strain along z that leaves no stress there
   (eight steps of Newton's method from 0, or one where that is exact). */
enum { PL_MAX_STRAINS = 6 };
#define PL_STRAINS(dimensions)  ((dimensions) == 2 ? 3 : 6)
#define PL_STRESSES(dimensions) ((dimensions) == 2 ? 4 : 6)

typedef struct pl_points {
  uint32_t size;
  long count;                       /* a multiple of PL_LANES */
  const double *const *strain;      /* [strains][count] */
  const double *const *strain_rate; /* [strains][count] 1/s */
  const double *cell_size;          /* [count] m, of the cell that the point stands for */
  const double *const *parameter;   /* [varying_count][count] SI: those that differ in space */
  const double *const *old_field;   /* [field_count][count] SI, when the step begins */
  double *const *new_field;         /* [field_count][count] written; other memory than old_field */
  double *const *stress;            /* [stresses][count] Pa, written */
  /* Of point_tangent: [strains][strains][count] Pa, written: the stress by the strain, where shears
     are those of engineers (twice the tensor's). In plane stress it is that of the plane alone. */
  double *const *tangent;
  /* Of point_observe: [1 + output_count][count], written: stored energy (J/m^3), then each
     output */
  double *const *observed;
  /* Of point_ledger: [PL_LOSSES][count] J/m^3, added to. What states take is that halfway of the
     way strain_rate time_step that led here (ledger.h): laws with fields read rates for it, too */
  double *const *lost;
  double time, time_step; /* s */
  double advance;         /* s, as of a strip: from the state that old_field is of */
} pl_points;

/* uniforms: [uniform_count], as `prepare` wrote them for any bond class */
typedef void (*pl_point_function)(const struct pl_law *law, const double *uniforms,
                                  const pl_points *points);

/* Rectangles of 2 x 2 points side by side along x, all alike (rectangle.h): from displacements of
   their nodes to forces on them in one loop. `points` are theirs, [count/PL_LANES][4][PL_LANES];
   its strains and stress are neither read nor written, nor are new fields that always have their
   initial value, which the host has put there. */
typedef struct pl_rectangles {
  uint32_t size;
  long count;                        /* of rectangles, a multiple of PL_LANES */
  long stride;                       /* doubles from a row of nodes to the next */
  const double *const *displacement; /* [2] m, from the lower left node of the first */
  const double *const *velocity;     /* [2] m/s; laws that do not read rates need none */
  const struct pl_rectangle *slopes; /* of strains, 1/m */
  const struct pl_rectangle *push;   /* of forces: times the volume of a point, m^2 */
  long cells;                        /* that there are: the last ones but fill a vector up */
  double *const *force;              /* [2][cells] N, written: of lower nodes, but for the right one
                                        of the last cell */
  double *const *above;              /* [2][cells] N, of these nodes: what the row below does to
                                        them, then of those above, what this row does */
  double (*right)[2];                /* [2][low, high] N: what the cell before the first does to
                                        its right nodes, then what the last one does */
  const pl_points *points;
} pl_rectangles;

typedef void (*pl_rectangle_function)(const struct pl_law *law, const double *uniforms,
                                      const pl_rectangles *cells);

/* Tips of cracks. */
enum pl_tip_input {
  PL_TIP_K_I,
  PL_TIP_K_II,           /* Pa m^(1/2) */
  PL_TIP_ENERGY_RELEASE, /* N/m */
  PL_TIP_ANGLE,          /* rad, from x: of the last leg */
  PL_TIP_SPEED,          /* m/s */
  PL_TIP_LENGTH,         /* m */
  PL_TIP_RAYLEIGH_SPEED, /* m/s */
  PL_TIP_SHEAR_SPEED,
  PL_TIP_DILATATIONAL_SPEED,
  PL_TIP_INPUTS
};
enum pl_tip_result {
  PL_TIP_GROW /* 1, else 0 */,
  PL_TIP_TOWARD /* rad */,
  PL_TIP_RUN /* m/s */,
  PL_TIP_RESULTS
};
typedef struct pl_tips {
  uint32_t size;
  long count;                     /* a multiple of PL_LANES */
  const double *const *in;        /* [PL_TIP_INPUTS][count] */
  const double *const *old_field; /* [field_count][count] SI */
  double *const *new_field;       /* [field_count][count] written; other memory than old_field */
  double *const *out;             /* [PL_TIP_RESULTS][count] written; toward: from the crack's own
                                     direction */
  double *const *observed;        /* [output_count][count] written: the law's outputs */
  double time, time_step;         /* s; of looks at the tip */
} pl_tips;
typedef void (*pl_tip_function)(const struct pl_law *law, const double *uniforms,
                                const pl_tips *tips);

/* Force planes. Central 2D: Fx, Fy on i (on j the opposite). Micropolar 2D: Fx, Fy, and the end
   moments M_i, M_j of the bond (on the particles the opposite); where it twists, the moment T on
   end j. */
typedef struct pl_law {
  int abi;          /* PL_KERNEL_ABI; checked at load; stands first whatever the number */
  uint32_t size;    /* of the table, B */
  int kind;         /* pl_law_kind */
  int topology;     /* pl_topology; laws of bonds: PL_ROWS */
  int dimensions;   /* 2, or 3 */
  int dof;          /* per particle */
  int force_planes; /* 2 central, 4 micropolar, 5 where bonds twist */
  const char *name; /* "mplm_bilinear" */
  const char *key;  /* hash of law, options, compiler and flags */
  int parameter_count;
  const pl_parameter *parameters; /* [parameter_count] */
  int density; /* place in `parameters` of the mass density (kg/m^3) of particles, or -1 */
  /* Parameters that strips and passes read bond by bond, or particle by particle; all else takes
     them as given to `prepare`. */
  int varying_count;
  /* [varying_count] their places in `parameters`. One that stands there twice is a field that
     changes in time: the later array has what it was a step ago. */
  const int *varying;
  int varying_place; /* pl_place: of laws of bonds on bonds, else on particles */
  int field_count;
  const pl_field *fields; /* [field_count] */
  int output_count;
  const pl_field *outputs;   /* [output_count] */
  int stores;                /* what is observed as stored is all energy that the bonds hold */
  int reads_rates;           /* forces or new fields depend on velocities */
  int uniform_count;         /* doubles that `prepare` writes */
  double flops_per_bond;     /* of `rows`: additions, multiplications, selections */
  double divisions_per_bond; /* of `rows`: divisions and roots */

  /* Values that depend on parameters and bond class only. */
  void (*prepare)(const struct pl_law *law, const double *parameters, const pl_bond_class *bonds,
                  double *uniforms);
  /* lower[p] and upper[p] of every parameter given all values (open ends: low_open, high_open =
     1). */
  void (*bounds)(const struct pl_law *law, const double *parameters, double *lower, double *upper,
                 unsigned char *low_open, unsigned char *high_open);

  pl_strip_function rows;         /* forces and new fields */
  pl_strip_function rows_ledger;  /* the same and dissipated energies */
  pl_strip_function rows_observe; /* stored energy and outputs; changes nothing */

  int state_input_count;
  const pl_input *state_inputs; /* [state_input_count] of pl_states.in */
  pl_states_function states;    /* the law alone, state by state: forces and new fields */
  pl_states_function tangent;   /* symbolic, at such states */

  /* Laws of families: the members from force_planes to tangent that speak of strips and bonds are
     0. */
  int neighbours; /* of the full families that the passes are written for; 0: of any */
  int link_count, bond_link_count;
  /* bonds add to both ends: so many sums; 0: either end computes its bonds */
  int sum_count;
  int constant_sum_count; /* sums that the passes may keep from step to step; 0: none */
  int reads_shape;        /* the passes read `shape` */
  int reads_share;        /* and `share` */
  int reads_mass;         /* and `mass` */
  /* a law of bonds in this form: its force depends on the bond's ends alone */
  int pairwise;
  pl_program step; /* new fields and the forces */
  /* Stored energy and outputs with the fields at hand (as old_field); changes nothing. */
  pl_program observe;

  const void *context; /* the interpreter's; NULL in compiled kernels */

  /* Of laws of families that store energy and may lose some: in place of `step` the same forces and
     fields, to the bit, and pl_family.lost. No passes: it has neither states nor rate terms, or
     what they take is not known. A body is run with one of the two. */
  pl_program ledger;

  /* Of laws of families, where it was asked for (`perilat build law.plm` does): the law alone,
     family by family, as `states` of laws of bonds. It gives the new fields of `step` (on lists to
     the bit, on rows to rounding) and pl_family.force_state; nothing is added up or left to other
     ends. With T_k, M_k the planes toward neighbour k, and T_k' the neighbour's plane back, those
     of `step` are

         force on the particle = sum_k (T_k - T_k'),   moment on it = sum_k M_k

     and sum_k T_k x_k / V over the reference chords x_k is the particle's stress (first
     Piola-Kirchhoff; V is its volume). Of a law of bonds in this form T_k is half of the bond's
     force, M_k all of its moment.

     It reads, of the particle: displacements, velocities, old fields, parameters, volume, mass,
     share, shape, held; of the neighbours the same but the shape, and of their old fields toward
     neighbours, if there are such (PL_ON_NEIGHBOUR), those toward the particle, under the opposite
     number. With one pass that is all: a particle with its neighbours is complete by itself, and
     neighbours of which no pass is run need no bonds on lists, on rows the bits of those to the
     particle. With more passes the law reads what neighbours find of their own families, which
     earlier passes leave in links: these must have been run for the neighbours, too. */
  pl_program force_state;

  /* Laws of a continuum (kind PL_CONTINUUM) have these in place of strips and passes. */
  pl_point_function point_step;    /* stress and new fields */
  pl_point_function point_ledger;  /* the same and lost energies */
  pl_point_function point_observe; /* stored energy and outputs; changes nothing */
  pl_point_function point_tangent; /* tangent; changes nothing */
  /* The stress is the same linear function of the strain alone at all times, 0 without strain. */
  int linear;

  /* Laws of cracks (kind PL_CRACK) have this alone. */
  pl_tip_function tip_look;

  /* Of laws of a continuum whose points can fail: place in `fields` of what is 1 where the point
     has failed, for good, else 0; -1 without such. A failed point has no stress, and stores
     nothing. */
  int failed_field;

  /* Of laws of a continuum: they read the size of the cell that a point stands for, which points of
     element-free cells do not have. */
  int reads_size;
  /* Bounds of that size (m), as `bounds` gives those of a parameter: one of each; NULL: any is
     good. And why, in the law's words; or NULL. */
  void (*size_bounds)(const struct pl_law *law, const double *parameters, double *lower,
                      double *upper, unsigned char *low_open, unsigned char *high_open);
  const char *size_reason;

  /* Of laws of a continuum in the plane that cost little: point_step and point_ledger for whole
     rectangles, to the bit the same. NULL: the host asks point by point. */
  pl_rectangle_function rectangle_step;
  pl_rectangle_function rectangle_ledger;

  /* Of laws of families: `spacing` and `horizon` of the law are a particle's own, those of the bond
     class times pl_family.own_size. */
  int reads_own_size;

  /* Parameters that the law declares as `field`: a host may let them change in time. Those among
     `varying` stand in arrays, like all of these. */
  int given_count;
  const int32_t *given; /* [given_count] their places in `parameters` */

  /* The rest state, or fields, change what the law stores: ledgers tell how much
     (PL_GIVEN_BY_REST). */
  int works_at_rest;
  /* Of laws of a continuum: linear but for a stress without strain, as of a rest strain. */
  int affine;
  /* Defaults that follow from other parameters' values: from `parameters`, SI, to `values`, of
     which nothing else is written. Each reads only parameters above its own. NULL: all defaults are
     numbers. pl_parameter.initial is what follows from the other defaults. */
  void (*defaults)(const struct pl_law *law, const double *parameters, double *values);
} pl_law;

/* The one symbol that a compiled kernel exports. */
typedef const pl_law *(*pl_kernel_entry)(void);
#define PL_KERNEL_ENTRY "perilat_kernel"

#endif
