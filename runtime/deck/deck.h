/* This room: from a deck's text to what it says. A deck is a structure for each group, every value
   in SI, every item with its place in the text so that later errors (an empty region, say) can
   point at the line. */
#ifndef PERILAT_RUNTIME_DECK_H
#define PERILAT_RUNTIME_DECK_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/arena.h"
#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"
#include "dsl/base/units.h"
#include "runtime/crack/tip_values.h"
#include "runtime/deck/time_function.h"
#include "runtime/geometry/shape.h"

C_LINKAGE_BEGIN

typedef struct deck_key { /* where a key was written, for messages about its value */
  const char *name;
  span name_where, value_where;
} deck_key;

typedef struct deck_item { /* what every group has */
  span where;              /* of the group's name */
  const deck_key *keys;
  int key_count;
  bool faulty; /* while reading: some of it was reported */
} deck_item;

/* Place of a key's value in the item, or of the group when the key was not written. */
span deck_where(const deck_item *item, const char *key);
bool deck_is_written(const deck_item *item, const char *key);

/* What a link joins a bar to: all sites within reach, or the place in the cell that holds it. */
enum link_to { LINK_TO_SITES, LINK_TO_PLACE };

typedef enum volume_correction { VOLUME_WHOLE, VOLUME_LINEAR } volume_correction;

/* Particles short of neighbours: as the lattice's others, or with operators and volumes of their
   own. */
typedef enum lattice_edges { EDGES_OF_LATTICE, EDGES_EXACT } lattice_edges;

/* Of nodes and cells: bilinear finite elements, or moving least squares. */
typedef enum mesh_method { MESH_ELEMENT_FREE, MESH_FINITE_ELEMENTS } mesh_method;
/* Of the points of an element: each its own, or the mean of the cell. */
typedef enum mesh_dilatation { DILATATION_POINT, DILATATION_MEAN } mesh_dilatation;

/* Of a &lattice, or of a &bar, a &link or a &mesh, which are of the kinds `bar`, `link` and `mesh`:
   they stand behind them, in this order. */
typedef struct deck_lattice {
  deck_item item;
  const char *name;
  const char *kind; /* of lattice_kind.h: "hexagonal", "blue_noise", ... */
  double spacing;   /* m; on no lattice: of the hexagonal or fcc one with as large particles */
  const struct formula *graded; /* blue_noise: `spacing` of x, y, z, whose value in the middle of
                                   the bodies `spacing` then is; or NULL */
  double horizon;               /* in spacings; 0: `shells` or `neighbours` decide */
  int shells;                   /* 0: the nearest neighbours */
  int neighbours;   /* blue_noise, particles: so many nearest ones; 0: `horizon` decides */
  int seed;         /* blue_noise */
  const char *file; /* particles: as written; deck_file_path finds it */
  enum volume_correction volume_correction;
  lattice_edges edges;
  double rotation;                            /* rad; deck: degrees as a plain number or '17 deg' */
  double axis[3];                             /* of the rotation, in space; 0, 0, 0: z */
  double origin[3];                           /* m: a point that is a lattice site; default 0, 0 */
  double thickness;                           /* m; these three are 0 in space and of chains */
  double stiffness_thickness, mass_thickness; /* m; default: thickness */
  double area;                                /* m^2, of chains and bars; else 0 */
  const char *setting; /* "plane_stress" (default) or "plane_strain"; "space" */
  /* of a bar: its corners, coordinate by coordinate, m */
  const double *points;
  int value_count; /* of all coordinates */
  bool closed;     /* the last corner is joined to the first */
  int copies;      /* of this line, */
  double shift[3]; /* m: each from the one before */
  double diameter; /* m; where the area is given, of the round one */
  /* of a link: names and numbers of the bar and of the lattice around it */
  const char *bar, *around;
  int of_bar, of_around;
  int every, first; /* particles of the bar that are joined: first, first + every, ... */
  enum link_to to;
  double within; /* spacings; to sites */
  /* of a mesh: the corner of least coordinates, extent, nodes along x and y */
  double corner[3], size[3]; /* m */
  const double *corners;     /* of a quadrilateral: x1, y1, ... counter-clockwise, m; else NULL */
  int corner_count;          /* values: 8, or 0 */
  double nodes[2];           /* whole; of a file: of rows that they are laid out in, and of these */
  const struct gmsh_mesh *gmsh; /* of a file; else NULL */
  const char *unit;             /* of places in the file, "mm" */
  mesh_method method;
  double support;   /* d_max, spacings */
  int gauss, parts; /* background rule: gauss x gauss points in each of parts x parts of a cell */
  double rich;      /* radius of the enriched basis, spacings along x; 0: a linear basis */
  bool smooth;      /* zones are blended by a smooth ramp */
  mesh_dilatation dilatation; /* of elements */
  double hourglass;           /* of elements with one point: part of their stiffness */
} deck_lattice;
typedef deck_lattice deck_bar, deck_link, deck_mesh;

