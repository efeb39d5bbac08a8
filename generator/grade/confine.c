#define _GNU_SOURCE
#include "generator/grade/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/resource.h>
#include <unistd.h>

#ifdef __linux__
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

/* --- limits ----------------------------------------------------------------------------------- */

/* `most`, and `grace` more until it is ended whatever it does. */
static void limit(int what, rlim_t most, rlim_t grace) {
  struct rlimit r;
  if (getrlimit((__rlimit_resource_t)what, &r) != 0) return;
  if (r.rlim_max == RLIM_INFINITY || most + grace < r.rlim_max) r.rlim_max = most + grace;
  r.rlim_cur = most < r.rlim_max ? most : r.rlim_max;
  setrlimit((__rlimit_resource_t)what, &r);
}

static void limit_all(const confinement *to) {
  const rlim_t seconds = (rlim_t)ceil(to->seconds);
  limit(RLIMIT_CPU, seconds > 0 ? seconds : 1, 2);
  limit(RLIMIT_FSIZE, to->file, 0);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_NOFILE, 64, 0);
#ifndef PERILAT_ADDRESS_SANITIZER /* it maps terabytes */
  limit(RLIMIT_AS, to->memory, 0);
#endif
}

/* --- files and processes ---------------------------------------------------------------------- */

#ifdef __linux__
/* New files, and changes of those that are there, below `folder` alone. */
static void fence_files(const char *folder) {
  struct landlock_ruleset_attr rules = {
      .handled_access_fs = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR |
                           LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_DIR |
                           LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SYM |
                           LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                           LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                           LANDLOCK_ACCESS_FS_EXECUTE};
  struct landlock_path_beneath_attr own = {.allowed_access = rules.handled_access_fs &
                                                             ~(uint64_t)LANDLOCK_ACCESS_FS_EXECUTE};
  const int set = (int)syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0);
  if (set < 0) return;
  own.parent_fd = open(folder, O_PATH | O_CLOEXEC);
  if (own.parent_fd >= 0 &&
      syscall(SYS_landlock_add_rule, set, LANDLOCK_RULE_PATH_BENEATH, &own, 0) == 0)
    syscall(SYS_landlock_restrict_self, set, 0);
  if (own.parent_fd >= 0) close(own.parent_fd);
  close(set);
}

#if defined(__x86_64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifdef OWN_ARCHITECTURE
#define FIELD(name)   BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, name))
#define REFUSE(error) BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ((error)&SECCOMP_RET_DATA))
/* This call, whatever its arguments. */
#define WITHOUT(call) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 1), REFUSE(EPERM)

/* No network, no programs, no other processes; threads of its own it may have. */
static void fence_calls(void) {
  struct sock_filter filter[] = {
      FIELD(arch),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, OWN_ARCHITECTURE, 1, 0),
      REFUSE(EPERM),
      FIELD(nr),
      WITHOUT(socket),
      WITHOUT(socketpair),
      WITHOUT(connect),
      WITHOUT(bind),
      WITHOUT(execve),
      WITHOUT(execveat),
      WITHOUT(ptrace),
      WITHOUT(process_vm_readv),
      WITHOUT(process_vm_writev),
      WITHOUT(mount),
      WITHOUT(unshare),
      WITHOUT(setns),
      WITHOUT(bpf),
      WITHOUT(keyctl),
      WITHOUT(io_uring_setup),
#ifdef SYS_fork
      WITHOUT(fork),
      WITHOUT(vfork),
#endif
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1),
      REFUSE(ENOSYS), /* so that the library asks for clone, whose flags can be seen */
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3),
      FIELD(args[0]),
      BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0),
      REFUSE(EPERM),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  const struct sock_fprog program = {.len = sizeof filter / sizeof *filter, .filter = filter};
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}
#else
static void fence_calls(void) {
  limit(RLIMIT_NPROC, 64, 0);
}
#endif
#endif

/* --- the whole -------------------------------------------------------------------------------- */

static void leave_terminal(void) {
  const int nothing = open("/dev/null", O_RDWR);
  if (nothing < 0) return;
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(nothing, STDERR_FILENO);
  if (nothing > STDERR_FILENO) close(nothing);
}

bool confine(const char *folder, const confinement *to) {
  if (chdir(folder) != 0) return false;
  leave_terminal();
  signal(SIGPIPE, SIG_DFL);
#ifdef __linux__
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  fence_files(folder);
#endif
  limit_all(to);
#ifdef __linux__
  fence_calls();
#endif
  return true;
}
