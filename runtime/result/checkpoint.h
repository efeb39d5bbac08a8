/* A checkpoint: named blocks of memory in one file that is either whole or not there
   (whole_file.h), forced to the disk; the last eight bytes are a checksum of all before. Bytes are
   those of this kind of machine: a checkpoint is for going on, not for keeping. */
#ifndef PERILAT_RUNTIME_CHECKPOINT_H
#define PERILAT_RUNTIME_CHECKPOINT_H

#include <stdbool.h>
#include <stddef.h>

#define CHECKPOINT_ENDING ".checkpoint" /* behind the path of the run's result */

typedef struct checkpoint_part {
  const char *name; /* for messages */
  void *data;
  size_t bytes;
} checkpoint_part;

/* `fingerprint` says what the state belongs to (deck, laws, kernel); a file with another one is
   refused. True once the new file stands whole under its name (its folder is then forced to the
   disk where that is possible). False with a sentence in `error` when it cannot be written; an
   older file of that name then stays as it was. */
bool checkpoint_write(const char *path, const char *fingerprint, const checkpoint_part *parts,
                      int count, char *error, size_t size);

/* Reads the parts back. They are touched only when the file is whole, of this fingerprint, and
   every part has its size. */
bool checkpoint_read(const char *path, const char *fingerprint, const checkpoint_part *parts,
                     int count, char *error, size_t size);

/* The fingerprint of a checkpoint (malloc'ed); NULL where the file is none. */
char *checkpoint_fingerprint(const char *path);

/* The first `bytes` of part 0 alone, after the same checks of the file (not of the other parts):
   what the sizes of the others depend on. */
bool checkpoint_peek(const char *path, const char *fingerprint, void *data, size_t bytes,
                     char *error, size_t size);

#endif
