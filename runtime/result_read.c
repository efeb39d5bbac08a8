/* The reading half of result.h. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "dsl/arena.h"
#include "runtime/hdf5_tools.h"
#include "runtime/result.h"

#define VALUES_LIMIT ((hsize_t)1 << 32) /* of one read: 32 GiB of doubles */

struct result_file {
  hid_t file;
  char path[1024];
};

result_file *result_read(const char *path, char *error, size_t size) {
  h5_quiet();
  struct stat about;
  FILE *probe = fopen(path, "rb");
  if (!probe || fstat(fileno(probe), &about) != 0 || !S_ISREG(about.st_mode)) {
    snprintf(error, size, "cannot read the result `%s`: %s", path,
             probe ? "it is not a file" : strerror(errno));
    if (probe) fclose(probe);
    return NULL;
  }
  fclose(probe);
  hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) {
    snprintf(error, size, "`%s` is not a whole HDF5 file", path);
    return NULL;
  }
  if (H5Lexists(file, "/history", H5P_DEFAULT) <= 0 ||
      H5Lexists(file, "/particles", H5P_DEFAULT) <= 0) {
    H5Fclose(file);
    snprintf(error, size, "`%s` is damaged, or not a result of perilat", path);
    return NULL;
  }
  result_file *f = must_calloc(1, sizeof *f);
  f->file = file;
  snprintf(f->path, sizeof f->path, "%s", path);
  return f;
}

void result_read_close(result_file *f) {
  H5Fclose(f->file);
  free(f);
}

/* Every part of the path must exist before H5Dopen may be asked. */
static hid_t open_set(const result_file *f, const char *name) {
  char part[512];
  for (const char *at = strchr(name + 1, '/');; at = strchr(at + 1, '/')) {
    size_t n = at ? (size_t)(at - name) : strlen(name);
    if (n >= sizeof part) return -1;
    memcpy(part, name, n);
    part[n] = 0;
    if (H5Lexists(f->file, part, H5P_DEFAULT) <= 0) return -1;
    if (!at) return H5Dopen2(f->file, name, H5P_DEFAULT);
  }
}

/* False of a set that claims more values than its bytes in the file can hold, however well they are compressed (deflate
   reaches 1032): a small file must not ask for all memory. */
static bool is_stored(hid_t set, int rank, const hsize_t *shape) {
  const hid_t type = H5Dget_type(set);
  double bytes = (double)H5Tget_size(type);
  H5Tclose(type);
  for (int k = 0; k < rank; k++)
    bytes *= (double)shape[k];
  return bytes <= 1100.0 * (double)H5Dget_storage_size(set) + 64e6;
}

/* Rank and shape of a data set; false when it is not of rank 1 to 3, or too large to be read from dimension `from` on. */
static bool shape_of(hid_t set, int from, int *rank, hsize_t shape[3]) {
  hid_t space = H5Dget_space(set);
  *rank = H5Sget_simple_extent_ndims(space);
  bool good = *rank >= 1 && *rank <= 3 && H5Sget_simple_extent_dims(space, shape, NULL) >= 0;
  H5Sclose(space);
  hsize_t product = 1;
  for (int k = from; good && k < *rank; k++) {
    good = shape[k] <= VALUES_LIMIT / (product ? product : 1);
    product *= shape[k];
  }
  return good && is_stored(set, *rank, shape);
}

/* The longer text; the old one is freed. */
static char *append_name(char *text, const char *folder, const char *name) {
  size_t used = strlen(text);
  text = must_realloc(text, used + strlen(folder) + strlen(name) + 3);
  sprintf(text + used, "%s%s%s", used ? ", " : "", folder, name);
  return text;
}

static void *read_whole(hid_t set, hid_t type, size_t width, int rank_wanted, hsize_t shape[3]) {
  int rank;
  if (!shape_of(set, 0, &rank, shape) || rank != rank_wanted) return NULL;
  size_t count = 1;
  for (int k = 0; k < rank; k++)
    count *= (size_t)shape[k];
  void *values = must_calloc(count + 1, width);
  if (count && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    free(values);
    return NULL;
  }
  return values;
}

char *result_members(result_file *f, const char *group) {
  char *names = result_list(f, group), *rest = NULL;
  char *text = must_calloc(1, 1);
  for (char *name = names ? strtok_r(names, ",", &rest) : NULL; name;
       name = strtok_r(NULL, ",", &rest)) {
    char path[512];
    snprintf(path, sizeof path, "%.250s/%.250s", group, name);
    char *inner = result_list(f, path), *inner_rest = NULL;
    if (!inner) text = append_name(text, "", name);
    for (char *part = inner ? strtok_r(inner, ",", &inner_rest) : NULL; part;
         part = strtok_r(NULL, ",", &inner_rest)) {
      snprintf(path, sizeof path, "%.250s/", name);
      text = append_name(text, path, part);
    }
    free(inner);
  }
  free(names);
  if (!*text) text = append_name(text, "", "nothing");
  return text;
}

