#include "generator/kernel/toolchain.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/sha256.h"
#include "generator/target/kernel_parts.h"

extern char **environ;

#define LONGEST_PATH   PATH_MAX
#define MOST_ARGUMENTS 128

/* --- programs and settings -------------------------------------------------------------------- */

static bool is_program(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISREG(about.st_mode) && access(path, X_OK) == 0;
}

/* Where the first word of `command` is, as a shell would find it. */
static bool find_program(const char *command, char *path, size_t size) {
  size_t length = strcspn(command, " \t");
  if (memchr(command, '/', length)) {
    snprintf(path, size, "%.*s", (int)length, command);
    return length && is_program(path);
  }
  const char *folders = getenv("PATH");
  while (length && folders && *folders) {
    size_t n = strcspn(folders, ":");
    snprintf(path, size, "%.*s/%.*s", (int)n, folders, (int)length, command);
    if (n && is_program(path)) return true;
    folders += n + (folders[n] == ':');
  }
  return false;
}

static const char *setting(const char *name) {
  const char *value = getenv(name);
  while (value && (*value == ' ' || *value == '\t'))
    value++;
  return value && *value ? value : NULL;
}

/* --- the processor ---------------------------------------------------------------------------- */

/* X(what kernels may be compiled for, its last instruction set as /proc/cpuinfo has it) */
#if defined(__x86_64__)
#define PROCESSORS(X)                                                                              \
  X("native", "")                                                                                  \
  X("x86-64", "")                                                                                  \
  X("x86-64-v2", " sse4_2")                                                                        \
  X("x86-64-v3", " avx2")                                                                          \
  X("x86-64-v4", " avx512vl")
#else
#define PROCESSORS(X) X("native", "")
#endif

typedef struct processor {
  const char *name, *needs;
} processor;

static const processor processors[] = {
#define X(name, needs) {name, needs},
    PROCESSORS(X)
#undef X
};

static const char processor_names[] =
#define X(name, needs) " " name
    PROCESSORS(X);
#undef X

/* That of PERILAT_PROCESSOR, otherwise native; NULL when there is none of that name. */
static const processor *chosen_processor(void) {
  const char *name = setting("PERILAT_PROCESSOR");
  for (size_t k = 0; k < sizeof processors / sizeof *processors; k++)
    if (strcmp(name ? name : "native", processors[k].name) == 0) return &processors[k];
  return NULL;
}

/* --- the compiler ----------------------------------------------------------------------------- */

const char *toolchain_compiler(void) {
  static const char *const usual[] = {"cc", "gcc", "clang"};
  char path[LONGEST_PATH];
  const char *chosen = setting("PERILAT_CC");
  if (!chosen_processor()) return NULL;
  if (chosen) /* who names a compiler gets that one or none */
    return find_program(chosen, path, sizeof path) ? chosen : NULL;
  chosen = setting("CC");
  if (chosen && find_program(chosen, path, sizeof path)) return chosen;
  for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
    if (find_program(usual[k], path, sizeof path)) return usual[k];
  return NULL;
}

const char *toolchain_no_compiler(void) {
  static _Thread_local char text[200]; /* the answer, until the thread's next call */
  const char *chosen = setting("PERILAT_CC");
  if (!chosen_processor()) {
    snprintf(text, sizeof text, "PERILAT_PROCESSOR is `%.40s`, which is none of%s",
             setting("PERILAT_PROCESSOR"), processor_names);
    return text;
  }
  if (!chosen) return "no C compiler was found (install gcc or clang, or set PERILAT_CC)";
  snprintf(text, sizeof text, "PERILAT_CC names the C compiler `%.100s`, which was not found",
           chosen);
  return text;
}

/* Lines of /proc/cpuinfo about one processor: model and instruction sets. Empty where there is
 * none. */
static void read_processor(char *text, size_t size) {
  char line[4096];
  *text = 0;
  FILE *in = fopen("/proc/cpuinfo", "r");
  while (in && fgets(line, sizeof line, in) && *line != '\n') {
    bool wanted = strncmp(line, "model name", 10) == 0 || strncmp(line, "flags", 5) == 0 ||
                  strncmp(line, "Features", 8) == 0 || strncmp(line, "vendor_id", 9) == 0 ||
                  strncmp(line, "CPU", 3) == 0;
    size_t used = strlen(text);
    if (wanted) snprintf(text + used, size - used, "%s", line);
  }
  if (in) fclose(in);
}

