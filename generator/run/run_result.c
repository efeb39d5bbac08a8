#include "generator/run/run_result.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/hash.h"
#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/kernel/version.h"
#include "generator/report/moment.h"
#include "generator/report/report_end.h"
#include "generator/report/resuming.h"
#include "runtime/base/whole_file.h"
#include "runtime/continuum/cells.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/geometry/surface.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/lattice/rows_select.h"
#include "runtime/lattice/shape_matrix.h"
#include "runtime/mesh/node_layout.h"
#include "runtime/result/checkpoint.h"
#include "runtime/result/result_state.h"
#include "runtime/simulation/simulation_save.h"

/* --- paths and fingerprint -------------------------------------------------------------------- */

/* The result stands in the working folder, named by the deck or after it; that of shapes where it
   is asked for. */
void choose_paths(run *r) {
  const char *given = r->options->shapes ? r->options->shapes : r->deck->output.result;
  char path[4096];
  if (given) {
    snprintf(path, sizeof path, "%s", given);
  } else {
    const char *slash = strrchr(r->options->deck_path, '/');
    const char *name = slash ? slash + 1 : r->options->deck_path;
    const char *dot = strrchr(name, '.');
    snprintf(path, sizeof path, "%.*s.h5", dot ? (int)(dot - name) : (int)strlen(name), name);
  }
  char *target =
      realpath(path, NULL); /* through links, so that the data lie where the user has put them */
  const char *chosen = target ? target : path;
  struct stat about;
  if (lstat(path, &about) != 0 || !S_ISLNK(about.st_mode)) chosen = path;
  r->result_path = arena_text(r->memory, chosen, strlen(chosen));
  free(target);
  r->checkpoint_path = arena_printf(r->memory, "%s" CHECKPOINT_ENDING, r->result_path);
}

/* What is in the way of a file that is to be put there; NULL: nothing. */
static const char *obstacle(const char *path) {
  struct stat about;
  if (lstat(path, &about) != 0) return NULL;
  if (S_ISDIR(about.st_mode)) return "a folder";
  if (S_ISLNK(about.st_mode)) return "a link";
  if (!S_ISREG(about.st_mode)) return "not an ordinary file";
  return about.st_mode & 0222 ? NULL : "protected against writing";
}

/* The longest of the names beside the result. */
static bool has_room(const run *r) {
  whole_file probe;
  const bool room = whole_file_begin(&probe, r->checkpoint_path);
  if (room) whole_file_end(&probe, false);
  return room;
}

/* What has named the result, to be told. */
static span namer(const run *r) {
  return r->options->shapes ? (span){0, 0, UINT16_MAX}
                            : deck_where(&r->deck->output.item, "result");
}

/* Hours of computing must not end in a path that cannot be written. */
bool result_can_be_written(run *r) {
  const span where = namer(r);
  char sidecar[WHOLE_FILE_PATH];
  result_sidecar(r->result_path, sidecar, sizeof sidecar);
  const char *slash = strrchr(r->result_path, '/');
  const int folder = slash ? (int)(slash - r->result_path) + 1 : 0;
  if (obstacle(r->result_path))
    diag_report(&r->said, DIAG_FILE, where, "the result `%s` is %s", r->result_path,
                obstacle(r->result_path));
  else if (obstacle(sidecar))
    diag_report(&r->said, DIAG_FILE, where, "`%s`, which belongs to the result, is %s", sidecar,
                obstacle(sidecar));
  else if (!has_room(r))
    diag_report(&r->said, DIAG_FILE, where, "cannot write the result into the folder `%.*s`: %s",
                folder > 0 ? folder : 1, folder > 0 ? r->result_path : ".", strerror(errno));
  else
    return true;
  diag_hint(&r->said, r->options->shapes
                          ? "give another path with -o"
                          : "give `result` another path in &output, or --set output.result=PATH");
  return false;
}

static bool result_spares(run *r, const char *input) {
  if (!same_file(r->result_path, input)) return true;
  diag_report(&r->said, DIAG_FILE, namer(r), "the result would overwrite `%s`", input);
  diag_hint(&r->said, r->options->shapes ? "give it another name with -o"
                                         : "give `result` another name in &output");
  return false;
}

/* Results that the motion at the start is taken from. */
static bool result_spares_starts(run *r, const deck_initial *items, int count) {
  for (int k = 0; k < count; k++)
    if (items[k].value.path && !result_spares(r, items[k].value.path)) return false;
  return true;
}

