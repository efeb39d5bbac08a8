/* A file that appears whole or not at all: it is written under a working name of its own beside its
   place and renamed at the end. A link stays a link; what is no ordinary file, as /dev/stdout, is
   written to directly. */
#ifndef PERILAT_RUNTIME_WHOLE_FILE_H
#define PERILAT_RUNTIME_WHOLE_FILE_H

#include <stdbool.h>
#include <stdio.h>

enum { WHOLE_FILE_PATH = 4096 };

typedef struct whole_file {
  char target[WHOLE_FILE_PATH], working[WHOLE_FILE_PATH + 64]; /* the caller writes to `working` */
} whole_file;

/* Makes the working file, which no other program has. False, with errno, when there is no room for
   it or the path names a file that is protected against writing. */
bool whole_file_begin(whole_file *f, const char *path);
/* The same, and the working file is open for writing; NULL with errno, and nothing left. */
FILE *whole_file_open(whole_file *f, const char *path);
/* Puts the file, which is closed, in its place when it is `good`; else, or when that fails, removes
   it and keeps errno. */
bool whole_file_end(const whole_file *f, bool good);
/* The same, and the file stands on the disk then. */
bool whole_file_end_on_disk(const whole_file *f, bool good);
/* Removes the working files of `path` that killed programs have left. For who knows that no other
   program writes it. */
void whole_file_clear(const char *path);

#endif
