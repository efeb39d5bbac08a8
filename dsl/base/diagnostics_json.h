/* Diagnostics in a JSON document, for editors and scripts. What several texts have to say (a deck,
   its laws) goes into the same document. The schema is in dsl/README.md. */
#ifndef PERILAT_DSL_DIAGNOSTICS_JSON_H
#define PERILAT_DSL_DIAGNOSTICS_JSON_H

#include "dsl/base/c_linkage.h"
#include "dsl/base/diagnostics.h"
#include "dsl/base/json.h"

C_LINKAGE_BEGIN

typedef struct diag_json {
  json *document; /* is in an object, from begin to end in the list of diagnostics */
  int errors, warnings;
} diag_json;

/* `checked` is the file as the user named it. */
void diag_json_begin(diag_json *j, json *document, const char *checked);
/* All of d, sorted by place as diag_print does. */
void diag_json_add(diag_json *j, const diagnostics *d);
/* Ends the list with its sums. `accepted`: the input was found right. */
void diag_json_end(diag_json *j, bool accepted);

C_LINKAGE_END

#endif
