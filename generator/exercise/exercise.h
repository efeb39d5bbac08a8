/* An exercise: a folder with a file that says what is judged. The room: what answers are measured
   by; it knows none. An exercise is trusted, an answer never. */
#ifndef PERILAT_GENERATOR_EXERCISE_H
#define PERILAT_GENERATOR_EXERCISE_H

#include "runtime/base/namelist.h"
#include "runtime/deck/deck_schema.h"

/* X(code, name) */
#define ITEM_KINDS(X)                                                                              \
  X(CHECK, "check")                                                                                \
  X(PATH, "path")                                                                                  \
  X(SAMPLE, "sample")                                                                              \
  X(IMPLIED, "implied")                                                                            \
  X(RUN, "run")                                                                                    \
  X(ANSWERS, "answers")                                                                            \
  X(HAND, "hand")

typedef enum item_kind {
#define X(code, name) ITEM_##code,
  ITEM_KINDS(X)
#undef X
      ITEM_KIND_COUNT
} item_kind;

typedef enum item_against { AGAINST_REFERENCE, AGAINST_EXPECTATIONS } item_against;
typedef enum item_show { SHOW_NOTHING, SHOW_WORDS, SHOW_STATE, SHOW_CURVE } item_show;

/* A file that an item names. */
typedef struct exercise_file {
  const char *path;  /* from the root */
  const char *shown; /* from the working folder: "05_memory/teacher/hidden/1.nml" */
  const char *name;  /* as in the exercise: "hidden/1.nml" */
  bool hidden;       /* it stands in the teacher's folder */
} exercise_file;

/* One group &item. What its kind does not use is 0. */
typedef struct exercise_item {
  deck_item item;
  int kind; /* item_kind */
  const char *title;
  int points;
  bool hidden;   /* students know it by title alone */
  bool withheld; /* hidden, of a published exercise: it can not be judged here */
  int show;      /* item_show */
  const char **files;
  int file_count;
  exercise_file *found; /* [found_count] what `files` stand for */
  int found_count;
  int against;      /* item_against */
  double tolerance; /* relative */
  bool energies;    /* path, sample: they are compared, too */
  int states;
  const char **vary;
  int vary_count;
  double within[2];
  bool seed_of_student;
  uint64_t seed;
  const char *quantity, *of, *monitor, *at, *material;
  const char **set, **like; /* of `run` and `implied`: what is set, "lattice.spacing=20 mm" */
  int set_count, like_count;
  const namelist_key *value; /* expected, or NULL */
} exercise_item;

/* A law that a teacher knows: equal to the solution, or wrong in a way that has a sentence. */
typedef struct known_answer {
  const char *path, *name; /* "wrong/half.plm" */
  const char *sentence;    /* of a wrong one */
} known_answer;

typedef struct exercise {
  deck_item item;
  const char *title;
  int minutes, points;
  const char *folder; /* from the root: processes that judge work elsewhere */
  const char *given;  /* the same as it was given: "course/05_memory" */
  const char *file;   /* "course/05_memory/exercise.nml" */
  const char *name;   /* "05_memory" */
  exercise_item *items;
  int item_count;
  bool kept;            /* the teacher's folder is there */
  bool of_answers;      /* a table of answers is asked for, not a law */
  const char *solution; /* path, or NULL */
  known_answer *equal, *wrong;
  int equal_count, wrong_count;
} exercise;

/* Reads FOLDER/exercise.nml and finds all files; NULL after messages at its lines. The sources are
   the caller's. */
exercise *exercise_read(arena *a, source_set *sources, const char *folder, diagnostics *d);

/* Can it be judged without the solution and the teacher's folder? */
bool item_is_public(const exercise_item *item);

#endif
