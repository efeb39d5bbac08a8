/* The laws that dsl/README.md shows as right pass what it teaches: `perilat check`, with every
   choice of their options. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "generator/kernel/model.h"

static void write_law(const char *path, const char *text, size_t length) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  assert_int_equal(fwrite(text, 1, length, out), length);
  assert_int_equal(fclose(out), 0);
}

static void assert_passes(const char *setting) {
  char command[1024];
  snprintf(command, sizeof command, "'%s' check readme_law.plm %s >readme_law.said 2>&1",
           PERILAT_PROGRAM, setting);
  const int status = system(command);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  (void)system("cat readme_law.plm readme_law.said >&2");
  fail_msg("%s", command);
}

/* The law with its defaults, and with every choice of each option. */
static void check_law(const char *text, size_t length) {
  model m;
  char setting[256];
  write_law("readme_law.plm", text, length);
  assert_true(model_open_text(&m, "readme_law.plm", text, length, NULL, 0));
  assert_passes("");
  for (int k = 0; k < m.law->options.count; k++) {
    const stmt *s = m.law->options.items[k]->declared;
    for (int c = 1; c < s->word_count; c++) {
      snprintf(setting, sizeof setting, "--set %s=%s", s->name, s->words[c]);
      assert_passes(setting);
    }
  }
  model_close(&m);
}

static void laws_of_the_readme_pass(void **state) {
  (void)state;
  static const char opening[] = "```plm\n", closing[] = "```";
  size_t length;
  char error[256];
  char *page = read_text_file(SOURCE_DIR "/dsl/README.md", 1 << 20, &length, error, sizeof error);
  assert_non_null(page);
  int count = 0;
  for (char *at = page; (at = strstr(at, opening));) {
    at += strlen(opening);
    const char *end = strstr(at, closing);
    assert_non_null(end);
    char *text = must_calloc((size_t)(end - at) + 1, 1);
    memcpy(text, at, (size_t)(end - at));
    check_law(text, strlen(text));
    free(text);
    count++;
  }
  free(page);
  assert_true(count >= 15);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(laws_of_the_readme_pass)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
