/* Diagnostics as one JSON document, for editors and scripts. What several texts have to say (a
   deck, its laws) goes into the same document. The schema is in dsl/README.md. */
#ifndef PERILAT_DSL_DIAGNOSTICS_JSON_H
#define PERILAT_DSL_DIAGNOSTICS_JSON_H

#include "dsl/c_linkage.h"
#include "dsl/diagnostics.h"
#include "dsl/json.h"

C_LINKAGE_BEGIN

enum { DIAG_JSON_SCHEMA = 1 };

typedef struct diag_json {
  json writer;
  char *text; /* the document so far */
  size_t length;
  int errors, warnings;
} diag_json;

/* `checked` is the file as the user named it; `version` perilat's. */
void diag_json_begin(diag_json *j, const char *checked, const char *version);
/* All of d, sorted by place as diag_print does. */
void diag_json_add(diag_json *j, const diagnostics *d);
/* Writes the document and lets go of it. `accepted`: the input was found right. */
void diag_json_end(diag_json *j, bool accepted, FILE *out);

C_LINKAGE_END

#endif
