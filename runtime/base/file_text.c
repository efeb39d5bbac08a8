#include "runtime/base/file_text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dsl/base/arena.h"
#include "runtime/base/ordinary_file.h"

#define LONGEST ((long long)1 << 31) /* bytes: places in the text are spans */

bool file_text_refuse(const file_text *f, span where, diagnostics *d, const char *why) {
  diag_report(d, DIAG_FILE, where, "cannot read `%s`: %s", f->path, why);
  return false;
}

static bool load(file_text *f, span where, diagnostics *d) {
  struct stat about;
  const char *why = NULL;
  const int file = ordinary_file_open(f->path, O_RDONLY, &why);
  FILE *in = file >= 0 ? fdopen(file, "rb") : NULL;
  if (!in || fstat(file, &about) != 0)
    return file_text_refuse(f, where, d, why ? why : strerror(errno));
  if (about.st_size >= LONGEST) {
    fclose(in);
    return file_text_refuse(f, where, d, "it is longer than 2 GiB");
  }
  f->text = f->owned = must_alloc((size_t)about.st_size + 1);
  f->length = fread(f->owned, 1, (size_t)about.st_size, in);
  f->owned[f->length] = 0;
  const bool failed = ferror(in) != 0;
  fclose(in);
  return failed ? file_text_refuse(f, where, d, strerror(errno)) : true;
}

static bool take_source(file_text *f, const source_set *sources) {
  for (int k = 0; k < sources->count; k++) {
    if (strcmp(sources->items[k].name, f->path) != 0) continue;
    f->text = sources->items[k].text;
    f->length = sources->items[k].length;
    f->source = k;
    return true;
  }
  return false;
}

bool file_text_open(file_text *f, char *path, span where, diagnostics *d) {
  *f = (file_text){.path = path, .source = -1};
  return take_source(f, d->sources) || load(f, where, d);
}

void file_text_close(file_text *f) {
  free(f->owned);
  free(f->path);
  *f = (file_text){.source = -1};
}

int file_text_source(file_text *f, diagnostics *d) {
  if (f->source < 0) f->source = source_add(d->sources, f->path, f->text, f->length);
  return f->source;
}

span file_text_span(file_text *f, const char *from, const char *to, diagnostics *d) {
  return (span){(uint32_t)(from - f->text), (uint32_t)(to - f->text),
                (uint16_t)file_text_source(f, d)};
}

span file_text_line(file_text *f, const char *at, diagnostics *d) {
  const char *from = at;
  while (from > f->text && from[-1] != '\n')
    from--;
  return file_text_span(f, from, at + strcspn(at, "\r\n"), d);
}