/* False with a sentence where kernels are compiled for instructions that are not here. */
static bool runs_here(char *error, size_t size) {
  char here[8192];
  const processor *p = chosen_processor();
  read_processor(here, sizeof here);
  if (!p || strstr(here, p->needs)) return true;
  snprintf(error, size, "PERILAT_PROCESSOR is %s, whose instructions this processor does not have",
           p->name);
  return false;
}

/* Speculation of divisions and square roots needs -fno-trapping-math and -fno-math-errno; the
   interpreter's bits need -ffp-contract=off. gcc does not know newer processors of Intel's by name and then orders
   instructions for none in particular; told to order them for an older one of the same build it gains 5 %. Combining more than two instructions takes gcc a third
   of its time on these loops and gains nothing. */
#define COMMON_FLAGS                                                                               \
  "-std=gnu11 -O3 -march=%s -fno-math-errno -fno-trapping-math -ffp-contract=off "                 \
  "--param max-combine-insns=2 -fPIC -shared"

const char *toolchain_flags(void) {
  static _Thread_local char flags[400]; /* the answer, until the thread's next call */
  char here[8192];
  const processor *p = chosen_processor();
  read_processor(here, sizeof here);
  const bool wide = p == processors && strstr(here, " avx512f");
  snprintf(flags, sizeof flags, COMMON_FLAGS "%s%s", p ? p->name : processors->name,
           wide ? " -mprefer-vector-width=512" : "",
           wide && strstr(here, "GenuineIntel") ? " -mtune=icelake-server" : "");
  return flags;
}

/* --- running it ------------------------------------------------------------------------------- */

typedef struct arguments {
  char *words[MOST_ARGUMENTS + 1]; /* malloc'ed */
  int count;
  bool too_many; /* nothing is started */
} arguments;

static void add_word(arguments *a, const char *word) {
  if (a->count < MOST_ARGUMENTS)
    a->words[a->count++] = must_copy(word);
  else
    a->too_many = true;
}

/* All words of `text`, but not `less`. */
static void add_words(arguments *a, const char *text, const char *less) {
  char *copy = must_copy(text);
  for (char *rest, *word = strtok_r(copy, " \t", &rest); word; word = strtok_r(NULL, " \t", &rest))
    if (strcmp(word, less) != 0) add_word(a, word);
  free(copy);
}

static void free_arguments(arguments *a) {
  while (a->count > 0)
    free(a->words[--a->count]);
}

/* Starts a program without a shell; both its outputs are added to `log`. 0 when it cannot be started. */
static pid_t start(arguments *a, const char *log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  a->words[a->count] = NULL;
  pid_t child;
  const bool failed =
      a->too_many || posix_spawnp(&child, a->words[0], &actions, NULL, a->words, environ) != 0;
  posix_spawn_file_actions_destroy(&actions);
  return failed ? 0 : child;
}

/* Exit status of a child; 127 when it could not be started; 128 + signal. */
static int finish(pid_t child) {
  int status;
  if (child == 0) return 127;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 127;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* First `size - 1` bytes of a file; empty when it cannot be read. */
static void read_head(const char *path, char *text, size_t size) {
  FILE *in = fopen(path, "rb");
  size_t n = in ? fread(text, 1, size - 1, in) : 0;
  text[n] = 0;
  if (in) fclose(in);
}

/* --- folders and files ------------------------------------------------------------------------ */

static bool is_usable_folder(const char *path) {
  struct stat about;
  if (stat(path, &about) != 0) return false;
  errno = ENOTDIR;
  return S_ISDIR(about.st_mode) && access(path, W_OK | X_OK) == 0;
}

/* Makes the folder and those above it; where that fails, errno says why. */
static bool make_folder(const char *path) {
  char part[LONGEST_PATH];
  if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part - 1) {
    errno = ENAMETOOLONG;
    return false;
  }
  for (char *c = part + 1; *c; c++) {
    if (*c != '/') continue;
    *c = 0;
    mkdir(part, 0777);
    *c = '/';
  }
  const int refused = mkdir(part, 0700) == 0 ? 0 : errno;
  if (is_usable_folder(path)) return true;
  if (refused && refused != EEXIST) errno = refused;
  return false;
}

