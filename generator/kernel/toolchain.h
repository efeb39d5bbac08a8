/* From C text to a loaded kernel: its key, compiling, dlopen and its checks. */
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

/* What the compiler says it is, "gcc (Debian 12.2.0-14) 12.2.0"; "" when it does not answer. */
void toolchain_version(char *version, size_t size);
/* Hash (hex, malloc'ed) of everything that decides a kernel: text, compiler and its version,
   flags, processor, ABI. */
char *toolchain_key(const char *text);

/* Compiles `c_text` (unless the cache has it), loads it and checks ABI and key. On failure false
   and a message in `error`; that of a compile failure names the kept source. Kernels for
   instructions that are not here are not made. */
bool toolchain_load(const char *c_text, const char *key, loaded_kernel *out, char *error,
                    size_t size);
/* Writes the shared object to `path` instead of the cache. */
bool toolchain_build(const char *c_text, const char *path, char *error, size_t size);
/* A program from a C text with a main(), linked with perilat's own libraries: a stand-alone
   solver. The text is compiled `parts` times, with PL_SOLVER_PART defined as 0, 1, ...; a main()
   and each kernel are parts, as the names inside of kernels are alike. */
bool toolchain_build_program(const char *c_text, int parts, const char *path, char *error,
                             size_t size);
/* Loads an existing shared kernel. */
bool toolchain_open(const char *path, const char *key_or_null, loaded_kernel *out, char *error,
                    size_t size);
void toolchain_unload(loaded_kernel *k);

C_LINKAGE_END

#endif
