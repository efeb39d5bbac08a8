#include "runtime/deck/deck_table.h"

#include <string.h>
#include <strings.h>

#define AT(group, field)       .offset = (long)offsetof(deck_##group, field)
#define COUNT_AT(group, field) .count_offset = (long)offsetof(deck_##group, field)
#define NOT_KEPT               .offset = DECK_NO_FIELD

#define REGION_KEY(group, text)                                                                    \
  { .name = "region", .type = DECK_NAME, .required = true, AT(group, region), .doc = text }

#define SHAPE_KEYS(group)                                                                           \
  {.name = "shape",                                                                                 \
   .type = DECK_CHOICE,                                                                             \
   .choices = "point|rectangle|disc|polygon|dog_bone|segment|box|cylinder|sphere|extrusion|face",   \
   .required = true,                                                                                \
   AT(group, shape.kind),                                                                           \
   .doc = "decides which of the keys below are needed; those from `box` on are "                    \
          "of space, a point is of both"},                                                          \
  {.name = "at",                                                                                    \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.at),                                                                             \
   .doc = "point: position; the nearest site is meant"},                                            \
  {.name = "within",                                                                                \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   .fallback = "= half a spacing",                                                                  \
   AT(group, shape.within),                                                                         \
   .doc = "point: largest distance of that site"},                                                  \
  {.name = "corner",                                                                                \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.corner),                                                                         \
   .doc = "rectangle, box: the corner of least coordinates"},                                       \
  {.name = "size",                                                                                  \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   AT(group, shape.size),                                                                           \
   .doc = "rectangle, box: extent along x, y, z"},                                                  \
  {.name = "rotation",                                                                              \
   .type = DECK_ANGLE,                                                                              \
   .fallback = "0",                                                                                 \
   AT(group, shape.rotation),                                                                       \
   .doc = "rectangle: about its corner; dog-bone: about its centre; a plain "                       \
          "number is in degrees"},                                                                  \
  {.name = "centre",                                                                                \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.centre),                                                                         \
   .doc = "disc, dog-bone, sphere: centre"},                                                        \
  {.name = "radius",                                                                                \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   AT(group, shape.radius),                                                                         \
   .doc = "disc, cylinder, sphere: outer radius; dog-bone: of the arcs at its "                     \
          "neck"},                                                                                  \
  {.name = "inner_radius",                                                                          \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_NOT_NEGATIVE,                                                                     \
   .fallback = "0",                                                                                 \
   AT(group, shape.inner_radius),                                                                   \
   .doc = "disc, cylinder, sphere: radius of the hole"},                                            \
  {.name = "width",                                                                                 \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   AT(group, shape.width),                                                                          \
   .doc = "dog-bone: of its ends"},                                                                 \
  {.name = "height",                                                                                \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   AT(group, shape.height),                                                                         \
   .doc = "dog-bone: from end to end"},                                                             \
  {.name = "neck",                                                                                  \
   .type = DECK_REAL,                                                                               \
   .unit = "m",                                                                                     \
   .bound = BOUND_POSITIVE,                                                                         \
   AT(group, shape.neck),                                                                           \
   .doc = "dog-bone: width in the middle, between two arcs"},                                       \
  {.name = "from",                                                                                  \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.from),                                                                           \
   .doc = "segment, cylinder: one end, of the cylinder's axis"},                                    \
  {.name = "to",                                                                                    \
   .type = DECK_PLACE,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.to),                                                                             \
   .doc = "segment, cylinder: the other end"},                                                      \
  {.name = "z",                                                                                     \
   .type = DECK_PAIR,                                                                               \
   .unit = "m",                                                                                     \
   AT(group, shape.z),                                                                              \
   .doc = "extrusion: from where to where the polygon reaches"},                                    \
  {.name = "points",                                                                                \
   .type = DECK_REALS,                                                                              \
   .unit = "m",                                                                                     \
   AT(group, shape.points),                                                                         \
   COUNT_AT(group, shape.point_count),                                                              \
   .doc = "polygon, extrusion: x1, y1, x2, y2, x3, y3, ...; face: x1, y1, z1, "                     \
          "... of the corners of a plane polygon in space"},                                        \
  {.name = "bulge",                                                                                 \
   .type = DECK_REALS,                                                                              \
   .unit = "m",                                                                                     \
   .fallback = "= straight edges",                                                                  \
   AT(group, shape.bulge),                                                                          \
   COUNT_AT(group, shape.bulge_count),                                                              \
   .doc = "polygon, extrusion: for each point, how far the edge that begins "                       \
          "there rises as an arc above its chord, outward positive, 0: straight"}

