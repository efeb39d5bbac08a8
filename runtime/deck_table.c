#include "runtime/deck_table.h"

#include <string.h>
#include <strings.h>

#define AT(group, field)       .offset = (long)offsetof(deck_##group, field)
#define COUNT_AT(group, field) .count_offset = (long)offsetof(deck_##group, field)
#define NOT_KEPT               .offset = DECK_NO_FIELD

#define REGION_KEY(group, text)                                                                    \
  { .name = "region", .type = DECK_NAME, .required = true, AT(group, region), .doc = text }

#define SHAPE_KEYS(group)                                                                          \
  {.name = "shape",                                                                                \
   .type = DECK_CHOICE,                                                                            \
   .choices = "point|rectangle|disc|polygon",                                                      \
   .required = true,                                                                               \
   AT(group, shape.kind),                                                                          \
   .doc = "decides which of the keys below are needed"},                                           \
      {.name = "at",                                                                               \
       .type = DECK_PAIR,                                                                          \
       .unit = "m",                                                                                \
       AT(group, shape.at),                                                                        \
       .doc = "point: position; the nearest site is meant"},                                       \
      {.name = "within",                                                                           \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       .fallback = "= half a spacing",                                                             \
       AT(group, shape.within),                                                                    \
       .doc = "point: largest distance of that site"},                                             \
      {.name = "corner",                                                                           \
       .type = DECK_PAIR,                                                                          \
       .unit = "m",                                                                                \
       AT(group, shape.corner),                                                                    \
       .doc = "rectangle: lower left corner"},                                                     \
      {.name = "size",                                                                             \
       .type = DECK_PAIR,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       AT(group, shape.size),                                                                      \
       .doc = "rectangle: width, height"},                                                         \
      {.name = "centre",                                                                           \
       .type = DECK_PAIR,                                                                          \
       .unit = "m",                                                                                \
       AT(group, shape.centre),                                                                    \
       .doc = "disc: centre"},                                                                     \
      {.name = "radius",                                                                           \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_POSITIVE,                                                                    \
       AT(group, shape.radius),                                                                    \
       .doc = "disc: outer radius"},                                                               \
      {.name = "inner_radius",                                                                     \
       .type = DECK_REAL,                                                                          \
       .unit = "m",                                                                                \
       .bound = BOUND_NOT_NEGATIVE,                                                                \
       .fallback = "0",                                                                            \
       AT(group, shape.inner_radius),                                                              \
       .doc = "disc: radius of the hole"},                                                         \
  {                                                                                                \
    .name = "points", .type = DECK_REALS, .unit = "m", AT(group, shape.points),                    \
    COUNT_AT(group, shape.point_count), .doc = "polygon: x1, y1, x2, y2, x3, y3, ..."              \
  }

#define TIME_KEYS                                                                                  \
  {.name = "history",                                                                              \
   .type = DECK_LATER,                                                                             \
   .choices = "constant|ramp|ramp and hold|cosine|table",                                          \
   .fallback = "= 'constant'; 'ramp and hold' with a rise, 'table' with times",                    \
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
  {                                                                                                \
    .name = "values", .type = DECK_LATER, .unit = "1", NOT_KEPT,                                   \
    .doc = "table: factors on the value at those times, straight lines between"                    \
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
     .doc = "time step; `'auto'`: `step_safety` times the largest stable one"},
    {.name = "step_safety",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_FRACTION,
     .fallback = "0.25",
     AT(simulation, step_safety),
     .doc = "part of the largest stable step"},
    {.name = "threads",
     .type = DECK_COUNT,
     .fallback = "0",
     .most = 4096,
     AT(simulation, threads),
     .doc = "0: as many as the machine offers"},
};

static const deck_key_info lattice_keys[] = {
    {.name = "name", .type = DECK_NAME, .required = true, AT(lattice, name), .doc = "its name"},
    {.name = "kind",
     .type = DECK_WORD,
     .choices = "hexagonal",
     .required = true,
     AT(lattice, kind),
     .doc = "arrangement of the sites"},
    {.name = "spacing",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .required = true,
     AT(lattice, spacing),
     .doc = "distance of neighbouring sites"},
    {.name = "rotation",
     .type = DECK_ANGLE,
     .fallback = "0",
     AT(lattice, rotation),
     .doc = "angle from x to the rows of sites; a plain number is in degrees"},
    {.name = "origin",
     .type = DECK_PAIR,
     .unit = "m",
     .fallback = "0, 0",
     AT(lattice, origin),
     .doc = "a point that is a site"},
    {.name = "thickness",
     .type = DECK_REAL,
     .unit = "m",
     .bound = BOUND_POSITIVE,
     .required = true,
     AT(lattice, thickness),
     .doc = "out of the plane"},
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
     .choices = "plane_stress|plane_strain",
     .fallback = "'plane_stress'",
     AT(lattice, setting),
     .doc = "what the thickness direction does"},
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
     .choices = "x|y|xy|rotation",
     .required = true,
     AT(support, fix),
     .doc = "directions that are held; several: `fix = 'x', 'rotation'`"},
};

static const deck_key_info drive_keys[] = {
    REGION_KEY(drive, "what is moved"),
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|rotation",
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
     .choices = "x|y|rotation",
     .fallback = "= 'rotation' with a moment; else required",
     NOT_KEPT,
     .doc = "direction of the load"},
    {.name = "force",
     .type = DECK_LATER,
     .unit = "N",
     NOT_KEPT,
     .doc = "full force, of all particles together (`x`, `y`)"},
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
     .required = true,
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
     .type = DECK_PAIR,
     .unit = "m/s^2",
     .required = true,
     AT(gravity, acceleration),
     .doc = "full acceleration along x, y; e.g. 0, '-9.81 m/s^2'"},
    TIME_KEYS,
};

static const deck_key_info initial_velocity_keys[] = {
    REGION_KEY(initial_velocity, "what moves"),
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|rotation",
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
     .choices = "reaction|displacement|velocity|opening|damaged|broken",
     .required = true,
     AT(monitor, kind),
     .doc = "decides which of the next four keys are needed"},
    {.name = "region",
     .type = DECK_NAME,
     AT(monitor, region),
     .doc = "reaction: force that its supports and drives exert on the body; displacement, "
            "velocity: mean"},
    {.name = "between",
     .type = DECK_NAMES,
     AT(monitor, between),
     .doc = "opening: two regions; mean displacement of the second less that of the first"},
    {.name = "component",
     .type = DECK_CHOICE,
     .choices = "x|y|rotation",
     AT(monitor, component),
     .doc = "all kinds but damaged and broken: direction"},
    {.name = "above",
     .type = DECK_REAL,
     .unit = "1",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "= 0; broken: 1",
     AT(monitor, above),
     .doc = "damaged: bonds with more damage than this are counted; broken: bonds with at least "
            "this damage, e.g. 0.999 for laws whose bonds never separate completely"},
    {.name = "average",
     .type = DECK_REAL,
     .unit = "s",
     .bound = BOUND_NOT_NEGATIVE,
     .fallback = "0",
     AT(monitor, average),
     .doc = "mean over this time before each sample; 0: the value at the sample"},
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
     .fallback = "= end_time/2000",
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
    if (strcasecmp(g->keys[i].name, name) == 0) return i;
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
      fprintf(out, " | %s |\n", g->keys[k].doc);
    }
    fputc('\n', out);
  }
}
