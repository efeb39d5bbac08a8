#include "runtime/hdf5_tools.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/arena.h"

/* A file that could not be closed (full disk) makes the library's own clearing up at exit crash; all that this program
   opens it closes itself. */
void h5_quiet(void) {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

hid_t h5_create(const char *path) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
  H5Pclose(access);
  return file;
}

bool h5_make_group(hid_t file, const char *name) {
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) return true;
  hid_t group = H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  return group >= 0 && H5Gclose(group) >= 0;
}

static hid_t text_type(size_t length) {
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, length);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/* Texts of variable length lie in heaps without checksums, and a damaged heap makes the library crash or hang. So a
   text attribute has a twin that our own reader looks at first: a line "name=text" of the object's comment, which the
   checksum of the object's header covers. */
static bool add_to_comment(hid_t object, const char *name, const char *text) {
  const size_t most = 4096; /* a header has no room for much more than ten times that */
  if (strchr(text, '\n') || strlen(text) > most) return true; /* only in the attribute */
  const ssize_t before = H5Oget_comment(object, NULL, 0);
  const size_t used = before > 0 ? (size_t)before : 0,
               size = used + strlen(name) + strlen(text) + 3;
  char *comment = must_calloc(size, 1);
  if (used) H5Oget_comment(object, comment, used + 1);
  snprintf(comment + used, size - used, "%s=%s\n", name, text);
  const bool good = H5Oset_comment(object, comment) >= 0;
  free(comment);
  return good;
}

/* The twin of a text attribute; false when there is none. */
static bool read_comment(hid_t object, const char *name, char *text, size_t size) {
  const ssize_t length = H5Oget_comment(object, NULL, 0);
  if (length <= 0) return false;
  char *comment = must_calloc((size_t)length + 1, 1), *rest = NULL;
  H5Oget_comment(object, comment, (size_t)length + 1);
  const size_t n = strlen(name);
  bool found = false;
  for (char *line = strtok_r(comment, "\n", &rest); line && !found;
       line = strtok_r(NULL, "\n", &rest))
    if (strncmp(line, name, n) == 0 && line[n] == '=') {
      snprintf(text, size, "%s", line + n + 1);
      found = true;
    }
  free(comment);
  return found;
}