#define TIME_KEYS                                                                                  \
  {.name = "history",                                                                              \
   .type = DECK_LATER,                                                                             \
   .choices = "constant|ramp|ramp and hold|cosine|table",                                          \
   .fallback = "= 'constant', in quasi-static runs a ramp over the run; 'ramp and hold' with a "    \
               "rise, 'table' with times or a file",                                               \
   NOT_KEPT,                                                                                       \
   .doc = "how the value develops in time"},                                                       \
      {.name = "start",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       .fallback = "= 0",                                                                          \
       NOT_KEPT,                                                                                   \
       .doc = "nothing acts before"},                                                              \
      {.name = "rise",                                                                             \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       NOT_KEPT,                                                                                   \
       .doc = "time from `start` until the full value is reached"},                                \
      {.name = "times",                                                                            \
       .type = DECK_LATER,                                                                         \
       .unit = "s",                                                                                \
       NOT_KEPT,                                                                                   \
       .doc = "table: times after `start`, ascending"},                                            \
      {.name = "values",                                                                           \
       .type = DECK_LATER,                                                                         \
       .unit = "1",                                                                                \
       NOT_KEPT,                                                                                   \
       .doc = "table: factors on the value at those times, straight lines between"},               \
  {                                                                                                \
    .name = "file", .type = DECK_LATER, NOT_KEPT,                                                  \
    .doc = "table: instead of `times` and `values`, two columns of a text file beside the deck; "  \
           "factors on the value, or with a unit and without the value the load itself"            \
  }

static const deck_key_info simulation_keys[] = {
    {.name = "title",
     .type = DECK_TEXT,
     .fallback = "= the deck's name",
     AT(simulation, title),
     .doc = "heading of pictures and results"},
    {.name = "end_time",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .required = true,
     AT(simulation, end_time),
     .doc = "the run begins at 0 and ends here"},
    {.name = "step",
     .type = DECK_STEP,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "'auto'",
     AT(simulation, step),
     .doc = "time step; `'auto'`: `step_safety` times the largest stable one, that of small "
            "strains"},
    {.name = "step_safety",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_FRACTION,
     .fallback = "= 0.25; with &relaxation 0.9",
     AT(simulation, step_safety),
     .doc = "part of the largest stable step"},
    {.name = "threads",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 4096,
     AT(simulation, threads),
     .doc = "0: as many as the machine offers"},
};

static const deck_key_info relaxation_keys[] = {
    {.name = "increments",
     .type = DECK_COUNT,
     .required = true,
     .most = 1000000,
     AT(relaxation, increments),
     .doc = "equal parts of `end_time` in which the loads come; the history has a sample after each"},
    {.name = "tolerance",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_FRACTION,
     .fallback = "1e-4",
     AT(relaxation, tolerance),
     .doc = "an increment is done when the unbalanced force is this part of the reactions or loads"},
    {.name = "most_steps",
     .type = DECK_COUNT,
     .fallback = "100000",
     .most = 1000000000,
     AT(relaxation, most_steps),
     .doc = "an increment that needs more steps is left as it is"},
};