typedef struct deck_zone { /* a part of a mesh with the other method */
  deck_item item;
  const char *mesh;
  mesh_method method;
  int gauss; /* of finite elements: 1 or 2 */
  mesh_dilatation dilatation;
  double hourglass;
  deck_shape shape;
} deck_zone;

/* Of nodes that are driven: they go where their velocity takes them, or give way to the body by
   dt^2 a/2 in each step. */
typedef enum newmark_motion { MOTION_CONSISTENT, MOTION_VELOCITY_ONLY } newmark_motion;

typedef struct deck_newmark { /* of meshes */
  deck_item item;
  double beta_1; /* 1/2: no numerical damping; up to 1 */
  newmark_motion motion;
} deck_newmark;

typedef struct deck_placed {     /* a value that may differ from place to place */
  double value;                  /* SI */
  const struct formula *formula; /* of x, y, z, instead; or NULL */
  const char *path;              /* of a table or result with places and values; or NULL */
  const char *column;            /* its column or field; NULL: the only one */
  const char *unit_text;         /* SI */
  bool grid; /* a table whose places are a grid: straight between them, else the nearest counts */
  int component;                /* of a field of vectors; negative: there is none */
  const char *lattice;          /* whose particles are meant: of a result the values of that name */
  const time_function *in_time; /* the same everywhere, instead: a table in time; or NULL */
} deck_placed;

typedef struct deck_assignment { /* parameter = value in a &material, or of a &field */
  const char *name;              /* as written */
  const char *vector;            /* of a component of a list, `fibre = 1, 0`: its name; else NULL */
  int listed;                    /* numbers in that list */
  double value; /* SI; of a formula in the middle of the lattice's or region's bodies */
  bool has_unit;
  dimension dim;             /* when has_unit */
  const deck_placed *placed; /* where it differs from place to place: a formula, or a file */
  const char *word;          /* a string that is not a number: an option's choice; else NULL */
  span name_where, value_where;
  /* of a &field: the law must declare one of that name; `anyway`: but for this law, which is beside
     that of the lattice */
  bool of_field, anyway;
} deck_assignment;

typedef struct deck_material {
  deck_item item;
  const char *lattice;           /* name; of a bar's the bar, of a link's the link */
  const char *bar, *link, *mesh; /* the same where the deck says that it is one; else NULL */
  const char *region;            /* name; NULL: of the whole lattice, but for what others say */
  const char *between[2];        /* names of regions; NULL: not of the bonds between two */
  const char *model;             /* name in models/ or a path ending in .plm */
  deck_assignment *assignments;
  int assignment_count;
  /* [varying_count] parameters that a &field makes differ in space */
  const char **varying;
  const span *varying_where;
  int varying_count;
  /* [regional_count] the materials of regions of the same lattice that have the same law; none for
     these themselves */
  const struct deck_material **regional;
  int regional_count;
  bool beside; /* other laws are at work on the lattice, too */
} deck_material;

