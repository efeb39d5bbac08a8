/* What is known of a law while it is checked, and how the checks report: the lowest of them. */
#ifndef PERILAT_DSL_CHECKER_H
#define PERILAT_DSL_CHECKER_H

#include "dsl/semantics/law.h"

/* What is known of a value while it is checked. */
typedef struct value {
  dimension dim;
  shape shape;
  placement place;
  bool zero;     /* the literal 0, which agrees with any unit and any shape */
  bool unknown;  /* unit and shape are not known (yet): agrees with everything */
  bool broken;   /* an error was reported: say nothing more */
  bool deviator; /* a tensor whose trace is 0 by what it is made of */
  bool whole;    /* a family's values taken together: x without [j] */
} value;

typedef enum name_space { SPACE_QUANTITIES, SPACE_FUNCTIONS, SPACE_CHOICES, SPACE_DECK } name_space;

/* A symbol and what only the checker needs to know of it; the symbol comes first. */
typedef struct entry {
  symbol symbol;
  name_space space;
  const char *key; /* its name, or the name without case in SPACE_DECK */
  int declared_at; /* position of the statement; -1 for built-ins */
  int rule_at;     /* STATE, DAMAGE: position of the rule; -1 without one */
  value type;
  bool known;    /* type is valid */
  bool infer;    /* STATE from a bare 0: unit and shape come from its rule */
  bool in_use;   /* FUNCTION: its body is being checked */
  bool in_cycle; /* a cycle through it was reported */
  bool refused;  /* a result that this kind of law does not have */
  /* QUANTITY: the law declares its name; PARAMETER: it lacks its unit; STATE: its rate lacks a
     time. Said once: of what reads it nothing more is said. */
  bool blamed;
  struct entry *arguments; /* FUNCTION: [declared->word_count] */
  struct entry *next;      /* of the same hash */
  int visited;             /* mark of the last search */
  const struct entry *reached_from;
} entry;

/* Where an expression stands decides which names it may read. */
typedef enum context {
  IN_RULE,
  IN_CONSTANT, /* nothing that moves */
  IN_DEFAULT,  /* numbers only */
  IN_FORMULA,  /* numbers and the parameters above: the default of a parameter */
  IN_BOUNDS    /* numbers and parameters */
} context;

enum {
  MOST_ARGUMENTS = 16,
  MOST_DEPTH = 1000,       /* of one expression with the functions it calls */
  MOST_EXPANSIONS = 20000, /* calls of functions, each with its body's own calls */
  MOST_SEARCHES = 20,      /* of a cycle, in one file */
  MOST_INFERENCE = 1000000 /* statements looked at to infer the units of states */
};

typedef struct checker {
  arena *memory;
  tree *tree;
  const source_set *sources;
  diagnostics *d;
  law *law;

  entry **buckets;
  int bucket_count;
  entry **entries; /* as declared, all spaces */
  int entry_count, entry_room;

  stmt **statements;
  int statement_count;
  int now; /* position of the statement being checked */
  context context;

  const char *alone;  /* of a formula: what it may read, in words; NULL in a law */
  entry *function;    /* whose body is being checked, or NULL */
  int call_depth;     /* 0 while the body is checked where it is declared */
  bool reads_poisson; /* stress or strain of a family: its third direction follows from `nu` */
  span call_where;    /* the outermost call */
  int depth, expansions, searches, search_mark;
  int rest_at;                 /* the line `rest ...`, where law->rest is given */
  const char *of_whole_family; /* the function of a family's values whose argument is no name */
  bool too_deep, in_reduction;
  bool holes;          /* some `?` was met */
  bool result_refused; /* some result was, so say nothing about missing ones */
} checker;
/* %s: the function. */
#define HINT_NAME_THE_FAMILY                                                                       \
  "give what stands in the brackets a name of its own above, `x[j] = ...`, and write `%s(x)`"

static inline entry *entry_of(const symbol *s) {
  return (entry *)(void *)(symbol *)(size_t)s;
}

/* An error at `where`; inside a function's body at the call, with a note that shows the place in
   the body. */
void complain(checker *ck, diag_code code, span where, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The written text of an expression when it is short, otherwise `otherwise`. */
const char *written(checker *ck, const expr *e, const char *otherwise);

/* Is it a law of single bonds or points, rather than of a particle's family? */
bool is_single(const checker *ck);
/* Where a state with one value lives: on bonds, points or particles. */
placement natural_place(const checker *ck);
/* "bond", "state" or "continuum", before "law". */
const char *law_word(const checker *ck);

#endif