static const deck_key_info lattice_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, AT(lattice, name), .doc = "its name"},
    {.name = "kind",
     .type = DECK_WORD,
     .choices = "hexagonal|square|cubic|fcc|blue_noise|particles",
     .required = true,
     AT(lattice, kind),
     .doc = "arrangement of the sites: `hexagonal` and `square` in the plane, `cubic` and `fcc` (edges of the cubes "
            "along x, y, z) in space; without a lattice, in the plane or in space as `setting` says: `blue_noise`, even "
            "but at random, and `particles`, read from a `file`"},
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= from the mean volume with kind `particles`; else required",
     AT(lattice, spacing),
     .doc = "distance of nearest neighbours; `blue_noise`, `particles`: in the hexagonal or fcc lattice with particles as "
            "large"},
    {.name = "horizon",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     .fallback = "= the nearest neighbours",
     AT(lattice, horizon),
     .doc = "in spacings: bonds join sites as far apart as this, and 0.1 % more; e.g. 3.015"},
    {.name = "shells",
     .type = DECK_COUNT,
     .fallback = "= 1",
     .most = 64,
     AT(lattice, shells),
     .doc = "instead of the horizon: 1 for the nearest neighbours, 2 for the second nearest, too, and so on"},
    {.name = "neighbours",
     .type = DECK_COUNT,
     .fallback = "= 12, in space 18, without a horizon",
     .most = 128,
     AT(lattice, neighbours),
     .doc = "`blue_noise`, `particles`, instead of the horizon: a bond joins two particles when either is among so many "
            "nearest ones of the other"},
    {.name = "seed",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 2147483647,
     AT(lattice, seed),
     .doc = "`blue_noise`: another seed gives another set of particles"},
    {.name = "file",
     .type = DECK_NAME,
     .fallback = "= none; required with kind `particles`",
     AT(lattice, file),
     .doc = "`particles`: a table (`.csv`) or a result (`.h5`), beside the deck"},
    {.name = "volume_correction",
     .type = DECK_CHOICE,
     .choices = "none|linear",
     .fallback = "'none'",
     AT(lattice, volume_correction),
     .doc = "part of a neighbour's volume that counts, for laws that use it; `linear`: (horizon + spacing/2 - "
            "distance)/spacing, from 0 to 1"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     AT(lattice, rotation),
     .doc = "angle from x to the rows of sites; a plain number is in degrees"},
    {.name = "axis",
     .type = DECK_DIRECTION,
     .unit = "1",
     .fallback = "= 0, 0, 1",
     AT(lattice, axis),
     .doc = "in space: direction about which the lattice is rotated"},
    {.name = "origin",
     .type = DECK_PLACE,
     .unit = "m",
     .fallback = "= 0, 0",
     AT(lattice, origin),
     .doc = "a point that is a site"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= none; required in the plane",
     AT(lattice, thickness),
     .doc = "out of the plane; the thicknesses are not for lattices in space"},
    {.name = "stiffness_thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= thickness",
     AT(lattice, stiffness_thickness),
     .doc = "thickness that the law sees as `t`"},
    {.name = "mass_thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .fallback = "= thickness",
     AT(lattice, mass_thickness),
     .doc = "thickness for volume and mass"},
    {.name = "setting",
     .type = DECK_WORD,
     .choices = "plane_stress|plane_strain|space",
     .fallback = "= 'plane_stress'",
     AT(lattice, setting),
     .doc = "what the thickness direction does; `space`: `blue_noise` and `particles` in space"},
};

static const deck_key_info material_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     AT(material, lattice),
     .doc = "name of the lattice"},
    {.name = "model",
     .type = DECK_NAME,
     .required = true,
     AT(material, model),
     .doc = "name of a law in `models/`, or a path that ends in `.plm`"},
};

