#include "runtime/result/result_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/base/whole_file.h"
#include "runtime/result/checkpoint.h"
#include "runtime/result/frame_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_sets.h"
#include "runtime/result/sealed_file.h"

/* The file that was looked at, opened by the library; negative when it is none of HDF5, or another
   by now. */
static hid_t open_looked_at(const char *path, int looked_at) {
  struct stat before, now;
  int *handle;
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return file;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, (void **)&handle) >= 0 && fstat(*handle, &now) == 0 &&
      fstat(looked_at, &before) == 0 && before.st_dev == now.st_dev && before.st_ino == now.st_ino)
    return file;
  H5Fclose(file);
  return -1;
}

/* What is wrong with the file; NULL: nothing, and it is open. */
static const char *open_checked(const char *path, int handle, seal_state seal, hid_t *file) {
  static const char broken[] =
      "has a broken seal: it is damaged, or was changed since it was written; copy it again from "
      "where it was whole, or run again (who has changed it takes its attribute `seal` away)";
  if (seal == SEAL_BROKEN) return broken;
  *file = open_looked_at(path, handle);
  if (*file < 0) return "is not a whole HDF5 file";
  if (seal == SEAL_NONE && sealed_file_is_marked(*file)) return broken;
  if (!h5_stays_inside(*file)) return "leads to other files, or in a circle; results do not";
  if (H5Lexists(*file, "/history", H5P_DEFAULT) > 0 &&
      H5Lexists(*file, "/particles", H5P_DEFAULT) > 0)
    return NULL;
  return h5_is_study_table(*file)
             ? "is the table of a study; the results are in the folder beside it"
             : "is damaged, or not a result of perilat";
}

static bool stands_beside(const char *path, const char *ending) {
  char name[WHOLE_FILE_PATH + 16];
  snprintf(name, sizeof name, "%s%s", path, ending);
  return access(name, F_OK) == 0;
}

/* A run that has not come to its end has left what it goes on from, or its frames alone. */
static void say_unreadable(const char *path, const char *why, char *error, size_t size) {
  const bool missing = access(path, F_OK) != 0;
  if (missing && stands_beside(path, CHECKPOINT_ENDING))
    snprintf(error, size,
             "there is no result `%s` yet, but the checkpoint of its run: it is at work, or was "
             "stopped or killed, and then goes on with: perilat run DECK --resume",
             path);
  else if (missing && stands_beside(path, FRAMES_ENDING))
    snprintf(error, size,
             "there is no result `%s`, but frames of its run: it is at work, or was killed before "
             "its first checkpoint; then run it again",
             path);
  else
    snprintf(error, size, "cannot read the result `%s`: %s", path, why);
}

result_file *result_read(const char *path, char *error, size_t size) {
  const char *why;
  hid_t file = -1;
  h5_quiet();
  const int handle = ordinary_file_open(path, O_RDONLY, &why);
  if (handle < 0) {
    say_unreadable(path, why, error, size);
    return NULL;
  }
  const seal_state seal = sealed_file_state(handle);
  why = open_checked(path, handle, seal, &file);
  close(handle);
  if (why) {
    if (file >= 0) H5Fclose(file);
    snprintf(error, size, "`%s` %s", path, why);
    return NULL;
  }
  if (seal == SEAL_NONE)
    fprintf(stderr,
            "perilat: warning: `%s` has no seal, so that damage to it may stay unseen: it is of an "
            "earlier version of perilat, or was changed\n",
            path);
  result_file *f = must_calloc(1, sizeof *f);
  f->file = file;
  f->field = -1;
  snprintf(f->path, sizeof f->path, "%s", path);
  return f;
}

void result_read_close(result_file *f) {
  for (int k = 0; k < NAMED_GROUPS; k++)
    result_names_free(&f->known[k]);
  result_names_free(&f->interactions);
  free(f->first_bond);
  if (f->field >= 0) H5Dclose(f->field);
  H5Fclose(f->file);
  free(f);
}

const char *result_trouble(const result_file *f) {
  return f->trouble[0] ? f->trouble : NULL;
}
