/* The way from C text to a loaded kernel: cache, corruption, races, missing compilers. Every test
 * has a cache of its own. */
#define _GNU_SOURCE /* nftw, RTLD_NEXT */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dlfcn.h>
#include <fcntl.h>
#include <ftw.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "dsl/base/sha256.h"
#include "generator/kernel/toolchain.h"
#include "generator/kernel/toolchain_cache.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/target/prelude.h"

#define ERROR_SIZE 2000

/* --- a small kernel, written by hand --------------------------------------------------------- */

static char *kernel_text(const char *key, int abi, double flops) {
  const char *format = "%s\n"
                       "static const pl_law the_law = {.abi = %d, .size = sizeof(pl_law), .name = "
                       "\"hand\", .key = \"%s\", "
                       ".flops_per_bond = %.17g};\n"
                       "const pl_law *perilat_kernel(void);\n"
                       "const pl_law *perilat_kernel(void) { return &the_law; }\n";
  size_t size = strlen(prelude_kernel_h) + 1000;
  char *text = malloc(size);
  assert_non_null(text);
  snprintf(text, size, format, prelude_kernel_h, abi, key, flops);
  return text;
}

/* Text with its own key, as the generator makes it. */
static char *keyed_text(double flops, char **key) {
  char *unkeyed = kernel_text("", PL_KERNEL_ABI, flops);
  *key = toolchain_key(unkeyed);
  free(unkeyed);
  return kernel_text(*key, PL_KERNEL_ABI, flops);
}

/* --- another processor ------------------------------------------------------------------------ */

static const char *processor_file = "/proc/cpuinfo";

FILE *fopen(const char *path, const char *mode) {
  FILE *(*of_library)(const char *, const char *);
  *(void **)&of_library = dlsym(RTLD_NEXT, "fopen");
  return of_library(strcmp(path, "/proc/cpuinfo") == 0 ? processor_file : path, mode);
}

static void put_processor(const char *path, const char *model, const char *flags) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fprintf(out, "model name\t: %s\nflags\t\t: fpu sse2 %s\n\n", model, flags);
  fclose(out);
}

/* --- fixtures -------------------------------------------------------------------------------- */

typedef struct place_of_test {
  char folder[256];
  char *path, *compiler, *cc, *processor;
} place_of_test;

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *at) {
  (void)about, (void)kind, (void)at;
  return remove(path);
}

static char *kept_setting(const char *name) {
  return getenv(name) ? strdup(getenv(name)) : NULL;
}

static void put_back(const char *name, char *value) {
  if (value)
    setenv(name, value, 1);
  else
    unsetenv(name);
  free(value);
}

