/* Runs a fuzzer on files instead of on inventions, each through all its parts: `replay_model folder
   | file ...`. A folder's files are taken in the order of their names. The test fails when one of
   them ends the program, or when there is none. */
#include <dirent.h>
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/fuzz/fuzz.h"

static char now[4096]; /* the file at hand, for the message of a crash */

static long replay_file(const char *path) {
  struct stat about;
  if (stat(path, &about) != 0 || !S_ISREG(about.st_mode)) return 0;
  FILE *in = fopen(path, "rb");
  uint8_t *bytes = in ? malloc((size_t)about.st_size + 1)
                      : NULL; /* exact but for malloc(0): overruns are seen */
  MUST(bytes && fread(bytes, 1, (size_t)about.st_size, in) == (size_t)about.st_size);
  fclose(in);
  snprintf(now, sizeof now, "%s", path);
  if (getenv("FUZZ_VERBOSE")) fprintf(stderr, "%s\n", now);
  LLVMFuzzerTestOneInput(bytes, (size_t)about.st_size);
  free(bytes);
  return 1;
}

static int not_hidden(const struct dirent *e) {
  return e->d_name[0] != '.';
}

static long replay(const char *path) {
  struct dirent **names;
  int count = scandir(path, &names, not_hidden, alphasort);
  if (count < 0) return replay_file(path);
  long files = 0;
  for (int k = 0; k < count; k++) {
    char inner[4096];
    snprintf(inner, sizeof inner, "%s/%s", path, names[k]->d_name);
    files += replay_file(inner);
    free(names[k]);
  }
  free(names);
  return files;
}

int main(int argc, char **argv) {
  long files = 0;
  MUST(setenv("FUZZ_EVERYTHING", "1", 1) == 0);
  for (int k = 1; k < argc; k++) {
    long found = replay(argv[k]);
    if (!found) fprintf(stderr, "%s: no files: %s\n", argv[k], strerror(errno));
    MUST(found);
    files += found;
  }
  printf("%ld files\n", files);
  return files > 0 ? 0 : 1;
}