typedef struct deck_crack { /* in the element-free part of a mesh, or on its edge */
  deck_item item;
  const char *name, *mesh;
  const double *points; /* x1, y1, x2, y2, ..., m */
  int point_count;      /* pairs */
  bool grows;
  bool symmetry;          /* on the edge of a mesh that is half of a body */
  const char *model;      /* law of its tips; NULL where it does not grow */
  deck_material material; /* that law with what the deck sets of it */
} deck_crack;

typedef enum tip_integral { TIPS_PLATEAU, TIPS_PYRAMID } tip_integral;

typedef struct deck_tips { /* how stress intensities are found, and how often */
  deck_item item;
  tip_integral integral;
  double half_size;   /* of the box, spacings along x */
  int points;         /* own points: cells of 2 x 2 a quadrant along either axis; 0: the mesh's */
  double from;        /* s: no look before */
  double check_every; /* s; 0: check_steps */
  int check_steps, updates;
  double segment;            /* least length of a leg before the crack may turn, spacings along x */
  double corner[3], size[3]; /* m: the rectangle in which cracks grow; size 0: the mesh */
} deck_tips;

/* A law at work on a lattice: that of its material without region first, then those of regions with
   another law, and of bonds between regions. */
typedef struct deck_interaction {
  const char *name; /* the lattice's; "plate.core", "plate.left-right" of the others */
  int lattice;
  const deck_material *material; /* NULL where the lattice has none */
} deck_interaction;

typedef enum field_kind { FIELD_UNIFORM, FIELD_NORMAL, FIELD_LOGNORMAL, FIELD_WEIBULL } field_kind;

typedef struct deck_number { /* in the unit of a parameter, which the law knows */
  bool given, has_unit;
  double value; /* SI */
  dimension dim;
} deck_number;

/* Bonds or particles: as the law has its parameters; a bond has the mean of its ends'. */
typedef enum field_place { FIELD_BY_LAW, FIELD_ON_BONDS, FIELD_ON_PARTICLES } field_place;

typedef struct deck_field { /* what a law is given, or a parameter that differs at random */
  deck_item item;
  const char *lattice, *parameter;
  const char *name, *mesh; /* of a field that the law declares; else NULL */
  bool random;             /* the values below hold */
  field_place on;
  field_kind kind;
  deck_number mean, low, high, scale; /* mean not given: the material's value */
  double cv, shape;                   /* 0: not given */
  double correlation_length;          /* m; 0: every bond or particle for itself */
  int seed;
  bool clip; /* values out of the law's range are moved to its bound */
} deck_field;

typedef struct deck_body { /* adds sites */
  deck_item item;
  const char *lattice;
  deck_shape shape;
} deck_body;

typedef struct deck_notch { /* removes sites, and bonds whose chord crosses it; a hole in a mesh */
  deck_item item;
  const char *lattice;
  const char *mesh; /* the same where the deck says that it is one; else NULL */
  deck_shape shape;
  bool cut_bonds; /* default true */
} deck_notch;

typedef struct deck_region {
  deck_item item;
  const char *name;
  const char *lattice; /* filled in when the deck has only one */
  deck_shape shape;
  const struct gmsh_group *group; /* of a mesh's file (gmsh_mesh.h); NULL: the deck's own */
} deck_region;

typedef struct deck_point_mass { /* carried by the particles of a region, without stiffness */
  deck_item item;
  const char *region;
  double mass;    /* kg: of each particle; 0: `total` is given */
  double total;   /* kg: of all, shared equally */
  double inertia; /* kg m^2: of each particle, about any axis */
} deck_point_mass;

/* Components in a deck are degrees of freedom of a particle: in the plane 0 x, 1 y, 2 rotation; in
   space 0 x, 1 y, 2 z, and 3, 4, 5 rotation about x, y, z. Bits of `fix` are 1 << component. */
enum { FIX_X = 1, FIX_Y = 2, FIX_ROTATION = 4, FIX_Z = 4 };

typedef struct deck_support {
  deck_item item;
  const char *region;
  int fix; /* bits */
} deck_support;

