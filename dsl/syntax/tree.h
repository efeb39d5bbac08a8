/* The tree of a model file: what was written, with a span on every node. The parser builds it; the
   checker (law_check.h) fills in the fields marked "checker". Nothing here assumes that a law is
   pairwise. */
#ifndef PERILAT_DSL_TREE_H
#define PERILAT_DSL_TREE_H

#include <stdbool.h>
#include <stdio.h>

#include "dsl/base/arena.h"
#include "dsl/base/c_linkage.h"
#include "dsl/base/source.h"
#include "dsl/base/units.h"

C_LINKAGE_BEGIN

/* What the lattice of a law may be, after `for` and `when`. X(code, word) */
#define LAW_SETTINGS(X)                                                                            \
  X(PLANE_STRESS, "plane_stress")                                                                  \
  X(PLANE_STRAIN, "plane_strain")                                                                  \
  X(SPACE, "space")

/* `for irregular`, `when irregular`: particles that stand on no lattice. */
#define LAW_IRREGULAR "irregular"
/* The function that `(1, 0, 0)` stands for. */
#define LAW_VECTOR "vector"
enum { VECTOR_COMPONENT_COUNT = 3 };
/* `for anisotropic`: a law that knows the axes. */
#define LAW_ANISOTROPIC "anisotropic"
/* The damage that `failed when ...` declares. */
#define LAW_FAILED "failed"
/* What has a rest state: `rest stretch = ...`. */
#define LAW_RESTING "stretch"

typedef enum expr_kind {
  EXPR_NUMBER, /* 30 [GPa] */
  EXPR_NAME,   /* x, x[j], x'[j], x' */
  EXPR_UNARY,  /* -a, not a */
  EXPR_BINARY, /* a + b, a <= b, a and b, a : b */
  EXPR_CALL,   /* f(a, b, weight = c) */
  EXPR_CASES,  /* | value when guard  ... | value otherwise */
  EXPR_HOLE    /* ?, ? [GPa]: still to be written */
} expr_kind;

/* How an operator is computed by an operation of the same or another name: a > b is b < a. */
typedef enum operator_reading { READ_AS_WRITTEN, READ_NEGATED, READ_EXCHANGED } operator_reading;

/* X(code, text, operation, reading): binary operators. A contraction of numbers is a product. */
#define TREE_BINARY_OPERATORS(X)                                                                   \
  X(OR, "or", OR, READ_AS_WRITTEN)                                                                 \
  X(AND, "and", AND, READ_AS_WRITTEN)                                                              \
  X(EQ, "==", EQ, READ_AS_WRITTEN)                                                                 \
  X(NE, "/=", EQ, READ_NEGATED)                                                                    \
  X(LT, "<", LT, READ_AS_WRITTEN)                                                                  \
  X(LE, "<=", LE, READ_AS_WRITTEN)                                                                 \
  X(GT, ">", LT, READ_EXCHANGED)                                                                   \
  X(GE, ">=", LE, READ_EXCHANGED)                                                                  \
  X(ADD, "+", ADD, READ_AS_WRITTEN)                                                                \
  X(SUB, "-", SUB, READ_AS_WRITTEN)                                                                \
  X(MUL, "*", MUL, READ_AS_WRITTEN)                                                                \
  X(DIV, "/", DIV, READ_AS_WRITTEN)                                                                \
  X(CONTRACT, ":", MUL, READ_AS_WRITTEN)                                                           \
  X(POW, "**", POW, READ_AS_WRITTEN)

typedef enum binary_op {
#define X(code, text, operation, reading) OP_##code,
  TREE_BINARY_OPERATORS(X)
#undef X
      OP_BINARY_COUNT
} binary_op;

typedef enum unary_op { OP_NEG, OP_PLUS, OP_NOT, OP_COMPONENT, OP_AXIS } unary_op;

/* What a value is, beside its dimension. A bending quantity has one component in 2D, two in 3D. */
typedef enum shape {
  SHAPE_SCALAR,
  SHAPE_LOGICAL,
  SHAPE_BENDING,
  SHAPE_VECTOR,
  SHAPE_TENSOR, /* symmetric */
  SHAPE_GENERAL /* a tensor that need not be symmetric */
} shape;