/* Those that parameters are taken from. */
static bool result_spares_parameters(run *r) {
  for (int k = 0; k < r->deck->material_count; k++)
    for (int n = 0; n < r->deck->materials[k].assignment_count; n++) {
      const deck_placed *by = r->deck->materials[k].assignments[n].placed;
      if (by && by->path && !result_spares(r, by->path)) return false;
    }
  return true;
}

bool result_spares_inputs(run *r) {
  bool good = r->options->deck_text || result_spares(r, r->options->deck_path);
  for (int k = 0; k < r->open_models; k++)
    for (int f = 0; f < r->models[k].sources.count; f++)
      good = good && result_spares(r, r->models[k].sources.items[f].name);
  for (int k = 0; k < r->deck->file_count; k++)
    good = good && result_spares(r, r->sources.items[r->deck->files[k].source].name);
  for (int k = 0; good && k < r->deck->lattice_count; k++) {
    if (!r->deck->lattices[k].file) continue;
    char *particles = deck_file_path(r->deck->name, r->deck->lattices[k].file);
    good = result_spares(r, particles);
    free(particles);
  }
  if (good && r->deck->start.result) good = result_spares(r, r->deck->start.result);
  return good && result_spares_parameters(r) &&
         result_spares_starts(r, r->deck->initial_velocitys, r->deck->initial_velocity_count) &&
         result_spares_starts(r, r->deck->initial_displacements,
                              r->deck->initial_displacement_count);
}

/* That of the compiled kernel, also where the law is interpreted. */
static const char *kernel_key(run *r, int interaction) {
  return r->built_in[interaction] ? r->laws[interaction].law->key
                                  : model_key(r->model_of[interaction]);
}

/* One after the other. */
static const char *all_kernel_keys(run *r) {
  const char *keys = kernel_key(r, 0);
  for (int k = 1; k < r->deck->interaction_count; k++)
    keys = arena_printf(r->memory, "%s %s", keys, kernel_key(r, k));
  return keys;
}

void fingerprint(run *r) {
  char *text = arena_printf(r->memory, "perilat %s\n", perilat_version);
  for (int k = 0; k < run_law_count(r); k++)
    if (r->laws[k].law)
      text = arena_printf(r->memory, "%slaw %s, kernel %s\n", text, r->laws[k].law->name,
                          kernel_key(r, k));
  for (int k = 0; k < r->deck->file_count; k++) { /* a file may have changed */
    const source *s = &r->sources.items[r->deck->files[k].source];
    text = arena_printf(r->memory, "%sfile %s, contents %016" PRIx64 "\n", text,
                        r->deck->files[k].name, hash_more(HASH_START, s->text, s->length));
  }
  text = arena_printf(r->memory, "%s%s", text, r->deck->identity);
  for (int k = 0; k < r->deck->lattice_count; k++) {
    const uint64_t particles = rows_fingerprint(simulation_rows(r->simulation, k));
    if (particles) text = arena_printf(r->memory, "%s\nparticles %016" PRIx64, text, particles);
  }
  for (int k = 0; k < r->deck->interaction_count; k++) {
    const uint64_t values = parameter_planes_fingerprint(simulation_planes(r->simulation, k));
    if (values) text = arena_printf(r->memory, "%s\nparameters %016" PRIx64, text, values);
  }
  const uint64_t from = simulation_started_from(r->simulation);
  if (from) text = arena_printf(r->memory, "%s\nstart %016" PRIx64, text, from);
  r->fingerprint = text;
}

/* --- result ----------------------------------------------------------------------------------- */

/* What has the law of that number: an interaction or, behind these, a crack. */
static const char *law_owner(const run *r, int number) {
  const int interactions = r->deck->interaction_count;
  return number < interactions ? r->deck->interactions[number].name
                               : r->deck->cracks[number - interactions].name;
}

/* Two interactions may have one law: its text is kept once. Kernels of one law for other lattices
   differ. */
static const char *text_name(run *r, const result_text *texts, int before, const char *text,
                             int number) {
  const char *name = r->laws[number].law->name;
  for (int k = 0; k < before; k++)
    if (strcmp(texts[k].name, name) == 0 && strcmp(texts[k].text, text) != 0)
      return arena_printf(r->memory, "%s.%s", name, law_owner(r, number));
  return name;
}

