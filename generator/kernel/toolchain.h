/* From C text to a loaded kernel: the C compiler, the cache, dlopen and its checks. */
#ifndef PERILAT_GENERATOR_TOOLCHAIN_H
#define PERILAT_GENERATOR_TOOLCHAIN_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"
#include "runtime/kernel.h"

C_LINKAGE_BEGIN

typedef struct loaded_kernel {
  const pl_law *law;
  void *handle; /* dlopen */
  char *path;   /* of the shared object */
  bool from_cache;
} loaded_kernel;

/* The C compiler in use: $PERILAT_CC, $CC, or the first of cc, gcc, clang on the path; NULL when there is none, also when
   $PERILAT_CC names one that is not there or $PERILAT_PROCESSOR no processor. May carry options ("cc -g"). */
const char *toolchain_compiler(void);
/* A sentence that says why there is none. */
const char *toolchain_no_compiler(void);
/* Flags of every kernel: -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off ... and -march=$PERILAT_PROCESSOR, otherwise
   this one. */
const char *toolchain_flags(void);
/* What the compiler says it is, "gcc (Debian 12.2.0-14) 12.2.0"; "" when it does not answer. */
void toolchain_version(char *version, size_t size);
/* Folder of the cache: $PERILAT_CACHE, else $XDG_CACHE_HOME/perilat, else ~/.cache/perilat, else a
   private folder in $TMPDIR. Created; never fails (an unwritable one gives that private folder,
   too). */
const char *toolchain_cache(void);
/* A sentence that says why the cache is not where it was to be; NULL where it is. */
const char *toolchain_cache_trouble(void);

/* Hash (hex, malloc'ed) of everything that decides a kernel: text, compiler and its version, flags, processor, ABI. */
char *toolchain_key(const char *text);

/* Compiles `c_text` (unless the cache has it), loads it and checks ABI and key. On failure false and a message
   in `error`; that of a compile failure names the kept source. Kernels for instructions that are not here are not made. */
bool toolchain_load(const char *c_text, const char *key, loaded_kernel *out, char *error,
                    size_t size);
/* Writes the shared object to `path` instead of the cache. */
bool toolchain_build(const char *c_text, const char *path, char *error, size_t size);
/* A program from a C text with a main(), linked with perilat's own libraries: a stand-alone solver. */
bool toolchain_build_program(const char *c_text, const char *path, char *error, size_t size);
/* Loads an existing shared kernel. */
bool toolchain_open(const char *path, const char *key_or_null, loaded_kernel *out, char *error,
                    size_t size);
void toolchain_unload(loaded_kernel *k);

C_LINKAGE_END

#endif
