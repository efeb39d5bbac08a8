/* One layout for model files. Line breaks, comments, brackets and the words themselves stay as they
   are; blanks, indentation and the alignment of declarations and cases are set. */
#ifndef PERILAT_DSL_FORMAT_H
#define PERILAT_DSL_FORMAT_H

#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"

C_LINKAGE_BEGIN

/* The text of sources->items[file] in that layout (malloc'ed). A text that cannot be read is not
   touched: NULL, and its errors are in d. Files that it includes are not looked at; a text without
   a model line is taken for one to be included. The result holds the same tree and is laid out
   already: formatting it again changes nothing. */
char *format_model(source_set *sources, int file, diagnostics *d);

C_LINKAGE_END

#endif
