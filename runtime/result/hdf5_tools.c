#include "runtime/result/hdf5_tools.h"

#include <hdf5_hl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* A file that could not be closed (full disk) makes the library's own clearing up at exit crash;
   all that this program opens it closes itself. */
void h5_quiet(void) {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  H5PLset_loading_state(0); /* a file must not make the library load programs */
}

/* As many attributes of the file stand where it begins, not in a heap of their own. */
enum { ATTRIBUTES = 64 };

hid_t h5_create(const char *path) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  hid_t creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_attr_phase_change(creation, ATTRIBUTES, ATTRIBUTES / 2);
  hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, creation, access);
  H5Pclose(creation);
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

bool h5_attribute_text(hid_t object, const char *name, const char *text) {
  hid_t type = text_type(H5T_VARIABLE), space = H5Screate(H5S_SCALAR);
  hid_t a = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = a >= 0 && H5Awrite(a, type, &text) >= 0;
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

static bool attribute_values(hid_t object, const char *name, hid_t stored, hid_t native, int rank,
                             const hsize_t *shape, const void *values) {
  hid_t space = H5Screate_simple(rank, shape, NULL);
  hid_t a = H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
  bool good = a >= 0 && H5Awrite(a, native, values) >= 0;
  if (a >= 0) H5Aclose(a);
  H5Sclose(space);
  return good;
}

bool h5_attribute_double(hid_t object, const char *name, double value) {
  return attribute_values(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 0, NULL, &value);
}

bool h5_attribute_integer(hid_t object, const char *name, int64_t value) {
  return attribute_values(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, 0, NULL, &value);
}

bool h5_attribute_integers(hid_t object, const char *name, const int64_t *values, int count) {
  const hsize_t shape[1] = {(hsize_t)count};
  return attribute_values(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, 1, shape, values);
}

bool h5_attribute_name(hid_t object, const char *name, const char *text) {
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, strlen(text));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const bool good = attribute_values(object, name, type, type, 0, NULL, text);
  H5Tclose(type);
  return good;
}

/* As many values as half a megabyte holds, of whole rows and frames where these are smaller. */
static void choose_chunk(int rank, const hsize_t *shape, hsize_t *chunk) {
  hsize_t left = (hsize_t)1 << 16;
  for (int k = rank - 1; k >= 0; k--) {
    chunk[k] = shape[k] < left ? shape[k] : left;
    left = left / chunk[k] > 0 ? left / chunk[k] : 1;
  }
}

static bool is_empty(int rank, const hsize_t *shape) {
  bool empty = false;
  for (int k = 0; k < rank; k++)
    empty = empty || shape[k] == 0;
  return empty;
}

static void pack(hid_t creation, int rank, const hsize_t *shape) {
  enum { LEVEL = 4 };
  hsize_t chunk[H5S_MAX_RANK];
  choose_chunk(rank, shape, chunk);
  H5Pset_chunk(creation, rank, chunk);
  H5Pset_shuffle(creation);
  H5Pset_deflate(creation, LEVEL);
  H5Pset_fletcher32(creation);
}

