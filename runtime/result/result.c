#include "runtime/result/result.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/whole_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/mesh_views.h"
#include "runtime/result/sealed_file.h"
#include "runtime/result/state_write.h"
#include "runtime/result/views.h"
#include "runtime/result/xdmf.h"

struct result {
  result_header header;
  frame_file *frames;
  char *path; /* the header's */
};

/* --- frames while the run goes on ------------------------------------------------------------- */

static size_t numbers_of(const result_field *f) {
  return (size_t)f->count * (size_t)f->components;
}

result *result_open(const result_header *header, bool resume, char *error, size_t size) {
  size_t numbers = 1; /* the time */
  for (int k = 0; k < header->field_count; k++)
    numbers += numbers_of(&header->fields[k]);
  frame_file *frames =
      frame_file_open(header->path, header->fingerprint, numbers, resume, error, size);
  if (!frames) return NULL;
  char sidecar[WHOLE_FILE_PATH];
  result_sidecar(header->path, sidecar, sizeof sidecar);
  whole_file_clear(header->path);
  whole_file_clear(sidecar);
  result *r = must_calloc(1, sizeof *r);
  *r = (result){*header, frames, must_alloc(strlen(header->path) + 1)};
  r->header.path = strcpy(r->path, header->path);
  return r;
}

bool result_begin(result *r, char *error, size_t size) {
  return frame_file_begin(r->frames, error, size);
}

bool result_resume(result *r, const frame_mark *mark, char *error, size_t size) {
  return frame_file_resume(r->frames, mark, error, size);
}

bool result_frame(result *r, double time, const double *const *values, char *error, size_t size) {
  double *at = frame_file_record(r->frames);
  *at++ = time;
  for (int k = 0; k < r->header.field_count; k++) {
    const size_t numbers = numbers_of(&r->header.fields[k]);
    if (numbers) memcpy(at, values[k], numbers * sizeof *at);
    at += numbers;
  }
  return frame_file_add(r->frames, error, size);
}

frame_mark result_mark(const result *r) {
  return frame_file_mark(r->frames);
}

bool result_frames_hold(const result *r) {
  char unsaid[512];
  return frame_file_each(r->frames, NULL, NULL, unsaid, sizeof unsaid);
}

bool result_sync(result *r, char *error, size_t size) {
  return frame_file_sync(r->frames, error, size);
}

void result_discard(result *r) {
  frame_file_remove(r->frames);
}

void result_close(result *r) {
  frame_file_close(r->frames);
  free(r->path);
  free(r);
}

/* --- the HDF5 file ---------------------------------------------------------------------------- */

static bool write_bonds(hid_t file, const result_bonds *b) {
  const hsize_t shape[2] = {(hsize_t)b->count, 2};
  char name[256];
  snprintf(name, sizeof name, "/bonds/%s", b->name);
  return h5_write_integers(file, name, b->pairs, 2, shape);
}

static bool write_particles(hid_t file, const result_header *h) {
  hsize_t places[2] = {(hsize_t)h->particle_count, (hsize_t)h->dimensions};
  hsize_t one[1] = {(hsize_t)h->particle_count};
  bool good =
      h5_make_group(file, "/particles") && h5_make_group(file, "/bonds") &&
      h5_write_doubles(file, "/particles/reference", h->reference, 2, places, "m") &&
      h5_write_doubles(file, "/particles/volume", h->volume, 1, one, "m^3") &&
      h5_write_integers(file, "/particles/body", h->body, 1, one) &&
      (!h->spacing || h5_write_doubles(file, "/particles/spacing", h->spacing, 1, one, "m")) &&
      (!h->resolved || h5_write_integers(file, "/particles/resolved", h->resolved, 1, one));
  for (int k = 0; good && k < h->interaction_count; k++)
    good = write_bonds(file, &h->bonds[k]);
  return good;
}

static bool write_texts(hid_t file, const char *group, const result_text *texts, int count) {
  bool good = h5_make_group(file, group);
  for (int k = 0; good && k < count; k++) {
    char name[WHOLE_FILE_PATH + 64]; /* some are paths */
    snprintf(name, sizeof name, "%s/%s", group, texts[k].name);
    good = H5Lexists(file, name, H5P_DEFAULT) > 0 || h5_write_text(file, name, texts[k].text);
  }
  return good;
}

static bool write_input(hid_t file, const result_header *h) {
  return h5_make_group(file, "/input") && h5_write_text(file, "/input/deck", h->deck_text) &&
         (!h->overrides || !*h->overrides || h5_write_text(file, "/input/set", h->overrides)) &&
         write_texts(file, "/input/models", h->models, h->model_count) &&
         write_texts(file, "/input/kernels", h->kernels, h->kernel_count) &&
         (h->file_count == 0 || write_texts(file, "/input/files", h->files, h->file_count));
}