static result_text *collect_texts(run *r, bool c_text, int *count) {
  result_text *texts = arena_alloc(r->memory, (size_t)run_law_count(r) * sizeof *texts);
  *count = 0;
  for (int k = 0; k < run_law_count(r); k++) {
    const built_in_law *b = r->built_in[k];
    model *m = b ? NULL : r->model_of[k];
    result_text *t = &texts[*count];
    if (!r->laws[k].law) continue;
    if (b)
      t->text = c_text ? b->c_text : b->law_text;
    else
      t->text = c_text ? model_c_text(m) : m->sources.items[0].text;
    t->name = text_name(r, texts, *count, t->text, k);
    ++*count;
  }
  return texts;
}

/* A name in HDF5 has no slash. */
static result_text *collect_files(run *r) {
  result_text *texts = arena_alloc(r->memory, (size_t)r->deck->file_count * sizeof *texts);
  for (int k = 0; k < r->deck->file_count; k++) {
    const deck_file *f = &r->deck->files[k];
    char *name = arena_text(r->memory, f->name, strlen(f->name));
    for (char *c = name; *c; c++)
      if (*c == '/') *c = ':';
    texts[k] = (result_text){name, r->sources.items[f->source].text};
  }
  return texts;
}

typedef struct particle_arrays { /* of all bodies, one after the other */
  double *reference, *volume, *spacing;
  int32_t *body, *resolved;
} particle_arrays;

static void put_particles(const run *r, int lattice, particle_arrays at) {
  const rows *w = simulation_rows(r->simulation, lattice);
  const size_t dimensions = (size_t)w->dimensions, n = (size_t)w->particle_count;
  for (size_t p = 0; p < n; p++) {
    double here[3];
    rows_place(w, w->particle_site[p], here);
    memcpy(at.reference + dimensions * p, here, dimensions * sizeof *here);
    at.volume[p] = w->site_volume ? w->site_volume[w->particle_site[p]] : w->volume;
    at.spacing[p] = rows_spacing(w, w->particle_site[p]);
    at.resolved[p] = 1;
  }
  if (deck_lattice_is_bar(&r->deck->lattices[lattice]))
    memset(at.body, -1, n * sizeof *at.body); /* of none */
  else
    rows_bodies(w, r->deck, lattice, at.body);
  if (w->list) shape_unresolved(w, at.resolved);
}

/* Those of a link are others'. */
static size_t own_particles(const run *r, int lattice) {
  const rows *w = simulation_rows(r->simulation, lattice);
  return w->copies ? 0 : (size_t)w->particle_count;
}

static void particle_table(run *r, result_header *h) {
  const int bodies = simulation_bodies(r->simulation);
  bool irregular = false, graded = false;
  h->dimensions = simulation_rows(r->simulation, 0)->dimensions;
  for (int b = 0; b < bodies; b++) {
    h->particle_count += (long)own_particles(r, b);
    graded = graded || simulation_rows(r->simulation, b)->own_size;
    irregular = irregular || (own_particles(r, b) > 0 && simulation_rows(r->simulation, b)->list &&
                              !deck_lattice_is_bar(&r->deck->lattices[b]));
  }
  const size_t n = (size_t)h->particle_count, dimensions = (size_t)h->dimensions;
  const particle_arrays all = {
      arena_alloc(r->memory, dimensions * n * sizeof(double)),
      arena_alloc(r->memory, n * sizeof(double)), arena_alloc(r->memory, n * sizeof(double)),
      arena_alloc(r->memory, n * sizeof(int32_t)), arena_alloc(r->memory, n * sizeof(int32_t))};
  size_t first = 0;
  for (int b = 0; b < bodies; b++) {
    if (own_particles(r, b) > 0)
      put_particles(r, b,
                    (particle_arrays){all.reference + dimensions * first, all.volume + first,
                                      all.spacing + first, all.body + first, all.resolved + first});
    first += own_particles(r, b);
  }
  h->reference = all.reference;
  h->volume = all.volume;
  h->spacing = graded ? all.spacing : NULL;
  h->body = all.body;
  h->resolved = irregular ? all.resolved : NULL;
}

/* A particle in the result; first[lattice]: the first one of each. For a place between several
   stands the nearest. */
static int32_t number_of(const rows *w, int32_t particle, int lattice, const int32_t *first) {
  const rows_copy *copy = w->copies ? &w->copies[particle] : NULL;
  return copy ? first[copy->lattice] + copy->particle[0] : first[lattice] + particle;
}

