#include "generator/page/page.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/page/html.h"
#include "generator/page/page_body.h"
#include "generator/page/page_curves.h"
#include "generator/page/page_data.h"
#include "generator/page/page_frames.h"
#include "generator/page/page_law.h"
#include "generator/page/page_result.h"
#include "generator/page/page_texts.h"
#include "generator/page/page_verdict.h"
#include "generator/page/shell.h"

static const char *title_of(const page_result *p) {
  return *p->title ? p->title : p->path;
}

static void put_header(FILE *out, const page_result *p) {
  fputs("<header><h1>", out);
  html_text(out, title_of(p));
  fputs("</h1>\n<p class=\"quiet\">", out);
  html_text(out, p->path);
  fputs("</p></header>\n", out);
}

/* What the script reads. malloc'ed. */
static char *data_of(const page_result *results, const movie *movies, int count) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  json w;
  json_begin(&w, out);
  json_object(&w);
  page_put_colours(&w);
  for (int k = 0; k < count; k++) {
    json_put_object(&w, results[k].key);
    page_put_histories(&w, &results[k]);
    page_put_frames(&w, &results[k], &movies[k]);
    json_object_end(&w);
  }
  json_object_end(&w);
  json_end(&w);
  must_close_text(out);
  return text;
}

static void put_result(FILE *out, const page_result *p, const movie *m) {
  put_header(out, p);
  page_verdict(out, p);
  page_main_curve(out, p);
  page_frames(out, p, m);
  page_body(out, p);
  page_laws(out, p);
  page_sentences(out, p);
  page_monitors(out, p);
  page_energies(out, p);
  page_warnings(out, p);
  page_inputs(out, p);
  page_provenance(out, p);
}

static void put_page(FILE *out, const page_result *results, int count) {
  movie movies[2];
  for (int k = 0; k < count; k++)
    movie_read(&movies[k], &results[k]);
  char *data = data_of(results, movies, count);
  shell_begin(out, title_of(&results[0]));
  fputs("<main>\n", out);
  put_result(out, &results[0], &movies[0]);
  fputs("</main>\n", out);
  shell_end(out, data);
  free(data);
  for (int k = 0; k < count; k++)
    movie_free(&movies[k]);
}

int page_of_results(FILE *out, const char *command, const char *const *paths, int count) {
  page_result results[2] = {{.path = NULL}};
  bool good = true;
  for (int k = 0; k < count; k++)
    good = page_result_open(&results[k], command, paths[k], k ? "b" : "a") && good;
  if (good) put_page(out, results, count);
  for (int k = 0; k < count; k++)
    good = page_result_close(&results[k], good);
  return good ? 0 : 1;
}