typedef struct deck_drive { /* prescribed motion: velocity or displacement; free before `start` */
  deck_item item;
  const char *region;
  int component;
  bool is_displacement;
  time_function motion; /* m/s or m (rad/s, rad) */
} deck_drive;

typedef struct deck_force { /* on the region, shared equally by its particles */
  deck_item item;
  const char *region;
  int component;       /* a rotation: moment in N*m */
  bool per_length;     /* by the particles' parts of their row */
  time_function force; /* N; per length N/m; of a traction Pa */
  /* of a traction: the mesh (else NULL), and the ends of the line that it acts on, or the name of
     lines of the mesh's file */
  const char *mesh;
  double from[3], to[3]; /* m */
  const char *edge;
} deck_force;
typedef deck_force deck_traction;
/* Of a traction on an edge, beside x and y: along the normal out of the body, or that turned by a
   right angle, counter-clockwise around the body. */
enum { TRACTION_NORMAL = 2, TRACTION_TANGENTIAL };

typedef struct deck_end_moment { /* horizontal forces, linear in y over the region, without
                                    resultant; N*m */
  deck_item item;
  const char *region;
  time_function moment; /* positive: counter-clockwise on the body */
} deck_end_moment;

typedef struct deck_protect { /* bonds that touch a particle within radius * spacing of the region:
                                 no damage */
  deck_item item;
  const char *region;
  double radius; /* in spacings; default 0: the region's own particles */
} deck_protect;

typedef struct deck_damping { /* kind 'mass': force -rate * mass * velocity on every particle */
  deck_item item;
  double rate;        /* 1/s; of a ratio it is known when the mode's frequency is (simulation.h) */
  double ratio;       /* of the critical damping of a mode; 0: the rate is given */
  int mode;           /* from 1 */
  double from, until; /* s; until may be infinite */
} deck_damping;

typedef struct deck_gravity { /* force mass * acceleration on every particle */
  deck_item item;
  double acceleration[3]; /* m/s^2 */
  time_function factor;   /* 1: full */
} deck_gravity;

typedef struct deck_contact {
  deck_item item;
  const char *name;
  const char **lattices; /* [lattice_count] one: with itself; none: all, and with themselves */
  int lattice_count;
  double stiffness; /* N/m, of two particles; 0: that of the softer lattice */
} deck_contact;

/* A rigid body without particles. It moves along `direction` as `motion` says; or, with a mass, as
   particles push it, at the beginning with the velocity motion.value. */
typedef struct deck_stamp {
  deck_item item;
  const char *name;
  deck_shape shape;      /* a rectangle, disc, box, cylinder or sphere without a hole */
  const char **lattices; /* [lattice_count] that it touches; none: all */
  int lattice_count;
  double mass;          /* kg; 0: its motion is prescribed */
  bool guided;          /* with a mass: it moves along `direction` alone */
  double direction[3];  /* of length 1; 0 where it stands */
  bool is_displacement; /* the motion is a way, m, else a velocity, m/s */
  time_function motion;
  double stiffness; /* N/m, of a particle; 0: that of its lattice */
  double friction;  /* coefficient */
  double damping;   /* of the critical one */
} deck_stamp;

typedef struct deck_tie { /* particles of the lattice that lie in the mesh move with it */
  deck_item item;
  const char *lattice, *mesh;
} deck_tie;

typedef struct deck_initial { /* of each particle of the region when the run begins */
  deck_item item;
  const char *region;
  int component;
  deck_placed value;
} deck_initial;
typedef deck_initial deck_initial_velocity;     /* m/s, rad/s */
typedef deck_initial deck_initial_displacement; /* m, rad */

typedef struct deck_stop {
  deck_item item;
  const char *monitor;
  bool below;   /* else above; compared with the monitor's absolute value */
  double level; /* in the monitor's unit, or a fraction when of_peak */
  bool of_peak; /* level times the largest absolute value so far */
  double after; /* s: not before; default 0 */
} deck_stop;