static const int32_t *pairs_of(run *r, int interaction, const int32_t *first) {
  const int lattice = r->deck->interactions[interaction].lattice;
  const rows *w = simulation_law_rows(r->simulation, interaction),
             *of = simulation_rows(r->simulation, lattice);
  rows_bond *bonds = rows_bonds(w);
  int32_t *pairs = arena_alloc(r->memory, 2 * (size_t)w->bond_count * sizeof *pairs);
  for (long m = 0; m < w->bond_count; m++) {
    pairs[2 * m] = number_of(of, bonds[m].i, lattice, first);
    pairs[2 * m + 1] = number_of(of, bonds[m].j, lattice, first);
  }
  free(bonds);
  return pairs;
}

static void bond_table(run *r, result_header *h) {
  const int bodies = simulation_bodies(r->simulation);
  int32_t *first = arena_alloc(r->memory, ((size_t)bodies + 1) * sizeof *first);
  first[0] = 0;
  for (int b = 0; b < bodies; b++)
    first[b + 1] = first[b] + (int32_t)own_particles(r, b);
  h->interaction_count = r->deck->interaction_count;
  result_bonds *bonds = arena_alloc(r->memory, (size_t)h->interaction_count * sizeof *bonds);
  for (int b = 0; b < h->interaction_count; b++)
    bonds[b] =
        (result_bonds){r->deck->interactions[b].name,
                       simulation_law_rows(r->simulation, b)->bond_count, pairs_of(r, b, first)};
  h->bonds = bonds;
}

/* The nodes of a cell as particles of its mesh, corners counter-clockwise, behind the last -1. */
static void corners_of(const cells *c, int cell, int columns, int32_t *around) {
  int node[ELEMENT_MOST_NODES];
  const int count = mesh_cell_nodes(&c->mesh, cell, node);
  for (int k = 0; k < columns; k++)
    around[k] = k < count ? cells_particle(c, node[k]) : -1;
}

/* 4, or as many as the cell with the most nodes has. */
static int columns_of(const mesh *m) {
  int node[ELEMENT_MOST_NODES], most = m->lists ? 3 : 4;
  for (int c = 0; c < mesh_cell_count(m) && m->lists; c++) {
    const int count = mesh_cell_nodes(m, c, node);
    if (count > most) most = count;
  }
  return most;
}

/* Its cells but those that are not there as a whole. */
static result_mesh mesh_of(run *r, int number, const cells *of_mesh, long first_particle) {
  const mesh *m = &of_mesh->mesh;
  const size_t most = (size_t)mesh_cell_count(m);
  const rows *w = simulation_rows(r->simulation, number);
  const int columns = columns_of(m);
  int32_t *corners = arena_alloc(r->memory, (size_t)columns * most * sizeof *corners),
          *method = arena_alloc(r->memory, most * sizeof *method);
  long count = 0;
  for (int c = 0; c < mesh_cell_count(m); c++) {
    if (!cells_whole(of_mesh, c)) continue;
    corners_of(of_mesh, c, columns, corners + columns * count);
    method[count++] = (int32_t)m->cell[c];
  }
  const gmsh_mesh *of = r->deck->lattices[number].gmsh;
  return (result_mesh){.name = r->deck->lattices[number].name,
                       .node_numbers = of ? of->tag : NULL,
                       .cell_numbers = of ? of->cell_tag : NULL,
                       .first_particle = first_particle,
                       .node_count = w->particle_count,
                       .cell_count = count,
                       .columns = columns,
                       .cells = corners,
                       .method = method,
                       .thickness = m->thickness};
}

static void mesh_table(run *r, result_header *h) {
  const int bodies = simulation_bodies(r->simulation);
  result_mesh *meshes = arena_alloc(r->memory, (size_t)bodies * sizeof *meshes);
  long first = 0;
  for (int b = 0; b < bodies; b++) {
    const cells *c = simulation_cells(r->simulation, b);
    if (c) meshes[h->mesh_count++] = mesh_of(r, b, c, first);
    first += (long)own_particles(r, b);
  }
  h->meshes = meshes;
}

/* What a law says may take several lines. */
static const char *one_line(const run *r, const char *words) {
  char *line = arena_text(r->memory, words, strlen(words));
  for (char *at = line; (at = strchr(at, '\n')); at++)
    *at = ' ';
  return line;
}

