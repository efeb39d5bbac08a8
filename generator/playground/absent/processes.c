/* Other processes, and threads beside the page's own: laws are interpreted by one. */
#define _GNU_SOURCE
#include <errno.h>
#include <omp.h>
#include <sched.h>

#include "generator/kernel/toolchain_process.h"

void arguments_add(arguments *a, const char *word) {
  (void)a, (void)word;
}

void arguments_add_words(arguments *a, const char *text, const char *less) {
  (void)a, (void)text, (void)less;
}

void arguments_free(arguments *a) {
  (void)a;
}

pid_t process_start(arguments *a, const char *log) {
  (void)a, (void)log;
  return 0;
}

int process_finish(pid_t child) {
  (void)child;
  return 127;
}

bool process_find(const char *command, char *path, size_t size) {
  (void)command, (void)path, (void)size;
  return false;
}

int sched_getaffinity(pid_t process, size_t size, cpu_set_t *set) {
  (void)process, (void)size, (void)set;
  errno = ENOSYS;
  return -1;
}

int __sched_cpucount(size_t size, const cpu_set_t *set) {
  (void)size, (void)set;
  return 1;
}

int omp_get_max_threads(void) {
  return 1;
}

int omp_get_num_threads(void) {
  return 1;
}

int omp_get_thread_num(void) {
  return 0;
}

void omp_set_num_threads(int count) {
  (void)count;
}