/* A folder that only this user can write to: somebody else's files there would be loaded as
 * programs. */
static bool make_private_folder(const char *path) {
  struct stat about;
  mkdir(path, 0700);
  return lstat(path, &about) == 0 && S_ISDIR(about.st_mode) && about.st_uid == geteuid() &&
         (about.st_mode & 077) == 0 && is_usable_folder(path);
}

static void use_temporary_folder(char *path, size_t size) {
  const char *parent = setting("TMPDIR");
  if (!parent || !is_usable_folder(parent)) parent = "/tmp";
  for (int k = 0; k < 100; k++) {
    snprintf(path, size, "%s/perilat-%ld-%d", parent, (long)geteuid(), k);
    if (make_private_folder(path)) return;
  }
  snprintf(path, size, "/dev/null"); /* holds nothing: what is written there fails with a message */
}

/* Where the settings want the cache; empty where they do not say. */
static void wanted_cache(char *path, size_t size) {
  const char *given = setting("PERILAT_CACHE"), *xdg = setting("XDG_CACHE_HOME"),
             *home = setting("HOME");
  *path = 0;
  if (given)
    snprintf(path, size, "%s", given);
  else if (xdg)
    snprintf(path, size, "%s/perilat", xdg);
  else if (home)
    snprintf(path, size, "%s/.cache/perilat", home);
}

const char *toolchain_cache(void) {
  static _Thread_local char path[LONGEST_PATH]; /* the answer, until the thread's next call */
  wanted_cache(path, sizeof path);
  if (!*path || !make_folder(path)) use_temporary_folder(path, sizeof path);
  return path;
}

const char *toolchain_cache_trouble(void) {
  static _Thread_local char text[3 * LONGEST_PATH]; /* as above */
  char wanted[LONGEST_PATH];
  wanted_cache(wanted, sizeof wanted);
  if (!*wanted || make_folder(wanted)) return NULL;
  const char *why = strerror(errno);
  snprintf(text, sizeof text,
           "the cache `%s` cannot be written to (%s): compiled kernels are kept in `%s`", wanted,
           why, toolchain_cache());
  return text;
}

/* An empty file of a name of its own beside `path`; the same folder, so that it can be renamed. */
static bool make_temporary(const char *path, const char *ending, char *temporary, size_t size) {
  int length = snprintf(temporary, size, "%s.XXXXXX%s", path, ending);
  if (length < 0 || (size_t)length >= size) return false;
  int file = mkstemps(temporary, (int)strlen(ending));
  return file >= 0 && close(file) == 0;
}

static bool write_file(const char *path, const char *mode, const void *data, size_t size) {
  FILE *out = fopen(path, mode);
  if (!out) return false;
  bool done = fwrite(data, 1, size, out) == size;
  return fclose(out) == 0 && done;
}

/* Whole or not at all, also for a second run that writes the same file. */
static bool put_file(const char *path, const char *text) {
  char temporary[LONGEST_PATH];
  if (!make_temporary(path, ".tmp", temporary, sizeof temporary)) return false;
  if (write_file(temporary, "wb", text, strlen(text)) && rename(temporary, path) == 0) return true;
  unlink(temporary);
  return false;
}

/* A file that a compilation makes beside KEY.so or KEY.c and takes away at its end: KEY.so.XXXXXX.tmp and the like. */
static bool is_passing(const char *name) {
  const size_t key = strspn(name, "0123456789abcdef");
  return key == 2 * SHA256_SIZE && name[key] == '.' && strchr(name + key + 1, '.');
}

