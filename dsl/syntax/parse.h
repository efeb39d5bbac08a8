/* Text in, tree and diagnostics out. Reentrant; opens no file: an `include` asks the caller. */
#ifndef PERILAT_DSL_PARSE_H
#define PERILAT_DSL_PARSE_H

#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"
#include "dsl/syntax/tree.h"

C_LINKAGE_BEGIN

/* Answers `include "name"`: returns the text (malloc'ed, NUL-terminated) and its name for messages
   in *found (malloc'ed), or NULL when there is no such file. `from` names the including source. */
typedef char *(*include_reader)(void *context, const char *name, const char *from, char **found);

typedef struct parse_options {
  include_reader read_include; /* NULL: includes are errors */
  void *context;
} parse_options;

/* Parses sources->items[file]. Returns the tree, also after errors if a model line was read (then
   with what could be understood), or NULL. All syntax errors of the file are reported, one a
   statement; after 200 reading stops. An `include` stays in the tree, followed by the statements it
   brought; a text that is included twice brings them once. */
tree *parse_model(arena *a, source_set *sources, int file, const parse_options *options,
                  diagnostics *d);

/* An expression by itself, or cases: the part `where` of a source. NULL after messages. */
expr *parse_expression(arena *a, source_set *sources, span where, diagnostics *d);

/* Is a text a law, by its first word behind comments? What a person has not named himself is not
   quoted unless it is one. */
bool parse_begins_law(const char *text);

C_LINKAGE_END

#endif