static hid_t make_set(hid_t file, const char *name, hid_t stored, int rank, const hsize_t *shape,
                      bool packed, const char *unit_text) {
  hid_t space = H5Screate_simple(rank, shape, NULL), creation = H5Pcreate(H5P_DATASET_CREATE);
  if (packed && !is_empty(rank, shape)) pack(creation, rank, shape);
  hid_t set = H5Dcreate2(file, name, stored, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  H5Pclose(creation);
  H5Sclose(space);
  if (set < 0 || !unit_text || h5_attribute_text(set, "units", unit_text)) return set;
  H5Dclose(set);
  return -1;
}

static bool write_set(hid_t file, const char *name, hid_t stored, hid_t native, const void *values,
                      int rank, const hsize_t *shape, bool packed, const char *unit_text) {
  hid_t set = make_set(file, name, stored, rank, shape, packed, unit_text);
  if (set < 0) return false;
  const bool good =
      is_empty(rank, shape) || H5Dwrite(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
  return H5Dclose(set) >= 0 && good;
}

bool h5_write_doubles(hid_t file, const char *name, const double *values, int rank,
                      const hsize_t *shape, const char *unit_text) {
  return write_set(file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values, rank, shape, true,
                   unit_text);
}

bool h5_write_integers(hid_t file, const char *name, const int32_t *values, int rank,
                       const hsize_t *shape) {
  return write_set(file, name, H5T_STD_I32LE, H5T_NATIVE_INT32, values, rank, shape, true, NULL);
}

bool h5_write_bytes(hid_t file, const char *name, const unsigned char *values, int rank,
                    const hsize_t *shape) {
  return write_set(file, name, H5T_STD_U8LE, H5T_NATIVE_UCHAR, values, rank, shape, true, NULL);
}

bool h5_write_list(hid_t file, const char *name, const int64_t *values, int rank,
                   const hsize_t *shape) {
  return write_set(file, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values, rank, shape, false, NULL);
}

/* Takes over the space. */
static bool write_texts(hid_t file, const char *name, const char *const *texts, hid_t space) {
  hid_t type = text_type(H5T_VARIABLE);
  hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  bool good = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) >= 0;
  if (set >= 0) H5Dclose(set);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

bool h5_write_text(hid_t file, const char *name, const char *text) {
  return write_texts(file, name, &text, H5Screate(H5S_SCALAR));
}

bool h5_write_texts(hid_t file, const char *name, const char *const *texts, int count) {
  const hsize_t shape[] = {(hsize_t)count};
  return write_texts(file, name, texts, H5Screate_simple(1, shape, NULL));
}

hid_t h5_make_frames(hid_t file, const char *name, int rank, const hsize_t *shape,
                     const char *unit_text) {
  return make_set(file, name, H5T_IEEE_F64LE, rank, shape, true, unit_text);
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

/* --- dimension scales ------------------------------------------------------------------------- */

bool h5_scale_begin(h5_scale *s, hid_t set, const char *name) {
  *s = (h5_scale){.set = set};
  return H5DSset_scale(set, name) >= 0 &&
         H5Rcreate(&s->reference, set, ".", H5R_OBJECT, H5I_INVALID_HID) >= 0;
}

static bool write_attribute(hid_t set, const char *name, hid_t type, hsize_t count,
                            const void *values) {
  const hid_t space = H5Screate_simple(1, &count, NULL);
  const hid_t attribute = H5Acreate2(set, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  const bool good = attribute >= 0 && H5Awrite(attribute, type, values) >= 0;
  if (attribute >= 0) H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
  return good;
}

bool h5_scale_attach(h5_scale *s, hid_t set, int rank) {
  hvl_t scales[H5S_MAX_RANK] = {{.len = 1, .p = &s->reference}};
  if (s->count == s->room) {
    s->room = 2 * s->room + 64;
    s->users = must_realloc(s->users, s->room * sizeof *s->users);
  }
  h5_scale_user *user = &s->users[s->count++];
  *user = (h5_scale_user){.dimension = 0};
  return H5Rcreate(&user->set, set, ".", H5R_OBJECT, H5I_INVALID_HID) >= 0 &&
         write_attribute(set, "DIMENSION_LIST", H5Tvlen_create(H5T_STD_REF_OBJ), (hsize_t)rank,
                         scales);
}

bool h5_scale_end(h5_scale *s) {
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof *s->users);
  H5Tinsert(type, "dataset", HOFFSET(h5_scale_user, set), H5T_STD_REF_OBJ);
  H5Tinsert(type, "dimension", HOFFSET(h5_scale_user, dimension), H5T_NATIVE_INT);
  bool good = s->count == 0;
  if (good)
    H5Tclose(type);
  else
    good = write_attribute(s->set, "REFERENCE_LIST", type, s->count, s->users);
  free(s->users);
  return H5Dclose(s->set) >= 0 && good;
}

/* --- views ------------------------------------------------------------------------------------ */

static bool map_block(hid_t file, hid_t view, const hsize_t *shape, int rank, const h5_block *of,
                      hid_t plist) {
  const hid_t set = H5Dopen2(file, of->set, H5P_DEFAULT);
  if (set < 0) return false;
  const hid_t there = H5Dget_space(set);
  const int from = H5Sget_simple_extent_ndims(there);
  const hsize_t rows = of->rows ? of->rows : shape[0], every = of->every ? of->every : shape[0],
                times = (shape[0] - of->first + every - 1) / every;
  const hsize_t begin[] = {of->first, 0}, stride[] = {every, 1}, repeats[] = {times, 1},
                block[] = {rows, rank > 1 ? of->count[from - 1] : 1};
  const bool good =
      H5Sselect_hyperslab(view, H5S_SELECT_SET, begin, stride, repeats, block) >= 0 &&
      H5Sselect_hyperslab(there, H5S_SELECT_SET, of->start, NULL, of->count, NULL) >= 0 &&
      H5Pset_virtual(plist, view, ".", of->set, there) >= 0;
  H5Sclose(there);
  return H5Dclose(set) >= 0 && good;
}

static bool is_nothing(const h5_block *of) {
  return of->count[0] == 0 || of->count[1] == 0;
}

static hid_t type_of_set(hid_t file, const char *name) {
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = set < 0 ? -1 : H5Dget_type(set);
  if (set >= 0) H5Dclose(set);
  return type;
}

bool h5_make_view(hid_t file, const char *name, int rank, const hsize_t *shape,
                  const h5_block *blocks, int count, bool gaps) {
  const double none = NAN;
  const hid_t type = type_of_set(file, blocks[0].set);
  if (type < 0) return false;
  const hid_t space = H5Screate_simple(rank, shape, NULL), plist = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_dset_no_attrs_hint(plist, true); /* half the size */
  H5Pset_obj_track_times(plist, false);
  bool good = !gaps || H5Pset_fill_value(plist, H5T_NATIVE_DOUBLE, &none) >= 0;
  for (int b = 0; good && b < count && !is_empty(rank, shape); b++)
    good = is_nothing(&blocks[b]) || map_block(file, space, shape, rank, &blocks[b], plist);
  H5Sselect_all(space);
  const hid_t view =
      good ? H5Dcreate2(file, name, type, space, H5P_DEFAULT, plist, H5P_DEFAULT) : -1;
  good = view >= 0 && H5Dclose(view) >= 0;
  H5Tclose(type);
  H5Pclose(plist);
  H5Sclose(space);
  return good;
}

bool h5_read_attribute_text(hid_t object, const char *name, char *text, size_t size) {
  text[0] = 0;
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

/* --- what a file holds ------------------------------------------------------------------------ */

typedef struct set_visit {
  bool (*visit)(hid_t set, void *context);
  void *context;
} set_visit;

static herr_t visit_link(hid_t root, const char *name, const H5L_info_t *link, void *data) {
  const set_visit *v = data;
  if (link->type != H5L_TYPE_HARD) return -1;
  const hid_t object = H5Oopen(root, name, H5P_DEFAULT);
  if (object < 0) return -1;
  const bool good = H5Iget_type(object) != H5I_DATASET || v->visit(object, v->context);
  H5Oclose(object);
  return good ? 0 : -1;
}

bool h5_each_set(hid_t file, bool (*visit)(hid_t set, void *context), void *context) {
  set_visit v = {visit, context};
  return H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit_link, &v) >= 0;
}

/* Virtual sets of virtual sets might lead in a circle, in which the library does not end. */
static bool is_plain(hid_t file, const char *name) {
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  const hid_t plist = set >= 0 ? H5Dget_create_plist(set) : -1;
  const bool plain = plist >= 0 && H5Pget_layout(plist) != H5D_VIRTUAL;
  if (plist >= 0) H5Pclose(plist);
  if (set >= 0) H5Dclose(set);
  return plain;
}

static bool maps_inside(hid_t file, hid_t plist) {
  size_t count = 0;
  bool good = H5Pget_virtual_count(plist, &count) >= 0;
  for (size_t k = 0; good && k < count; k++) {
    char from[3] = "", name[1024] = "";
    H5Pget_virtual_filename(plist, k, from, sizeof from);
    const ssize_t length = H5Pget_virtual_dsetname(plist, k, name, sizeof name);
    good = strcmp(from, ".") == 0 && length > 0 && length < (ssize_t)sizeof name &&
           is_plain(file, name);
  }
  return good;
}

static bool set_stays_inside(hid_t set, void *file) {
  const hid_t plist = H5Dget_create_plist(set);
  const bool good = plist >= 0 && H5Pget_external_count(plist) == 0 &&
                    (H5Pget_layout(plist) != H5D_VIRTUAL || maps_inside(*(hid_t *)file, plist));
  if (plist >= 0) H5Pclose(plist);
  return good;
}

bool h5_stays_inside(hid_t file) {
  return h5_each_set(file, set_stays_inside, &file);
}

bool h5_is_study_table(hid_t file) {
  return H5Lexists(file, "/table", H5P_DEFAULT) > 0 &&
         H5Lexists(file, "/table/case", H5P_DEFAULT) > 0 &&
         H5Lexists(file, "/cases", H5P_DEFAULT) > 0 &&
         H5Lexists(file, "/history", H5P_DEFAULT) <= 0;
}