typedef struct deck_frame { /* taken beside those of &output */
  deck_item item;
  const double *at; /* [at_count] s */
  int at_count;     /* 0: when `event` comes for the first time */
  deck_stop event;
} deck_frame;

/* In the order of the deck's word. Without a note: a mean over the region, or at a place. */
typedef enum monitor_kind {
  MONITOR_REACTION,         /* N: force of a support or drive on the body; on it with scale = -1 */
  MONITOR_DISPLACEMENT,     /* m */
  MONITOR_VELOCITY,         /* m/s */
  MONITOR_OPENING,          /* m: displacement of the second region less that of the first */
  MONITOR_DAMAGED,          /* count of bonds with damage > `above` */
  MONITOR_BROKEN,           /* count of bonds with damage >= `above` */
  MONITOR_FIELD,            /* the law's: mean of a field or of an output on particles */
  MONITOR_ACCELERATION,     /* m/s^2 */
  MONITOR_MOMENTUM,         /* N s: of the region, as the next two, or of all particles */
  MONITOR_ANGULAR_MOMENTUM, /* N m s, about `about` */
  MONITOR_ENERGY,           /* J: kinetic or stored */
  MONITOR_FORCE,            /* N: through a section */
  MONITOR_MOMENT,           /* N m: through a section, about `at` */
  MONITOR_TIP,              /* m: way of the furthest damaged bond */
  MONITOR_TIP_SPEED,        /* m/s: of that */
  MONITOR_STRESS,           /* Pa */
  MONITOR_STRAIN,           /* 1 */
  MONITOR_APPLIED,          /* N, N m */
  MONITOR_BAR_FORCE,     /* N: along a bar, in the bond nearest to `at`, or the largest tension */
  MONITOR_SLIP,          /* m: of a link to places, nearest to `at`, or the largest in size */
  MONITOR_CONTACT_FORCE, /* N: of all contacts, on the region's or on all particles */
  MONITOR_CRACK_WIDTH,   /* m: of the widest crack across the line from `from` to `to` */
  MONITOR_CRACK,         /* of the tip of a crack in a mesh: tip_values.h */
  MONITOR_REACTIONS,     /* N, `between`: half of the second's reaction less the first's */
  /* Of a stamp: */
  MONITOR_STAMP_DISPLACEMENT, /* m: from where it is drawn */
  MONITOR_STAMP_VELOCITY,     /* m/s */
  MONITOR_STAMP_FORCE,        /* N: of the particles on it */
  MONITOR_STAMP_MOMENT        /* N m: of these about its middle */
} monitor_kind;

enum { MONITOR_KINETIC, MONITOR_STORED }; /* components of MONITOR_ENERGY */

typedef struct deck_monitor {
  deck_item item;
  const char *name;
  monitor_kind kind;
  const char *region;  /* NULL: `between`, or of `lattice` all particles, or those at `at` */
  const char *lattice; /* NULL: the region's, or the only one; of counts all */
  const char *between[2];
  const char *field;
  const char *stamp; /* NULL: of particles */
  const char *crack; /* "notch": its tip at the last point; "notch/start": that at the first */
  tip_value value;   /* of that tip */
  /* of the particles' motion; of MONITOR_FORCE, MONITOR_MOMENT -1: along the normal; of
     MONITOR_ANGULAR_MOMENTUM, MONITOR_MOMENT the axis x, y, z; of tensors as symmetric_tensor.h
     says */
  int component;
  bool placed;                    /* `at` is given */
  double at[3];                   /* m */
  double normal[3], direction[3]; /* of any length */
  double from[3], to[3];          /* m */
  double about[3];                /* m */
  double average; /* s: mean over this time before each sample; 0: value at the sample */
  double zero_at; /* s: the value then is subtracted; negative: never */
  double above;   /* DAMAGED: default 0; BROKEN: default 1; CRACK_WIDTH: default 0.99 */
  double scale;   /* factor on the value; default 1 (-1: downward load positive) */
} deck_monitor;