/* A data set of times is the scale of the first dimension of what stands beside it. */
static bool write_times(hid_t file, const result_header *h, const char *name, const char *long_name,
                        const double *times, long count, h5_scale *scale) {
  const hsize_t n[1] = {(hsize_t)count};
  if (!h5_write_doubles(file, name, times, 1, n, h->numbers ? "1" : "s")) return false;
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  if (set < 0) return false;
  if (h5_attribute_text(set, "long_name", h->numbers ? h->numbers : long_name) &&
      h5_scale_begin(scale, set, "time"))
    return true;
  H5Dclose(set);
  return false;
}

static bool describe(hid_t set, int rank, h5_scale *times, const char *long_name) {
  return h5_scale_attach(times, set, rank) &&
         (!long_name || h5_attribute_text(set, "long_name", long_name));
}

static bool write_verdict(hid_t set, const result_series *s) {
  return !s->judges || (h5_attribute_integer(set, "checked", s->unchecked == NULL) &&
                        (!s->unchecked || h5_attribute_text(set, "unchecked", s->unchecked)));
}

/* "energy/kinetic", "plate/kinetic", "notch/start/K_I": in folders. */
static bool make_folders(hid_t file, const result_series *s) {
  char name[512];
  bool good = true;
  for (const char *slash = strchr(s->name, '/'); slash && good; slash = strchr(slash + 1, '/')) {
    snprintf(name, sizeof name, "/history/%.*s", (int)(slash - s->name), s->name);
    good = h5_make_group(file, name);
  }
  return good;
}

static bool write_series(hid_t file, h5_scale *times, long count, const result_series *s) {
  char name[512];
  const hsize_t n[1] = {(hsize_t)count};
  if (!make_folders(file, s)) return false;
  snprintf(name, sizeof name, "/history/%s", s->name);
  if (!h5_write_doubles(file, name, s->values, 1, n, s->unit)) return false;
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  const bool good = set >= 0 && describe(set, 1, times, s->long_name) && write_verdict(set, s);
  if (set >= 0) H5Dclose(set);
  return good;
}

static bool write_history(hid_t file, const result_header *h, const result_ending *e) {
  if (!h5_make_group(file, "/history") || !h5_make_group(file, "/history/energy")) return false;
  h5_scale times;
  if (!write_times(file, h, "/history/time", "time of the sample", e->time, e->history_count,
                   &times))
    return false;
  bool good = true;
  for (int k = 0; good && k < e->series_count; k++)
    good = write_series(file, &times, e->history_count, &e->series[k]);
  return h5_scale_end(&times) && good;
}

/* The data sets of the fields, and the times of the frames, while frames are copied. */
typedef struct frame_sets {
  const result_header *header;
  hid_t *sets; /* [field_count]; negative: could not be made */
  double *times;
  long count;
  mesh_views meshes;
} frame_sets;

/* The path that the field is; NULL of others. */
static mesh_path *path_of(const frame_sets *s, const result_field *f) {
  for (int k = 0; k < s->meshes.path_count; k++)
    if (s->meshes.paths[k].field == f) return &s->meshes.paths[k];
  return NULL;
}

/* How many points of a path there are. */
static bool measure_frame(void *context, int64_t frame, const double *record) {
  const frame_sets *s = context;
  const double *values = record + 1;
  (void)frame;
  for (int k = 0; k < s->header->field_count; k++) {
    const result_field *f = &s->header->fields[k];
    mesh_path *p = path_of(s, f);
    while (p && p->most < f->count && !isnan(values[2 * p->most]))
      p->most++;
    values += numbers_of(f);
  }
  return true;
}

/* "" of a path that the header does not tell of. */
static const char *mesh_of(const result_header *h, const result_field *f) {
  for (int k = 0; k < h->crack_count; k++)
    if (strcmp(h->cracks[k].field, f->name) == 0) return h->cracks[k].mesh;
  return "";
}

static bool is_of_dead_cells(const result_field *f) {
  return !f->interaction && strcmp(f->name, MESH_DEAD_CELLS) == 0;
}

/* Room for the paths, and for which cells have died. A damaged frame leaves a sentence. */
static bool open_paths(const result *r, frame_sets *s, char *error, size_t size) {
  const result_header *h = s->header;
  mesh_views *v = &s->meshes;
  v->paths = must_calloc((size_t)h->field_count + 1, sizeof *v->paths);
  for (int k = 0; k < h->field_count; k++)
    if (result_field_is_path(&h->fields[k]))
      v->paths[v->path_count++] =
          (mesh_path){.field = &h->fields[k], .mesh = mesh_of(h, &h->fields[k]), .most = 1};
  for (int k = 0; k < h->field_count; k++)
    if (is_of_dead_cells(&h->fields[k])) {
      v->particles = h->fields[k].count;
      v->dead = must_calloc((size_t)(v->particles * s->count) + 1, sizeof *v->dead);
    }
  if (v->path_count > 0 && !frame_file_each(r->frames, measure_frame, s, error, size)) return false;
  for (int k = 0; k < v->path_count; k++)
    v->paths[k].points =
        must_calloc(2 * (size_t)(v->paths[k].most * s->count) + 1, sizeof *v->paths[k].points);
  return true;
}