static inline bool shape_is_tensor(shape s) {
  return s == SHAPE_TENSOR || s == SHAPE_GENERAL;
}

/* Where a value lives. Ordered: a bond value may be made of uniform ones. NEIGHBOUR is directed, i
   toward j. */
typedef enum placement {
  ON_NOTHING,
  ON_BODY,
  ON_POINT, /* of a continuum */
  ON_TIP,   /* of a crack */
  ON_PARTICLE,
  ON_BOND,
  ON_NEIGHBOUR
} placement;

/* Components of a symmetric tensor, in this order. X(code, first axis, second axis) */
#define TENSOR_COMPONENTS(X)                                                                       \
  X(XX, 'x', 'x') X(YY, 'y', 'y') X(ZZ, 'z', 'z') X(XY, 'x', 'y') X(YZ, 'y', 'z') X(XZ, 'x', 'z')
enum { TENSOR_COMPONENT_COUNT = 6 };
/* The components of a general tensor: those above, then these. */
#define TURNED_COMPONENTS(X) X(YX, 'y', 'x') X(ZY, 'z', 'y') X(ZX, 'z', 'x')
enum { GENERAL_COMPONENT_COUNT = 9 };
/* The component of a symmetric tensor that a general one has in its place. */
static inline int symmetric_component(int component) {
  return component < TENSOR_COMPONENT_COUNT ? component : component - 3;
}
/* The component that follows from the others where the trace is 0: zz = -(xx + yy). */
enum { TENSOR_TRACED = 2 };

struct symbol; /* law.h */
struct function_builtin;
typedef struct expr expr;
typedef struct stmt stmt;

/* No expression is deeper than this, so that walks over trees may recurse. */
enum { TREE_DEEPEST = 200 };

typedef struct argument {
  const char *keyword; /* NULL for a positional one */
  span keyword_where;
  expr *value;
} argument;

typedef struct case_line {
  expr *value;
  expr *guard; /* NULL: otherwise */
  bool jump;
  bool open; /* `| ?`: value and guard are one hole, and still to be written; `guard` is NULL */
  span where;
} case_line;

struct expr {
  expr_kind kind;
  span where;
  int depth; /* levels of the tree from here down; the parser keeps it to TREE_DEEPEST */

  double number;         /* NUMBER: as written, before the unit */
  const char *unit_text; /* NUMBER, HOLE: NULL without a unit */
  span unit_where;

  const char *name; /* NAME, CALL */
  span name_where;
  bool indexed; /* NAME: [j] follows */
  bool primed;  /* NAME: ' follows the name (the neighbour's value toward me) */

  unary_op unary;
  int component; /* UNARY: of OP_COMPONENT of a general tensor, of OP_AXIS of a vector */
  binary_op binary;
  expr *left, *right; /* BINARY; UNARY uses left */

  argument *arguments; /* CALL */
  int argument_count;
  case_line *cases; /* CASES */
  int case_count;

  /* checker */
  struct symbol *symbol; /* NAME: what it refers to; CALL: a user's function */
  int builtin;           /* CALL: enum builtin_function of builtins.h, or -1 */
  bool reads_old;        /* NAME of a state or damage: value of the last step */
  bool open;             /* unit and shape are not known, because of a hole or an error */
  dimension dim;
  enum shape shape;
  bool deviator; /* a tensor whose trace is 0 by what it is made of */
  placement place;
};

typedef enum stmt_kind {
#define TREE_STATEMENTS(X)                                                                         \
  X(PARAMETER, "parameter")                                                                        \
  X(FIELD, "field")                                                                                \
  X(CONSTANT, "constant")                                                                          \
  X(OPTION, "option")                                                                              \
  X(DEFINITION, "definition") X(STATE, "state") X(DAMAGE, "damage") X(FUNCTION, "function")        \
      X(FORCE, "force") X(FORCE_STATE, "force state") X(MOMENT, "moment") X(ENERGY, "energy")      \
          X(STRESS, "stress") X(STRAIN, "strain") X(YIELD, "yield") X(FLOW, "flow")                \
              X(RATE, "rate") X(OUTPUT, "output") X(NONCONSERVATIVE, "nonconservative")            \
                  X(INCLUDE, "include") X(GROW, "grow") X(TOWARD, "toward") X(SPEED, "speed")      \
                      X(REQUIRE, "require") X(ACCEPT, "accept")
#define X(code, text) STMT_##code,
  TREE_STATEMENTS(X)
#undef X
      STMT_COUNT
} stmt_kind;

