#include "dsl/base/diagnostics_json.h"

#include <stdlib.h>

void diag_json_begin(diag_json *j, json *document, const char *checked) {
  *j = (diag_json){.document = document};
  json_put_text(document, "checked", checked);
  json_put_array(document, "diagnostics");
}

static void put_where(json *w, const source_set *sources, span where) {
  json_key(w, "where");
  if (!sources || where.file >= sources->count) {
    json_null(w);
    return;
  }
  uint32_t end = where.end > where.begin ? where.end : where.begin;
  place first = source_place(sources, where.file, where.begin);
  place last = source_place(sources, where.file, end);
  json_object(w);
  json_put_text(w, "file", sources->items[where.file].name);
  json_put_integer(w, "line", first.line);
  json_put_integer(w, "column", first.column);
  json_put_integer(w, "end_line", last.line);
  json_put_integer(w, "end_column", last.column);
  json_put_integer(w, "begin", (long)where.begin);
  json_put_integer(w, "end", (long)end);
  json_object_end(w);
}

static void put_note(json *w, const diagnostics *d, const diagnostic *one) {
  json_key(w, "note");
  if (!one->note) {
    json_null(w);
    return;
  }
  json_object(w);
  json_put_text(w, "message", one->note);
  put_where(w, d->sources, one->note_where);
  json_object_end(w);
}

static void put_one(json *w, const diagnostics *d, const diagnostic *one, const char *kind) {
  json_object(w);
  json_put_text(w, "code", diag_name(one->code));
  json_put_text(w, "severity", kind);
  json_put_text(w, "message", one->message);
  put_where(w, d->sources, one->where);
  json_put_text(w, "hint", one->accepted ? one->accepted : one->hint);
  put_note(w, d, one);
  json_object_end(w);
}

void diag_json_add(diag_json *j, const diagnostics *d) {
  const diagnostic **sorted = diag_sorted(d);
  for (int i = 0; i < d->count; i++) {
    const bool error = diag_severity(sorted[i]->code) == SEVERITY_ERROR;
    *(error ? &j->errors : &j->warnings) += 1;
    put_one(j->document, d, sorted[i], error ? "error" : "warning");
  }
  free(sorted);
  for (int i = 0; i < d->accepted_count; i++)
    put_one(j->document, d, &d->accepted[i], "accepted");
}

void diag_json_end(diag_json *j, bool accepted) {
  json *w = j->document;
  json_array_end(w);
  json_put_integer(w, "errors", j->errors);
  json_put_integer(w, "warnings", j->warnings);
  json_put_bool(w, "accepted", accepted);
}