static int shape_of(const frame_sets *s, const result_field *f, hsize_t shape[3]) {
  const mesh_path *p = path_of(s, f);
  shape[0] = (hsize_t)s->count;
  shape[1] = (hsize_t)(p ? p->most : f->count);
  shape[2] = (hsize_t)f->components;
  return f->interaction || result_field_of_cells(f) || result_field_of_stamp(f) ? 2 : 3;
}

/* "/cracks/notch" of "notch/points". */
static bool make_group_of_path(hid_t file, const result_field *f) {
  char name[512];
  snprintf(name, sizeof name, "/cracks/%.*s", (int)(strrchr(f->name, '/') - f->name), f->name);
  return h5_make_group(file, name);
}

static const char *group_of(const result_field *f) {
  return result_field_of_cracks(f)  ? "/cracks"
         : result_field_of_cells(f) ? "/cells"
         : result_field_of_stamp(f) ? "/stamps"
                                    : "/frames";
}

/* "/stamps/hammer" */
static bool make_group_of_stamp(hid_t file, const char *stamp, char *name, size_t size) {
  snprintf(name, size, "/stamps/%s", stamp);
  return h5_make_group(file, "/stamps") && h5_make_group(file, name);
}

static bool write_outlines(hid_t file, const result_header *h) {
  char group[256], name[512];
  bool good = true;
  for (int k = 0; k < h->stamp_count && good; k++) {
    const hsize_t shape[2] = {(hsize_t)h->stamps[k].count, 2};
    good = make_group_of_stamp(file, h->stamps[k].name, group, sizeof group);
    snprintf(name, sizeof name, "%s/outline", group);
    good = good && h5_write_doubles(file, name, h->stamps[k].outline, 2, shape, "m");
  }
  return good;
}

static hid_t make_field(hid_t file, const frame_sets *s, const result_field *f) {
  char name[512];
  hsize_t shape[3];
  if (!h5_make_group(file, group_of(f))) return -1;
  if (result_field_is_path(f) && !make_group_of_path(file, f)) return -1;
  snprintf(name, sizeof name, "%s/%s", group_of(f), f->interaction ? f->interaction : f->name);
  if (f->interaction) {
    if (!h5_make_group(file, name)) return -1;
    snprintf(name, sizeof name, "/frames/%s/%s", f->interaction, f->name);
  }
  if (result_field_of_stamp(f)) {
    char group[256];
    if (!make_group_of_stamp(file, f->name, group, sizeof group)) return -1;
    snprintf(name, sizeof name, "%s/place", group);
  }
  const int rank = shape_of(s, f, shape);
  const hid_t set = h5_make_frames(file, name, rank, shape, f->unit);
  if (set < 0 || (h5_attribute_text(set, "kind", f->kind) &&
                  (!path_of(s, f) || h5_attribute_text(set, "mesh", path_of(s, f)->mesh))))
    return set;
  H5Dclose(set);
  return -1;
}

static bool put_frame(void *context, int64_t frame, const double *record) {
  const frame_sets *s = context;
  const double *values = record + 1;
  bool good = true;
  s->times[frame] = record[0];
  for (int k = 0; good && k < s->header->field_count; k++) {
    const result_field *f = &s->header->fields[k];
    hsize_t shape[3];
    const int rank = shape_of(s, f, shape);
    const mesh_path *p = path_of(s, f);
    if (p) memcpy(p->points + 2 * p->most * frame, values, 2 * (size_t)p->most * sizeof *values);
    if (is_of_dead_cells(f))
      memcpy(s->meshes.dead + s->meshes.particles * frame, values,
             (size_t)s->meshes.particles * sizeof *values);
    good = s->sets[k] >= 0 && h5_write_frame(s->sets[k], (long)frame, rank, shape, values);
    values += numbers_of(f);
  }
  return good;
}

static bool describe_fields(hid_t file, const frame_sets *s) {
  h5_scale times;
  if (!write_times(file, s->header, "/frames/time", "time of the frame", s->times, s->count,
                   &times))
    return false;
  bool good = true;
  for (int k = 0; good && k < s->header->field_count; k++) {
    const result_field *f = &s->header->fields[k];
    hsize_t shape[3];
    good = describe(s->sets[k], shape_of(s, f, shape), &times, f->long_name);
  }
  return h5_scale_end(&times) && good;
}

