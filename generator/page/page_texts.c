#include "generator/page/page_texts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/page/html.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

static void put_pre(FILE *out, const char *class, const char *text) {
  fprintf(out, "<pre class=\"%s\" tabindex=\"0\">", class);
  html_text(out, text);
  fputs("</pre>\n", out);
}

void page_sentences(FILE *out, const page_result *p) {
  if (!*p->said_begin && !*p->said_end) return;
  fputs("<section><h2>The run in sentences</h2>\n", out);
  if (*p->said_begin) put_pre(out, "said", p->said_begin);
  if (*p->said_end) put_pre(out, "said", p->said_end);
  fputs("</section>\n", out);
}

/* --- inputs ----------------------------------------------------------------------------------- */

static void put_folded(FILE *out, const char *what, const char *name, const char *text) {
  long lines = 0;
  for (const char *c = text; *c; c++)
    lines += *c == '\n';
  fprintf(out, "<details><summary>%s", what);
  if (*name) {
    fputs(" <code>", out);
    html_text(out, name);
    fputs("</code>", out);
  }
  fprintf(out, " <small>%ld line%s</small></summary>\n", lines, lines == 1 ? "" : "s");
  put_pre(out, "source", text);
  fputs("</details>\n", out);
}

/* All texts of a group of the result. */
static void put_group(FILE *out, const page_result *p, const char *group, const char *what) {
  result_names names = result_list(p->file, group);
  for (int k = 0; k < names.count; k++) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", group, names.items[k]);
    char *text = result_read_text(p->file, path);
    if (text) put_folded(out, what, names.items[k], text);
    free(text);
  }
  result_names_free(&names);
}

void page_inputs(FILE *out, const page_result *p) {
  fputs("<section><h2>What was asked</h2>\n", out);
  if (*p->set) put_folded(out, "Set on the command line", "", page_without_folders(p, p->set));
  if (*p->deck_text) put_folded(out, "Deck", page_without_folders(p, p->deck_name), p->deck_text);
  put_group(out, p, "/input/models", "Law");
  put_group(out, p, "/input/files", "Table");
  fputs("</section>\n", out);
}

/* --- provenance ------------------------------------------------------------------------------- */

static void put_row(FILE *out, const char *name, const char *value) {
  if (!*value) return;
  fprintf(out, "<tr><th scope=\"row\">%s</th><td>", name);
  html_text(out, value);
  fputs("</td></tr>\n", out);
}

/* As a shell takes it. */
static void put_word(FILE *out, const char *word, size_t length) {
  bool plain = length > 0;
  for (size_t k = 0; k < length; k++)
    plain = plain && (strchr("%+,-./:=@_[]", word[k]) || (word[k] >= '0' && word[k] <= '9') ||
                      (word[k] >= 'a' && word[k] <= 'z') || (word[k] >= 'A' && word[k] <= 'Z'));
  if (plain) {
    html_bytes(out, word, length);
    return;
  }
  fputs("&#39;", out);
  for (size_t k = 0; k < length; k++)
    if (word[k] == '\'')
      fputs("&#39;\\&#39;&#39;", out);
    else
      html_bytes(out, word + k, 1);
  fputs("&#39;", out);
}

static void put_command(FILE *out, const page_result *p) {
  const char *name = *p->deck_name ? page_without_folders(p, p->deck_name) : "deck.nml";
  fputs("<pre class=\"command\" tabindex=\"0\">perilat run ", out);
  put_word(out, name, strlen(name));
  for (const char *line = page_without_folders(p, p->set); *line;) {
    const size_t length = strcspn(line, "\n");
    if (length) fputs(" --set ", out);
    if (length) put_word(out, line, length);
    line += length + (line[length] == '\n');
  }
  fputs("</pre>\n", out);
  if (!*p->deck_name)
    fputs("<p>The deck is the one above; the result does not tell what its file was called.</p>\n",
          out);
}

void page_provenance(FILE *out, const page_result *p) {
  char text[64];
  fputs("<section class=\"provenance\"><h2>Where this comes from</h2>\n<table>\n", out);
  put_row(out, "result", p->shown);
  put_row(out, "perilat", p->version);
  put_row(out, "begun", p->started);
  put_row(out, "compiler of the law", p->compiler);
  put_row(out, "its flags", p->flags);
  snprintf(text, sizeof text, "%.0f; the numbers are the same for any", p->threads);
  if (!isnan(p->threads)) put_row(out, "threads", text);
  fputs("</table>\n<p>This repeats the run:</p>\n", out);
  put_command(out, p);
  fputs("</section>\n", out);
}
