/* The frames of a run that is going on: RESULT.frames, a record of numbers each, which survives a
   kill. The run that writes it holds its lock. What a checkpoint counts on is told by a mark: how
   many frames, and the sum of all that stands before their end (hash.h). */
#ifndef PERILAT_RUNTIME_FRAME_FILE_H
#define PERILAT_RUNTIME_FRAME_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

#define FRAMES_ENDING ".frames" /* behind the path of the run's result */

typedef struct frame_mark {
  int64_t count;
  uint64_t sum;
} frame_mark;

typedef struct frame_file frame_file;

/* Opens and locks RESULT.frames, and changes nothing in it; without `there` it is made when it is
   not there. A frame has `numbers`, `fingerprint` says what run it belongs to. NULL with a sentence
   in `error` (size bytes). */
frame_file *frame_file_open(const char *result, const char *fingerprint, size_t numbers, bool there,
                            char *error, size_t size);
/* Either comes next: no frames, or those that the mark tells of. These must be there, of the same
   run, with every bit as it was, or else the file stays as it is; what follows them goes. False
   with a sentence. */
bool frame_file_begin(frame_file *f, char *error, size_t size);
bool frame_file_resume(frame_file *f, const frame_mark *mark, char *error, size_t size);

/* Where the numbers of the next frame go, and their end as a frame. False when it cannot be written
   (disk full); the frames before it stay. */
double *frame_file_record(frame_file *f);
bool frame_file_add(frame_file *f, char *error, size_t size);
frame_mark frame_file_mark(const frame_file *f);
/* Forces the frames to the disk (before a checkpoint that counts on them). */
bool frame_file_sync(frame_file *f, char *error, size_t size);

/* All frames, one after the other (`take` may be NULL). False with a sentence when one cannot be
   read, `take` says so (no sentence), or they are not those that were added. */
typedef bool frame_taker(void *context, int64_t frame, const double *record);
bool frame_file_each(frame_file *f, frame_taker *take, void *context, char *error, size_t size);

void frame_file_remove(frame_file *f); /* from the folder */
void frame_file_close(frame_file *f);

C_LINKAGE_END

#endif