/* A damaged frame leaves a sentence in `error`, a full disk none. */
static bool write_frames(hid_t file, const result *r, frame_sets *s, char *error, size_t size) {
  const int fields = r->header.field_count;
  bool good = h5_make_group(file, "/frames") && open_paths(r, s, error, size);
  s->sets = must_alloc(((size_t)fields + 1) * sizeof *s->sets);
  for (int k = 0; k < fields; k++) {
    s->sets[k] = good ? make_field(file, s, &s->header->fields[k]) : -1;
    good = s->sets[k] >= 0;
  }
  good = good && frame_file_each(r->frames, put_frame, s, error, size) && describe_fields(file, s);
  for (int k = 0; k < fields; k++)
    if (s->sets[k] >= 0) good = H5Dclose(s->sets[k]) >= 0 && good;
  free(s->sets);
  if (good) mesh_views_find(&s->meshes, s->header, s->count);
  return good;
}

static bool write_attributes(hid_t file, const result_header *h, const result_ending *e) {
  return h5_attribute_text(file, "perilat_version", h->version) &&
         h5_attribute_text(file, "started", h->started) &&
         h5_attribute_text(file, "title", h->title) &&
         h5_attribute_text(file, "deck", h->deck_name ? h->deck_name : "") &&
         h5_attribute_text(file, "kernel_key", h->kernel_key) &&
         h5_attribute_text(file, "compiler", h->compiler ? h->compiler : "") &&
         h5_attribute_text(file, "flags", h->flags ? h->flags : "") &&
         h5_attribute_integer(file, "threads", h->threads) &&
         h5_attribute_text(file, "ended", e->ended ? e->ended : "") &&
         h5_attribute_integer(file, "status", e->status) &&
         h5_attribute_double(file, "wall_seconds", e->seconds) &&
         h5_attribute_double(file, "dt", e->dt) && h5_attribute_integer(file, "steps", e->steps);
}

static bool write_hdf5(const result *r, const result_ending *e, frame_sets *frames,
                       const char *path, char *error, size_t size) {
  const hid_t file = sealed_file_create(path);
  if (file < 0) return false;
  const bool good =
      write_attributes(file, &r->header, e) && write_input(file, &r->header) &&
      (e->said_count == 0 || write_texts(file, "/said", e->said, e->said_count)) &&
      write_particles(file, &r->header) && mesh_views_write_meshes(file, &r->header) &&
      write_outlines(file, &r->header) && write_history(file, &r->header, e) &&
      write_frames(file, r, frames, error, size) && (!e->state || state_write(file, e->state)) &&
      views_write(file, &r->header, &frames->meshes, frames->count);
  if (good) return sealed_file_close(file, path);
  H5Fclose(file);
  return false;
}

static bool write_sidecar(const result *r, const frame_sets *frames, const char *path) {
  FILE *out = fopen(path, "w");
  const bool good =
      out && xdmf_write(out, &r->header, &frames->meshes, frames->times, frames->count);
  return out && fclose(out) == 0 && good;
}

static bool fail(const char *path, char *error, size_t size) {
  if (!error[0])
    snprintf(error, size, "cannot write the result `%s`: %s", path,
             errno ? strerror(errno) : "the HDF5 library refused");
  return false;
}

void result_sidecar(const char *path, char *sidecar, size_t size) {
  const size_t n = strlen(path);
  const bool ends = n > 3 && strcmp(path + n - 3, ".h5") == 0;
  snprintf(sidecar, size, "%.*s.xdmf", (int)(ends ? n - 3 : n), path);
}

/* Both are written before either is put in its place. */
bool result_finish(result *r, const result_ending *e, char *error, size_t size) {
  const char *path = r->header.path;
  frame_sets frames = {.header = &r->header, .count = (long)result_mark(r).count};
  char sidecar_path[WHOLE_FILE_PATH];
  whole_file file, sidecar;
  result_sidecar(path, sidecar_path, sizeof sidecar_path);
  h5_quiet();
  error[0] = 0;
  if (!whole_file_begin(&file, path)) return fail(path, error, size);
  errno = 0; /* the library has no better way of saying that the disk is full */
  frames.times = must_calloc((size_t)frames.count + 1, sizeof *frames.times);
  bool good = write_hdf5(r, e, &frames, file.working, error, size);
  good = good && whole_file_begin(&sidecar, sidecar_path);
  if (good) {
    good = write_sidecar(r, &frames, sidecar.working);
    good = whole_file_end_on_disk(&file, good);
    good = whole_file_end(&sidecar, good);
  } else
    whole_file_end(&file, false);
  free(frames.times);
  mesh_views_free(&frames.meshes);
  return good || fail(path, error, size);
}
