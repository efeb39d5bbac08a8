/* Programs that are started without a shell. */
#ifndef PERILAT_GENERATOR_TOOLCHAIN_PROCESS_H
#define PERILAT_GENERATOR_TOOLCHAIN_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { MOST_ARGUMENTS = 128 };

typedef struct arguments {
  char *words[MOST_ARGUMENTS + 1]; /* malloc'ed */
  int count;
  bool too_many; /* nothing is started */
} arguments;

void arguments_add(arguments *a, const char *word);
/* All words of `text`, but not `less`. */
void arguments_add_words(arguments *a, const char *text, const char *less);
void arguments_free(arguments *a);

/* Starts a program; both its outputs are added to `log`. 0 when it cannot be started. */
pid_t process_start(arguments *a, const char *log);
/* Exit status of a child; 127 when it could not be started; 128 + signal. */
int process_finish(pid_t child);

/* Where the first word of `command` is, as a shell would find it. */
bool process_find(const char *command, char *path, size_t size) __attribute__((nonnull));

#endif