typedef struct deck_output {
  deck_item item;
  const char *result;  /* path; default: the deck's file name with .h5, in the working directory */
  int frames;          /* default 20 */
  double sample;       /* s: history interval; 0: chosen */
  const char **fields; /* "displacement", "velocity", "rotation", "force", "damage", "dissipated",
                          law fields */
  int field_count;
  const span *field_where; /* [field_count]; NULL when the key was not written */
  bool energy;             /* ledger on: default true */
  bool losses;             /* and what laws of families lose: default false */
  bool state;              /* the whole state at the end is kept: default false */
} deck_output;

typedef struct deck_start {
  deck_item item;
  const char *result; /* from the working directory; NULL: the run begins at rest */
} deck_start;

typedef struct deck_checkpoint {
  deck_item item;
  double interval; /* seconds of wall time; default 600; 0: only when stopped */
} deck_checkpoint;

typedef struct deck_relaxation { /* increments 0: a dynamic run */
  deck_item item;
  int increments;
  double tolerance; /* unbalanced force over the force needed */
  int most_steps;   /* of an increment */
  bool solved;      /* of a &static: each increment is one system of equations */
} deck_relaxation;

typedef struct deck_static { /* kept as a relaxation, `solved` */
  deck_item item;
  int increments;
} deck_static;

typedef struct deck_simulation {
  deck_item item;
  const char *title;
  double end_time;    /* s; of a number of periods it is 0 until their length is known */
  double periods;     /* of the lowest mode; 0: the time is given */
  double step;        /* s; 0: auto */
  double step_safety; /* default 0.25; of quasi-static runs 0.9 */
  int shrink_every;   /* steps between two looks at how long one may be; 0: it stays */
  int threads;        /* 0: as the machine offers */
} deck_simulation;

typedef struct deck_texts { /* of a key that takes several */
  const char **items;
  int count;
  const span *where; /* [count] inside the quotes */
} deck_texts;

/* Many runs of a deck, which `perilat study` does; a run of the deck itself takes no notice. */
typedef struct deck_study {
  deck_item item;
  deck_texts decks;     /* files; none: the deck that it stands in */
  deck_texts vary;      /* "group.key=v1, v2 with group.key=w1, w2" */
  deck_texts set;       /* "group.key=value", in all runs */
  const char *x, *y;    /* monitors; NULL: time, and load or the first */
  const char *result;   /* what its files are called; NULL: after the file */
  int jobs;             /* runs at the same time; 0: as many as there are processors */
  const char *converge; /* key that goes to 0 */
  const char *of;       /* "peak", "last" */
  const char *strength; /* "group.key=from..to:step", or the key alone */
  const char *watch;    /* monitor that says whether a load is borne */
  const char *twin;     /* deck of the same body by displacement, for its peak */
  double growth;        /* of that monitor while the load is held: more is a collapse */
  double limit;         /* m: beyond is a collapse */
  int longest;          /* hold, in those of the deck */
  deck_texts fit;       /* "group.key=low..high" */
  deck_texts to;        /* tables with measured curves, one for each deck */
  const double *weights;
  int weight_count;
  const char *search; /* "bobyqa", "nelder-mead" */
  int runs;           /* the most that the search may ask for */
} deck_study;

typedef struct deck_file { /* a table that a load was read from */
  const char *name;        /* as written, without columns */
  int source;              /* its text among the sources */
} deck_file;

/* The groups of a deck, in the order in which they are read, so that names are known before they
   are used: ONE is there once at most, LIST any number of times, MORE too, as more items of another
   list (`static`, which C lets no field be called, once: it is `at_rest`). Each has its structure
   above, its keys and its check in a group_*.c. */
