/* Bytes as a result file, through everything that reads results and, rarely, the pictures. The
   first byte of an input says how the file comes about: a result that was right with some of its
   bytes changed, or a file that HDF5 itself writes from a recipe: the names of a result, but of any
   type, rank and size. Recipes try what perilat makes of a file that is whole; of changed bytes the
   checksums of the format find most. Not those in the heaps of texts: there HDF5 1.10 itself can be
   led to loop or to read where nothing is (H5HG_read), so they are left as they are. */
#include <hdf5.h>
#include <string.h>

#include "generator/page/page.h"
#include "runtime/plot/plot_curve.h"
#include "runtime/plot/plot_map.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/result.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"
#include "runtime/result/sealed_file.h"
#include "tests/fuzz/memory_file.h"

enum {
  FROM_RECIPE = 1,
  PICTURES = 2,
  SEAL_BROKEN_TOO = 4, /* else it is put right, so that what lies behind it is reached */
  LONGEST = 1 << 14,
  PARTICLES = 3,
  BONDS = 2,
  SAMPLES = 5,
  MOST_ITEMS = 12
};

static memory_file file;
static uint8_t *right_bytes;
static size_t right_size;
static bool *is_heap; /* [right_size] */
static char error[600], unit[20];

static const double reference[2 * PARTICLES] = {0, 0, 1, 0, 0.5, 0.75},
                                  volume[PARTICLES] = {1, 2, 3};
static const int32_t body[PARTICLES] = {0, 0, 1}, bonds[2 * BONDS] = {0, 1, 1, 2};

/* A result as runs write it. */
static void write_right(const char *path) {
  static const result_text texts[] = {{"law", "model law"}};
  static const result_field fields[] = {
      {.name = "displacement", .unit = "m", .components = 2, .count = PARTICLES, .kind = "other"},
      {.name = "omega",
       .unit = "1",
       .interaction = "concrete",
       .components = 1,
       .count = BONDS,
       .kind = "damage"}};
  static const double u[2 * PARTICLES] = {0, 0.1, 0, 0, 0.2, 0}, omega[BONDS] = {0.5, 1},
                            time[SAMPLES] = {0, 1, 2, 3, 4};
  static const double *const values[] = {u, omega};
  static const result_series series[] = {{.name = "load", .unit = "N", .values = time},
                                         {.name = "energy/kinetic", .unit = "J", .values = time}};
  const result_header h = {.path = path,
                           .fingerprint = "f",
                           .title = "t",
                           .started = "now",
                           .version = "0",
                           .kernel_key = "k",
                           .deck_text = "&simulation /",
                           .models = texts,
                           .model_count = 1,
                           .kernels = texts,
                           .kernel_count = 1,
                           .particle_count = PARTICLES,
                           .dimensions = 2,
                           .reference = reference,
                           .body = body,
                           .volume = volume,
                           .bonds = &(result_bonds){"concrete", BONDS, bonds},
                           .interaction_count = 1,
                           .fields = fields,
                           .field_count = 2};
  result *r = result_open(&h, false, error, sizeof error);
  MUST(r && result_begin(r, error, sizeof error) &&
       result_frame(r, 0, values, error, sizeof error) &&
       result_frame(r, 1, values, error, sizeof error));
  MUST(result_finish(r,
                     &(result_ending){.ended = "end of the run",
                                      .dt = 1e-3,
                                      .steps = 42,
                                      .time = time,
                                      .history_count = SAMPLES,
                                      .series = series,
                                      .series_count = 2},
                     error, sizeof error));
  result_discard(r);
  result_close(r);
}

/* The heaps of texts ("GCOL", four bytes, size) and what points into them (length, address of the
   heap, index). */
static void find_heaps(void) {
  is_heap = calloc(right_size, 1);
  MUST(is_heap);
  for (uint64_t heap = 0; heap + 16 <= right_size; heap++) {
    uint64_t size;
    memcpy(&size, right_bytes + heap + 8, sizeof size);
    if (memcmp(right_bytes + heap, "GCOL", 4) != 0) continue;
    memset(is_heap + heap, true, size);
    for (size_t at = 4; at + 12 <= right_size; at++)
      if (memcmp(right_bytes + at, &heap, sizeof heap) == 0) memset(is_heap + at - 4, true, 16);
  }
}