/* Outlines of stamps in the plane. */
static void stamp_table(run *r, result_header *h) {
  const deck *k = r->deck;
  result_stamp *stamps = arena_alloc(r->memory, ((size_t)k->stamp_count + 1) * sizeof *stamps);
  for (int n = 0; n < k->stamp_count && h->dimensions == 2; n++) {
    double(*points)[2] = arena_alloc(r->memory, SURFACE_OUTLINE * sizeof *points);
    surface of;
    if (!surface_open(&k->stamps[n].shape, &of)) continue;
    const int count = surface_outline(&of, points);
    stamps[h->stamp_count++] = (result_stamp){k->stamps[n].name, *points, count};
  }
  h->stamps = stamps;
}

/* Fields of the frames, as the simulation offers them. */
static void frame_table(run *r, result_header *h) {
  const frame_field *offered;
  h->field_count = simulation_frame_fields(r->simulation, &offered);
  result_field *fields = arena_alloc(r->memory, (size_t)h->field_count * sizeof *fields);
  result_crack *cracks = arena_alloc(r->memory, (size_t)h->field_count * sizeof *cracks);
  for (int k = 0; k < h->field_count; k++) {
    const frame_field *f = &offered[k];
    fields[k] = (result_field){f->name,
                               f->unit,
                               f->on_bonds ? h->bonds[f->interaction].name : NULL,
                               f->components,
                               f->count,
                               f->on_cells ? "cells" : f->kind,
                               one_line(r, f->long_name)};
    if (f->mesh) cracks[h->crack_count++] = (result_crack){f->name, f->mesh};
  }
  h->fields = fields;
  h->cracks = cracks;
}

/* What made the kernels: now, when the solver was built, or nothing. */
static void name_compiler(run *r, result_header *h) {
  char version[512];
  const built_in_law *b = r->built_in[0];
  if (b)
    h->compiler = b->compiler, h->flags = b->flags;
  else if (r->model_of[0]->loaded.law) {
    toolchain_version(version, sizeof version);
    h->compiler = arena_text(r->memory, version, strlen(version));
    h->flags = arena_printf(r->memory, "%s", toolchain_flags());
  } else
    h->compiler = "none: the law was interpreted", h->flags = "";
}

static char *list_overrides(run *r) {
  char *text = arena_text(r->memory, "", 0);
  for (int k = 0; k < r->options->override_count; k++)
    text = arena_printf(r->memory, "%s%s\n", text, r->options->overrides[k].text);
  return text;
}

result_header describe_result(run *r) {
  result_header h = {.path = r->result_path,
                     .fingerprint = r->fingerprint,
                     .title = r->deck->simulation.title ? r->deck->simulation.title : "",
                     .started = r->started,
                     .version = perilat_version,
                     .kernel_key = all_kernel_keys(r),
                     .threads = simulation_threads(r->simulation),
                     .deck_name = r->options->deck_path,
                     .deck_text = r->sources.items[0].text,
                     .overrides = list_overrides(r)};
  h.models = collect_texts(r, false, &h.model_count);
  h.kernels = collect_texts(r, true, &h.kernel_count);
  h.files = collect_files(r);
  h.file_count = r->deck->file_count;
  name_compiler(r, &h);
  particle_table(r, &h);
  bond_table(r, &h);
  mesh_table(r, &h);
  stamp_table(r, &h);
  return h;
}

bool open_described(run *r, const result_header *h) {
  char error[ERROR_LENGTH];
  r->result = result_open(h, r->options->resume, error, sizeof error);
  if (!r->result) {
    say_error("%s", error);
    return false;
  }
  whole_file_clear(r->checkpoint_path);
  size_t total = 0;
  for (int k = 0; k < h->field_count; k++)
    total += (size_t)(h->fields[k].count * h->fields[k].components);
  r->frame_buffer = must_alloc((total + 1) * sizeof(double));
  return true;
}

bool open_result(run *r) {
  result_header h = describe_result(r);
  frame_table(r, &h);
  return open_described(r, &h);
}

/* Its frames are about to go. */
static bool give_up_checkpoint(const run *r) {
  if (unlink(r->checkpoint_path) == 0)
    fprintf(stderr, "perilat: warning: this run starts anew; `%s` of an earlier one is given up\n",
            r->checkpoint_path);
  else if (errno != ENOENT) {
    say_error("cannot remove `%s` of an earlier run: %s", r->checkpoint_path, strerror(errno));
    return false;
  }
  return true;
}

