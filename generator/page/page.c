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
  return *p->title ? p->title : p->shown;
}

static void put_header(FILE *out, const page_result *results, int count) {
  fputs("<header><h1>", out);
  html_text(out, title_of(&results[0]));
  if (count > 1 && strcmp(title_of(&results[0]), title_of(&results[1])) != 0) {
    fputs(" <small>beside</small> ", out);
    html_text(out, title_of(&results[1]));
  }
  fputs("</h1>\n", out);
  fputs("</header>\n", out);
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

/* --- sections --------------------------------------------------------------------------------- */

typedef void section(FILE *out, const page_result *p);

/* What stands in a page, in its order: X(name of the link, its words) */
#define PARTS(X)                                                                                   \
  X("body", "The body")                                                                            \
  X("law", "The law")                                                                              \
  X("sentences", "In sentences")                                                                   \
  X("asked", "What was asked")                                                                     \
  X("monitors", "Monitors")                                                                        \
  X("frames", "What is seen")                                                                      \
  X("energies", "Energies")                                                                        \
  X("origin", "Where this comes from")

static void put_links(FILE *out) {
  fputs("<nav aria-label=\"parts of the page\">", out);
#define X(name, words) fputs("<a href=\"#" name "\">" words "</a> ", out);
  PARTS(X)
#undef X
  fputs("</nav>\n", out);
}

/* Of two results side by side. */
static void put_beside(FILE *out, const page_result *results, int count, const char *name,
                       section *put) {
  fprintf(out, "<div id=\"%s\"%s>\n", name, count > 1 ? " class=\"pair\"" : "");
  for (int k = 0; k < count; k++) {
    if (count > 1) fputs("<div>", out);
    put(out, &results[k]);
    if (count > 1) fputs("</div>\n", out);
  }
  fputs("</div>\n", out);
}

static void put_frames(FILE *out, const page_result *results, const movie *movies, int count) {
  fputs("<section id=\"frames\"><h2>What is seen</h2>\n", out);
  if (count > 1) fputs("<div class=\"pair\">\n", out);
  for (int k = 0; k < count; k++) {
    if (count > 1) fputs("<div>", out);
    page_frames(out, &results[k], &movies[k]);
    if (count > 1) fputs("</div>\n", out);
  }
  if (count > 1) fputs("</div>\n", out);
  page_main_curve(out, results, count, false);
  fputs("</section>\n", out);
}

static void put_sections(FILE *out, const page_result *results, const movie *movies, int count) {
  put_header(out, results, count);
  put_links(out);
  put_beside(out, results, count, "verdict", page_verdict);
  page_main_curve(out, results, count, true);
  put_beside(out, results, count, "body", page_body);
  put_beside(out, results, count, "law", page_laws);
  put_beside(out, results, count, "sentences", page_sentences);
  put_beside(out, results, count, "asked", page_inputs);
  page_monitors(out, results, count);
  put_frames(out, results, movies, count);
  put_beside(out, results, count, "energies", page_energies);
  put_beside(out, results, count, "warnings", page_warnings);
  put_beside(out, results, count, "origin", page_provenance);
}

static void put_page(FILE *out, const page_result *results, int count) {
  movie movies[2];
  for (int k = 0; k < count; k++)
    movie_read(&movies[k], &results[k]);
  char *data = data_of(results, movies, count);
  shell_begin(out, title_of(&results[0]));
  fputs("<main>\n", out);
  put_sections(out, results, movies, count);
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
  page_results_name(results, count);
  if (good) put_page(out, results, count);
  for (int k = 0; k < count; k++)
    good = page_result_close(&results[k], good);
  return good ? 0 : 1;
}
