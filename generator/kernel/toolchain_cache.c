#include "generator/kernel/toolchain_cache.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/sha256.h"
#include "generator/kernel/toolchain_compiler.h"

#define LONGEST_PATH PATH_MAX

/* --- folders and files ------------------------------------------------------------------------ */

static bool is_usable_folder(const char *path) {
  struct stat about;
  if (stat(path, &about) != 0) return false;
  errno = ENOTDIR;
  return S_ISDIR(about.st_mode) && access(path, W_OK | X_OK) == 0;
}

/* Makes the folder and those above it; where that fails, errno says why. */
static bool make_folder(const char *path) {
  char part[LONGEST_PATH];
  if (snprintf(part, sizeof part, "%s", path) >= (int)sizeof part - 1) {
    errno = ENAMETOOLONG;
    return false;
  }
  for (char *c = part + 1; *c; c++) {
    if (*c != '/') continue;
    *c = 0;
    mkdir(part, 0777);
    *c = '/';
  }
  const int refused = mkdir(part, 0700) == 0 ? 0 : errno;
  if (is_usable_folder(path)) return true;
  if (refused && refused != EEXIST) errno = refused;
  return false;
}

/* A folder that only this user can write to: somebody else's files there would be loaded as
 * programs. */
static bool make_private_folder(const char *path) {
  struct stat about;
  mkdir(path, 0700);
  return lstat(path, &about) == 0 && S_ISDIR(about.st_mode) && about.st_uid == geteuid() &&
         (about.st_mode & 077) == 0 && is_usable_folder(path);
}

static void use_temporary_folder(char *path, size_t size) {
  const char *parent = toolchain_setting("TMPDIR");
  if (!parent || !is_usable_folder(parent)) parent = "/tmp";
  for (int k = 0; k < 100; k++) {
    snprintf(path, size, "%s/perilat-%ld-%d", parent, (long)geteuid(), k);
    if (make_private_folder(path)) return;
  }
  snprintf(path, size, "/dev/null"); /* holds nothing: what is written there fails with a message */
}

/* Where the settings want the cache; empty where they do not say. */
static void wanted_cache(char *path, size_t size) {
  const char *given = toolchain_setting("PERILAT_CACHE"),
             *xdg = toolchain_setting("XDG_CACHE_HOME"), *home = toolchain_setting("HOME");
  *path = 0;
  if (given)
    snprintf(path, size, "%s", given);
  else if (xdg)
    snprintf(path, size, "%s/perilat", xdg);
  else if (home)
    snprintf(path, size, "%s/.cache/perilat", home);
}

const char *toolchain_cache(void) {
  static _Thread_local char path[LONGEST_PATH]; /* the answer, until the thread's next call */
  wanted_cache(path, sizeof path);
  if (!*path || !make_folder(path)) use_temporary_folder(path, sizeof path);
  return path;
}

const char *toolchain_cache_trouble(void) {
  static _Thread_local char text[3 * LONGEST_PATH]; /* as above */
  char wanted[LONGEST_PATH];
  wanted_cache(wanted, sizeof wanted);
  if (!*wanted || make_folder(wanted)) return NULL;
  const char *why = strerror(errno);
  snprintf(text, sizeof text,
           "the cache `%s` cannot be written to (%s): compiled kernels are kept in `%s`", wanted,
           why, toolchain_cache());
  return text;
}

bool cache_temporary(const char *path, const char *ending, char *temporary, size_t size) {
  int length = snprintf(temporary, size, "%s.XXXXXX%s", path, ending);
  if (length < 0 || (size_t)length >= size) return false;
  int file = mkstemps(temporary, (int)strlen(ending));
  return file >= 0 && close(file) == 0;
}

bool cache_write(const char *path, const char *mode, const void *data, size_t size) {
  FILE *out = fopen(path, mode);
  if (!out) return false;
  bool done = fwrite(data, 1, size, out) == size;
  return fclose(out) == 0 && done;
}

bool cache_put(const char *path, const char *text) {
  char temporary[LONGEST_PATH];
  if (!cache_temporary(path, ".tmp", temporary, sizeof temporary)) return false;
  if (cache_write(temporary, "wb", text, strlen(text)) && rename(temporary, path) == 0) return true;
  unlink(temporary);
  return false;
}

/* A file that a compilation makes beside KEY.so or KEY.c and takes away at its end:
   KEY.so.XXXXXX.tmp and the like. */
static bool is_passing(const char *name) {
  const size_t key = strspn(name, "0123456789abcdef");
  return key == 2 * SHA256_SIZE && name[key] == '.' && strchr(name + key + 1, '.');
}

void cache_clear_remains(const char *folder) {
  enum { DAY = 24 * 60 * 60 };
  const time_t now = time(NULL);
  DIR *all = opendir(folder);
  for (const struct dirent *e; all && (e = readdir(all));) {
    char path[LONGEST_PATH];
    struct stat about;
    if (!is_passing(e->d_name) ||
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name) >= (int)sizeof path)
      continue;
    if (lstat(path, &about) == 0 && S_ISREG(about.st_mode) && now - about.st_mtime > DAY)
      unlink(path);
  }
  if (all) closedir(all);
}

/* --- the seal --------------------------------------------------------------------------------- */

static const char seal_mark[8] = "PERILAT";
#define SEAL_SIZE (sizeof seal_mark + SHA256_SIZE)

static void digest_of(const void *data, size_t size, unsigned char digest[SHA256_SIZE]) {
  sha256 h;
  sha256_begin(&h);
  sha256_add(&h, data, size);
  sha256_end(&h, digest);
}

/* Whole file (malloc'ed), or NULL. */
static unsigned char *read_file(const char *path, size_t *size) {
  FILE *in = fopen(path, "rb");
  struct stat about;
  if (!in || fstat(fileno(in), &about) != 0 || !S_ISREG(about.st_mode)) {
    if (in) fclose(in);
    return NULL;
  }
  unsigned char *data = must_alloc((size_t)about.st_size + 1);
  *size = fread(data, 1, (size_t)about.st_size, in);
  fclose(in);
  return data;
}

bool cache_seal(const char *path) {
  size_t size;
  unsigned char *data = read_file(path, &size), end[SEAL_SIZE];
  if (!data) return false;
  memcpy(end, seal_mark, sizeof seal_mark);
  digest_of(data, size, end + sizeof seal_mark);
  free(data);
  return cache_write(path, "ab", end, sizeof end);
}

bool cache_is_sealed(const char *path) {
  size_t size;
  unsigned char *data = read_file(path, &size), digest[SHA256_SIZE];
  bool sound = false;
  if (data && size > SEAL_SIZE) {
    const unsigned char *end = data + size - SEAL_SIZE;
    digest_of(data, size - SEAL_SIZE, digest);
    sound = memcmp(end, seal_mark, sizeof seal_mark) == 0 &&
            memcmp(end + sizeof seal_mark, digest, sizeof digest) == 0;
  }
  free(data);
  return sound;
}
