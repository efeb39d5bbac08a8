/* Opens what must be an ordinary file and looks what it is before anything is read: a pipe is
   refused, not waited for. */
#ifndef PERILAT_RUNTIME_ORDINARY_FILE_H
#define PERILAT_RUNTIME_ORDINARY_FILE_H

/* `flags` as of open. With O_NOFOLLOW a link is refused, a symbolic one and another name of the
   same file: for files that are written in their place. -1, and in `why` what stands in the way,
   without the path. */
int ordinary_file_open(const char *path, int flags, const char **why);

#endif