static int set_up(void **state) {
  place_of_test *p = calloc(1, sizeof *p);
  snprintf(p->folder, sizeof p->folder, "%s/perilat test XXXXXX",
           getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (!mkdtemp(p->folder)) return -1;
  setenv("PERILAT_CACHE", p->folder, 1);
  p->path = kept_setting("PATH");
  p->compiler = kept_setting("PERILAT_CC");
  p->cc = kept_setting("CC");
  p->processor = kept_setting("PERILAT_PROCESSOR");
  unsetenv("PERILAT_PROCESSOR");
  *state = p;
  return 0;
}

static int tear_down(void **state) {
  place_of_test *p = *state;
  put_back("PATH", p->path);
  put_back("PERILAT_CC", p->compiler);
  put_back("CC", p->cc);
  put_back("PERILAT_PROCESSOR", p->processor);
  nftw(p->folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
  free(p);
  return 0;
}

static void assert_loads(const char *text, const char *key, bool from_cache, double flops) {
  loaded_kernel k;
  char error[ERROR_SIZE] = "";
  bool done = toolchain_load(text, key, &k, error, sizeof error);
  if (!done) fail_msg("%s", error);
  assert_string_equal(k.law->key, key);
  assert_true(k.law->flops_per_bond == flops);
  assert_int_equal(k.from_cache, from_cache);
  toolchain_unload(&k);
}

static int count_files(const char *folder, const char *ending) {
  char command[600];
  snprintf(command, sizeof command, "ls '%s' | grep -c '%s$'", folder, ending);
  FILE *in = popen(command, "r");
  int n = -1;
  assert_non_null(in);
  assert_int_equal(fscanf(in, "%d", &n), 1);
  pclose(in);
  return n;
}

/* --- SHA-256 --------------------------------------------------------------------------------- */

static void assert_digest(const char *block, int times, const char *expected) {
  sha256 h;
  char hex[SHA256_TEXT];
  sha256_begin(&h);
  for (int k = 0; k < times; k++)
    sha256_add(&h, block, strlen(block));
  sha256_text(&h, hex);
  assert_string_equal(hex, expected);
}

/* The example messages that NIST publishes with FIPS 180-4. */
static void digests_are_those_of_the_standard(void **state) {
  (void)state;
  assert_digest("", 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  assert_digest("abc", 1, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  assert_digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 1,
                "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  assert_digest("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 25000,
                "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

/* --- loading --------------------------------------------------------------------------------- */

static void a_kernel_is_compiled_once(void **state) {
  (void)state;
  char *key, *text = keyed_text(17, &key);
  assert_int_equal(strlen(key), 64);
  assert_loads(text, key, false, 17);
  assert_loads(text, key, true, 17);
  free(text);
  free(key);
}

static void a_cached_object_with_another_key_is_rebuilt(void **state) {
  place_of_test *p = *state;
  char *key, *text = keyed_text(1, &key), *other_key, *other = keyed_text(2, &other_key);
  char from[600], to[600];
  assert_string_not_equal(key, other_key);
  assert_loads(other, other_key, false, 2);
  snprintf(from, sizeof from, "%s/%s.so", p->folder, other_key);
  snprintf(to, sizeof to, "%s/%s.so", p->folder, key);
  assert_int_equal(rename(from, to), 0);
  assert_loads(text, key, false, 1);
  assert_loads(text, key, true, 1);
  free(text);
  free(key);
  free(other);
  free(other_key);
}

/* Every kind of damage that a full disk, a copy or a wrong hand can do: cut anywhere, one byte
 * turned anywhere. */
static void a_damaged_object_is_rebuilt(void **state) {
  place_of_test *p = *state;
  char *key, *text = keyed_text(3, &key), path[600];
  struct stat about;
  snprintf(path, sizeof path, "%s/%s.so", p->folder, key);
  assert_loads(text, key, false, 3);
  assert_int_equal(stat(path, &about), 0);
  for (int k = 0; k < 6; k++) {
    assert_int_equal(truncate(path, about.st_size * k / 6), 0);
    assert_loads(text, key, false, 3);
    FILE *out = fopen(path, "r+b");
    assert_non_null(out);
    fseek(out, about.st_size * k / 6, SEEK_SET);
    int byte = fgetc(out);
    fseek(out, -1, SEEK_CUR);
    fputc(byte ^ 0x40, out);
    fclose(out);
    assert_loads(text, key, false, 3);
  }
  assert_loads(text, key, true, 3);
  free(text);
  free(key);
}

static void runs_at_once_do_not_disturb_each_other(void **state) {
  place_of_test *p = *state;
  char *key, *text = keyed_text(4, &key);
  pid_t children[4];
  for (int k = 0; k < 4; k++) {
    children[k] = fork();
    if (children[k] == 0) {
      loaded_kernel loaded;
      char error[ERROR_SIZE];
      bool done = toolchain_load(text, key, &loaded, error, sizeof error);
      _exit(done && loaded.law->flops_per_bond == 4 ? 0 : 1);
    }
  }
  for (int k = 0; k < 4; k++) {
    int status;
    waitpid(children[k], &status, 0);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  assert_int_equal(count_files(p->folder, "so"), 1);
  assert_int_equal(count_files(p->folder, "tmp"), 0);
  free(text);
  free(key);
}

/* A file in the cache as a killed compilation, or somebody else, left it so many hours ago. */
static void leave_file(const char *folder, const char *name, int hours) {
  char path[1200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fclose(out);
  const struct timespec then = {.tv_sec = time(NULL) - 3600L * hours}, both[] = {then, then};
  assert_int_equal(utimensat(AT_FDCWD, path, both, 0), 0);
}

static bool is_there(const char *folder, const char *name) {
  char path[1200];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return access(path, F_OK) == 0;
}

static void what_killed_compilations_left_is_taken_away_after_a_day(void **state) {
  place_of_test *p = *state;
  char *key, *text = keyed_text(6, &key), name[8][100];
  static const char *const endings[] = {".so.abcdef.tmp", ".so.abcdef.tmp.1.o", ".c.abcdef.log",
                                        ".c.abcdef.tmp"};
  for (int k = 0; k < 4; k++) {
    snprintf(name[k], sizeof name[k], "%064d%s", k, endings[k]);
    leave_file(p->folder, name[k], 25);
    snprintf(name[4 + k], sizeof name[4 + k], "%064d%s", 4 + k, endings[k]);
    leave_file(p->folder, name[4 + k], 23); /* perhaps still at work */
  }
  const char *others[] = {"my.own.tmp", "0123.c.abcdef.log"};
  for (int k = 0; k < 2; k++)
    leave_file(p->folder, others[k], 1000);
  assert_loads(text, key, false, 6);
  for (int k = 0; k < 8; k++)
    assert_int_equal(is_there(p->folder, name[k]), k >= 4);
  for (int k = 0; k < 2; k++)
    assert_true(is_there(p->folder, others[k]));
  free(text);
  free(key);
}

static void refused_source_is_kept_and_named(void **state) {
  place_of_test *p = *state;
  loaded_kernel k;
  char error[ERROR_SIZE] = "", path[600];
  const char *text = "int here_is_no_semicolon\nstatic\n";
  assert_false(toolchain_load(text, "somekey", &k, error, sizeof error));
  snprintf(path, sizeof path, "%s/somekey.c", p->folder);
  assert_non_null(strstr(error, "failed (status 1) on the generated C, which is kept as"));
  assert_non_null(strstr(error, path));
  assert_non_null(strstr(error, "error:")); /* what the compiler said */
  FILE *in = fopen(path, "r");
  char kept[100] = "";
  assert_non_null(in);
  assert_int_equal(fread(kept, 1, sizeof kept - 1, in), strlen(text));
  fclose(in);
  assert_string_equal(kept, text);
  assert_int_equal(count_files(p->folder, "so"), 0);
  assert_int_equal(count_files(p->folder, "tmp"), 0);
}

/* --- opening --------------------------------------------------------------------------------- */

static void assert_refused(const char *path, const char *key, const char *why) {
  loaded_kernel k;
  char error[ERROR_SIZE] = "";
  assert_false(toolchain_open(path, key, &k, error, sizeof error));
  if (!strstr(error, why)) fail_msg("expected `%s` in: %s", why, error);
  assert_null(k.law);
  assert_null(k.handle);
}

static void foreign_objects_are_refused_with_the_reason(void **state) {
  place_of_test *p = *state;
  char path[600], error[ERROR_SIZE] = "";
  snprintf(path, sizeof path, "%s/no such.so", p->folder);
  assert_refused(path, NULL, "No such file");
  snprintf(path, sizeof path, "%s/kernel; touch harm.so", p->folder);
  assert_true(toolchain_build("int unrelated = 1;\n", path, error, sizeof error));
  assert_refused(path, NULL, "is not a kernel");
  char *old = kernel_text("k", PL_KERNEL_ABI + 1, 0);
  assert_true(toolchain_build(old, path, error, sizeof error));
  assert_refused(path, NULL, "interface");
  free(old);
  char *good = kernel_text("k", PL_KERNEL_ABI, 0);
  assert_true(toolchain_build(good, path, error, sizeof error));
  assert_refused(path, "another", "another law");
  loaded_kernel k;
  assert_true(toolchain_open(path, "k", &k, error, sizeof error));
  assert_string_equal(k.law->name, "hand");
  toolchain_unload(&k);
  free(good);
  assert_int_equal(count_files(p->folder, "c"), 0); /* built: nothing to keep */
}

/* A law whose table says how long it is, with as many inputs of a state. */
static char *table_text(size_t length, int inputs) {
  const char *format =
      "%s\n"
      "static const pl_input inputs[] = {{0}, {0}, {0}, {0}, {0}, {0}, {\"humidity\", "
      "\"1\"}};\n"
      "static const struct {\n  pl_law law;\n  double appended[8];\n} table = "
      "{{.abi = PL_KERNEL_ABI, .size = %zu, .name = \"hand\", .key = \"k\", "
      ".state_input_count = %d, .state_inputs = inputs}, {0}};\n"
      "const pl_law *perilat_kernel(void);\n"
      "const pl_law *perilat_kernel(void) { return &table.law; }\n";
  size_t size = strlen(prelude_kernel_h) + 1000;
  char *text = malloc(size);
  assert_non_null(text);
  snprintf(text, size, format, prelude_kernel_h, length, inputs);
  return text;
}

/* Longer tables are of later versions, shorter ones of earlier ones: good are those that have what
   is read here. */
static void tables_of_other_lengths_are_taken_where_they_suffice(void **state) {
  place_of_test *p = *state;
  const struct {
    size_t length;
    int inputs;
    const char *refused;
  } cases[] = {{sizeof(pl_law), PL_STATE_INPUTS, NULL},
               {sizeof(pl_law) + 8 * sizeof(double), PL_STATE_INPUTS, NULL},
               {offsetof(pl_law, context), PL_STATE_INPUTS, NULL},
               {offsetof(pl_law, context) - 1, PL_STATE_INPUTS, "ends too early"},
               {0, PL_STATE_INPUTS, "ends too early, after 0 bytes"},
               {sizeof(pl_law), PL_STATE_INPUTS + 1, "the input `humidity`"}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char path[600], error[ERROR_SIZE] = "", *text = table_text(cases[k].length, cases[k].inputs);
    snprintf(path, sizeof path, "%s/table %zu.so", p->folder, k);
    assert_true(toolchain_build(text, path, error, sizeof error));
    free(text);
    if (cases[k].refused) {
      assert_refused(path, "k", cases[k].refused);
      continue;
    }
    loaded_kernel kernel;
    if (!toolchain_open(path, "k", &kernel, error, sizeof error)) fail_msg("%zu: %s", k, error);
    toolchain_unload(&kernel);
  }
}

static void a_text_file_is_no_kernel(void **state) {
  place_of_test *p = *state;
  char path[600];
  snprintf(path, sizeof path, "%s/text.so", p->folder);
  FILE *out = fopen(path, "w");
  fputs("not an object", out);
  fclose(out);
  assert_refused(path, NULL, "cannot load");
}

static void objects_cannot_be_built_where_nothing_can_be_written(void **state) {
  (void)state;
  char error[ERROR_SIZE] = "";
  assert_false(toolchain_build("int x;\n", "/dev/null/kernel.so", error, sizeof error));
  assert_non_null(strstr(error, "cannot write"));
}

/* --- the compiler ---------------------------------------------------------------------------- */

static void without_a_compiler_there_is_none(void **state) {
  (void)state;
  loaded_kernel k;
  char error[ERROR_SIZE] = "";
  unsetenv("PERILAT_CC");
  unsetenv("CC");
  assert_non_null(toolchain_compiler());
  setenv("PATH", "", 1);
  assert_null(toolchain_compiler());
  assert_false(toolchain_load("int x;\n", "k", &k, error, sizeof error));
  assert_non_null(strstr(error, "no C compiler"));
  char *key = toolchain_key("int x;\n"); /* the interpreter's runs have keys too */
  assert_int_equal(strlen(key), 64);
  free(key);
}

static void a_named_compiler_is_taken_or_none(void **state) {
  (void)state;
  setenv("PERILAT_CC", "no-such-compiler", 1);
  assert_null(toolchain_compiler());
  assert_non_null(strstr(toolchain_no_compiler(), "PERILAT_CC names the C compiler `no-such-comp"));
  unsetenv("PERILAT_CC");
  setenv("CC", "no-such-compiler", 1);
  assert_string_not_equal(toolchain_compiler(), "no-such-compiler");
  setenv("PERILAT_CC", "  cc -DUNUSED=1", 1);
  assert_string_equal(toolchain_compiler(), "cc -DUNUSED=1");
  char *key, *text = keyed_text(5, &key);
  assert_loads(text, key, false, 5);
  free(text);
  free(key);
}

/* What another one runs is another kernel, under a key of its own. */
static void a_named_processor_is_compiled_for(void **state) {
  (void)state;
  assert_non_null(strstr(toolchain_flags(), "-march=native"));
  setenv("PERILAT_PROCESSOR", "8087", 1);
  assert_null(toolchain_compiler());
  assert_non_null(strstr(toolchain_no_compiler(), "PERILAT_PROCESSOR is `8087`, which is none of"));
#if defined(__x86_64__)
  unsetenv("PERILAT_PROCESSOR");
  char *native, *basic, *text = keyed_text(5, &native);
  free(text);
  setenv("PERILAT_PROCESSOR", "x86-64", 1);
  assert_non_null(strstr(toolchain_flags(), "-march=x86-64 "));
  text = keyed_text(5, &basic);
  assert_string_not_equal(native, basic);
  assert_loads(text, basic, false, 5);
  free(text);
  free(native);
  free(basic);
#endif
}

static void a_compiler_that_fails_is_reported(void **state) {
  place_of_test *p = *state;
  loaded_kernel k;
  char error[ERROR_SIZE] = "";
  setenv("PERILAT_CC", "false", 1);
  assert_false(toolchain_load("int x;\n", "k", &k, error, sizeof error));
  assert_non_null(strstr(error, "status 1"));
  setenv("PERILAT_CC", "true", 1); /* says it is done and writes nothing */
  assert_false(toolchain_load("int x;\n", "k", &k, error, sizeof error));
  assert_int_equal(count_files(p->folder, "tmp"), 0);
}

/* A kernel whose number of operations is a constant of the other part. */
static char *text_in_parts(const char *other) {
  static const char form[] =
      "%s\n"
      "extern const double of_other;\n"
      "#if PL_PART == 0\n"
      "static pl_law the_law = {.abi = PL_KERNEL_ABI, .size = sizeof(pl_law), .name = \"hand\", "
      ".key = \"parts\"};\n"
      "const pl_law *perilat_kernel(void);\n"
      "const pl_law *perilat_kernel(void) { the_law.flops_per_bond = of_other; return &the_law; }\n"
      "#else\n"
      "%s\n"
      "#endif\n";
  const size_t size = strlen(prelude_kernel_h) + sizeof form + strlen(other);
  char *text = malloc(size);
  assert_non_null(text);
  snprintf(text, size, form, prelude_kernel_h, other);
  return text;
}

static void parts_are_compiled_each_and_linked(void **state) {
  place_of_test *p = *state;
  loaded_kernel k;
  char error[ERROR_SIZE] = "";
  char *text = text_in_parts("const double of_other = 7;"),
       *wrong = text_in_parts("const double;;x");
  assert_loads(text, "parts", false, 7);
  assert_loads(text, "parts", true, 7);
  assert_false(toolchain_load(wrong, "wrong", &k, error, sizeof error));
  assert_non_null(strstr(error, "error:"));
  assert_int_equal(count_files(p->folder, "tmp"), 0);
  assert_int_equal(count_files(p->folder, "o"), 1); /* the .so */
  assert_int_equal(count_files(p->folder, "log"), 0);
  free(text);
  free(wrong);
}

static void the_key_holds_text_compiler_and_flags(void **state) {
  (void)state;
  unsetenv("PERILAT_CC");
  char *first = toolchain_key("a"), *again = toolchain_key("a"), *text = toolchain_key("b");
  setenv("PERILAT_CC", "cc -O0", 1);
  char *options = toolchain_key("a");
  assert_string_equal(first, again);
  assert_string_not_equal(first, text);
  assert_string_not_equal(first, options);
  free(first);
  free(again);
  free(text);
  free(options);
}

/* A folder that two machines share: kernels for the processor at hand are those of one model and
   its instructions. */
static void the_key_holds_the_processor(void **state) {
  place_of_test *p = *state;
  char path[600], *keys[4];
  static const char *const models[] = {"one", "other", "one", "one"}, *const flags[] = {
                                                                          "avx2", "avx2",
                                                                          "fma avx2", "avx2"};
  snprintf(path, sizeof path, "%s/cpuinfo", p->folder);
  processor_file = path;
  for (int k = 0; k < 4; k++) {
    put_processor(path, models[k], flags[k]);
    keys[k] = toolchain_key("a");
  }
  processor_file = "/proc/cpuinfo";
  assert_string_not_equal(keys[0], keys[1]);
  assert_string_not_equal(keys[0], keys[2]);
  assert_string_equal(keys[0], keys[3]);
  for (int k = 0; k < 4; k++)
    free(keys[k]);
}

/* --- the cache ------------------------------------------------------------------------------- */

static void an_unwritable_cache_gives_a_temporary_one(void **state) {
  place_of_test *p = *state;
  char *kept = kept_setting("TMPDIR");
  setenv("TMPDIR", p->folder, 1);
  setenv("PERILAT_CACHE", "/dev/null/cache", 1);
  const char *cache = toolchain_cache(), *trouble = toolchain_cache_trouble();
  struct stat about;
  assert_non_null(
      strstr(trouble, "the cache `/dev/null/cache` cannot be written to (Not a directory)"));
  assert_non_null(strstr(trouble, cache));
  assert_memory_equal(cache, p->folder, strlen(p->folder));
  assert_int_equal(stat(cache, &about), 0);
  assert_int_equal(about.st_mode & 0777, 0700);
  char *key, *text = keyed_text(6, &key);
  assert_loads(text, key, false, 6);
  assert_loads(text, key, true, 6);
  free(text);
  free(key);
  put_back("TMPDIR", kept);
}

/* Others could have put a program there for us to load. */
static void a_temporary_cache_that_others_can_write_is_not_used(void **state) {
  place_of_test *p = *state;
  char *kept = kept_setting("TMPDIR"), first[600];
  setenv("TMPDIR", p->folder, 1);
  setenv("PERILAT_CACHE", "/dev/null/cache", 1);
  snprintf(first, sizeof first, "%s", toolchain_cache());
  assert_int_equal(chmod(first, 0777), 0);
  assert_string_not_equal(toolchain_cache(), first);
  assert_int_equal(chmod(first, 0700), 0);
  assert_string_equal(toolchain_cache(), first);
  put_back("TMPDIR", kept);
}

static void assert_cache_is(const char *folder, const char *below) {
  assert_null(toolchain_cache_trouble());
  const char *cache = toolchain_cache();
  assert_memory_equal(cache, folder, strlen(folder));
  assert_string_equal(cache + strlen(folder), below);
}

static void the_cache_follows_the_usual_variables(void **state) {
  place_of_test *p = *state;
  char *home = kept_setting("HOME"), *xdg = kept_setting("XDG_CACHE_HOME");
  unsetenv("PERILAT_CACHE");
  setenv("XDG_CACHE_HOME", p->folder, 1);
  assert_cache_is(p->folder, "/perilat");
  unsetenv("XDG_CACHE_HOME");
  setenv("HOME", p->folder, 1);
  assert_cache_is(p->folder, "/.cache/perilat");
  put_back("HOME", home);
  put_back("XDG_CACHE_HOME", xdg);
}

int main(void) {
#define IN_OWN_CACHE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(digests_are_those_of_the_standard),
      IN_OWN_CACHE(a_kernel_is_compiled_once),
      IN_OWN_CACHE(a_cached_object_with_another_key_is_rebuilt),
      IN_OWN_CACHE(a_damaged_object_is_rebuilt),
      IN_OWN_CACHE(runs_at_once_do_not_disturb_each_other),
      IN_OWN_CACHE(what_killed_compilations_left_is_taken_away_after_a_day),
      IN_OWN_CACHE(refused_source_is_kept_and_named),
      IN_OWN_CACHE(foreign_objects_are_refused_with_the_reason),
      IN_OWN_CACHE(tables_of_other_lengths_are_taken_where_they_suffice),
      IN_OWN_CACHE(a_text_file_is_no_kernel),
      IN_OWN_CACHE(objects_cannot_be_built_where_nothing_can_be_written),
      IN_OWN_CACHE(without_a_compiler_there_is_none),
      IN_OWN_CACHE(a_named_compiler_is_taken_or_none),
      IN_OWN_CACHE(a_named_processor_is_compiled_for),
      IN_OWN_CACHE(a_compiler_that_fails_is_reported),
      IN_OWN_CACHE(parts_are_compiled_each_and_linked),
      IN_OWN_CACHE(the_key_holds_text_compiler_and_flags),
      IN_OWN_CACHE(the_key_holds_the_processor),
      IN_OWN_CACHE(an_unwritable_cache_gives_a_temporary_one),
      IN_OWN_CACHE(a_temporary_cache_that_others_can_write_is_not_used),
      IN_OWN_CACHE(the_cache_follows_the_usual_variables),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