bool h5_attribute_text(hid_t object, const char *name, const char *text) {
  hid_t type = text_type(H5T_VARIABLE), space = H5Screate(H5S_SCALAR);
  hid_t a = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = a >= 0 && H5Awrite(a, type, &text) >= 0 && add_to_comment(object, name, text);
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

static bool attribute_number(hid_t object, const char *name, hid_t stored, hid_t native,
                             const void *value) {
  hid_t space = H5Screate(H5S_SCALAR);
  hid_t a = H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = a >= 0 && H5Awrite(a, native, value) >= 0;
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  return good;
}

bool h5_attribute_double(hid_t object, const char *name, double value) {
  return attribute_number(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

bool h5_attribute_integer(hid_t object, const char *name, int64_t value) {
  return attribute_number(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

static bool write_set(hid_t file, const char *name, hid_t stored, hid_t native, const void *values,
                      int rank, const hsize_t *shape, const char *unit_text) {
  hid_t space = H5Screate_simple(rank, shape, NULL);
  hid_t set = H5Dcreate2(file, name, stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool empty = false;
  for (int k = 0; k < rank; k++)
    empty = empty || shape[k] == 0;
  bool good = set >= 0 &&
              (empty || H5Dwrite(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0) &&
              (!unit_text || h5_attribute_text(set, "units", unit_text));
  if (set >= 0) good = H5Dclose(set) >= 0 && good;
  H5Sclose(space);
  return good;
}

bool h5_write_doubles(hid_t file, const char *name, const double *values, int rank,
                      const hsize_t *shape, const char *unit_text) {
  return write_set(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values, rank, shape, unit_text);
}

bool h5_write_integers(hid_t file, const char *name, const int32_t *values, int rank,
                       const hsize_t *shape) {
  return write_set(file, name, H5T_STD_I32LE, H5T_NATIVE_INT32, values, rank, shape, NULL);
}

bool h5_write_text(hid_t file, const char *name, const char *text) {
  hid_t type = text_type(H5T_VARIABLE), space = H5Screate(H5S_SCALAR);
  hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool good = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text) >= 0;
  if (set >= 0) H5Dclose(set);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

hid_t h5_make_frames(hid_t file, const char *name, int rank, const hsize_t *shape,
                     const char *unit_text, int level) {
  hid_t space = H5Screate_simple(rank, shape, NULL), creation = H5Pcreate(H5P_DATASET_CREATE);
  hsize_t chunk[3] = {1, shape[1], rank > 2 ? shape[2] : 1};
  const hsize_t most = (hsize_t)1 << 20; /* values a chunk */
  if (chunk[1] > most) chunk[1] = most;
  if (shape[0] > 0 && shape[1] > 0) {
    H5Pset_chunk(creation, rank, chunk);
    H5Pset_shuffle(creation);
    H5Pset_deflate(creation, (unsigned)level);
  }
  hid_t set = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  if (set >= 0) h5_attribute_text(set, "units", unit_text);
  H5Pclose(creation);
  H5Sclose(space);
  return set;
}

bool h5_write_frame(hid_t set, long frame, int rank, const hsize_t *shape, const double *values) {
  if (shape[1] == 0) return true;
  hsize_t start[3] = {(hsize_t)frame, 0, 0}, count[3] = {1, shape[1], rank > 2 ? shape[2] : 1};
  hid_t space = H5Dget_space(set), memory = H5Screate_simple(rank, count, NULL);
  bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
              H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
  H5Sclose(memory);
  H5Sclose(space);
  return good;
}

bool h5_read_attribute_text(hid_t object, const char *name, char *text, size_t size) {
  text[0] = 0;
  if (read_comment(object, name, text, size)) return true;
  if (H5Aexists(object, name) <= 0) return false;
  hid_t a = H5Aopen(object, name, H5P_DEFAULT);
  hid_t type = a >= 0 ? H5Aget_type(a) : -1;
  hid_t space = a >= 0 ? H5Aget_space(a) : -1;
  bool good =
      type >= 0 && H5Tget_class(type) == H5T_STRING && H5Sget_simple_extent_npoints(space) == 1;
  if (good) {
    char *whole = NULL;
    const bool fixed = H5Tis_variable_str(type) == 0;
    hid_t memory = text_type(fixed ? size : H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type)); /* the library does not translate */
    good = H5Aread(a, memory, fixed ? (void *)text : (void *)&whole) >= 0;
    if (whole) snprintf(text, size, "%s", whole);
    free(whole);
    text[good ? size - 1 : 0] = 0;
    H5Tclose(memory);
  }
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  if (a >= 0) H5Aclose(a);
  return good;
}

char *h5_read_text(hid_t set) {
  hid_t type = H5Dget_type(set), space = H5Dget_space(set);
  const bool fixed = H5Tis_variable_str(type) == 0;
  char *text = NULL;
  if (H5Tget_class(type) == H5T_STRING && H5Sget_simple_extent_npoints(space) == 1) {
    hid_t memory = text_type(fixed ? H5Tget_size(type) + 1 : H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type));
    text = fixed ? must_calloc(H5Tget_size(type) + 1, 1) : NULL;
    if (H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, fixed ? (void *)text : (void *)&text) <
        0) {
      free(text);
      text = NULL;
    } else if (!text) { /* the library's empty text of variable length */
      text = must_calloc(1, 1);
    }
    H5Tclose(memory);
  }
  H5Sclose(space);
  H5Tclose(type);
  return text;
}

bool sync_file(const char *path) {
  int file = open(path, O_RDONLY);
  bool good = file >= 0 && fsync(file) == 0;
  if (file >= 0) close(file);
  char folder[4096];
  const char *slash = strrchr(path, '/');
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) : 1, slash ? path : ".");
  int f = open(*folder ? folder : "/", O_RDONLY | O_DIRECTORY);
  if (f >= 0) {
    fsync(f); /* some file systems refuse to sync a folder; the file itself is safe */
    close(f);
  }
  return good;
}
