/* A checked law: every name resolved, every unit agreed, every quantity placed, in an order in
   which it can be evaluated. The checker annotates the tree in place; the generator reads this and
   nothing else. */
#ifndef PERILAT_DSL_LAW_H
#define PERILAT_DSL_LAW_H

#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"
#include "dsl/semantics/builtins.h"
#include "dsl/syntax/tree.h"

C_LINKAGE_BEGIN

typedef enum symbol_kind {
  SYMBOL_QUANTITY,  /* built in: stretch, s, ... */
  SYMBOL_PARAMETER, /* and `field`, a value that may differ in place and time */
  SYMBOL_CONSTANT,  /* does not change in time */
  SYMBOL_DEFINED,   /* plain definition, yield, stress, strain */
  SYMBOL_STATE,
  SYMBOL_DAMAGE,
  SYMBOL_RESULT, /* force N, V, moment M_i, M_j, T, energy W, force state F */
  SYMBOL_OUTPUT,
  SYMBOL_FUNCTION,
  SYMBOL_OPTION,  /* option onset */
  SYMBOL_CHOICE,  /* rankine: a value of an option; also plane_stress, plane_strain, space */
  SYMBOL_ARGUMENT /* of a user's function */
} symbol_kind;

typedef struct symbol {
  symbol_kind kind;
  const char *name;
  span where;           /* of the name where it was declared */
  const stmt *declared; /* NULL for built-ins */
  /* statement that gives its value in each step; NULL for built-ins, parameters */
  const stmt *rule;
  int index; /* QUANTITY: builtin_quantity; otherwise its position in the list of its kind below */
  dimension dim;
  enum shape shape;
  placement place;
  const char *doc;                   /* description or NULL */
  double initial;                    /* PARAMETER: default, STATE: initial value; SI */
  bool has_default;                  /* PARAMETER */
  bool follows; /* PARAMETER: its default reads parameters above it; `initial` has theirs */
  struct symbol *option;             /* CHOICE: its option (NULL for settings) */
  /* STATE: the tensor, PARAMETER: the vector that it is a component of, or NULL */
  const struct symbol *component_of;
  int component;
  const struct symbol *rate_of; /* STATE: the field whose rate it keeps, or NULL */
  bool deviator;    /* STATE: a tensor of trace 0, which is kept without its component zz */
  bool old_is_read; /* STATE, DAMAGE: some rule reads the value of the last step */
  bool used;        /* a force or an output depends on it */
} symbol;

/* Of a parameter: declared by `field`. */
static inline bool symbol_is_field(const symbol *s) {
  return s->kind == SYMBOL_PARAMETER && s->declared->kind == STMT_FIELD;
}

typedef struct symbol_list {
  symbol **items;
  int count;
} symbol_list;

/* The result quantities of laws of bonds and of continua, by position. NULL where the law does not
   give one. */
typedef enum law_result {
  RESULT_N,
  RESULT_V,
  RESULT_M_I,
  RESULT_M_J,
  RESULT_T,
  RESULT_W,
  RESULT_SIGMA,
  RESULT_GROW, /* of a tip */
  RESULT_TOWARD,
  RESULT_SPEED,
  RESULT_COUNT
} law_result;

/* A choice for one option, as a deck or a command line makes it. */
typedef struct law_choice {
  const char *option, *choice;
} law_choice;

/* The lattice of a law: it decides `when plane_strain` and the third direction of tensors. */
typedef enum law_setting {
#define X(code, word) SETTING_##code,
  LAW_SETTINGS(X)
#undef X
} law_setting;

/* accept CHECK "why": what this check finds is meant. */
typedef struct law_waiver {
  diag_code check;
  const char *why;
  span where;
} law_waiver;
enum { LAW_WAIVERS_MOST = DIAG_COUNT }; /* each once */

typedef struct law {
  struct tree *tree;
  law_setting setting; /* first that the law names; may be changed before it is lowered */
  bool irregular;      /* lowered for particles that stand on no lattice */
  int neighbours;      /* of a full family, where they are known; else 0 */
  /* Lowered for bonds that twist: in space. Else `twist` is 0 and `moment T` nothing. */
  bool twists;
  /* and that bend about all axes: bending quantities are vectors across the bond, in the axes of
     the lattice. Else they are numbers. */
  bool bends_in_space;
  arena *memory; /* not owned */
  const source_set *sources;
  symbol_list parameters; /* of vectors the components x, y, z, one after the other */
  symbol_list fields; /* states and damages, in the order declared; of tensors the components */
  symbol_list outputs;
  symbol_list options;
  const char **chosen; /* [options.count] the choice in force (default: the first) */
  const symbol *results[RESULT_COUNT];
  const symbol *rho;    /* the parameter `rho`, or NULL */
  const stmt *sized;    /* `require h in ...`, or NULL */
  const symbol *rest; /* `rest_stretch`, `rest_strain`, from which these are measured, or NULL */
  const symbol *failed; /* the damage of `failed when`, or NULL */
  const stmt **rules;   /* statements to evaluate each step, in order (constants first) */
  int rule_count;
  const char *nonconservative; /* reason, or NULL */
  law_waiver waivers[LAW_WAIVERS_MOST];
  int waiver_count;
} law;

const char *law_setting_name(law_setting setting);
bool law_setting_find(const char *name, law_setting *setting);
/* The first that the law names in its line `for`; plane stress without one. */
law_setting law_first_setting(const law *l);
/* Whether its line `for` names it; a law without one is meant for all. */
bool law_is_for(const law *l, law_setting setting);
/* That of a lattice with 2 or 3 dimensions: the first of these that the law names; plane stress or
   space where it names none. */
law_setting law_setting_in(const law *l, int dimensions);
/* Of a state that is a tensor or vector, the field that keeps component k; -1 of zz of a deviator,
   which is -(xx + yy). */
int law_field_of(const symbol *tensor, int k);
/* The line by which the law accepts what a check finds; NULL without one. */
const law_waiver *law_accepts(const law *l, diag_code check);
/* The k-th of all that it says about its mechanics, `nonconservative` first; false behind
   the last. */
bool law_says(const law *l, int k, const char **check, const char **why);
/* Of the messages from number `from` on those that the law accepts are set apart. */
void law_waive(const law *l, diagnostics *d, int from);
/* Whether nothing is set apart by this line: its check has found nothing, as yet. */
bool law_waiver_is_idle(const law_waiver *w, const diagnostics *d);
/* The field that keeps the rate of field k; -1 of one that has none. */
int law_rate_field(const law *l, int k);
/* The line `force state` of a law of families; NULL without one. */
const stmt *law_force_state(const law *l);

C_LINKAGE_END

#endif
