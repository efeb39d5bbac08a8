/* What lexer, grammar and syntax messages share while one text is read. Internal to the front end:
   callers see parse.h only. */
#ifndef PERILAT_DSL_PARSING_H
#define PERILAT_DSL_PARSING_H

#include "dsl/syntax/parse.h"

enum {
  NAME_LONGEST = 63,      /* characters of a name */
  TEXT_LONGEST = 1 << 20, /* bytes of one text */
  INCLUDE_DEEPEST = 16,   /* texts that include one another */
  ERRORS_MOST = 200,      /* errors after which reading stops */
  INCLUDE_MOST = 256,     /* included texts of one model */
  TOKEN_CODES = 512       /* room for every token code */
};

/* Words that begin a line. X(token, text) */
#define LINE_WORDS(X)                                                                              \
  X(MODEL, "model")                                                                                \
  X(END, "end")                                                                                    \
  X(LAW, "law")                                                                                    \
  X(FOR, "for")                                                                                    \
  X(PARAMETER, "parameter")                                                                        \
  X(CONSTANT, "constant")                                                                          \
  X(OPTION, "option")                                                                              \
  X(STATE, "state") X(DAMAGE, "damage") X(FUNCTION, "function") X(FORCE, "force")                  \
      X(MOMENT, "moment") X(ENERGY, "energy") X(STRESS, "stress") X(STRAIN, "strain")              \
          X(YIELD, "yield") X(FLOW, "flow") X(OUTPUT, "output")                                    \
              X(NONCONSERVATIVE, "nonconservative") X(INCLUDE, "include")

/* Words that are never names. */
#define RESERVED_WORDS(X)                                                                          \
  X(WHEN, "when")                                                                                  \
  X(OTHERWISE, "otherwise")                                                                        \
  X(JUMP, "jump")                                                                                  \
  X(IN, "in")                                                                                      \
  X(AND, "and")                                                                                    \
  X(OR, "or") X(NOT, "not") X(BY, "by") X(ALONG, "along") X(RETURNED, "returned") X(ON, "on")

/* A piece of the text and where it stands. text is NULL when the piece is absent. */
typedef struct word {
  const char *text;
  span where;
} word;

typedef struct words {
  const char **items;
  span *where;
  int count;
} words;

typedef struct lexing {
  void *scanner;    /* flex's own */
  const char *text; /* whole text */
  uint32_t length;
  uint32_t offset;       /* first byte not yet read */
  uint32_t joined_until; /* line ends before this offset do not end the statement: a `|` follows */
  bool continued;        /* after `&`: the next line end does not count */
  bool ended;            /* the line end that closes the text was delivered */
  int last, before_last; /* codes of the tokens delivered last */
  span last_where, before_where;
  int first; /* token that began the statement */
  span first_where;
  int equals;              /* `=` read in the statement */
  bool stray_close;        /* a bracket was closed that is not open */
  span comment;            /* comment read since the last token; empty without */
  span open[TREE_DEEPEST]; /* brackets not yet closed */
  int open_count;
  char *next_doc; /* lines of !> that wait for a statement */
  size_t next_length, next_room;
  char *doc; /* those of the present statement */
} lexing;

/* A text and the ones that include it. */
typedef struct include_chain {
  const struct include_chain *outer;
  const char *name;
  span where; /* of the include line in the outer text */
  int depth;  /* 0 for the model's own file */
} include_chain;

typedef struct include_list {
  const char *names[INCLUDE_MOST];
  int count;
} include_list;

typedef struct parsing {
  arena *memory;
  source_set *sources;
  uint16_t file;
  diagnostics *messages;
  const parse_options *options;
  include_chain chain;
  include_list *included; /* all texts included so far: each is read once */
  tree *model;
  stmt **tail; /* where the next statement is linked */
  bool model_seen, law_seen, setting_seen, ended, out_of_model;
  bool failed; /* the present statement has had its message */
  lexing lex;
} parsing;

/* lexer.l */
void lexer_open(parsing *p, const char *text, size_t length);
void lexer_close(parsing *p);
const char *const *line_words(int *count);

/* True when the statement has had no message yet; it then counts as having one. */
bool first_complaint(parsing *p);

/* syntax_error.c: says what is wrong at `token`, given the tokens that could have stood there. */
void syntax_error(parsing *p, int token, span where, const bool expected[TOKEN_CODES]);
/* A character sequence that no rule of the language begins with. */
void syntax_slip(parsing *p, span where);
/* A number with letters or points stuck to it. */
void syntax_bad_number(parsing *p, span where);

/* tree_build.c: nodes with spans; depth and index are checked here. */
expr *build_number(parsing *p, double number, word written_unit, span where);
expr *build_name(parsing *p, word name, bool primed, word index, span where);
expr *build_unary(parsing *p, unary_op op, expr *operand, span where);
expr *build_binary(parsing *p, binary_op op, expr *left, expr *right, span where);
expr *build_call(parsing *p, word name);
expr *build_argument(parsing *p, expr *call, word keyword, expr *value);
expr *build_cases(parsing *p, span where);
expr *build_case(parsing *p, expr *cases, expr *value, expr *guard, bool jump, span where);
words *build_words(parsing *p);
words *build_word(parsing *p, words *list, word item);
bounds build_bounds(parsing *p, bool lower_open, expr *lower, expr *upper, bool upper_open,
                    span where);
/* index.text is NULL for a name without [j]. */
stmt *build_stmt(parsing *p, stmt_kind kind, word name, word index, expr *value, span where);
void build_placement(parsing *p, stmt *s, word on);
void build_words_of(stmt *s, const words *list);
void build_force_state(parsing *p, word state, stmt *s, word direction);

/* parse.c: lines of a model file, in order. */
void line_model(parsing *p, word name);
void line_end(parsing *p, word of, word name, span where);
void line_law(parsing *p, word first, word second, span where);
void line_settings(parsing *p, const words *list, span where);
void line_statement(parsing *p, stmt *s, word text, span where);
/* The present line could not be understood and was skipped. */
void line_broken(parsing *p);

#endif
