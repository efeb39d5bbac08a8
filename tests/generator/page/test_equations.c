/* The equations of every law that comes along as they stand in pages: well formed, and with nothing
   of LaTeX or Markdown left over. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>

#include "dsl/print/explain.h"
#include "generator/kernel/model.h"
#include "generator/page/markdown.h"
#include "tests/generator/command_tools.h"

/* malloc'ed */
static char *page_of_markdown(const char *text) {
  char *page = NULL;
  size_t length;
  FILE *out = open_memstream(&page, &length);
  fputs("<div>\n", out);
  markdown_put(out, text, NULL);
  fputs("</div>\n", out);
  fclose(out);
  return page;
}

static char *explained(const char *path) {
  model m;
  assert_true(model_open(&m, path, NULL, 0));
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  explain_law(m.law, EXPLAIN_MARKDOWN, NULL, 0, out);
  fclose(out);
  model_close(&m);
  char *page = page_of_markdown(text);
  free(text);
  return page;
}

/* As far as the tool of another house is there. */
static void is_well_formed(workplace *w, const char *page) {
  write_text(w, "page.xml", page);
  const int status =
      shell(w, "command -v xmllint > /dev/null || exit 77; xmllint --noout page.xml");
  if (status != 0 && status != 77) fprintf(stderr, "%s\n", w->said);
  assert_true(status == 0 || status == 77);
}

static void laws_are_well_formed(void **state) {
  workplace *w = *state;
  glob_t found;
  assert_int_equal(glob(SOURCE_DIR "/models/*.plm", 0, NULL, &found), 0);
  assert_true(found.gl_pathc > 20);
  for (size_t k = 0; k < found.gl_pathc; k++) {
    char *page = explained(found.gl_pathv[k]);
    is_well_formed(w, page);
    if (strchr(page, '$') || strstr(page, "\\frac") || strstr(page, "\\left") || strchr(page, '`'))
      fail_msg("%s: %s", found.gl_pathv[k], page);
    assert_non_null(strstr(page, "<math display=\"block\">"));
    free(page);
  }
  globfree(&found);
}

static void texts_stay_texts(void **state) {
  (void)state;
  static const char *const rows[][2] = {
      {"# A & B", "<div>\n<h2>A &amp; B</h2>\n</div>\n"},
      {"a `<b>` \\`c\\` \\$5 and \\$6",
       "<div>\n<p>a <code>&lt;b&gt;</code> `c` $5 and $6</p>\n</div>\n"},
      {"| x | y |\n|---|---|\n| `a|b` | c\\|d |\n\nend",
       "<div>\n<div class=\"scroll\"><table><thead><tr><th>x</th><th>y</th></tr>\n</thead><tbody>\n"
       "<tr><td><code>a|b</code></td><td>c|d</td></tr>\n</tbody></table></div>\n<p>end</p>\n"
       "</div>\n"},
      {"<script>alert(1)</script>",
       "<div>\n<p>&lt;script&gt;alert(1)&lt;/script&gt;</p>\n</div>\n"},
      {"open $x", "<div>\n<p>open $x</p>\n</div>\n"},
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
    char *page = page_of_markdown(rows[k][0]);
    assert_string_equal(page, rows[k][1]);
    free(page);
  }
}

static void sections_can_be_left_out(void **state) {
  (void)state;
  static const char *const skip[] = {"Gone", NULL};
  char *page = NULL;
  size_t length;
  FILE *out = open_memstream(&page, &length);
  markdown_put(out, "# A\na\n## Gone\n| x |\n|---|\n| 1 |\ng\n## B\nb\n", skip);
  fclose(out);
  assert_string_equal(page, "<h2>A</h2>\n<p>a</p>\n<h3>B</h3>\n<p>b</p>\n");
  free(page);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(laws_are_well_formed, set_up_workplace, tear_down_workplace),
      cmocka_unit_test(texts_stay_texts),
      cmocka_unit_test(sections_can_be_left_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