typedef struct bounds {
  bool given;
  bool lower_open, upper_open; /* ( or [ */
  expr *lower, *upper;         /* NULL: infinite (written inf or -inf) */
  span where;
} bounds;

struct stmt {
  stmt_kind kind;
  span where;
  const char *name; /* NULL for nonconservative and include */
  span name_where;
  bool indexed;          /* name[j] */
  expr *value;           /* rule, default or initial value; NULL when absent */
  placement place;       /* STATE, DAMAGE, FIELD: as written, ON_NOTHING when not written */
  span place_where;      /* of the word after `on` */
  const char *unit_text; /* PARAMETER, FIELD: unit behind the name, NULL without one */
  span unit_where;
  bool along_reference; /* FORCE_STATE: acts along the reference bond, not the current one */
  bounds in;            /* PARAMETER, FIELD, REQUIRE */
  const char **words;   /* OPTION: choices; FUNCTION: arguments */
  span *word_where;
  int word_count;
  expr *when;       /* FLOW: guard */
  bool returned;    /* FLOW along ... returned */
  bool tensor;      /* STATE: begins at `tensor 0` or `deviator 0` */
  bool deviator;    /* STATE: begins at `deviator 0` */
  const char *rest_of; /* DEFINITION: written `rest stretch = ...`, then `stretch`; else NULL */
  bool total;          /* DEFINITION: what follows from such a line */
  bool vector;      /* STATE: begins at `vector 0` */
  bool failure;     /* DAMAGE: written `failed when ...` */
  const char *text; /* quoted text: description, reason, or included file */
  span text_where;
  const char *doc; /* lines of !> before it, joined by newline; NULL without */
  stmt *next;

  /* checker */
  struct symbol *symbol; /* what the statement declares or defines */
};

/* What stands in the line `law`. */
#define LAW_KINDS(X)                                                                               \
  X(LAW_CENTRAL_BOND, "central bond")                                                              \
  X(LAW_MICROPOLAR_BOND, "micropolar bond")                                                        \
  X(LAW_STATE, "state")                                                                            \
  X(LAW_SLIP_BOND, "slip bond")                                                                    \
  X(LAW_CONTINUUM, "continuum")                                                                    \
  X(LAW_CRACK, "crack")

typedef enum law_kind {
#define X(code, words) code,
  LAW_KINDS(X)
#undef X
} law_kind;

const char *law_kind_name(law_kind kind);
/* For hints: how to say which kind a law is. */
#define LAW_LINES                                                                                  \
  "`law central bond`, `law micropolar bond`, `law slip bond`, `law state` or `law continuum`"

/* Whether the ends of its bonds turn, so that particles have rotations. */
static inline bool law_kind_turns(law_kind kind) {
  return kind == LAW_MICROPOLAR_BOND || kind == LAW_SLIP_BOND;
}

typedef struct tree {
  const char *name;
  span name_where;
  const char *doc;
  law_kind law;
  span law_where;
  const char **settings; /* for plane_stress, space */
  span *setting_where;
  int setting_count;
  bool anisotropic; /* was in the line `for`; it does not stand among the settings */
  span anisotropic_where;
  bool rests;  /* has a line `rest stretch` */
  stmt *first; /* in the order written, included statements in place */
} tree;

const char *stmt_kind_name(stmt_kind kind);
const char *placement_name(placement p);
/* "force N", "grow": what the line gives; in `memory`. */
const char *stmt_words(arena *memory, const stmt *s);
/* The axes of a component, 'x', 'y' or 'z'. */
char tensor_axis(int component, int which);
char vector_axis(int component);
/* Is it `(1, 0, 0)`, or `vector(1, 0, 0)`? */
bool expr_is_vector(const expr *e);

/* Prints the tree as indented text, one node a line, without spans, as golden tests have it. */
void tree_dump(const tree *t, FILE *out);
/* Prints an expression as source text with the fewest parentheses. */
void expr_print(const expr *e, FILE *out);
/* The same as a text, to be freed. */
char *expr_text(const expr *e);

C_LINKAGE_END

#endif
