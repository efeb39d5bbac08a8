#include "generator/kernel/toolchain.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/sha256.h"
#include "generator/kernel/toolchain_cache.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/kernel/toolchain_process.h"
#include "generator/target/kernel_parts.h"

#define LONGEST_PATH PATH_MAX

/* First `size - 1` bytes of a file; empty when it cannot be read. */
static void read_head(const char *path, char *text, size_t size) {
  FILE *in = fopen(path, "rb");
  size_t n = in ? fread(text, 1, size - 1, in) : 0;
  text[n] = 0;
  if (in) fclose(in);
}

/* --- key -------------------------------------------------------------------------------------- */

/* First line of `compiler --version`; empty when it does not answer. */
static void read_version(const char *compiler, char *version, size_t size) {
  char log[LONGEST_PATH], base[LONGEST_PATH - 16];
  *version = 0;
  snprintf(base, sizeof base, "%s/version", toolchain_cache());
  if (!cache_temporary(base, ".log", log, sizeof log)) return;
  arguments a = {0};
  arguments_add_words(&a, compiler, "");
  arguments_add(&a, "--version");
  if (process_finish(process_start(&a, log)) == 0) read_head(log, version, size);
  version[strcspn(version, "\n")] = 0;
  arguments_free(&a);
  unlink(log);
}

/* The length goes in too, so that no two lists of texts look the same. */
static void add_text(sha256 *h, const char *text) {
  uint64_t length = strlen(text);
  sha256_add(h, &length, sizeof length);
  sha256_add(h, text, (size_t)length);
}

void toolchain_version(char *version, size_t size) {
  const char *compiler = toolchain_compiler();
  *version = 0;
  if (compiler) read_version(compiler, version, size);
}

char *toolchain_key(const char *text) {
  char path[LONGEST_PATH] = "", version[512] = "", here[8192];
  const char *compiler = toolchain_compiler();
  if (compiler) process_find(compiler, path, sizeof path);
  toolchain_version(version, sizeof version);
  toolchain_processor(here, sizeof here);
  const uint64_t layout[] = {PL_KERNEL_ABI, sizeof(pl_law), sizeof(pl_strip),
                             sizeof(pl_bond_class)};
  sha256 h;
  sha256_begin(&h);
  add_text(&h, text);
  add_text(&h, compiler ? compiler : "");
  add_text(&h, path);
  add_text(&h, version);
  add_text(&h, toolchain_flags());
  add_text(&h, here);
  sha256_add(&h, layout, sizeof layout);
  char *key = must_alloc(SHA256_TEXT);
  sha256_text(&h, key);
  return key;
}

/* --- compiling -------------------------------------------------------------------------------- */

#define SOLVER_LIBRARIES                                                                           \
  "-lperilat_generator -lperilat_runtime -lperilat_generator -lperilat_runtime -lperilat_dsl "     \
  "-fopenmp " PERILAT_LINK_LIBRARIES

/* What the compiler is asked to do. */
typedef struct compilation {
  const char *source;
  const char *libraries; /* the option that says where they are: a program; NULL: a shared object */
  int parts;             /* that the source is compiled in at the same time; 1: whole */
  const char *macro;     /* what tells a part its number */
  const char *log;       /* what the compiler says is added to */
} compilation;

/* The compiler with flags, but not `less`, and where to write. */
static arguments command(const char *output, const char *less) {
  arguments a = {0};
  arguments_add_words(&a, toolchain_compiler(), "");
  arguments_add_words(&a, toolchain_flags(), less);
  arguments_add(&a, "-o");
  arguments_add(&a, output); /* whole, blanks and all */
  return a;
}

static int run_and_free(arguments *a, const char *log) {
  arguments_add(a, "-lm"); /* fma, where the processor has none */
  const int status = process_finish(process_start(a, log));
  arguments_free(a);
  return status;
}

static arguments linking(const compilation *c, const char *object) {
  return command(object, c->libraries ? "-shared" : "");
}

static int link_and_free(arguments *a, const compilation *c) {
  if (c->libraries) {
    arguments_add(a, c->libraries);
    arguments_add_words(a, SOLVER_LIBRARIES, "");
  }
  return run_and_free(a, c->log);
}

static int compile_whole(const compilation *c, const char *object) {
  arguments a = linking(c, object);
  arguments_add(&a, c->source);
  return link_and_free(&a, c);
}

