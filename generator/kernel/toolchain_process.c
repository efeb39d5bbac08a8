#include "generator/kernel/toolchain_process.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dsl/base/arena.h"

extern char **environ;

static bool is_program(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 && S_ISREG(about.st_mode) && access(path, X_OK) == 0;
}

bool process_find(const char *command, char *path, size_t size) {
  size_t length = strcspn(command, " \t");
  if (memchr(command, '/', length)) {
    snprintf(path, size, "%.*s", (int)length, command);
    return length && is_program(path);
  }
  const char *folders = getenv("PATH");
  while (length && folders && *folders) {
    size_t n = strcspn(folders, ":");
    snprintf(path, size, "%.*s/%.*s", (int)n, folders, (int)length, command);
    if (n && is_program(path)) return true;
    folders += n + (folders[n] == ':');
  }
  return false;
}

void arguments_add(arguments *a, const char *word) {
  if (a->count < MOST_ARGUMENTS)
    a->words[a->count++] = must_copy(word);
  else
    a->too_many = true;
}

void arguments_add_words(arguments *a, const char *text, const char *less) {
  char *copy = must_copy(text);
  for (char *rest, *word = strtok_r(copy, " \t", &rest); word; word = strtok_r(NULL, " \t", &rest))
    if (strcmp(word, less) != 0) arguments_add(a, word);
  free(copy);
}

void arguments_free(arguments *a) {
  while (a->count > 0)
    free(a->words[--a->count]);
}

pid_t process_start(arguments *a, const char *log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log, O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  a->words[a->count] = NULL;
  pid_t child;
  const bool failed =
      a->too_many || posix_spawnp(&child, a->words[0], &actions, NULL, a->words, environ) != 0;
  posix_spawn_file_actions_destroy(&actions);
  return failed ? 0 : child;
}

int process_finish(pid_t child) {
  int status;
  if (child == 0) return 127;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return 127;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