/* Bytes that were right, with some changed, but none of the heaps. */
static size_t damage(recipe *r, uint8_t *bytes) {
  memcpy(bytes, right_bytes, right_size);
  const size_t left = recipe_damage(r, bytes, right_size);
  for (size_t k = 0; k < left; k++)
    if (is_heap[k]) bytes[k] = right_bytes[k];
  return left;
}

static void end(void) {
  memory_file_free(&file);
  free(right_bytes);
  free(is_heap);
}

static void begin(void) {
  char path[64];
  snprintf(path, sizeof path, "/tmp/perilat_fuzz_%d.h5", (int)getpid());
  write_right(path);
  right_bytes = file_bytes(path, &right_size);
  unlink(path);
  strcpy(strrchr(path, '.'), ".xdmf");
  unlink(path);
  find_heaps();
  file = memory_file_new();
  atexit(end);
}

/* --- recipes ------------------------------------------------------------------------------------
 */

static const char *const places[] = {"/history/time",
                                     "/history/load",
                                     "/history/energy/kinetic",
                                     "/history",
                                     "/frames/time",
                                     "/frames/displacement",
                                     "/frames/damage",
                                     "/frames/concrete/omega",
                                     "/frames/concrete/damage",
                                     "/particles/reference",
                                     "/particles",
                                     "/particles/body",
                                     "/particles/volume",
                                     "/bonds/concrete",
                                     "/bonds",
                                     "/bonds/a",
                                     "/input/deck",
                                     "/input/models/law",
                                     "/frames",
                                     "/frames/a, b",
                                     "/frames/concrete",
                                     "/history/energy"};

static hid_t type_of(recipe *r) {
  const unsigned which = recipe_byte(r);
  hid_t t;
  switch (which & 15) {
  case 8:
    return H5Tcopy(H5T_STD_I32BE);
  case 9:
    return H5Tcopy(H5T_IEEE_F32BE);
  case 10:
    return H5Tcopy(H5T_STD_U8LE);
  case 11:
    t = H5Tcopy(H5T_C_S1);
    H5Tset_size(t, 1 + recipe_byte(r));
    return t;
  case 12:
    t = H5Tcopy(H5T_C_S1);
    H5Tset_size(t, H5T_VARIABLE);
    return t;
  case 13:
    t = H5Tcreate(H5T_COMPOUND, 16);
    H5Tinsert(t, "a", 0, H5T_IEEE_F64LE);
    return t;
  case 14:
    return H5Tcreate(H5T_OPAQUE, 8);
  case 15:
    return H5Tvlen_create(H5T_IEEE_F64LE);
  default:
    return H5Tcopy(which & 1 ? H5T_STD_I32LE : H5T_IEEE_F64LE);
  }
}

/* Sizes are mostly small; with `huge` they are of 40 bits, which a chunked set may have without
 * taking room. */
static hid_t space_of(recipe *r, bool huge, hsize_t *points, int *rank) {
  const unsigned which = recipe_byte(r);
  *rank = (int)(which % 6);
  *points = 1;
  if (*rank == 5) {
    *points = 0;
    return H5Screate(H5S_NULL);
  }
  hsize_t size[4];
  for (int k = 0; k < *rank; k++) {
    size[k] = huge ? (hsize_t)recipe_number(r, 5) : (hsize_t)(recipe_byte(r) % 7);
    *points *= huge ? 0 : size[k];
  }
  return *rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(*rank, size, NULL);
}

/* What HDF5 must be given: an attribute of texts of any length that was never written makes the
   library itself read wherever its heap points to. */
static void *texts_of(recipe *r, hsize_t points) {
  static char text[] = "a text as other programs write it, longer than any unit is, and not ended "
                       "where one would like";
  char **texts = malloc((size_t)points * sizeof *texts);
  MUST(texts);
  for (hsize_t k = 0; k < points; k++)
    texts[k] = text + recipe_byte(r) % sizeof text;
  return texts;
}