double *result_read_series(result_file *f, const char *name, long *count, char *unit_text,
                           size_t unit_size, char *error, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "/history/%s", name);
  hid_t set = open_set(f, path);
  hsize_t shape[3];
  double *values = set >= 0 ? read_whole(set, H5T_NATIVE_DOUBLE, sizeof *values, 1, shape) : NULL;
  if (values) {
    *count = (long)shape[0];
    h5_read_attribute_text(set, "units", unit_text, unit_size);
  } else {
    char *names = result_members(f, "/history");
    snprintf(error, size, "`%s` has no history `%s`; it has %s", f->path, name, names);
    free(names);
  }
  if (set >= 0) H5Dclose(set);
  return values;
}

/* Names that result_read_frame takes, of particles or of bonds: "damage, displacement". */
static char *field_names(result_file *f, bool of_bonds) {
  char *members = result_members(f, "/frames"), *rest = NULL, *names = must_calloc(1, 1);
  for (char *name = strtok_r(members, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest))
    if ((strchr(name, '/') != NULL) == of_bonds && strcmp(name, "time") != 0 &&
        strcmp(name, "nothing") != 0)
      names = append_name(names, "", name);
  free(members);
  return *names ? names : append_name(names, "", "none");
}

static void no_such_field(result_file *f, const char *field, char *error, size_t size) {
  char *of_particles = field_names(f, false), *of_bonds = field_names(f, true);
  snprintf(error, size, "`%s` has no field `%s`; fields of particles: %s; of bonds: %s", f->path,
           field, of_particles, of_bonds);
  free(of_particles);
  free(of_bonds);
}

static double *read_slab(hid_t set, long frame, int rank, const hsize_t shape[3]) {
  hsize_t start[3] = {(hsize_t)frame, 0, 0}, count[3] = {1, shape[1], rank > 2 ? shape[2] : 1};
  double *values = must_calloc((size_t)(count[1] * count[2]) + 1, sizeof *values);
  hid_t space = H5Dget_space(set), memory = H5Screate_simple(rank, count, NULL);
  bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
              H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
  H5Sclose(memory);
  H5Sclose(space);
  if (good) return values;
  free(values);
  return NULL;
}

double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit_text, size_t unit_size, char *error,
                          size_t size) {
  char path[512];
  snprintf(path, sizeof path, "/frames/%s", field);
  hid_t set = open_set(f, path);
  int rank = 0;
  hsize_t shape[3] = {0, 0, 0};
  if (set < 0 || !shape_of(set, 1, &rank, shape) || rank < 2) {
    no_such_field(f, field, error, size);
    if (set >= 0) H5Dclose(set);
    return NULL;
  }
  long frames = (long)shape[0], wanted = frame < 0 ? frames + frame : frame;
  double *values = NULL;
  if (wanted < 0 || wanted >= frames)
    snprintf(error, size, "`%s` has %ld frames, numbered from 0; there is no frame %ld", f->path,
             frames, frame);
  else if (!(values = read_slab(set, wanted, rank, shape)))
    snprintf(error, size, "frame %ld of `%s` in `%s` cannot be read", wanted, field, f->path);
  *count = (long)shape[1];
  *components = rank > 2 ? (int)shape[2] : 1;
  h5_read_attribute_text(set, "units", unit_text, unit_size);
  H5Dclose(set);
  return values;
}

bool result_find_field(result_file *f, const char *given, char *name, size_t size) {
  char path[512], *interactions = result_list(f, "/bonds"), *rest = NULL;
  int found = 0;
  snprintf(path, sizeof path, "/frames/%.400s", given);
  snprintf(name, size, "%s", given);
  hid_t set = open_set(f, path);
  for (char *i = set < 0 && interactions ? strtok_r(interactions, ",", &rest) : NULL; i;
       i = strtok_r(NULL, ",", &rest)) {
    snprintf(path, sizeof path, "/frames/%.200s/%.200s", i, given);
    hid_t other = open_set(f, path);
    if (other < 0) continue;
    H5Dclose(other);
    if (!found++) snprintf(name, size, "%s", path + strlen("/frames/"));
  }
  free(interactions);
  if (set >= 0) H5Dclose(set);
  return set >= 0 || found == 1;
}

static bool is_damage(result_file *f, const char *field) {
  char path[512], kind[16] = "";
  snprintf(path, sizeof path, "/frames/%.500s", field);
  hid_t set = open_set(f, path);
  if (set < 0) return false;
  h5_read_attribute_text(set, "kind", kind, sizeof kind);
  H5Dclose(set);
  return strcmp(kind, "damage") == 0;
}

/* Takes one more damage into `most`, which may be NULL; frees it. NULL when they do not fit. */
static double *larger_of(double *most, long bonds, double *more, long count) {
  if (!most) return more;
  const bool fits = more && count == bonds;
  for (long b = 0; fits && b < bonds; b++)
    if (more[b] > most[b]) most[b] = more[b];
  free(more);
  if (fits) return most;
  free(most);
  return NULL;
}

