/* A file that appears whole or not at all: it is written under a working name beside its place and renamed at the end. A link
   stays a link; what is no ordinary file, as /dev/stdout, is written to directly. */
#ifndef PERILAT_RUNTIME_WHOLE_FILE_H
#define PERILAT_RUNTIME_WHOLE_FILE_H

#include <stdbool.h>

enum { WHOLE_FILE_PATH = 4096 };

typedef struct whole_file {
  char target[WHOLE_FILE_PATH], working[WHOLE_FILE_PATH + 8]; /* the caller writes to `working` */
} whole_file;

/* False, with errno, when the path is too long or names a file that is protected against writing. */
bool whole_file_begin(whole_file *f, const char *path);
/* Puts the file, which is closed, in its place when it is `good`; else, or when that fails, removes it and keeps errno. */
bool whole_file_end(const whole_file *f, bool good);

#endif