static uint8_t *bytes_of(recipe *r, size_t size) {
  uint8_t *bytes = malloc(size);
  MUST(bytes);
  for (size_t k = 0; k < size; k++)
    bytes[k] = (uint8_t)recipe_byte(r);
  return bytes;
}

/* Values are bytes of the recipe. */
static void fill(recipe *r, hid_t object, bool attribute, hid_t type, hsize_t points) {
  if (points == 0 || H5Tget_class(type) == H5T_VLEN) return;
  const bool is_text = H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) > 0;
  void *values = is_text ? texts_of(r, points) : bytes_of(r, (size_t)points * H5Tget_size(type));
  if (attribute)
    H5Awrite(object, type, values);
  else
    H5Dwrite(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  free(values);
}

static void add_attribute(recipe *r, hid_t object, const char *name) {
  hsize_t points;
  int rank;
  const hid_t type = type_of(r), space = space_of(r, false, &points, &rank);
  const hid_t a = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (a >= 0) {
    fill(r, a, true, type, points);
    H5Aclose(a);
  }
  H5Sclose(space);
  H5Tclose(type);
}

static void add_set(recipe *r, hid_t f, const char *path, unsigned how) {
  const bool huge = (how & 0x40) != 0, units = (how & 0x80) != 0;
  hsize_t points;
  int rank;
  const hid_t type = type_of(r), space = space_of(r, huge, &points, &rank);
  const hid_t links = H5Pcreate(H5P_LINK_CREATE), creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  if (huge && rank > 0 && rank < 5) {
    const hsize_t chunk[4] = {1, 1, 1, 1};
    H5Pset_chunk(creation, rank, chunk);
  }
  const hid_t set = H5Dcreate2(f, path, type, space, links, creation, H5P_DEFAULT);
  if (set >= 0) {
    fill(r, set, false, type, points);
    if (units) add_attribute(r, set, "units");
    if (how & 0x20)
      h5_attribute_text(set, "kind", "damage");
    else if (how & 0x10)
      add_attribute(r, set, "kind");
    H5Dclose(set);
  }
  H5Pclose(creation);
  H5Pclose(links);
  H5Sclose(space);
  H5Tclose(type);
}

static void add_link(hid_t f, const char *path, const char *target) {
  const hid_t links = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  H5Lcreate_soft(target, f, path, links, H5P_DEFAULT);
  H5Pclose(links);
}

static uint8_t *cook(recipe *r, size_t *size) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 14, 0);
  const hid_t f = H5Fcreate("recipe", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  MUST(f >= 0);
  for (int k = 0; k < MOST_ITEMS && r->at < r->end; k++) {
    const unsigned how = recipe_byte(r), where = recipe_byte(r) % (sizeof places / sizeof *places);
    if ((how & 0x3f) == 0x3f)
      add_attribute(r, f, "title");
    else if ((how & 0x3f) == 0x3e)
      add_link(f, places[where], places[recipe_byte(r) % (sizeof places / sizeof *places)]);
    else
      add_set(r, f, places[where], how);
  }
  h5_make_group(f, "/history");
  h5_make_group(f, "/particles");
  H5Fflush(f, H5F_SCOPE_GLOBAL);
  const ssize_t length = H5Fget_file_image(f, NULL, 0);
  MUST(length > 0);
  uint8_t *bytes = malloc((size_t)length);
  MUST(bytes && H5Fget_file_image(f, bytes, (size_t)length) == length);
  H5Fclose(f);
  H5Pclose(access);
  *size = (size_t)length;
  return bytes;
}

/* --- reading ------------------------------------------------------------------------------------
 */

/* All of it, so that what was not written is seen. */
static void sum_doubles(const double *values, long count) {
  volatile double sum = 0;
  for (long k = 0; values && k < count; k++)
    sum = sum + values[k];
}

static void read_frames(result_file *f) {
  static const char *const fields[] = {"displacement", "damage",   "concrete/omega",
                                       "time",         "concrete", "a, b"};
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    for (long frame = -2; frame <= 1; frame++) {
      long count = 0;
      int components = 0;
      *error = 0;
      double *v = result_read_frame(f, fields[k], frame, &count, &components, unit, sizeof unit,
                                    error, sizeof error);
      MUST(v || *error);
      sum_doubles(v, v ? count * components : 0);
      free(v);
    }
}