#define DECK_GROUPS(ONE, LIST, MORE)                                                               \
  ONE(simulation)                                                                                  \
  ONE(relaxation)                                                                                  \
  MORE(static)                                                                                     \
  LIST(lattice)                                                                                    \
  MORE(bar)                                                                                        \
  MORE(link)                                                                                       \
  MORE(mesh)                                                                                       \
  LIST(zone)                                                                                       \
  LIST(crack)                                                                                      \
  ONE(tips)                                                                                        \
  ONE(newmark)                                                                                     \
  LIST(tie)                                                                                        \
  LIST(material)                                                                                   \
  LIST(field)                                                                                      \
  LIST(body)                                                                                       \
  LIST(notch)                                                                                      \
  LIST(region)                                                                                     \
  LIST(point_mass)                                                                                 \
  LIST(support)                                                                                    \
  LIST(drive)                                                                                      \
  LIST(force)                                                                                      \
  MORE(traction)                                                                                   \
  LIST(end_moment)                                                                                 \
  LIST(protect)                                                                                    \
  LIST(damping)                                                                                    \
  LIST(gravity)                                                                                    \
  LIST(contact)                                                                                    \
  LIST(stamp)                                                                                      \
  LIST(initial_velocity)                                                                           \
  LIST(initial_displacement)                                                                       \
  ONE(start)                                                                                       \
  LIST(monitor)                                                                                    \
  LIST(stop)                                                                                       \
  LIST(frame)                                                                                      \
  ONE(output)                                                                                      \
  ONE(checkpoint)                                                                                  \
  ONE(study)

typedef enum deck_group {
#define X(group) DECK_GROUP_##group,
  DECK_GROUPS(X, X, X)
#undef X
      DECK_GROUP_COUNT
} deck_group;

typedef struct deck_names deck_names;

typedef struct deck {
  const char *name;     /* of the source */
  const char *identity; /* text that is equal for decks that compute the same: overrides applied,
                           without comments, title, number of threads, checkpoints and studies */
  deck_file *files;     /* each once */
  int file_count;
  const deck_interaction *interactions; /* lattice by lattice */
  int interaction_count;
  uint64_t lacks;    /* groups of which items were left out: see deck_lacks */
  deck_names *names; /* of what deck_find_... finds; NULL: few, looked at one by one */
#define ONE(group) deck_##group group;
#define LIST(group)                                                                                \
  const deck_##group *group##s;                                                                    \
  int group##_count;
#define MORE(group)
  DECK_GROUPS(ONE, LIST, MORE)
#undef ONE
#undef LIST
#undef MORE
  deck_static at_rest;
} deck;

/* "group.key=value" as given by --set; a group that occurs several times is named group[k] (from 1)
   or, where groups have a name, group[name]. */
typedef struct deck_override {
  const char *text;
} deck_override;

/* Position of the group of that name (without regard to case) in DECK_GROUPS, or -1. */
int deck_group_find(const char *name);
/* Their names; `names` must hold DECK_GROUP_COUNT. Returns the count. */
int deck_group_names(const char **names);

/* Some item of that group ("body") may have been left out; NULL: of any group. */
bool deck_lacks(const deck *k, const char *group);

/* Index of the named thing, or -1. */
int deck_find_region(const deck *k, const char *name);
int deck_find_lattice(const deck *k, const char *name);
int deck_find_monitor(const deck *k, const char *name);
int deck_find_crack(const deck *k, const char *name);
int deck_find_contact(const deck *k, const char *name);
int deck_find_stamp(const deck *k, const char *name);
/* Index of the first &material of a lattice that is of the whole of it, or -1. */
int deck_find_material(const deck *k, const char *lattice);
/* That of lattice number `lattice`; NULL without one. */
const deck_material *deck_material_of(const deck *k, int lattice);
/* None of its `&body` was written; bars, links and particles of a file need none. */
bool deck_misses_body(const deck *k, int lattice);
/* For many searches: none of the names is known yet, they are taken up as the lists grow. */
deck_names *deck_names_new(arena *a);

/* A file that the deck at a path names, beside the deck unless its name begins with `/`;
   malloc'ed. */
char *deck_file_path(const char *deck_path, const char *name);

/* "x", "y", and "rotation" in the plane; "x", "y", "z", "rotation_x", ... in space. */
const char *deck_component_name(int dimensions, int component);

C_LINKAGE_END

#endif