/* Takes away what compilations that were killed have left in the cache; none takes a day. */
static void clear_remains(const char *folder) {
  enum { DAY = 24 * 60 * 60 };
  const time_t now = time(NULL);
  DIR *all = opendir(folder);
  for (const struct dirent *e; all && (e = readdir(all));) {
    char path[LONGEST_PATH];
    struct stat about;
    if (!is_passing(e->d_name) ||
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name) >= (int)sizeof path)
      continue;
    if (lstat(path, &about) == 0 && S_ISREG(about.st_mode) && now - about.st_mtime > DAY)
      unlink(path);
  }
  if (all) closedir(all);
}

/* --- the seal: a digest behind the end of a cached object, where the loader does not look ----- */

static const char seal_mark[8] = "PERILAT";
#define SEAL_SIZE (sizeof seal_mark + SHA256_SIZE)

static void digest_of(const void *data, size_t size, unsigned char digest[SHA256_SIZE]) {
  sha256 h;
  sha256_begin(&h);
  sha256_add(&h, data, size);
  sha256_end(&h, digest);
}

/* Whole file (malloc'ed), or NULL. */
static unsigned char *read_file(const char *path, size_t *size) {
  FILE *in = fopen(path, "rb");
  struct stat about;
  if (!in || fstat(fileno(in), &about) != 0 || !S_ISREG(about.st_mode)) {
    if (in) fclose(in);
    return NULL;
  }
  unsigned char *data = must_alloc((size_t)about.st_size + 1);
  *size = fread(data, 1, (size_t)about.st_size, in);
  fclose(in);
  return data;
}

static bool seal(const char *path) {
  size_t size;
  unsigned char *data = read_file(path, &size), end[SEAL_SIZE];
  if (!data) return false;
  memcpy(end, seal_mark, sizeof seal_mark);
  digest_of(data, size, end + sizeof seal_mark);
  free(data);
  return write_file(path, "ab", end, sizeof end);
}

/* A cut or altered object would end the program when it is loaded or, worse, run. */
static bool is_sealed(const char *path) {
  size_t size;
  unsigned char *data = read_file(path, &size), digest[SHA256_SIZE];
  bool sound = false;
  if (data && size > SEAL_SIZE) {
    const unsigned char *end = data + size - SEAL_SIZE;
    digest_of(data, size - SEAL_SIZE, digest);
    sound = memcmp(end, seal_mark, sizeof seal_mark) == 0 &&
            memcmp(end + sizeof seal_mark, digest, sizeof digest) == 0;
  }
  free(data);
  return sound;
}

/* --- key -------------------------------------------------------------------------------------- */

/* First line of `compiler --version`; empty when it does not answer. */
static void read_version(const char *compiler, char *version, size_t size) {
  char log[LONGEST_PATH], base[LONGEST_PATH - 16];
  *version = 0;
  snprintf(base, sizeof base, "%s/version", toolchain_cache());
  if (!make_temporary(base, ".log", log, sizeof log)) return;
  arguments a = {0};
  add_words(&a, compiler, "");
  add_word(&a, "--version");
  if (finish(start(&a, log)) == 0) read_head(log, version, size);
  version[strcspn(version, "\n")] = 0;
  free_arguments(&a);
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
  if (compiler) find_program(compiler, path, sizeof path);
  toolchain_version(version, sizeof version);
  read_processor(here, sizeof here);
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
  bool in_parts;
  const char *log; /* what the compiler says is added to */
} compilation;

/* The compiler with flags, but not `less`, and where to write. */
static arguments command(const char *output, const char *less) {
  arguments a = {0};
  add_words(&a, toolchain_compiler(), "");
  add_words(&a, toolchain_flags(), less);
  add_word(&a, "-o");
  add_word(&a, output); /* whole, blanks and all */
  return a;
}

static int run_and_free(arguments *a, const char *log) {
  add_word(a, "-lm"); /* fma, where the processor has none */
  const int status = finish(start(a, log));
  free_arguments(a);
  return status;
}

static int compile_whole(const compilation *c, const char *object) {
  arguments a = command(object, c->libraries ? "-shared" : "");
  add_word(&a, c->source);
  if (c->libraries) {
    add_word(&a, c->libraries);
    add_words(&a, SOLVER_LIBRARIES, "");
  }
  return run_and_free(&a, c->log);
}

static void name_part(char part[LONGEST_PATH], const char *object, int number) {
  snprintf(part, LONGEST_PATH, "%.*s.%d.o", LONGEST_PATH - 16, object, number);
}