static void name_part(char part[LONGEST_PATH], const char *object, int number) {
  snprintf(part, LONGEST_PATH, "%.*s.%d.o", LONGEST_PATH - 16, object, number);
}

/* Parts at the same time, then linked. */
static int compile_parts(const compilation *c, const char *object) {
  char part[LONGEST_PATH], macro[64];
  pid_t *children = must_calloc((size_t)c->parts, sizeof *children);
  arguments link = linking(c, object);
  int status = 0;
  for (int k = 0; k < c->parts; k++) {
    name_part(part, object, k);
    arguments_add(&link, part);
    arguments a = command(part, "-shared");
    snprintf(macro, sizeof macro, "-D%s=%d", c->macro, k);
    arguments_add(&a, macro);
    arguments_add(&a, "-c");
    arguments_add(&a, c->source);
    children[k] = process_start(&a, c->log);
    arguments_free(&a);
  }
  for (int k = 0; k < c->parts; k++) {
    const int of_part = process_finish(children[k]);
    status = status ? status : of_part;
  }
  if (!status)
    status = link_and_free(&link, c);
  else
    arguments_free(&link);
  for (int k = 0; k < c->parts; k++) {
    name_part(part, object, k);
    unlink(part);
  }
  free(children);
  return status;
}

static void explain_failure(int status, const char *source, const char *log, char *error,
                            size_t size) {
  char said[600];
  read_head(log, said, sizeof said);
  if (status == 127)
    snprintf(error, size, "the C compiler `%s` could not be started", toolchain_compiler());
  else
    snprintf(error, size,
             "the C compiler `%s` failed (status %d) on the generated C, which is kept as `%s`; "
             "it %s%s",
             toolchain_compiler(), status, source, *said ? "said:\n" : "said nothing", said);
}

/* Compiles to `path`, whole or not at all. */
static bool compile_to(compilation c, const char *path, bool sealed, char *error, size_t size) {
  char object[LONGEST_PATH], log[LONGEST_PATH];
  if (!toolchain_compiler()) {
    snprintf(error, size, "%s", toolchain_no_compiler());
    return false;
  }
  if (!cache_temporary(path, ".tmp", object, sizeof object)) {
    snprintf(error, size, "cannot write beside `%s`: %s", path, strerror(errno));
    return false;
  }
  if (!cache_temporary(c.source, ".log", log, sizeof log)) {
    snprintf(error, size, "cannot write beside `%s`: %s", c.source, strerror(errno));
    unlink(object);
    return false;
  }
  c.log = log;
  const int status = c.parts > 1 ? compile_parts(&c, object) : compile_whole(&c, object);
  if (status) explain_failure(status, c.source, log, error, size);
  unlink(log);
  bool done = !status && (!sealed || cache_seal(object)) && chmod(object, 0755) == 0 &&
              rename(object, path) == 0;
  if (!status && !done) snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  if (!done) unlink(object);
  return done;
}

/* Of a kernel's text. */
static compilation of_kernel(const char *source, const char *c_text) {
  const int parts = strstr(c_text, "PL_PART") ? KERNEL_PARTS : 1;
  return (compilation){.source = source, .parts = parts, .macro = "PL_PART"};
}

/* A program with `libraries`, of `parts`; else a kernel. */
static bool build(const char *c_text, const char *libraries, int parts, const char *path,
                  char *error, size_t size) {
  char source[LONGEST_PATH], base[LONGEST_PATH - 16];
  snprintf(base, sizeof base, "%s/build", toolchain_cache());
  if (!cache_temporary(base, ".c", source, sizeof source) ||
      !cache_write(source, "wb", c_text, strlen(c_text))) {
    snprintf(error, size, "cannot write a file in `%s`: %s", toolchain_cache(), strerror(errno));
    return false;
  }
  const compilation c = libraries ? (compilation){.source = source,
                                                  .libraries = libraries,
                                                  .parts = parts,
                                                  .macro = "PL_SOLVER_PART"}
                                  : of_kernel(source, c_text);
  bool done = compile_to(c, path, false, error, size);
  if (done) unlink(source);
  return done;
}

bool toolchain_build(const char *c_text, const char *path, char *error, size_t size) {
  return build(c_text, NULL, 1, path, error, size);
}

