/* Every group and key a deck may hold, in one table: it drives reading, suggestions, overrides and
 * the reference. */
#ifndef PERILAT_RUNTIME_DECK_TABLE_H
#define PERILAT_RUNTIME_DECK_TABLE_H

#include <stddef.h>

#include "runtime/deck/deck.h"

typedef enum deck_type {
  DECK_TEXT,   /* a text, perhaps empty */
  DECK_NAME,   /* a text that is not empty */
  DECK_NAMES,  /* several */
  DECK_WORD,   /* one of `choices`, kept as text */
  DECK_CHOICE, /* one of `choices`, kept as its position */
  DECK_FIXED,  /* list of directions, kept as bits: x 1, y 2, z 4, rotation 8 */
  DECK_REAL,
  DECK_STEP,  /* a time or 'auto', which is kept as 0 */
  DECK_PAIR,  /* two reals */
  DECK_PLACE, /* two reals in the plane, three in space */
  DECK_DIRECTION, /* three reals, not all 0 */
  DECK_REALS, /* list of reals */
  DECK_ANGLE, /* plain number: degrees; kept in rad */
  DECK_COUNT, /* int */
  DECK_LOGICAL,
  DECK_LATER /* its unit depends on other keys: read when those are known */
} deck_type;

typedef enum deck_bound {
  BOUND_NONE,
  BOUND_POSITIVE,
  BOUND_NOT_NEGATIVE,
  BOUND_FRACTION
} deck_bound;

enum { DECK_NO_FIELD = -1, DECK_MOST_KEYS = 24 };

typedef struct deck_key_info {
  const char *name;
  const char *former; /* a name that older decks give it, or NULL; deck_present_names mends it */
  deck_type type;
  const char *unit;    /* of reals, "1" for a pure number; shown only for DECK_LATER */
  const char *choices; /* "a|b|c" */
  deck_bound bound;
  const char *fallback; /* default as a deck would write it; "= ..." describes one that is computed;
                           NULL: none */
  bool required;
  long offset, count_offset; /* in the group's structure; DECK_NO_FIELD: not kept */
  int most;                  /* DECK_COUNT: largest value */
  const char *doc;
} deck_key_info;

typedef struct deck_group_info {
  const char *name;
  const char *identity; /* key that tells groups of this name apart in overrides, or NULL */
  bool single;          /* at most one in a deck */
  bool open;            /* other keys are assignments */
  const deck_key_info *keys;
  int key_count;
  const char *doc;
} deck_group_info;

/* In this order groups are read, so that names are known before they are used. X(name, identity,
 * single, open, doc) */
#define DECK_GROUPS(X)                                                                             \
  X(simulation, NULL, true, false, "The run as a whole. Required, once.")                          \
  X(relaxation, NULL, true, false,                                                                 \
    "Makes the run quasi-static: the loads come in increments, and after each the body comes to "  \
    "rest by damped motion.")                                                                      \
  X(lattice, "name", false, false,                                                                 \
    "A lattice of particles that bodies are cut from. At least one.")                              \
  X(material, "lattice", false, true,                                                              \
    "The law of a lattice's bonds. Every other key sets a parameter or an option of the law, "     \
    "e.g. `E = '30 GPa'`.")                                                                        \
  X(field, "parameter", false, false,                                                              \
    "A parameter of the law that differs from bond to bond at random, the same for the same "      \
    "seed whatever the threads. Uniform: `low` and `high`, or `cv`; normal, lognormal: `cv`; "     \
    "Weibull: `shape`, or `cv`.")                                                                  \
  X(body, "lattice", false, false,                                                                 \
    "Adds the lattice sites inside or on a shape. At least one for each lattice.")                 \
  X(notch, "lattice", false, false,                                                                \
    "Removes the sites inside or on a shape and, by default, the bonds that cross it.")            \
  X(region, "name", false, false,                                                                  \
    "Names the particles inside or on a shape, for loads and monitors.")                           \
  X(support, "region", false, false, "Holds particles where they are.")                            \
  X(drive, "region", false, false,                                                                 \
    "Prescribed motion of a region from `start` on; free before. Give `velocity` or "              \
    "`displacement`.")                                                                             \
  X(force, "region", false, false,                                                                 \
    "Force on a region, shared equally by its particles. Give `total` or `moment`.")               \
  X(end_moment, "region", false, false,                                                            \
    "Moment on a region: horizontal forces, linear in y, without resultant.")                      \
  X(protect, "region", false, false, "Bonds near a region take no damage.")                        \
  X(damping, NULL, false, false, "Slows the motion of every particle for a time.")                 \
  X(gravity, NULL, false, false,                                                                   \
    "Weight of every particle; several add up. Its work is in the energy ledger.")                 \
  X(initial_velocity, "region", false, false, "Velocity of a region when the run begins.")         \
  X(monitor, "name", false, false, "A quantity recorded at every sample of the history.")          \
  X(stop, "monitor", false, false, "Ends the run early, at a sample. Give `below` or `above`.")                 \
  X(output, NULL, true, false, "What is written, and how often.")                                  \
  X(checkpoint, NULL, true, false, "State from which a stopped or killed run goes on.")

typedef enum deck_group_kind {
#define X(name, identity, single, open, doc) DECK_GROUP_##name,
  DECK_GROUPS(X)
#undef X
      DECK_GROUP_COUNT
} deck_group_kind;

extern const deck_group_info deck_groups[DECK_GROUP_COUNT];

/* The groups that a kind of file may hold. */
typedef struct deck_grammar {
  const char *file; /* what such a file is called: "deck" */
  const deck_group_info *groups;
  int group_count;
} deck_grammar;
extern const deck_grammar deck_grammar_of_decks;

/* Position of the group or key of that name (without regard to case), or -1; a key also by its former name. */
int deck_group_find(const char *name);
int deck_key_find(const deck_group_info *g, const char *name);
/* Names for suggestions; `names` must hold DECK_GROUP_COUNT or DECK_MOST_KEYS. Returns the count.
 */
int deck_group_names(const char **names);
int deck_key_names(const deck_group_info *g, const char **names);

/* Splits "a|b|c" (at most `most` words) into an arena. */
int deck_choices(arena *a, const char *choices, const char **words, int most);

#endif