/* Parts at the same time, then linked. */
static int compile_parts(const compilation *c, const char *object) {
  char part[LONGEST_PATH], macro[32];
  pid_t children[KERNEL_PARTS];
  arguments link = command(object, "");
  int status = 0;
  for (int k = 0; k < KERNEL_PARTS; k++) {
    name_part(part, object, k);
    add_word(&link, part);
    arguments a = command(part, "-shared");
    snprintf(macro, sizeof macro, "-DPL_PART=%d", k);
    add_word(&a, macro);
    add_word(&a, "-c");
    add_word(&a, c->source);
    children[k] = start(&a, c->log);
    free_arguments(&a);
  }
  for (int k = 0; k < KERNEL_PARTS; k++) {
    const int of_part = finish(children[k]);
    status = status ? status : of_part;
  }
  if (!status)
    status = run_and_free(&link, c->log);
  else
    free_arguments(&link);
  for (int k = 0; k < KERNEL_PARTS; k++) {
    name_part(part, object, k);
    unlink(part);
  }
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
  if (!make_temporary(path, ".tmp", object, sizeof object)) {
    snprintf(error, size, "cannot write beside `%s`: %s", path, strerror(errno));
    return false;
  }
  if (!make_temporary(c.source, ".log", log, sizeof log)) {
    snprintf(error, size, "cannot write beside `%s`: %s", c.source, strerror(errno));
    unlink(object);
    return false;
  }
  c.log = log;
  const int status = c.in_parts ? compile_parts(&c, object) : compile_whole(&c, object);
  if (status) explain_failure(status, c.source, log, error, size);
  unlink(log);
  bool done =
      !status && (!sealed || seal(object)) && chmod(object, 0755) == 0 && rename(object, path) == 0;
  if (!status && !done) snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  if (!done) unlink(object);
  return done;
}

static bool has_parts(const char *c_text) {
  return strstr(c_text, "PL_PART") != NULL;
}

static bool build(const char *c_text, const char *libraries, const char *path, char *error,
                  size_t size) {
  char source[LONGEST_PATH], base[LONGEST_PATH - 16];
  snprintf(base, sizeof base, "%s/build", toolchain_cache());
  if (!make_temporary(base, ".c", source, sizeof source) ||
      !write_file(source, "wb", c_text, strlen(c_text))) {
    snprintf(error, size, "cannot write a file in `%s`: %s", toolchain_cache(), strerror(errno));
    return false;
  }
  const compilation c = {
      .source = source, .libraries = libraries, .in_parts = !libraries && has_parts(c_text)};
  bool done = compile_to(c, path, false, error, size);
  if (done) unlink(source);
  return done;
}

bool toolchain_build(const char *c_text, const char *path, char *error, size_t size) {
  return build(c_text, NULL, path, error, size);
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

bool toolchain_build_program(const char *c_text, const char *path, char *error, size_t size) {
  char folder[LONGEST_PATH];
  if (!find_libraries(folder, sizeof folder)) {
    snprintf(error, size,
             "a solver is linked with libperilat_runtime.a, which is not beside this program");
    return false;
  }
  return build(c_text, folder, path, error, size);
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
  if (!runs_here(error, size)) return false;
  const char *cache = toolchain_cache();
  snprintf(object, sizeof object, "%s/%s.so", cache, key);
  snprintf(source, sizeof source, "%s/%s.c", cache, key);
  if (is_sealed(object) && toolchain_open(object, key, out, error, size)) {
    out->from_cache = true;
    return true;
  }
  *out = (loaded_kernel){0};
  clear_remains(cache);
  if (!put_file(source, c_text)) {
    snprintf(error, size, "cannot write `%s`: %s", source, strerror(errno));
    return false;
  }
  const compilation c = {.source = source, .in_parts = has_parts(c_text)};
  return compile_to(c, object, true, error, size) && toolchain_open(object, key, out, error, size);
}

void toolchain_unload(loaded_kernel *k) {
  if (k->handle) dlclose(k->handle);
  free(k->path);
  *k = (loaded_kernel){0};
}
