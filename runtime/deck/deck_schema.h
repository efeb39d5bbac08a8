/* What a group of a deck and its keys are: how a key is written, its unit, its bounds, where its
   value is kept. The groups themselves stand in group_*.c. */
#ifndef PERILAT_RUNTIME_DECK_SCHEMA_H
#define PERILAT_RUNTIME_DECK_SCHEMA_H

#include <stddef.h>

#include "runtime/base/namelist.h"
#include "runtime/deck/deck.h"

typedef enum deck_type {
  DECK_TEXT,   /* a text, perhaps empty */
  DECK_NAME,   /* a text that is not empty */
  DECK_NAMES,  /* several */
  DECK_WORD,   /* one of `choices`, kept as text */
  DECK_CHOICE, /* one of `choices`, kept as its position */
  DECK_FIXED,  /* list of directions, kept as bits: 1 << place in DECK_COMPONENTS */
  DECK_REAL,
  DECK_STEP,      /* a time or 'auto', which is kept as 0 */
  DECK_END,       /* a time or a number of periods, which is kept, a double, at count_offset */
  DECK_PAIR,      /* two reals */
  DECK_PLACE,     /* two reals in the plane, three in space */
  DECK_DIRECTION, /* three reals, not all 0 */
  DECK_REALS,     /* list of reals */
  DECK_ANGLE,     /* plain number: degrees; kept in rad */
  DECK_COUNT,     /* int */
  DECK_LOGICAL,
  DECK_LATER /* its unit depends on other keys: read when those are known */
} deck_type;

typedef enum deck_bound {
  BOUND_NONE,
  BOUND_POSITIVE,
  BOUND_NOT_NEGATIVE,
  BOUND_FRACTION
} deck_bound;

enum { DECK_NO_FIELD = -1, DECK_MOST_KEYS = 28 };

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

struct deck_reader;
/* Completes one item from its group; its plain keys have been read without error. The item is not
   yet counted in the deck. */
typedef void deck_group_check(struct deck_reader *r, const namelist_group *from, void *item);

typedef struct deck_group_info {
  const char *name;
  const char *identity; /* key that tells groups of this name apart in overrides, or NULL */
  const char *parts[5]; /* keys that do so in its place where a group has them, the last of them */
  bool single;          /* at most one in a deck */
  bool open;            /* other keys are assignments */
  const deck_key_info *keys;
  int key_count;
  size_t size;               /* of its structure, which begins with a deck_item */
  size_t place;              /* in the deck: of the structure, or of the list of them */
  size_t count_place;        /* in the deck: of the list's count */
  void (*begin)(void *item); /* what an item is before its keys are read; NULL: all 0 */
  deck_group_check *check;   /* what its keys mean together; NULL: each is right by itself */
  const char *doc;
} deck_group_info;

/* Where in deck_GROUP a key's value is kept. */
#define DECK_AT(group, field)       .offset = (long)offsetof(deck_##group, field)
#define DECK_COUNT_AT(group, field) .count_offset = (long)offsetof(deck_##group, field)
#define DECK_NOT_KEPT               .offset = DECK_NO_FIELD

/* The row of a group whose keys are GROUP_keys, as DECK_GROUPS says that there is one, a list of
   them, or more in the list of another group:
     DECK_LIST(body, .identity = "lattice", .check = check_body, .doc = "Adds a shape."); */
#define DECK_ONE(group, ...)                                                                       \
  DECK_ROW(group, .single = true, .place = offsetof(deck, group), __VA_ARGS__)
#define DECK_LIST(group, ...)                                                                      \
  DECK_ROW(group, .place = offsetof(deck, group##s), .count_place = offsetof(deck, group##_count), \
           __VA_ARGS__)
#define DECK_MORE(group, other, ...)                                                               \
  DECK_ROW(group, .place = offsetof(deck, other##s), .count_place = offsetof(deck, other##_count), \
           __VA_ARGS__)
#define DECK_ROW(group, ...)                                                                       \
  _Static_assert(sizeof group##_keys / sizeof *group##_keys <= DECK_MOST_KEYS, "too many keys");   \
  _Static_assert(offsetof(deck_##group, item) == 0, "an item begins with what all have");          \
  const deck_group_info deck_group_##group = {                                                     \
      .name = #group,                                                                              \
      .keys = group##_keys,                                                                        \
      .key_count = (int)(sizeof group##_keys / sizeof *group##_keys),                              \
      .size = sizeof(deck_##group),                                                                \
      __VA_ARGS__}

/* The groups that a kind of file may hold. */
typedef struct deck_grammar {
  const char *file; /* what such a file is called: "deck" */
  const deck_group_info *const *groups;
  int group_count;
} deck_grammar;

/* Position of the key of that name, present or former (without regard to case), or -1. */
int deck_key_find(const deck_group_info *g, const char *name);
/* Names for suggestions; `names` must hold DECK_MOST_KEYS. Returns the count. */
int deck_key_names(const deck_group_info *g, const char **names);

/* Splits "a|b|c" (at most `most` words) into an arena. */
int deck_choices(arena *a, const char *choices, const char **words, int most);

#endif