static const deck_key_info field_keys[] = {
    {.name = "parameter",
     .type = DECK_NAME,
     .required = true,
     AT(field, parameter),
     .doc = "of the law, but not `rho`"},
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= the only one",
     AT(field, lattice),
     .doc = "name of the lattice; needed when there are several"},
    {.name = "on",
     .type = DECK_WORD,
     .choices = "bond|particle",
     .fallback = "'bond'",
     NOT_KEPT,
     .doc = "`particle`: a value for each particle; a bond has the mean of its two ends"},
    {.name = "distribution",
     .type = DECK_CHOICE,
     .choices = "uniform|normal|lognormal|weibull",
     .required = true,
     AT(field, kind),
     .doc = "of the values"},
    {.name = "mean",
     .type = DECK_LATER,
     .unit = "as the parameter",
     .fallback = "= the material's value",
     NOT_KEPT,
     .doc = "mean of the values"},
    {.name = "cv",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     AT(field, cv),
     .doc = "standard deviation over mean"},
    {.name = "low",
     .type = DECK_LATER,
     .unit = "as the parameter",
     NOT_KEPT,
     .doc = "uniform: smallest value"},
    {.name = "high",
     .type = DECK_LATER,
     .unit = "as the parameter",
     NOT_KEPT,
     .doc = "uniform: largest value"},
    {.name = "shape",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_POSITIVE,
     AT(field, shape),
     .doc = "Weibull: exponent; the part of values above x is exp(-(x/scale)**shape)"},
    {.name = "scale",
     .type = DECK_LATER,
     .unit = "as the parameter",
     .fallback = "= from the mean",
     NOT_KEPT,
     .doc = "Weibull: see shape"},
    {.name = "correlation_length",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(field, correlation_length),
     .doc = "L in exp(-(r/L)**2), the correlation of the underlying normal field at a distance r; "
            "0: none"},
    {.name = "seed",
     .type = DECK_COUNT,
     .fallback = "1",
     .most = 2147483647,
     AT(field, seed),
     .doc = "another seed gives another field"},
    {.name = "clip",
     .type = DECK_LOGICAL,
     .fallback = ".false.",
     AT(field, clip),
     .doc = "move values that the law does not allow to the nearest that it allows; else they are "
            "an error"},
};

static const deck_key_info body_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     AT(body, lattice),
     .doc = "name of the lattice"},
    SHAPE_KEYS(body),
};

static const deck_key_info notch_keys[] = {
    {.name = "lattice",
     .type = DECK_NAME,
     .required = true,
     AT(notch, lattice),
     .doc = "name of the lattice"},
    {.name = "cut_bonds",
     .type = DECK_LOGICAL,
     .fallback = ".true.",
     AT(notch, cut_bonds),
     .doc = "also remove bonds between remaining sites whose line crosses the shape"},
    SHAPE_KEYS(notch),
};

static const deck_key_info region_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, AT(region, name), .doc = "its name"},
    {.name = "lattice",
     .type = DECK_NAME,
     .fallback = "= the only one",
     AT(region, lattice),
     .doc = "name of the lattice; needed when there are several"},
    SHAPE_KEYS(region),
};

static const deck_key_info support_keys[] = {
    REGION_KEY(support, "what is held"),
    {.name = "fix",
     .type = DECK_FIXED,
     .choices = "x|y|z|xy|xz|yz|xyz|rotation",
     .required = true,
     AT(support, fix),
     .doc = "directions that are held; several: `fix = 'x', 'rotation'`. Here and below, `z` is for lattices in "
            "space, `rotation` for those in the plane"},
};

static const deck_key_info drive_keys[] = {
    REGION_KEY(drive, "what is moved"),
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|z|rotation",
     .required = true,
     AT(drive, component),
     .doc = "direction of the motion"},
    {.name = "velocity",
     .type = DECK_LATER,
     .unit = "m/s; rotation: rad/s",
     NOT_KEPT,
     .doc = "full velocity"},
    {.name = "displacement",
     .type = DECK_LATER,
     .unit = "m; rotation: rad",
     NOT_KEPT,
     .doc = "full displacement, counted from where the region is at `start`"},
    TIME_KEYS,
};

