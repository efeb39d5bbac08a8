/* Writes JSON: objects and arrays one entry a line, indented; always valid. In texts control bytes
   are escaped and bytes that are not UTF-8 become U+FFFD; a number that is not finite becomes null.
 */
#ifndef PERILAT_DSL_JSON_H
#define PERILAT_DSL_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

enum { JSON_DEEPEST = 16 };

typedef struct json {
  FILE *out;
  int depth;
  bool filled[JSON_DEEPEST]; /* the object or array open at this depth has an entry */
  bool after_key;
} json;

void json_begin(json *j, FILE *out);
/* Ends the line after the outermost value. */
void json_end(json *j);

void json_object(json *j);
void json_object_end(json *j);
void json_array(json *j);
void json_array_end(json *j);
/* Before each value of an object. */
void json_key(json *j, const char *name);

/* null for NULL. */
void json_text(json *j, const char *text);
void json_bytes(json *j, const char *text, size_t length);
void json_number(json *j, double number);
void json_integer(json *j, long number);
void json_bool(json *j, bool value);
void json_null(json *j);

/* Key and value at once. */
void json_put_text(json *j, const char *name, const char *text);
void json_put_number(json *j, const char *name, double number);
void json_put_integer(json *j, const char *name, long number);
void json_put_bool(json *j, const char *name, bool value);
void json_put_object(json *j, const char *name);
void json_put_array(json *j, const char *name);

/* What perilat writes for other programs: one object, which says first what form it has and who
   wrote it. The schema is raised when a key changes its meaning or goes. */
enum { JSON_SCHEMA = 1 };
void json_document(json *j, FILE *out, const char *version);
void json_document_end(json *j);

C_LINKAGE_END

#endif
