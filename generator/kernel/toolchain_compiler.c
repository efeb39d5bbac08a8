#include "generator/kernel/toolchain_compiler.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/toolchain_process.h"

#define LONGEST_PATH PATH_MAX

const char *toolchain_setting(const char *name) {
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
  const char *name = toolchain_setting("PERILAT_PROCESSOR");
  for (size_t k = 0; k < sizeof processors / sizeof *processors; k++)
    if (strcmp(name ? name : "native", processors[k].name) == 0) return &processors[k];
  return NULL;
}

/* --- the compiler ----------------------------------------------------------------------------- */

const char *toolchain_compiler(void) {
  static const char *const usual[] = {"cc", "gcc", "clang"};
  char path[LONGEST_PATH];
  const char *chosen = toolchain_setting("PERILAT_CC");
  if (!chosen_processor()) return NULL;
  if (chosen) /* who names a compiler gets that one or none */
    return process_find(chosen, path, sizeof path) ? chosen : NULL;
  chosen = toolchain_setting("CC");
  if (chosen && process_find(chosen, path, sizeof path)) return chosen;
  for (size_t k = 0; k < sizeof usual / sizeof *usual; k++)
    if (process_find(usual[k], path, sizeof path)) return usual[k];
  return NULL;
}

const char *toolchain_no_compiler(void) {
  static _Thread_local char text[200]; /* the answer, until the thread's next call */
  const char *chosen = toolchain_setting("PERILAT_CC");
  if (!chosen_processor()) {
    snprintf(text, sizeof text, "PERILAT_PROCESSOR is `%.40s`, which is none of%s",
             toolchain_setting("PERILAT_PROCESSOR"), processor_names);
    return text;
  }
  if (!chosen) return "no C compiler was found (install gcc or clang, or set PERILAT_CC)";
  snprintf(text, sizeof text, "PERILAT_CC names the C compiler `%.100s`, which was not found",
           chosen);
  return text;
}

void toolchain_processor(char *text, size_t size) {
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

bool toolchain_runs_here(char *error, size_t size) {
  char here[8192];
  const processor *p = chosen_processor();
  toolchain_processor(here, sizeof here);
  if (!p || strstr(here, p->needs)) return true;
  snprintf(error, size, "PERILAT_PROCESSOR is %s, whose instructions this processor does not have",
           p->name);
  return false;
}

/* Speculation of divisions and square roots needs -fno-trapping-math and -fno-math-errno; the
   interpreter's bits need -ffp-contract=off. gcc does not know newer processors by name and then
   orders instructions for none in particular; told to order them for one with vectors of 512 bits
   it gains 5 % on Intel's processors and 3 to 8 % on AMD's. Combining more than two instructions
   takes gcc a third of its time on these loops and gains nothing. */
#define COMMON_FLAGS                                                                               \
  "-std=gnu11 -O3 -march=%s -fno-math-errno -fno-trapping-math -ffp-contract=off "                 \
  "--param max-combine-insns=2 -fPIC -shared"

const char *toolchain_flags(void) {
  static _Thread_local char flags[400]; /* the answer, until the thread's next call */
  char here[8192];
  const processor *p = chosen_processor();
  toolchain_processor(here, sizeof here);
  const bool wide = p == processors && strstr(here, " avx512f");
  snprintf(flags, sizeof flags, COMMON_FLAGS "%s%s", p ? p->name : processors->name,
           wide ? " -mprefer-vector-width=512" : "", wide ? " -mtune=icelake-server" : "");
  return flags;
}