static const deck_key_info force_keys[] = {
    REGION_KEY(force, "what is loaded"),
    {.name = "component",
     .type = DECK_LATER,
     .choices = "x|y|z|rotation",
     .fallback = "= 'rotation' with a moment; else required",
     NOT_KEPT,
     .doc = "direction of the load"},
    {.name = "total",
     .former = "force", /* Fortran's own reader wants no variable named like its group */
     .type = DECK_LATER,
     .unit = "N",
     NOT_KEPT,
     .doc = "full force, of all particles together (`x`, `y`, `z`)"},
    {.name = "moment",
     .type = DECK_LATER,
     .unit = "N*m",
     NOT_KEPT,
     .doc = "full moment, of all particles together (`rotation`)"},
    TIME_KEYS,
};

static const deck_key_info end_moment_keys[] = {
    REGION_KEY(end_moment, "what is loaded, e.g. the end columns of a beam"),
    {.name = "moment",
     .type = DECK_LATER,
     .unit = "N*m",
     .fallback = "= required, but for a file with a unit",
     NOT_KEPT,
     .doc = "full moment; counter-clockwise on the body is positive"},
    TIME_KEYS,
};

static const deck_key_info protect_keys[] = {
    REGION_KEY(protect, "around which bonds stay whole"),
    {.name = "radius",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(protect, radius),
     .doc = "in spacings: all bonds of particles within it; 0: of the region's own particles"},
};

static const deck_key_info damping_keys[] = {
    {.name = "kind",
     .type = DECK_WORD,
     .choices = "mass",
     .fallback = "'mass'",
     NOT_KEPT,
     .doc = "`mass`: force = -rate * mass * velocity"},
    {.name = "rate",
     .type = DECK_REAL,
     .unit = "1/s",
     .bound = BOUND_POSITIVE,
     .required = true,
     AT(damping, rate),
     .doc = "how fast velocities decay"},
    {.name = "from",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(damping, from),
     .doc = "begin"},
    {.name = "until",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "= the end of the run",
     AT(damping, until),
     .doc = "end"},
};

static const deck_key_info gravity_keys[] = {
    {.name = "acceleration",
     .type = DECK_PLACE,
     .unit = "m/s^2",
     .required = true,
     AT(gravity, acceleration),
     .doc = "full acceleration along x, y and, in space, z; e.g. 0, '-9.81 m/s^2'"},
    TIME_KEYS,
};

static const deck_key_info initial_velocity_keys[] = {
    REGION_KEY(initial_velocity, "what moves"),
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|z|rotation",
     .required = true,
     AT(initial_velocity, component),
     .doc = "direction of the motion"},
    {.name = "value",
     .type = DECK_LATER,
     .unit = "m/s; rotation: rad/s",
     .required = true,
     NOT_KEPT,
     .doc = "the velocity, of each particle"},
};

