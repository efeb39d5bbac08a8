/* How commands say errors, and --json: what a command has to say is one JSON document on the
   standard output; all that is printed for people goes to the error stream then. */
#ifndef PERILAT_GENERATOR_DOCUMENT_H
#define PERILAT_GENERATOR_DOCUMENT_H

#include <stdio.h>

#include "dsl/base/json.h"

typedef struct document {
  json writer; /* in the object that the document is */
  char *text;
  size_t length;
  FILE *memory;
  int standard_output;   /* where it goes */
  const char *error_key; /* NULL: "error" */
} document;

void document_begin(document *d);
/* Ends it with `error`, the first sentence that say_error said since it began or null, and writes
   it. Returns `status`, or 2 where the document could not be written: end_output says why. */
int document_end(document *d, int status);

/* "perilat: error: SENTENCE" on the error stream. */
void say_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* For the document only: an error that has been printed in another way. */
void keep_error(const char *sentence);

/* What a program with this exit status ends with: 2 after a message where not all of what it
   printed could be written. */
int end_output(int status);

#endif
