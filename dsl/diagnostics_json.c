#include "dsl/diagnostics_json.h"

#include <stdlib.h>

#include "dsl/arena.h"

void diag_json_begin(diag_json *j, const char *checked, const char *version) {
  *j = (diag_json){.text = NULL};
  FILE *memory = must_open_text(&j->text, &j->length);
  json *w = &j->writer;
  json_begin(w, memory);
  json_object(w);
  json_key(w, "schema");
  json_integer(w, DIAG_JSON_SCHEMA);
  json_key(w, "perilat");
  json_text(w, version);
  json_key(w, "checked");
  json_text(w, checked);
  json_key(w, "diagnostics");
  json_array(w);
}

static void put_integer(json *w, const char *key, long value) {
  json_key(w, key);
  json_integer(w, value);
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
  json_key(w, "file");
  json_text(w, sources->items[where.file].name);
  put_integer(w, "line", first.line);
  put_integer(w, "column", first.column);
  put_integer(w, "end_line", last.line);
  put_integer(w, "end_column", last.column);
  put_integer(w, "begin", (long)where.begin);
  put_integer(w, "end", (long)end);
  json_object_end(w);
}

static void put_note(json *w, const diagnostics *d, const diagnostic *one) {
  json_key(w, "note");
  if (!one->note) {
    json_null(w);
    return;
  }
  json_object(w);
  json_key(w, "message");
  json_text(w, one->note);
  put_where(w, d->sources, one->note_where);
  json_object_end(w);
}

void diag_json_add(diag_json *j, const diagnostics *d) {
  json *w = &j->writer;
  const diagnostic **sorted = diag_sorted(d);
  for (int i = 0; i < d->count; i++) {
    const diagnostic *one = sorted[i];
    bool error = diag_severity(one->code) == SEVERITY_ERROR;
    *(error ? &j->errors : &j->warnings) += 1;
    json_object(w);
    json_key(w, "code");
    json_text(w, diag_name(one->code));
    json_key(w, "severity");
    json_text(w, error ? "error" : "warning");
    json_key(w, "message");
    json_text(w, one->message);
    put_where(w, d->sources, one->where);
    json_key(w, "hint");
    json_text(w, one->hint);
    put_note(w, d, one);
    json_object_end(w);
  }
  free(sorted);
}

void diag_json_end(diag_json *j, bool accepted, FILE *out) {
  json *w = &j->writer;
  json_array_end(w);
  put_integer(w, "errors", j->errors);
  put_integer(w, "warnings", j->warnings);
  json_key(w, "accepted");
  json_bool(w, accepted);
  json_object_end(w);
  json_end(w);
  must_close_text(w->out);
  fwrite(j->text, 1, j->length, out);
  free(j->text);
  *j = (diag_json){.text = NULL};
}
