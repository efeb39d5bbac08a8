/* Where a compiled law and the runtime meet; nothing else crosses. A kernel is a table of facts about a law
   and a few functions over strips of bonds. It knows nothing of lattices, loads or files.

   A strip is a run of bonds of one direction: bond k joins particle i(k) to j(k). On rows, i and j are unit-stride
   (near end and far end arrays, same index); on lists they are gathered through index arrays. Arrays hold, per
   degree of freedom, displacement (m) and velocity (m/s) components first, then rotations (rad, rad/s).
   Dimensions of this ABI: 2D now; dof = 2 (central) or 3 (micropolar). */
#ifndef PERILAT_RUNTIME_KERNEL_H
#define PERILAT_RUNTIME_KERNEL_H

#include <stdint.h>

#define PL_KERNEL_ABI 2
#define PL_MAX_DOF    6
#define PL_MAX_PLANES 12 /* force planes a bond */
#define PL_STATE_INPUTS                                                                            \
  5 /* planes of `states` before the fields: stretch, stretch_rate, theta_i, theta_j, length */
#define PL_STATE_RESULTS 3 /* N, M_i, M_j */
#define PL_STATE_RATES   4 /* inputs that the tangent is by: the first ones */
#define PL_TANGENTS      (PL_STATE_RESULTS * PL_STATE_RATES)
#define PL_LANES         8 /* strips on rows are multiples of this; arrays are aligned to PL_ALIGNMENT */
#define PL_ALIGNMENT     64

enum pl_law_kind { PL_CENTRAL = 0, PL_MICROPOLAR = 1, PL_STATE = 2 };
enum pl_field_kind { PL_FIELD_STATE = 0, PL_FIELD_DAMAGE = 1, PL_FIELD_OUTPUT = 2 };

/* Bits of a strip's flags. */
#define PL_PRESENT(direction)   (INT64_C(1) << (direction))        /* the bond exists */
#define PL_PROTECTED(direction) (INT64_C(1) << (32 + (direction))) /* its damage stays as it is */

/* Quantities that are the same for all bonds of one class (a direction of a lattice), in SI. */
typedef struct pl_bond_class {
  double s;              /* reference length, m */
  double spacing;        /* m */
  double t;              /* stiffness thickness, m */
  double V;              /* particle volume, m^3 */
  double mass_i, mass_j; /* kg */
  double area;           /* m^2, bars */
  double shell;          /* 1, 2, ... */
  double n;              /* bonds of a full family */
  double
      chord[3]; /* reference chord from i to j, m; |chord| = s (rows only; lists carry their own) */
} pl_bond_class;

typedef struct pl_parameter {
  const char *name, *unit, *doc;
  double initial; /* default, SI */
  int has_default;
} pl_parameter;

typedef struct pl_field {
  const char *name, *unit, *doc;
  double initial;
  int kind; /* pl_field_kind */
} pl_field;

typedef struct pl_strip {
  long count;           /* bonds; on rows a multiple of PL_LANES */
  long direction;       /* which bits of `flags` are meant */
  const int64_t *flags; /* [count] rows: flags of the sites i; lists: of the bonds */
  const double *displacement_i[PL_MAX_DOF], *displacement_j[PL_MAX_DOF];
  const double *velocity_i[PL_MAX_DOF], *velocity_j[PL_MAX_DOF];
  const int32_t *i, *j;   /* lists: the displacement and velocity arrays are indexed by these */
  const double *chord[3]; /* lists: reference chord components, m */
  const double *const
      *parameter; /* [varying][count] values of the parameters that differ from bond to bond */
  double *const *field; /* [fields][count] read and written in place */
  double *const *force; /* [force_planes][count] written; 0 where the bond is absent */
  double *
      dissipated_state; /* [count] J, added to: energy lost to damage and plasticity in this step */
  double *dissipated_rate; /* [count] J, added to: energy lost to rate terms in this step */
  double *const *observed; /* [1 + outputs][count]: stored energy (J), then each output */
  double time_step;        /* s */
} pl_strip;

struct pl_law;
typedef void (*pl_strip_function)(const struct pl_law *law, const double *uniforms,
                                  const pl_strip *strip);

/* Force planes. Central 2D: Fx, Fy on i (on j the opposite). Micropolar 2D: Fx, Fy, moment on i, moment on j. */
typedef struct pl_law {
  int abi;        /* PL_KERNEL_ABI; checked at load */
  int kind;       /* pl_law_kind */
  int dimensions; /* 2 */
  int dof;        /* per particle */
  int force_planes;
  const char *name;
  const char *key; /* hash of law, options, compiler and flags */
  int parameter_count;
  const pl_parameter *parameters;
  int varying_count; /* parameters that strips read bond by bond; all else takes them as given to `prepare` */
  const int *varying; /* [varying_count] their places in `parameters` */
  int field_count;
  const pl_field *fields;
  int output_count;
  const pl_field *outputs;
  int uniform_count;         /* doubles that `prepare` writes */
  double flops_per_bond;     /* of `rows`: additions, multiplications, selections */
  double divisions_per_bond; /* of `rows`: divisions and roots */

  /* Values that depend on parameters and bond class only. */
  void (*prepare)(const struct pl_law *law, const double *parameters, const pl_bond_class *bonds,
                  double *uniforms);
  /* lower[p] and upper[p] of every parameter given all values (open ends: low_open, high_open = 1). */
  void (*bounds)(const struct pl_law *law, const double *parameters, double *lower, double *upper,
                 unsigned char *low_open, unsigned char *high_open);

  pl_strip_function rows;         /* forces and new fields */
  pl_strip_function rows_ledger;  /* the same and dissipated energies */
  pl_strip_function rows_observe; /* stored energy and outputs; changes nothing */
  pl_strip_function list, list_ledger, list_observe;

  /* The law alone, state by state. in: [PL_STATE_INPUTS + fields][count] stretch, stretch_rate, theta_i, theta_j,
     length (m), then fields; out: [PL_STATE_RESULTS + fields][count] N (N), M_i, M_j (N m; 0 for central laws), then new fields. */
  void (*states)(const struct pl_law *law, const double *uniforms, long count,
                 const double *const *in, double *const *out);
  /* Symbolic tangent at such states: out[PL_TANGENTS][count] = dN/d(stretch, rate, theta_i, theta_j), dM_i/d..., dM_j/d... */
  void (*tangent)(const struct pl_law *law, const double *uniforms, long count,
                  const double *const *in, double *const *out);

  const void *context; /* the interpreter's; NULL in compiled kernels */
} pl_law;

/* The one symbol that a compiled kernel exports. */
typedef const pl_law *(*pl_kernel_entry)(void);
#define PL_KERNEL_ENTRY "perilat_kernel"

#endif