/* -L and the folder with this program's static libraries: where it was built, or where it is
   installed. */
static bool find_libraries(char *folder, size_t size) {
  static const char *const relative[] = {"", "/" PERILAT_LIBRARY_FOLDER};
  char program[LONGEST_PATH], probe[LONGEST_PATH + 64];
  ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
  program[n > 0 ? n : 0] = 0;
  char *slash = strrchr(program, '/');
  if (slash) *slash = 0;
  for (size_t k = 0; slash && k < sizeof relative / sizeof *relative; k++) {
    int length = snprintf(folder, size, "-L%s%s", program, relative[k]);
    if (length < 0 || (size_t)length >= size) return false;
    snprintf(probe, sizeof probe, "%s/libperilat_runtime.a", folder + strlen("-L"));
    if (access(probe, R_OK) == 0) return true;
  }
  return false;
}

bool toolchain_build_program(const char *c_text, int parts, const char *path, char *error,
                             size_t size) {
  char folder[LONGEST_PATH];
  if (!find_libraries(folder, sizeof folder)) {
    snprintf(error, size,
             "a solver is linked with libperilat_runtime.a, which is not beside this program");
    return false;
  }
  return build(c_text, folder, parts, path, error, size);
}

/* --- loading ---------------------------------------------------------------------------------- */

static bool check_law(const pl_law *law, const char *path, const char *key, char *error,
                      size_t size) {
  if (!law)
    snprintf(error, size, "`%s` is not a kernel of perilat", path);
  else if (law->abi != PL_KERNEL_ABI)
    snprintf(error, size,
             "`%s` was built for version %d of the kernel interface, not %d: build it again", path,
             law->abi, PL_KERNEL_ABI);
  else if (!PL_HAS(law, observe))
    snprintf(error, size, "the table of `%s` ends too early, after %u bytes: build it again", path,
             law->size);
  else if (law->state_input_count > PL_STATE_INPUTS)
    snprintf(error, size,
             "the law of `%s` wants the input `%s` of a state, which is not known here", path,
             law->state_inputs[PL_STATE_INPUTS].name);
  else if (key && strcmp(law->key, key) != 0)
    snprintf(error, size, "`%s` is the kernel of another law, compiler or processor", path);
  else
    return true;
  return false;
}

bool toolchain_open(const char *path, const char *key_or_null, loaded_kernel *out, char *error,
                    size_t size) {
  *out = (loaded_kernel){0};
  char *full =
      realpath(path, NULL); /* a bare name would be looked for among the system's libraries */
  if (!full) {
    snprintf(error, size, "cannot read `%s`: %s", path, strerror(errno));
    return false;
  }
  void *handle = dlopen(full, RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    snprintf(error, size, "cannot load `%s`: %s", path, dlerror());
    free(full);
    return false;
  }
  pl_kernel_entry entry;
  *(void **)&entry = dlsym(handle, PL_KERNEL_ENTRY);
  const pl_law *law = entry ? entry() : NULL;
  if (!check_law(law, path, key_or_null, error, size)) {
    dlclose(handle);
    free(full);
    return false;
  }
  *out = (loaded_kernel){.law = law, .handle = handle, .path = full};
  return true;
}

bool toolchain_load(const char *c_text, const char *key, loaded_kernel *out, char *error,
                    size_t size) {
  char object[LONGEST_PATH], source[LONGEST_PATH];
  if (!toolchain_runs_here(error, size)) return false;
  const char *cache = toolchain_cache();
  snprintf(object, sizeof object, "%s/%s.so", cache, key);
  snprintf(source, sizeof source, "%s/%s.c", cache, key);
  if (cache_is_sealed(object) && toolchain_open(object, key, out, error, size)) {
    out->from_cache = true;
    return true;
  }
  *out = (loaded_kernel){0};
  cache_clear_remains(cache);
  if (!cache_put(source, c_text)) {
    snprintf(error, size, "cannot write `%s`: %s", source, strerror(errno));
    return false;
  }
  const compilation c = of_kernel(source, c_text);
  return compile_to(c, object, true, error, size) && toolchain_open(object, key, out, error, size);
}

void toolchain_unload(loaded_kernel *k) {
  if (k->handle) dlclose(k->handle);
  free(k->path);
  *k = (loaded_kernel){0};
}