bool begin_anew(run *r) {
  char error[ERROR_LENGTH];
  if (!give_up_checkpoint(r)) return false;
  if (result_begin(r->result, error, sizeof error)) return true;
  say_error("%s", error);
  result_discard(r->result);
  return false;
}

static void keep(run *r) {
  r->is_kept = true;
  r->kept_time = simulation_time(r->simulation);
}

bool resume(run *r) {
  char error[ERROR_LENGTH];
  frame_mark frames;
  if (!simulation_restore(r->simulation, r->checkpoint_path, r->fingerprint, &frames, error,
                          sizeof error)) {
    say_error("cannot resume: %s", error);
    print_misfit(r);
    return false;
  }
  if (!result_resume(r->result, &frames, error, sizeof error)) {
    say_error("cannot resume: %s", error);
    return false;
  }
  char text[MOMENT_TEXT];
  printf("resumed at %s (step %ld)\n", moment(r, simulation_time(r->simulation), text),
         simulation_step_done(r->simulation));
  fflush(stdout);
  keep(r);
  return true;
}

bool write_frame(run *r) {
  const frame_field *fields;
  int count = simulation_frame_fields(r->simulation, &fields);
  const double **values = must_alloc((size_t)(count + 1) * sizeof *values);
  double *at = r->frame_buffer;
  for (int k = 0; k < count; k++) {
    values[k] = at;
    simulation_frame_values(r->simulation, k, at);
    at += fields[k].count * fields[k].components;
  }
  char error[ERROR_LENGTH];
  bool good = result_frame(r->result, simulation_time(r->simulation), values, error, sizeof error);
  free(values);
  if (good)
    simulation_frame_taken(r->simulation);
  else /* a resumed run takes it again */
    say_error("%s", error);
  return good;
}

bool write_checkpoint(run *r) {
  char error[ERROR_LENGTH];
  const frame_mark frames = result_mark(r->result);
  bool good = result_sync(r->result, error, sizeof error) &&
              simulation_save(r->simulation, r->checkpoint_path, r->fingerprint, &frames, error,
                              sizeof error);
  if (good)
    keep(r);
  else
    say_error("no checkpoint was written: %s", error);
  return good;
}

bool can_go_on(const run *r) {
  return r->is_kept && result_frames_hold(r->result);
}

/* The frames go last: the lock on them is on the checkpoint, too. */
void remove_remains(run *r) {
  unlink(r->checkpoint_path);
  result_discard(r->result);
}

/* What the run said, but for nothing. */
static int list_said(run *r, const terminal_record *said, result_text texts[3]) {
  const char *warnings =
      arena_printf(r->memory, "%s%s", r->said_warnings ? r->said_warnings : "", said->texts[1]);
  const result_text all[] = {{"begin", r->said_begin ? r->said_begin : ""},
                             {"end", said->texts[0]},
                             {"warnings", warnings}};
  int count = 0;
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    if (*all[k].text) texts[count++] = all[k];
  return count;
}

bool finish_result(run *r, const run_end *end, const terminal_record *said) {
  result_text texts[3];
  const int count = simulation_series_count(r->simulation);
  result_series *series = arena_alloc(r->memory, (size_t)count * sizeof *series);
  char ended[512], error[ERROR_LENGTH];
  for (int k = 0; k < count; k++) {
    series[k] = (result_series){.judges = false};
    series[k].judges = simulation_judges(r->simulation, k, &series[k].unchecked);
    series[k].name = simulation_series(r->simulation, k, &series[k].unit, &series[k].values);
    series[k].long_name = one_line(r, simulation_series_words(r->simulation, k, r->memory));
  }
  describe_end(r, end, ended, sizeof ended);
  result_ending e = {.ended = ended,
                     .status = end->exit_status,
                     .seconds = end->seconds,
                     .dt = simulation_step_limit(r->simulation)->step,
                     .steps = simulation_steps_taken(r->simulation),
                     .series = series,
                     .series_count = count};
  e.said = texts;
  e.said_count = list_said(r, said, texts);
  e.history_count = simulation_history(r->simulation, &e.time);
  result_state *state = r->deck->output.state ? simulation_take_state(r->simulation) : NULL;
  e.state = state;
  const bool good = result_finish(r->result, &e, error, sizeof error);
  result_state_free(state);
  if (!good) say_error("%s", error);
  return good;
}
