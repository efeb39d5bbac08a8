/* Files that a text of somebody else may name. Once confined to a folder, the process opens by
   those names nothing outside of it, links followed, but what stands in folders for reading. */
#ifndef PERILAT_RUNTIME_CONFINED_H
#define PERILAT_RUNTIME_CONFINED_H

#include <stdbool.h>

/* For the rest of the process: reading in `folder` and in those of readable[count], which need not
   be there; writing in `folder` alone. False, and nothing may be read, when `folder` is none. */
bool files_confine(const char *folder, const char *const *readable, int count);
/* A confined process reads everything but this file, which need not be there. */
void file_never_read(const char *path);
bool files_are_confined(void);
/* True when the process is not confined, or the file lies where it may. */
bool file_may_be_read(const char *path);
/* The same of a file that need not be there yet. */
bool file_may_be_written(const char *path);

#endif
