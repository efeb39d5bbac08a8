/* Inside of the checker, shared by its parts: names.c declares and finds, types.c and calls.c give
   every expression its dimension, shape and placement, parameters.c does defaults and bounds,
   order.c what depends on what; law.c leads. */
#ifndef PERILAT_DSL_CHECK_H
#define PERILAT_DSL_CHECK_H

#include "dsl/semantics/law.h"

/* What is known of a value while it is checked. */
typedef struct value {
  dimension dim;
  shape shape;
  placement place;
  bool zero;    /* the literal 0, which agrees with any unit and any shape */
  bool unknown; /* unit and shape are not known (yet): agrees with everything */
  bool broken;  /* an error was reported: say nothing more */
  bool whole;   /* a family's values taken together: x without [j] */
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
  bool known;              /* type is valid */
  bool infer;              /* STATE from a bare 0: unit and shape come from its rule */
  bool in_use;             /* FUNCTION: its body is being checked */
  bool in_cycle;           /* a cycle through it was reported */
  bool refused;            /* a result that this kind of law does not have */
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

  entry *function; /* whose body is being checked, or NULL */
  int call_depth;  /* 0 while the body is checked where it is declared */
  bool reads_poisson; /* stress or strain of a family: its third direction follows from `nu` */
  span call_where; /* the outermost call */
  int depth, expansions, searches, search_mark;
  bool too_deep, in_reduction;
  bool result_refused; /* some result was, so say nothing about missing ones */
} checker;

static inline entry *entry_of(const symbol *s) {
  return (entry *)(void *)(symbol *)(size_t)s;
}

/* --- law.c ------------------------------------------------------------------------------------ */
/* An error at `where`; inside a function's body at the call, with a note that shows the place in
 * the body. */
void complain(checker *ck, diag_code code, span where, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* The written text of an expression in quotes when it is short, otherwise `otherwise`. */
const char *written(checker *ck, const expr *e, const char *otherwise);
bool is_pairwise(const checker *ck);

/* --- names.c ---------------------------------------------------------------------------------- */
void names_begin(checker *ck);
void names_end(checker *ck);
/* Declares what every statement declares; duplicates and reserved names are reported. */
void names_declare(checker *ck);
entry *names_find(const checker *ck, name_space space, const char *name);
/* Several options may have choices of the same name. */
entry *names_find_choice(const checker *ck, const symbol *option, const char *name);
/* Adds "did you mean" from the names of a space. */
void names_suggest(checker *ck, name_space space, const char *name);
/* Resolves a name in an expression; NULL after an error. */
entry *names_resolve(checker *ck, expr *e);

/* Does not change in time. */
bool is_fixed(const symbol *s);

/* --- types.c ---------------------------------------------------------------------------------- */
extern const value BROKEN;
value check_value(checker *ck, expr *e);  /* a value, not a whole family */
value check_family(checker *ck, expr *e); /* or x without [j] */
value check_number(checker *ck, expr *e); /* neither logical */
value check_guard(checker *ck, expr *e);
/* The common unit and shape of two values; complains as "..., so they cannot be `deed`". */
value agree(checker *ck, span where, expr *a, value va, expr *b, value vb, const char *deed);
placement place_join(const checker *ck, placement a, placement b);
/* Complains unless the value has this unit and shape; `what` says whose, e.g. "`force N`". */
bool expect(checker *ck, expr *e, value v, dimension dim, shape s, const char *what);
bool expect_scalar(checker *ck, expr *e, value v, const char *what);
value scalar_of(dimension dim, placement where);
const char *describe(checker *ck, dimension dim);
const char *shape_words(shape s);
dimension dimension_of(const char *unit_text);

/* --- calls.c ---------------------------------------------------------------------------------- */
value check_call(checker *ck, expr *e);
value check_function_body(checker *ck, entry *function);

/* --- parameters.c ----------------------------------------------------------------------------- */
bool read_unit(checker *ck, const char *text, span where, unit *result);
void check_parameter(checker *ck, stmt *s);
void check_initial_value(checker *ck, stmt *s);
void check_bounds(checker *ck);

/* --- order.c ---------------------------------------------------------------------------------- */
/* Reports that `e` names something defined only below; as a cycle when that something needs what is
 * being defined. */
void report_undefined(checker *ck, const expr *e, entry *target);
/* Sets symbol.used of all that a force or an output reaches. */
void mark_used(checker *ck);
/* An error for each damage without effect, warnings for the rest. */
void report_unused(checker *ck);

#endif
