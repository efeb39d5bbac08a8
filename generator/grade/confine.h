/* What a process that reads a stranger's file may do: little. */
#ifndef PERILAT_GENERATOR_CONFINE_H
#define PERILAT_GENERATOR_CONFINE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct confinement {
  double seconds; /* of processor time */
  size_t memory;  /* B, of addresses */
  size_t file;    /* B, the longest file that it writes */
} confinement;

/* For the rest of this process: works in `folder`, which is the only one in which it can make or
   change files (where the kernel knows Landlock); starts no process, opens no socket, looks at no
   other process (where it knows seccomp); ends when it takes more than it may. Its standard input
   is empty, what it prints goes nowhere. False where the folder cannot be entered. */
bool confine(const char *folder, const confinement *to);

#endif