static void read_all(result_file *f) {
  static const char *const histories[] = {"time", "load", "energy/kinetic", "energy", "no/such"};
  static const char *const groups[] = {"/history",   "/frames", "/bonds",
                                       "/particles", "/input",  "/none"};
  static const char *const texts[] = {"/input/deck", "/input/models/law", "/history",
                                      "/history/time"};
  for (size_t k = 0; k < sizeof groups / sizeof *groups; k++) {
    result_names listed = result_list(f, groups[k]), members = result_members(f, groups[k]);
    result_names_free(&listed);
    result_names_free(&members);
  }
  for (size_t k = 0; k < sizeof histories / sizeof *histories; k++) {
    long count = 0;
    *error = 0;
    double *v = result_read_series(f, histories[k], &count, unit, sizeof unit, error, sizeof error);
    MUST(v || *error);
    sum_doubles(v, v ? count : 0);
    free(v);
  }
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
    char *text = result_read_text(f, texts[k]);
    if (text) MUST(strlen(text) < (size_t)1 << 30);
    free(text);
  }
  read_frames(f);
  char name[64];
  for (size_t k = 0; k < 2; k++)
    (void)result_find(f, "/frames", k ? "omega" : "displacement", name, sizeof name, error,
                      sizeof error);
  long count = 0;
  *error = 0;
  double *damage = result_read_damage(f, -1, &count, error, sizeof error);
  sum_doubles(damage, damage ? count : 0);
  free(damage);
  int dimensions;
  double *places_read = result_read_reference(f, &count, &dimensions);
  const long particles = places_read ? count : 0;
  sum_doubles(places_read, dimensions * particles);
  free(places_read);
  int32_t *pairs = result_read_bonds(f, NULL, &count);
  for (long k = 0; pairs && k < 2 * count; k++)
    MUST(pairs[k] >= 0 && pairs[k] < particles);
  free(pairs);
  free(result_read_bonds(f, "concrete", &count));
  double *times = result_read_frame_times(f, &count);
  sum_doubles(times, times ? count : 0);
  free(times);
  free(result_read_title(f));
}

static void draw(void) {
  const char *const results[] = {file.path};
  char path[80];
  snprintf(path, sizeof path, "/tmp/perilat_fuzz_%d.svg", (int)getpid());
  const plot_curve_options curve = {.output = path, .x = "time", .y = "load"};
  const plot_map_options map = {.output = path,
                                .frame = -1,
                                .field = "damage",
                                .component = -1,
                                .factor = -1,
                                .slice_axis = -1};
  *error = 0;
  MUST(plot_curve(results, 1, &curve, error, sizeof error) || *error);
  *error = 0;
  MUST(plot_map(file.path, &map, error, sizeof error) || *error);
  unlink(path);
}

/* A page tells why there is none, or is whole. */
static void make_page(void) {
  const char *const results[] = {file.path};
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  MUST(out);
  const int status = page_of_results(out, "fuzz", results, 1);
  fclose(out);
  MUST(status == 1 || (length > 10 && strcmp(text + length - 8, "</html>\n") == 0));
  free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!right_bytes) begin();
  if (size == 0 || size > LONGEST) return 0;
  const fuzz_choice choice = fuzz_choose(data, size);
  recipe r = {data, data + size};
  const unsigned how = recipe_byte(&r);
  size_t left = right_size;
  uint8_t *bytes;
  if (how & FROM_RECIPE)
    bytes = cook(&r, &left);
  else {
    bytes = malloc(right_size);
    MUST(bytes);
    left = damage(&r, bytes);
  }
  memory_file_set(&file, bytes, left);
  free(bytes);
  if (!(how & SEAL_BROKEN_TOO)) (void)sealed_file_renew(file.handle);
  *error = 0;
  result_file *f = result_read(file.path, error, sizeof error);
  MUST(f || *error);
  if (f) {
    read_all(f);
    result_read_close(f);
    if ((how & PICTURES) && fuzz_one_in(choice, 23)) draw();
    if ((how & PICTURES) && fuzz_one_in(choice, 7)) make_page();
  }
  MUST(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL) == 0); /* nothing was left open */
  return 0;
}