static const deck_key_info monitor_keys[] = {
    {.name = "name",
     .type = DECK_NAME,
     .required = true,
     AT(monitor, name),
     .doc = "letters, digits and `_`; its name in the result"},
    {.name = "kind",
     .type = DECK_CHOICE,
     .choices = "reaction|displacement|velocity|opening|damaged|broken|field",
     .required = true,
     AT(monitor, kind),
     .doc = "decides which of the next five keys are needed"},
    {.name = "region",
     .type = DECK_NAME,
     AT(monitor, region),
     .doc = "reaction: force that its supports and drives exert on the body; displacement, "
            "velocity, field: mean"},
    {.name = "between",
     .type = DECK_NAMES,
     AT(monitor, between),
     .doc = "two regions; opening: mean displacement of the second less that of the first; "
            "reaction, in place of `region`: half the reaction of the second less that of the "
            "first, what the two ends of a specimen carry in the mean"},
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|z|rotation",
     AT(monitor, component),
     .doc = "reaction, displacement, velocity, opening: direction"},
    {.name = "field",
     .type = DECK_NAME,
     AT(monitor, field),
     .doc = "field: name of a state, damage or output of the law that stands on particles"},
    {.name = "above",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= 0; broken: 1",
     AT(monitor, above),
     .doc = "damaged: bonds with more damage than this are counted (particles, where the law's "
            "damage stands on these alone); broken: those with at least this damage, e.g. 0.999 "
            "for laws whose bonds never separate completely"},
    {.name = "average",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(monitor, average),
     .doc = "mean of all states of this time before each sample, the present one included; of a "
            "velocity way over time; 0: the value at the sample"},
    {.name = "zero_at",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= never",
     AT(monitor, zero_at),
     .doc = "the value at this time is subtracted"},
    {.name = "scale",
     .type = DECK_REAL,
     .unit = "1",
     .fallback = "1",
     AT(monitor, scale),
     .doc = "factor on the value, e.g. -1 to count a downward load positive"},
};

static const deck_key_info stop_keys[] = {
    {.name = "monitor",
     .type = DECK_NAME,
     .required = true,
     AT(stop, monitor),
     .doc = "name of the monitor that decides"},
    {.name = "below",
     .type = DECK_LATER,
     .unit = "as the monitor",
     NOT_KEPT,
     .doc = "stop when its absolute value is less"},
    {.name = "above",
     .type = DECK_LATER,
     .unit = "as the monitor",
     NOT_KEPT,
     .doc = "stop when its absolute value is more"},
    {.name = "of",
     .type = DECK_WORD,
     .choices = "peak",
     NOT_KEPT,
     .doc = "`below` is a fraction of the largest absolute value so far"},
    {.name = "after",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(stop, after),
     .doc = "not before this time"},
};

static const deck_key_info output_keys[] = {
    {.name = "result",
     .type = DECK_NAME,
     .fallback = "= the deck's name with .h5, in the working folder",
     AT(output, result),
     .doc = "path of the result file, from the working folder"},
    {.name = "frames",
     .type = DECK_COUNT,
     .fallback = "20",
     .most = 100000,
     AT(output, frames),
     .doc = "states stored after the initial one, which is frame 0; evenly spaced"},
    {.name = "sample",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_POSITIVE,
     .fallback = "= end_time/2000, at least 200 steps",
     AT(output, sample),
     .doc = "interval of the history"},
    {.name = "fields",
     .type = DECK_NAMES,
     .fallback = "'displacement', 'damage'",
     AT(output, fields),
     COUNT_AT(output, field_count),
     .doc = "stored in each frame: displacement, velocity, rotation, force, damage (all of the "
            "law's, and their mean per particle), dissipated (energy lost, per particle), or a "
            "state, damage, output or random parameter of the law"},
    {.name = "energy",
     .type = DECK_LOGICAL,
     .fallback = ".true.",
     AT(output, energy),
     .doc = "keep the energy ledger"},
};

static const deck_key_info checkpoint_keys[] = {
    {.name = "interval",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "'600 s'",
     AT(checkpoint, interval),
     .doc = "of wall time between two checkpoints; 0: only when the run is stopped"},
};

