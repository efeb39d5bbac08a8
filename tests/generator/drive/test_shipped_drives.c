/* The drive files of the shipped laws hold, interpreted and compiled, and each law has one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TEXT = 65536 };

/* Runs the program in the test's folder; its output, both channels, into `text`. Returns the exit
 * status. */
static int perilat(const char *arguments, char *text) {
  char command[2048];
  snprintf(command, sizeof command, "PERILAT_MODELS='%s/models' '%s' %s 2>&1", SOURCE_DIR,
           PERILAT_PROGRAM, arguments);
  FILE *in = popen(command, "r");
  assert_non_null(in);
  size_t n = fread(text, 1, TEXT - 1, in);
  text[n] = 0;
  int status = pclose(in);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

static int ends_in(const char *name, const char *tail) {
  size_t n = strlen(name), m = strlen(tail);
  return n > m && strcmp(name + n - m, tail) == 0;
}

static void shipped_drive_files_hold(void **state) {
  (void)state;
  char arguments[512], text[TEXT];
  int files = 0;
  DIR *folder = opendir(SOURCE_DIR "/models/drives");
  assert_non_null(folder);
  for (struct dirent *e; (e = readdir(folder));) {
    if (!ends_in(e->d_name, ".nml")) continue;
    for (int compiled = 0; compiled < 2; compiled++) {
      snprintf(arguments, sizeof arguments, "drive %s/models/drives/%s%s", SOURCE_DIR, e->d_name,
               compiled ? " --compiled" : "");
      if (perilat(arguments, text) != 0) fail_msg("%s\n%s", arguments, text);
      if (!strstr(text, "PASS")) fail_msg("%s expects nothing", e->d_name);
    }
    files++;
  }
  closedir(folder);
  assert_true(files >= 9);
}

/* Laws of families are driven by files of other names, those of cracks by none. */
static int is_not_asked(const char *path) {
  char line[256];
  int is = 0;
  FILE *in = fopen(path, "r");
  assert_non_null(in);
  while (!is && fgets(line, sizeof line, in))
    is = strstr(line, "law state") || strcmp(line, "  crack\n") == 0;
  fclose(in);
  return is;
}

/* A law without a drive file that names it is not checked by anything here. */
static void every_shipped_law_is_driven(void **state) {
  (void)state;
  char path[512];
  DIR *folder = opendir(SOURCE_DIR "/models");
  assert_non_null(folder);
  for (struct dirent *e; (e = readdir(folder));) {
    if (!ends_in(e->d_name, ".plm")) continue;
    snprintf(path, sizeof path, "%s/models/%s", SOURCE_DIR, e->d_name);
    if (is_not_asked(path)) continue;
    snprintf(path, sizeof path, "%s/models/drives/%.*s.nml", SOURCE_DIR, (int)strlen(e->d_name) - 4,
             e->d_name);
    if (access(path, R_OK) != 0) fail_msg("there is no %s", path);
  }
  closedir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(shipped_drive_files_hold),
                                     cmocka_unit_test(every_shipped_law_is_driven)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
