/* The folder of compiled kernels, and the files in it: each stands whole or not at all, an
   object with a seal, a digest behind its end, where the loader does not look. */
#ifndef PERILAT_GENERATOR_TOOLCHAIN_CACHE_H
#define PERILAT_GENERATOR_TOOLCHAIN_CACHE_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

/* Folder of the cache: $PERILAT_CACHE, else $XDG_CACHE_HOME/perilat, else ~/.cache/perilat, else a
   private folder in $TMPDIR. Created; never fails (an unwritable one gives that private folder,
   too). */
const char *toolchain_cache(void);
/* A sentence that says why the cache is not where it was to be; NULL where it is. */
const char *toolchain_cache_trouble(void);

/* An empty file of a name of its own beside `path`; the same folder, so that it can be renamed. */
bool cache_temporary(const char *path, const char *ending, char *temporary, size_t size);
/* By fopen's mode; false where not all was written. */
bool cache_write(const char *path, const char *mode, const void *data, size_t size);
/* Whole or not at all, also for a second run that writes the same file. */
bool cache_put(const char *path, const char *text);
/* Takes away what compilations that were killed have left in the cache; none takes a day. */
void cache_clear_remains(const char *folder);

bool cache_seal(const char *path);
/* A cut or altered object would end the program when it is loaded or, worse, run. */
bool cache_is_sealed(const char *path);

C_LINKAGE_END

#endif
