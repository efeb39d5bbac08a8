#include "runtime/result/result_read.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/diagnostics.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/sealed_file.h"

#define VALUES_LIMIT ((hsize_t)1 << 32) /* of one read: 32 GiB of doubles */

typedef enum named_group { HISTORIES, FIELDS, NAMED_GROUPS } named_group;

struct result_file {
  hid_t file;
  hid_t field; /* the set of frames that was read last, open for the next frame; -1: none */
  char path[1024], field_name[512];
  char trouble[1600];
  result_names known[NAMED_GROUPS]; /* listed when they are first asked for */
  bool listed[NAMED_GROUPS];
  result_names interactions; /* likewise, */
  long *first_bond;          /* [interactions + 1] where theirs begin among all bonds */
};

/* --- opening ---------------------------------------------------------------------------------- */

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
  return "is damaged, or not a result of perilat";
}

result_file *result_read(const char *path, char *error, size_t size) {
  const char *why;
  hid_t file = -1;
  h5_quiet();
  const int handle = ordinary_file_open(path, O_RDONLY, &why);
  if (handle < 0) {
    snprintf(error, size, "cannot read the result `%s`: %s", path, why);
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

static const result_names *names_in(result_file *f, const char *group);
const char *result_trouble(const result_file *f) {
  return f->trouble[0] ? f->trouble : NULL;
}

/* A set that is there cannot be read: the first is kept for result_trouble. */
static void report_unreadable(result_file *f, hid_t set) {
  char name[512] = "";
  if (f->trouble[0]) return;
  H5Iget_name(set, name, sizeof name);
  snprintf(f->trouble, sizeof f->trouble, "`%s` of `%s` cannot be read: it is damaged", name,
           f->path);
}

bool result_is_quasi_static(result_file *f) {
  return result_names_find(names_in(f, "/history"), "relaxation_steps") >= 0;
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

/* False of a set that claims more values than its bytes in the file can hold, however well they are
   compressed (deflate reaches 1032): a small file must not ask for all memory. */
static bool is_stored(hid_t set, int rank, const hsize_t *shape) {
  const hid_t type = H5Dget_type(set);
  double bytes = (double)H5Tget_size(type);
  H5Tclose(type);
  for (int k = 0; k < rank; k++)
    bytes *= (double)shape[k];
  return bytes <= 1100.0 * (double)H5Dget_storage_size(set) + 64e6;
}

/* Rank and shape of a data set; false when it is not of rank 1 to 3, or too large to be read from
   dimension `from` on. */
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

static void *read_whole(result_file *f, hid_t set, hid_t type, size_t width, int rank_wanted,
                        hsize_t shape[3]) {
  int rank;
  if (!shape_of(set, 0, &rank, shape) || rank != rank_wanted) {
    report_unreadable(f, set);
    return NULL;
  }
  size_t count = 1;
  for (int k = 0; k < rank; k++)
    count *= (size_t)shape[k];
  void *values = must_calloc(count + 1, width);
  if (count && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
    report_unreadable(f, set);
    free(values);
    return NULL;
  }
  return values;
}

/* --- names ------------------------------------------------------------------------------------ */

static void add_name(result_names *n, const char *folder, const char *name) {
  const size_t size = strlen(folder) + strlen(name) + 2;
  if ((n->count & (n->count - 1)) == 0) /* room is the power of two at or above the count */
    n->items = must_realloc(n->items, (n->count ? 2 * (size_t)n->count : 1) * sizeof *n->items);
  char *item = n->items[n->count++] = must_alloc(size);
  snprintf(item, size, "%s%s%s", folder, *folder ? "/" : "", name);
}

void result_names_free(result_names *n) {
  for (int k = 0; k < n->count; k++)
    free(n->items[k]);
  free(n->items);
  name_index_clear(&n->whole);
  name_index_clear(&n->last);
  *n = (result_names){0};
}

static herr_t list_one(hid_t group, const char *name, const H5L_info_t *info, void *names) {
  (void)group, (void)info;
  add_name(names, "", name);
  return 0;
}

result_names result_list(result_file *f, const char *group) {
  result_names n = {0};
  if (H5Lexists(f->file, group, H5P_DEFAULT) <= 0) return n;
  hid_t g = H5Gopen2(f->file, group, H5P_DEFAULT);
  if (g < 0) return n;
  H5Literate(g, H5_INDEX_NAME, H5_ITER_INC, NULL, list_one, &n);
  H5Gclose(g);
  return n;
}

static bool is_group(const result_file *f, const char *path) {
  hid_t g = H5Gopen2(f->file, path, H5P_DEFAULT);
  if (g >= 0) H5Gclose(g);
  return g >= 0;
}

static const char *last_part(const char *name) {
  const char *slash = strrchr(name, '/');
  return slash ? slash + 1 : name;
}

static bool is_sum(const char *name) {
  return strncmp(name, "energy/", 7) == 0;
}

/* Of energies that several have the last part means the sum. */
static void index_names(result_names *n) {
  for (int k = 0; k < n->count; k++) {
    name_index_add(&n->whole, n->items[k], k);
    int *of_part = name_index_add(&n->last, last_part(n->items[k]), k);
    if (*of_part == k || (*of_part >= 0 && is_sum(n->items[*of_part]))) continue;
    *of_part = is_sum(n->items[k]) ? k : -1;
  }
}

result_names result_members(result_file *f, const char *group) {
  result_names all = {0}, outer = result_list(f, group);
  for (int k = 0; k < outer.count; k++) {
    char path[512];
    if (strcmp(outer.items[k], "time") == 0) continue;
    snprintf(path, sizeof path, "%.250s/%.250s", group, outer.items[k]);
    if (!is_group(f, path)) {
      add_name(&all, "", outer.items[k]);
      continue;
    }
    result_names inner = result_list(f, path);
    for (int i = 0; i < inner.count; i++)
      add_name(&all, outer.items[k], inner.items[i]);
    result_names_free(&inner);
  }
  result_names_free(&outer);
  index_names(&all);
  return all;
}

static const result_names *names_in(result_file *f, const char *group) {
  const named_group k = strcmp(group, "/frames") == 0 ? FIELDS : HISTORIES;
  if (!f->listed[k]) f->known[k] = result_members(f, group);
  f->listed[k] = true;
  return &f->known[k];
}

int result_names_find(const result_names *n, const char *given) {
  const int found = name_index_find(&n->whole, given);
  return found >= 0 ? found : name_index_find(&n->last, given);
}

/* The nearest name, in full or its last part. */
static const char *near_name(const result_names *n, const char *given) {
  const char **candidates = must_calloc(2 * (size_t)n->count + 1, sizeof *candidates);
  for (int k = 0; k < n->count; k++) {
    candidates[k] = n->items[k];
    candidates[n->count + k] = last_part(n->items[k]);
  }
  const char *near = nearest_name(given, candidates, 2 * n->count);
  free(candidates);
  return near;
}

/* Appends to the sentence, as far as there is room. */
static void add_text(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void add_text(char *text, size_t size, const char *format, ...) {
  const size_t used = strlen(text);
  va_list values;
  va_start(values, format);
  vsnprintf(text + used, size - used, format, values);
  va_end(values);
}

enum { OF_PARTICLES = 1, OF_BONDS = 2 }; /* the latter lie in folders */
static void add_names(char *text, size_t size, const result_names *n, int which) {
  int count = 0;
  for (int k = 0; k < n->count; k++)
    if (which & (strchr(n->items[k], '/') ? OF_BONDS : OF_PARTICLES))
      add_text(text, size, "%s%s", count++ ? ", " : "", name_shown(n->items[k]));
  if (!count) add_text(text, size, "none");
}

static void no_such_name(result_file *f, const char *group, const char *given, char *error,
                         size_t size) {
  const bool of_frames = strcmp(group, "/frames") == 0;
  const result_names *n = names_in(f, group);
  const char *near = near_name(n, given);
  snprintf(error, size, "`%s` has no %s `%s`; ", f->path, of_frames ? "field" : "history", given);
  if (near) add_text(error, size, "did you mean `%s`? ", name_shown(near));
  if (of_frames) {
    add_text(error, size, "fields of particles: ");
    add_names(error, size, n, OF_PARTICLES);
    add_text(error, size, "; of bonds: ");
    add_names(error, size, n, OF_BONDS);
  } else {
    add_text(error, size, "it has ");
    add_names(error, size, n, OF_PARTICLES | OF_BONDS);
  }
}

/* Opens a history or a field, by its full name or a part that says which. Negative after a
   sentence. */
static hid_t open_named(result_file *f, const char *group, const char *given, char *error,
                        size_t size) {
  char name[512], path[600];
  snprintf(path, sizeof path, "%s/%s", group, given);
  hid_t set = open_set(f, path);
  if (set >= 0) return set;
  if (!result_find(f, group, given, name, sizeof name, error, size)) return -1;
  snprintf(path, sizeof path, "%s/%s", group, name);
  set = open_set(f, path);
  if (set < 0) snprintf(error, size, "`%s` of `%s` cannot be read", name_shown(name), f->path);
  return set;
}

/* How many have a field of that name on their bonds. */
static int interactions_with(const result_names *n, const char *field) {
  int count = 0;
  for (int k = 0; k < n->count; k++)
    count += strchr(n->items[k], '/') && strcmp(last_part(n->items[k]), field) == 0;
  return count;
}

bool result_find(result_file *f, const char *group, const char *given, char *name, size_t size,
                 char *error, size_t error_size) {
  const result_names *n = names_in(f, group);
  const int k = result_names_find(n, given);
  const bool is_time = k < 0 && strcmp(group, "/history") == 0 && strcmp(given, "time") == 0;
  snprintf(name, size, "%s", k < 0 ? given : n->items[k]);
  if (k >= 0 || is_time) return true;
  const char *field = strncmp(given, "*/", 2) == 0 ? given + 2 : given;
  if (strcmp(group, "/frames") == 0 && interactions_with(n, field) > 0) {
    snprintf(name, size, "*/%s", field);
    return true;
  }
  no_such_name(f, group, given, error, error_size);
  return false;
}

/* --- values ----------------------------------------------------------------------------------- */

void result_read_unchecked(result_file *f, const char *name, char *why, size_t size) {
  char error[2048];
  hid_t set = open_named(f, "/history", name, error, sizeof error);
  if (size > 0) *why = 0;
  if (set < 0) return;
  h5_read_attribute_text(set, "unchecked", why, size);
  H5Dclose(set);
}

double *result_read_series(result_file *f, const char *name, long *count, char *unit_text,
                           size_t unit_size, char *error, size_t size) {
  hid_t set = open_named(f, "/history", name, error, size);
  if (set < 0) return NULL;
  hsize_t shape[3];
  double *values = read_whole(f, set, H5T_NATIVE_DOUBLE, sizeof *values, 1, shape);
  if (values) {
    *count = (long)shape[0];
    h5_read_attribute_text(set, "units", unit_text, unit_size);
  } else
    snprintf(error, size, "%s", f->trouble);
  H5Dclose(set);
  return values;
}

/* The set of a field, which stays open: frames that follow each other may lie in one chunk. */
static hid_t open_field(result_file *f, const char *field, char *error, size_t size) {
  if (f->field >= 0 && strcmp(f->field_name, field) == 0) return f->field;
  if (f->field >= 0) H5Dclose(f->field);
  f->field = open_named(f, "/frames", field, error, size);
  snprintf(f->field_name, sizeof f->field_name, "%s", field);
  return f->field;
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

/* A frame of one data set. */
static double *read_one(result_file *f, const char *field, long frame, long *count, int *components,
                        char *unit_text, size_t unit_size, char *error, size_t size) {
  hid_t set = open_field(f, field, error, size);
  if (set < 0) return NULL;
  int rank = 0;
  hsize_t shape[3] = {0, 0, 0};
  if (!shape_of(set, 1, &rank, shape) || rank < 2) {
    report_unreadable(f, set);
    snprintf(error, size, "`%s` of `%s` is not a field with a value for each particle or bond",
             field, f->path);
    return NULL;
  }
  long frames = (long)shape[0], wanted = frame < 0 ? frames + frame : frame;
  double *values = NULL;
  if (wanted < 0 || wanted >= frames)
    snprintf(error, size, "`%s` has %ld frames, numbered from 0; there is no frame %ld", f->path,
             frames, frame);
  else if (!(values = read_slab(set, wanted, rank, shape))) {
    report_unreadable(f, set);
    snprintf(error, size, "frame %ld of %s", wanted, f->trouble);
  }
  *count = (long)shape[1];
  *components = rank > 2 ? (int)shape[2] : 1;
  h5_read_attribute_text(set, "units", unit_text, unit_size);
  return values;
}

/* --- fields of bonds -------------------------------------------------------------------------- */

static long bonds_in(result_file *f, const char *interaction) {
  char path[512];
  hsize_t shape[3] = {0, 0, 0};
  int rank;
  snprintf(path, sizeof path, "/bonds/%.500s", interaction);
  const hid_t set = open_set(f, path);
  const bool good = set >= 0 && shape_of(set, 0, &rank, shape) && rank == 2;
  if (set >= 0) H5Dclose(set);
  return good ? (long)shape[0] : 0;
}

static const result_names *interactions_of(result_file *f) {
  if (f->first_bond) return &f->interactions;
  f->interactions = result_list(f, "/bonds");
  f->first_bond = must_calloc((size_t)f->interactions.count + 1, sizeof *f->first_bond);
  for (int k = 0; k < f->interactions.count; k++)
    f->first_bond[k + 1] = f->first_bond[k] + bonds_in(f, f->interactions.items[k]);
  return &f->interactions;
}

static bool is_of(const char *field, const char *interaction) {
  const size_t own = strlen(interaction);
  return strncmp(field, interaction, own) == 0 && field[own] == '/';
}

/* Puts the field of one interaction where its bonds are among all. False with a sentence. */
static bool put_bonds(result_file *f, const char *field, int interaction, long frame, double *all,
                      char *unit_text, size_t unit_size, char *error, size_t size) {
  char found[64] = "";
  long count = 0;
  int components = 0;
  const long first = f->first_bond[interaction], bonds = f->first_bond[interaction + 1] - first;
  double *values = read_one(f, field, frame, &count, &components, found, sizeof found, error, size);
  bool good = values != NULL;
  if (good && (count != bonds || components != 1)) {
    snprintf(error, size, "`%s` in `%s` is not one number a bond", field, f->path);
    good = false;
  }
  if (good && *unit_text && strcmp(unit_text, found) != 0) {
    snprintf(error, size, "`%s` has one unit in `%s` and another elsewhere: give the whole name",
             last_part(field), field);
    good = false;
  }
  snprintf(unit_text, unit_size, "%s", found);
  if (good) memcpy(all + first, values, (size_t)bonds * sizeof *all);
  free(values);
  return good;
}

/* In the order of result_read_bonds; NaN where an interaction has no such field. */
static double *read_bonds_of_all(result_file *f, const char *name, long frame, long *count,
                                 char *unit_text, size_t unit_size, char *error, size_t size) {
  const result_names *all = interactions_of(f), *fields = names_in(f, "/frames");
  const bool any = strncmp(name, "*/", 2) == 0;
  *count = f->first_bond[all->count];
  double *values = must_calloc((size_t)*count + 1, sizeof *values);
  bool good = true;
  for (long b = 0; b < *count; b++)
    values[b] = NAN;
  *unit_text = 0;
  for (int k = 0; good && k < fields->count; k++) {
    const char *field = fields->items[k];
    if (any ? strcmp(last_part(field), name + 2) != 0 : strcmp(field, name) != 0) continue;
    for (int n = 0; good && n < all->count; n++)
      if (is_of(field, all->items[n]))
        good = put_bonds(f, field, n, frame, values, unit_text, unit_size, error, size);
  }
  if (good) return values;
  free(values);
  return NULL;
}

double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit_text, size_t unit_size, char *error,
                          size_t size) {
  char name[512];
  if (!result_find(f, "/frames", field, name, sizeof name, error, size)) return NULL;
  if (!strchr(name, '/') || interactions_of(f)->count < 2)
    return read_one(f, name, frame, count, components, unit_text, unit_size, error, size);
  *components = 1;
  return read_bonds_of_all(f, name, frame, count, unit_text, unit_size, error, size);
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
    if (!(most[b] >= more[b]) && !isnan(more[b])) most[b] = more[b];
  free(more);
  if (fits) return most;
  free(most);
  return NULL;
}

double *result_read_damage(result_file *f, long frame, long *bonds, char *error, size_t size) {
  const result_names *fields = names_in(f, "/frames");
  double *most = NULL;
  bool good = true;
  error[0] = 0;
  *bonds = 0;
  for (int k = 0; good && k < fields->count; k++) {
    const char *name = fields->items[k];
    char unit_text[16];
    long count = 0;
    int components = 0;
    if (!strchr(name, '/') || !is_damage(f, name)) continue;
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
  for (long b = 0; most && b < *bonds; b++) /* of interactions whose law has no damage */
    if (isnan(most[b])) most[b] = 0;
  return most;
}

/* A table of as many columns as there may be; how many there are goes into *columns. */
static void *read_table(result_file *f, const char *path, hid_t type, size_t width, int least,
                        int most, long *rows_read, int *columns) {
  const int rank = most > 1 ? 2 : 1;
  hid_t set = open_set(f, path);
  hsize_t shape[3] = {0, 0, 0};
  void *values = set >= 0 ? read_whole(f, set, type, width, rank, shape) : NULL;
  if (values && rank == 2 && (shape[1] < (hsize_t)least || shape[1] > (hsize_t)most)) {
    report_unreadable(f, set);
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

double *result_read_volume(result_file *f, long *particles) {
  int columns;
  return read_table(f, "/particles/volume", H5T_NATIVE_DOUBLE, sizeof(double), 1, 1, particles,
                    &columns);
}

static bool name_particles(const int32_t *pairs, long bonds, long particles) {
  for (long k = 0; k < 2 * bonds; k++)
    if (pairs[k] < 0 || pairs[k] >= particles) return false;
  return true;
}

static int32_t *read_pairs(result_file *f, const char *interaction, long particles, long *bonds) {
  char path[512];
  int columns;
  snprintf(path, sizeof path, "/bonds/%.500s", interaction);
  int32_t *pairs = read_table(f, path, H5T_NATIVE_INT32, sizeof *pairs, 2, 2, bonds, &columns);
  if (!pairs || name_particles(pairs, *bonds, particles)) return pairs;
  snprintf(f->trouble, sizeof f->trouble, "`%s` of `%s` names particles that are not there", path,
           f->path);
  free(pairs);
  return NULL;
}

int32_t *result_read_bonds(result_file *f, const char *interaction, long *bonds) {
  const result_names *names = interactions_of(f);
  long particles = 0;
  int columns;
  free(result_read_reference(f, &particles, &columns));
  *bonds = 0;
  if (interaction) return read_pairs(f, interaction, particles, bonds);
  int32_t *all = NULL;
  for (int k = 0; k < names->count; k++) {
    long count = 0;
    int32_t *more = read_pairs(f, names->items[k], particles, &count);
    if (!more) {
      free(all);
      *bonds = 0;
      return NULL;
    }
    all = must_realloc(all, 2 * (size_t)(*bonds + count + 1) * sizeof *all);
    if (count) memcpy(all + 2 * *bonds, more, 2 * (size_t)count * sizeof *all);
    *bonds += count;
    free(more);
  }
  return all;
}

double *result_read_frame_times(result_file *f, long *frames) {
  int columns;
  return read_table(f, "/frames/time", H5T_NATIVE_DOUBLE, sizeof(double), 1, 1, frames, &columns);
}

char *result_read_text(result_file *f, const char *path) {
  hid_t set = open_set(f, path);
  if (set < 0) return NULL;
  char *text = h5_read_text(set);
  if (!text) report_unreadable(f, set);
  H5Dclose(set);
  return text;
}

char *result_read_words(result_file *f, const char *name) {
  char words[1024];
  h5_read_attribute_text(f->file, name, words, sizeof words);
  char *copy = must_calloc(strlen(words) + 1, 1);
  return strcpy(copy, words);
}

double result_read_number(result_file *f, const char *name) {
  double value = NAN;
  if (H5Aexists(f->file, name) <= 0) return value;
  const hid_t a = H5Aopen(f->file, name, H5P_DEFAULT), space = a >= 0 ? H5Aget_space(a) : -1;
  if (space < 0 || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(a, H5T_NATIVE_DOUBLE, &value) < 0)
    value = NAN;
  if (space >= 0) H5Sclose(space);
  if (a >= 0) H5Aclose(a);
  return value;
}

char *result_read_title(result_file *f) {
  return result_read_words(f, "title");
}
