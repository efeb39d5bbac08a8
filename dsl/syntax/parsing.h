/* What lexer, grammar, tree and syntax messages know of a text while it is read. Internal to the
   front end: callers see parse.h only. */
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

#define HINT_PLACES "write `on bond`, `on particle`, `on neighbour`, `on point` or `on tip`"

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
  bool alone;             /* an expression by itself is read, no model */
  span part;              /* of the source that is read */
  expr *expression;
  tree *model;
  stmt **tail; /* where the next statement is linked */
  bool model_seen, law_seen, setting_seen, ended, out_of_model;
  bool failed; /* the present statement has had its message */
  lexing lex;
} parsing;

/* True when the statement has had no message yet; it then counts as having one. */
bool first_complaint(parsing *p);

/* False after a message about a text that is too long or no text. */
bool text_acceptable(const source_set *sources, int file, diagnostics *d);

#endif