double *result_read_damage(result_file *f, long frame, long *bonds, char *error, size_t size) {
  char name[512], unit_text[16], *interaction = result_list(f, "/bonds"), *rest = NULL;
  double *most = NULL;
  bool good = interaction != NULL;
  error[0] = 0;
  *bonds = 0;
  if (interaction) interaction[strcspn(interaction, ",")] = 0;
  snprintf(name, sizeof name, "/frames/%.400s", interaction ? interaction : "");
  char *fields = interaction ? result_list(f, name) : NULL;
  for (char *field = fields ? strtok_r(fields, ",", &rest) : NULL; good && field;
       field = strtok_r(NULL, ",", &rest)) {
    long count = 0;
    int components = 0;
    snprintf(name, sizeof name, "%.250s/%.250s", interaction, field);
    if (!is_damage(f, name)) continue;
    double *more = result_read_frame(f, name, frame, &count, &components, unit_text,
                                     sizeof unit_text, error, size);
    if (more && components != 1) { /* one number a bond */
      free(more);
      more = NULL;
      snprintf(error, size, "`%s` in `%s` is not one number a bond", name, f->path);
    }
    most = larger_of(most, *bonds, more, count);
    *bonds = count;
    good = most != NULL;
  }
  free(fields);
  free(interaction);
  return most;
}

/* A table of as many columns as there may be; how many there are goes into *columns. */
static void *read_table(result_file *f, const char *path, hid_t type, size_t width, int least,
                        int most, long *rows_read, int *columns) {
  const int rank = most > 1 ? 2 : 1;
  hid_t set = open_set(f, path);
  hsize_t shape[3] = {0, 0, 0};
  void *values = set >= 0 ? read_whole(set, type, width, rank, shape) : NULL;
  if (values && rank == 2 && (shape[1] < (hsize_t)least || shape[1] > (hsize_t)most)) {
    free(values);
    values = NULL;
  }
  *rows_read = values ? (long)shape[0] : 0;
  *columns = values && rank == 2 ? (int)shape[1] : 1;
  if (set >= 0) H5Dclose(set);
  return values;
}

double *result_read_reference(result_file *f, long *particles, int *dimensions) {
  return read_table(f, "/particles/reference", H5T_NATIVE_DOUBLE, sizeof(double), 2, 3, particles,
                    dimensions);
}

/* Pairs that name particles which do not exist make the table unusable. */
int32_t *result_read_bonds(result_file *f, const char *interaction, long *bonds) {
  char path[512];
  char *names = interaction ? NULL : result_list(f, "/bonds");
  const char *name = interaction ? interaction : names ? names : "";
  snprintf(path, sizeof path, "/bonds/%.*s", (int)strcspn(name, ","), name);
  free(names);
  int columns;
  int32_t *pairs = read_table(f, path, H5T_NATIVE_INT32, sizeof *pairs, 2, 2, bonds, &columns);
  long particles;
  free(result_read_reference(f, &particles, &columns));
  for (long m = 0; pairs && m < 2 * *bonds; m++)
    if (pairs[m] < 0 || pairs[m] >= particles) {
      free(pairs);
      *bonds = 0;
      return NULL;
    }
  return pairs;
}

double *result_read_frame_times(result_file *f, long *frames) {
  int columns;
  return read_table(f, "/frames/time", H5T_NATIVE_DOUBLE, sizeof(double), 1, 1, frames, &columns);
}

char *result_read_text(result_file *f, const char *path) {
  hid_t set = open_set(f, path);
  if (set < 0) return NULL;
  char *text = h5_read_text(set);
  H5Dclose(set);
  return text;
}

typedef struct name_list {
  char *text;
  size_t length;
} name_list;

static herr_t add_name(hid_t group, const char *name, const H5L_info_t *info, void *data) {
  (void)group, (void)info;
  name_list *l = data;
  size_t n = strlen(name);
  l->text = must_realloc(l->text, l->length + n + 2);
  if (l->length) l->text[l->length++] = ',';
  memcpy(l->text + l->length, name, n + 1);
  l->length += n;
  return 0;
}

char *result_list(result_file *f, const char *group) {
  if (H5Lexists(f->file, group, H5P_DEFAULT) <= 0) return NULL;
  hid_t g = H5Gopen2(f->file, group, H5P_DEFAULT);
  if (g < 0) return NULL;
  name_list l = {NULL, 0};
  H5Literate(g, H5_INDEX_NAME, H5_ITER_INC, NULL, add_name, &l);
  H5Gclose(g);
  return l.text;
}

char *result_read_title(result_file *f) {
  char title[512];
  h5_read_attribute_text(f->file, "title", title, sizeof title);
  char *copy = must_calloc(strlen(title) + 1, 1);
  return strcpy(copy, title);
}