const deck_group_info deck_groups[DECK_GROUP_COUNT] = {
#define X(group, key, once, more, text)                                                            \
  {.name = #group,                                                                                 \
   .identity = key,                                                                                \
   .single = once,                                                                                 \
   .open = more,                                                                                   \
   .keys = group##_keys,                                                                           \
   .key_count = (int)(sizeof(group##_keys) / sizeof(group##_keys[0])),                             \
   .doc = text},
    DECK_GROUPS(X)
#undef X
};

const deck_grammar deck_grammar_of_decks = {"deck", deck_groups, DECK_GROUP_COUNT};

#define X(group, key, once, more, text)                                                            \
  _Static_assert(sizeof(group##_keys) / sizeof(group##_keys[0]) <= DECK_MOST_KEYS, "too many "     \
                                                                                   "keys");
DECK_GROUPS(X)
#undef X

int deck_group_find(const char *name) {
  for (int i = 0; i < DECK_GROUP_COUNT; i++)
    if (strcasecmp(deck_groups[i].name, name) == 0) return i;
  return -1;
}

int deck_key_find(const deck_group_info *g, const char *name) {
  for (int i = 0; i < g->key_count; i++)
    if (strcasecmp(g->keys[i].name, name) == 0 ||
        (g->keys[i].former && strcasecmp(g->keys[i].former, name) == 0))
      return i;
  return -1;
}

int deck_group_names(const char **names) {
  for (int i = 0; i < DECK_GROUP_COUNT; i++)
    names[i] = deck_groups[i].name;
  return DECK_GROUP_COUNT;
}

int deck_key_names(const deck_group_info *g, const char **names) {
  for (int i = 0; i < g->key_count; i++)
    names[i] = g->keys[i].name;
  return g->key_count;
}

int deck_choices(arena *a, const char *choices, const char **words, int most) {
  int count = 0;
  while (*choices && count < most) {
    size_t length = strcspn(choices, "|");
    words[count++] = arena_text(a, choices, length);
    choices += length + (choices[length] == '|');
  }
  return count;
}

/* --- reference -------------------------------------------------------------------------------- */

static void print_choices(const char *choices, FILE *out) {
  for (const char *p = choices; *p;) {
    size_t length = strcspn(p, "|");
    fprintf(out, "%s`'%.*s'`", p == choices ? "" : ", ", (int)length, p);
    p += length + (p[length] == '|');
  }
}

static void print_type(const deck_key_info *key, FILE *out) {
  bool pure = key->unit && strcmp(key->unit, "1") == 0;
  const char *shown = pure ? "a pure number" : key->unit;
  if (key->choices) {
    print_choices(key->choices, out);
    return;
  }
  switch (key->type) {
  case DECK_PAIR:
    fprintf(out, "two values, %s", shown);
    break;
  case DECK_DIRECTION:
    fputs("three pure numbers", out);
    break;
  case DECK_PLACE:
    fprintf(out, "two values, in space three, %s", shown);
    break;
  case DECK_REALS:
    fprintf(out, "list, %s", shown);
    break;
  case DECK_STEP:
    fprintf(out, "%s or `'auto'`", shown);
    break;
  case DECK_ANGLE:
    fputs("degrees, or `'0.3 rad'`", out);
    break;
  case DECK_COUNT:
    fprintf(out, "whole number, 0 to %d", key->most);
    break;
  case DECK_LOGICAL:
    fputs("`.true.` or `.false.`", out);
    break;
  case DECK_NAMES:
    fputs("texts", out);
    break;
  default:
    fputs(shown ? shown : "text", out);
  }
}

static void print_default(const deck_key_info *key, FILE *out) {
  if (key->required)
    fputs("required", out);
  else if (key->fallback && key->fallback[0] == '=')
    fputs(key->fallback + 2, out);
  else if (key->fallback)
    fprintf(out, "`%s`", key->fallback);
}

void deck_reference(FILE *out) {
  for (int i = 0; i < DECK_GROUP_COUNT; i++) {
    const deck_group_info *g = &deck_groups[i];
    fprintf(out, "### &%s\n\n%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n",
            g->name, g->doc);
    for (int k = 0; k < g->key_count; k++) {
      fprintf(out, "| `%s` | ", g->keys[k].name);
      print_type(&g->keys[k], out);
      fputs(" | ", out);
      print_default(&g->keys[k], out);
      fprintf(out, " | %s", g->keys[k].doc);
      if (g->keys[k].former) fprintf(out, "; formerly `%s`", g->keys[k].former);
      fputs(" |\n", out);
    }
    fputc('\n', out);
  }
}
