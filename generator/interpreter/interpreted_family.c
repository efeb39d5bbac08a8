#include "generator/interpreter/interpreted_family.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/interpret.h"
#include "generator/lower/kinematics.h"
#include "generator/plan/program_facts.h"

enum { LANES = FAMILY_CHUNK, MOST_NEIGHBOURS = 2 * PL_MAX_DIRECTIONS };
_Static_assert(FAMILY_CHUNK == INTERPRET_LANES, "a chunk is what the interpreter takes at a time");

struct family_runner {
  const kernel_plan *plan;
  arena *memory;
  interpreter ***run[RUN_PROGRAMS]; /* [program][pass][segment] */
  const double **parameters, **bond_parameters, **particle_parameters, **neighbour_parameters,
      **fields, **new_fields, **neighbour_fields, **links, **neighbour_links, **bond_links,
      **neighbour_bond_links, **shared, **shared_odd, **slots, **planes, *shape[PL_SHAPE_PLANES(3)],
      *ends[ENDS_COUNT];
  double *slot;  /* [slots][LANES] */
  double *plane; /* [planes][MOST_NEIGHBOURS][LANES] */
  double held[2][LANES];
  /* [2 links of bonds][LANES] shared values as the far end has them, when their sign differs */
  double *opposite;
  double *gathered; /* [most][LANES] values of neighbours, on lists */
  int gathered_count;
  double *results, **result; /* [most roots][LANES] */
  unsigned char *ones, ends_stride[ENDS_COUNT];
};

static const family_program *program_of(const kernel_plan *p, int which) {
  const family_program *programs[RUN_PROGRAMS] = {&p->step, &p->losses, &p->observe};
  return programs[which];
}

/* --- making ----------------------------------------------------------------------------------- */

static int larger(int a, int b) {
  return a > b ? a : b;
}

static interpreter *segment_interpreter(family_runner *r, const segment *a, const ir_node *inputs) {
  const kernel_plan *p = r->plan;
  ir_node *nodes = must_alloc((2 * (size_t)a->root_count + 1) * sizeof *nodes);
  const int count = segment_nodes(p->graph, a, nodes);
  ir_substitute(p->graph, nodes, count, p->uniforms, inputs, p->uniform_count, nodes);
  interpreter *made = interpreter_new(p->graph, nodes, count);
  free(nodes);
  return made;
}

static void make_interpreters(family_runner *r, const ir_node *inputs, int *slots, int *planes,
                              int *roots) {
  for (int which = 0; which < RUN_PROGRAMS; which++) {
    const family_program *q = program_of(r->plan, which);
    r->run[which] = arena_alloc(r->memory, ((size_t)q->pass_count + 1) * sizeof(interpreter **));
    for (int k = 0; k < q->pass_count; k++) {
      const family_pass *now = &q->passes[k];
      *slots = larger(*slots, now->slot_count);
      *planes = larger(*planes, now->plane_count);
      r->run[which][k] =
          arena_alloc(r->memory, ((size_t)now->segment_count + 1) * sizeof(interpreter *));
      for (int s = 0; s < now->segment_count; s++) {
        r->run[which][k][s] = segment_interpreter(r, &now->segments[s], inputs);
        *roots = larger(*roots, 2 * now->segments[s].root_count);
      }
    }
  }
}

static const double **pointers(family_runner *r, int count) {
  return arena_alloc(r->memory, ((size_t)count + 1) * sizeof(double *));
}

family_runner *family_runner_new(const kernel_plan *p, const ir_node *inputs) {
  family_runner *r = must_calloc(1, sizeof *r);
  int slots = 0, planes = 0, roots = 0, fields = p->law->fields.count;
  r->plan = p;
  r->memory = arena_new();
  make_interpreters(r, inputs, &slots, &planes, &roots);
  r->parameters = pointers(r, p->law->parameters.count + p->uniform_count);
  r->bond_parameters = pointers(r, p->variation.varying_count);
  r->particle_parameters = pointers(r, p->variation.varying_count);
  r->neighbour_parameters = pointers(r, p->variation.varying_count);
  r->fields = pointers(r, fields);
  r->new_fields = pointers(r, fields);
  r->neighbour_fields = pointers(r, fields);
  r->links = pointers(r, p->links.of_particles);
  r->neighbour_links = pointers(r, p->links.of_particles);
  r->bond_links = pointers(r, p->links.of_bonds);
  r->neighbour_bond_links = pointers(r, p->links.of_bonds);
  r->shared = pointers(r, 2 * p->links.of_bonds);
  r->shared_odd = pointers(r, 2 * p->links.of_bonds);
  r->opposite = must_calloc((size_t)(2 * p->links.of_bonds) * LANES + 1, sizeof(double));
  r->slots = pointers(r, slots);
  r->planes = pointers(r, planes);
  r->slot = must_calloc((size_t)slots * LANES + 1, sizeof(double));
  r->plane = must_calloc((size_t)planes * MOST_NEIGHBOURS * LANES + 1, sizeof(double));
  r->gathered = must_calloc((size_t)(p->links.of_particles + 3 * p->links.of_bonds + fields +
                                     p->variation.varying_count + ENDS_COUNT) *
                                LANES,
                            sizeof(double));
  r->results = must_calloc((size_t)roots * LANES + 1, sizeof(double));
  r->result = arena_alloc(r->memory, ((size_t)roots + 1) * sizeof(double *));
  for (int k = 0; k < roots; k++)
    r->result[k] = r->results + (size_t)k * LANES;
  for (int k = 0; k < slots; k++)
    r->slots[k] = r->slot + (size_t)k * LANES;
  const int most = larger(larger(larger(fields, p->variation.varying_count),
                                 larger(p->links.of_particles, 2 * p->links.of_bonds)),
                          larger(slots, larger(planes, PL_SHAPE_PLANES(3))));
  r->ones = arena_alloc(r->memory, (size_t)most + 1);
  memset(r->ones, 1, (size_t)most + 1);
  memset(r->ends_stride, 1, sizeof r->ends_stride);
  r->ends_stride[ENDS_TIME_STEP] = 0;
  return r;
}

void family_runner_free(family_runner *r) {
  if (!r) return;
  for (int which = 0; which < RUN_PROGRAMS; which++) {
    const family_program *q = program_of(r->plan, which);
    for (int k = 0; k < q->pass_count; k++)
      for (int s = 0; s < q->passes[k].segment_count; s++)
        interpreter_free(r->run[which][k][s]);
  }
  free(r->slot);
  free(r->plane);
  free(r->gathered);
  free(r->opposite);
  free(r->results);
  arena_free(r->memory);
  free(r);
}

/* --- inputs ----------------------------------------------------------------------------------- */

static bool is_of_particle(const family_runner *r, int field) {
  return r->plan->law->fields.items[field]->place <= ON_PARTICLE;
}

/* What a segment of the particles reads: neighbours are not touched. */
static void point_at_particles(family_runner *r, const pl_family *f, long first) {
  for (int k = 0; k < r->plan->links.of_particles; k++)
    r->links[k] = f->link[k] + first;
  for (int k = 0; k < r->plan->law->fields.count; k++)
    r->fields[k] = f->old_field[k] + first;
  for (int k = 0; k < r->plan->variation.varying_count; k++)
    r->particle_parameters[k] = f->parameter[k] + first;
  for (int k = 0; r->plan->reads_shape && k < PL_SHAPE_PLANES(r->plan->dimensions); k++)
    r->shape[k] = f->shape[k] + first;
  for (int k = 0; k < ENDS_COUNT; k++) {
    const ends_origin *o = &ends_origins[k];
    if (o->owner != OF_I || o->component >= r->plan->dof) continue;
    if (o->array == FROM_DISPLACEMENT) r->ends[k] = f->displacement[o->component] + first;
    if (o->array == FROM_VELOCITY) r->ends[k] = f->velocity[o->component] + first;
  }
  for (long q = 0; q < LANES && first + q < f->count; q++)
    r->held[0][q] = f->held[first + q] ? 1 : 0;
  r->ends[ENDS_HELD_I] = r->held[0];
  if (r->plan->reads_share) r->ends[ENDS_SHARE_I] = f->share + first;
  if (f->volume) r->ends[ENDS_VOLUME_I] = f->volume + first;
  if (f->mass) r->ends[ENDS_MASS_I] = f->mass + first;
  r->ends[ENDS_TIME_STEP] = &f->time_step;
}

/* Where the values of neighbour k of the chunk's particles stand, given where those of the run's
   particles begin: on rows further along the same array, on lists gathered into the next buffer. */
static const double *at_offset(family_runner *r, const pl_family *f, const double *values,
                               long first, long k, const long *offset) {
  if (!f->neighbour) return values + first + offset[k];
  const int32_t *to = f->neighbour + k * f->plane + first;
  double *buffer = r->gathered + (size_t)r->gathered_count++ * LANES;
  for (long q = 0; q < LANES && first + q < f->count; q++)
    buffer[q] = values[first + q + to[q]];
  return buffer;
}

static const double *at_neighbours(family_runner *r, const pl_family *f, const double *values,
                                   long first, long k) {
  return at_offset(r, f, values, first, k, f->offset);
}

/* The same of links. */
static const double *at_links(family_runner *r, const pl_family *f, const double *values,
                              long first, long k) {
  return at_offset(r, f, values, first, k, f->link_offset);
}

static void point_at_motion(family_runner *r, const pl_family *f, long first, long k) {
  for (int e = 0; e < ENDS_COUNT; e++) {
    const ends_origin *o = &ends_origins[e];
    if (o->owner != OF_J || o->component >= r->plan->dof) continue;
    if (o->array == FROM_DISPLACEMENT)
      r->ends[e] = at_neighbours(r, f, f->displacement[o->component], first, k);
    if (o->array == FROM_VELOCITY)
      r->ends[e] = at_neighbours(r, f, f->velocity[o->component], first, k);
  }
  for (long q = 0; q < LANES && first + q < f->count; q++) {
    const long to = f->neighbour ? f->neighbour[k * f->plane + first + q] : f->offset[k];
    r->held[1][q] = f->held[first + q + to] ? 1 : 0;
  }
  r->ends[ENDS_HELD_J] = r->held[1];
}

static double *shared_plane(const pl_family *f, int index, long owned) {
  const shared_place at = program_shared_place(index);
  return f->bond_link[at.link] + (owned + (at.upper ? f->neighbours / 2 : 0)) * f->link_plane;
}

/* What the owner of the bond has left. At the end of a block another one may be writing zeros over
   zeros where no site is. */
static void point_at_shared(family_runner *r, const pl_family *f, long first, long k) {
  const long half = f->neighbours / 2;
  for (int n = 0; n < 2 * r->plan->links.of_bonds; n++) {
    double *opposite = r->opposite + (size_t)n * LANES;
    r->shared[n] = k < half ? shared_plane(f, n, k) + first
                            : at_links(r, f, shared_plane(f, n, k - half), first, k);
    for (long q = 0; k >= half && q < LANES && first + q < f->count; q++)
      opposite[q] = -r->shared[n][q];
    r->shared_odd[n] = k < half ? r->shared[n] : opposite;
  }
}

static void point_at_list(family_runner *r, const pl_family *f, long first, long k) {
  static const ends_input chord[] = {ENDS_CHORD_X, ENDS_CHORD_Y, ENDS_CHORD_Z};
  for (int d = 0; d < r->plan->dimensions; d++)
    r->ends[chord[d]] = f->chord[d] + k * f->plane + first;
  r->ends[ENDS_REFERENCE_LENGTH] = f->length + k * f->plane + first;
  r->ends[ENDS_VOLUME_J] = at_neighbours(r, f, f->volume, first, k);
}

/* On bonds each neighbour has a plane. */
static void point_at_parameters(family_runner *r, const pl_family *f, long first, long k) {
  const bool on_bonds = r->plan->law->tree->law != LAW_STATE;
  for (int n = 0; n < r->plan->variation.varying_count; n++)
    if (on_bonds)
      r->bond_parameters[n] = f->parameter[n] + k * f->plane + first;
    else
      r->neighbour_parameters[n] = at_neighbours(r, f, f->parameter[n], first, k);
  if (f->mass) r->ends[ENDS_MASS_J] = at_neighbours(r, f, f->mass, first, k);
  if (r->plan->reads_share) r->ends[ENDS_SHARE_J] = at_neighbours(r, f, f->share, first, k);
}

static void point_at_neighbour(family_runner *r, const pl_family *f, long first, long k,
                               const double *uniforms) {
  const long half = f->neighbours / 2, back = k < half ? k + half : k - half;
  const kernel_plan *p = r->plan;
  const int parameters = p->law->parameters.count;
  r->gathered_count = 0;
  for (int u = 0; u < p->uniform_count && !f->neighbour; u++)
    r->parameters[parameters + u] = uniforms + k * p->uniform_count + u;
  for (int n = 0; n < p->links.of_particles; n++)
    r->neighbour_links[n] = at_links(r, f, f->link[n], first, k);
  for (int n = 0; n < p->links.of_bonds; n++) {
    r->bond_links[n] = f->bond_link[n] + first + k * f->link_plane;
    r->neighbour_bond_links[n] = at_links(r, f, f->bond_link[n] + back * f->link_plane, first, k);
  }
  for (int n = 0; n < p->law->fields.count; n++) {
    const long plane = is_of_particle(r, n) ? 0 : f->plane;
    r->fields[n] = f->old_field[n] + first + k * plane;
    if (f->new_field)
      r->new_fields[n] = f->new_field[n] + first + (is_of_particle(r, n) ? 0 : k * f->new_plane);
    r->neighbour_fields[n] = at_neighbours(r, f, f->old_field[n] + back * plane, first, k);
  }
  point_at_parameters(r, f, first, k);
  point_at_shared(r, f, first, k);
  point_at_motion(r, f, first, k);
  if (f->neighbour) point_at_list(r, f, first, k);
}

static void point_at_planes(family_runner *r, const family_pass *now, long k) {
  for (int n = 0; n < now->plane_count; n++)
    r->planes[n] = r->plane + ((size_t)n * MOST_NEIGHBOURS + (size_t)k) * LANES;
}

static interpreter_inputs inputs_of(const family_runner *r) {
  return (interpreter_inputs){.values = {[IR_FROM_PARAMETER] = r->parameters,
                                         [IR_FROM_BOND_PARAMETER] = r->bond_parameters,
                                         [IR_FROM_PARTICLE_PARAMETER] = r->particle_parameters,
                                         [IR_FROM_NEIGHBOUR_PARAMETER] = r->neighbour_parameters,
                                         [IR_FROM_FIELD] = r->fields,
                                         [IR_FROM_ENDS] = r->ends,
                                         [IR_FROM_SHAPE] = r->shape,
                                         [IR_FROM_NEIGHBOUR_FIELD] = r->neighbour_fields,
                                         [IR_FROM_LINK] = r->links,
                                         [IR_FROM_NEIGHBOUR_LINK] = r->neighbour_links,
                                         [IR_FROM_BOND_LINK] = r->bond_links,
                                         [IR_FROM_NEIGHBOUR_BOND_LINK] = r->neighbour_bond_links,
                                         [IR_FROM_SHARED] = r->shared,
                                         [IR_FROM_SHARED_ODD] = r->shared_odd,
                                         [IR_FROM_NEW_FIELD] = r->new_fields,
                                         [IR_FROM_SLOT] = r->slots,
                                         [IR_FROM_PLANE] = r->planes},
                              .stride = {[IR_FROM_BOND_PARAMETER] = r->ones,
                                         [IR_FROM_PARTICLE_PARAMETER] = r->ones,
                                         [IR_FROM_NEIGHBOUR_PARAMETER] = r->ones,
                                         [IR_FROM_FIELD] = r->ones,
                                         [IR_FROM_ENDS] = r->ends_stride,
                                         [IR_FROM_SHAPE] = r->ones,
                                         [IR_FROM_NEIGHBOUR_FIELD] = r->ones,
                                         [IR_FROM_LINK] = r->ones,
                                         [IR_FROM_NEIGHBOUR_LINK] = r->ones,
                                         [IR_FROM_BOND_LINK] = r->ones,
                                         [IR_FROM_NEIGHBOUR_BOND_LINK] = r->ones,
                                         [IR_FROM_SHARED] = r->ones,
                                         [IR_FROM_SHARED_ODD] = r->ones,
                                         [IR_FROM_NEW_FIELD] = r->ones,
                                         [IR_FROM_SLOT] = r->ones,
                                         [IR_FROM_PLANE] = r->ones}};
}

/* --- outputs ---------------------------------------------------------------------------------- */

static double *target_of(family_runner *r, const segment_root *root, const pl_family *f, long first,
                         long k) {
  switch (root->target) {
  case TO_LINK:
    return f->link[root->index] + first;
  case TO_BOND_LINK:
    return f->bond_link[root->index] + first + k * f->link_plane;
  case TO_SHARED:
    return shared_plane(f, root->index, k) + first;
  case TO_PARTICLE_FIELD:
    return f->new_field[root->index] + first;
  case TO_PARTICLE_FORCE:
    return f->force[root->index] + first;
  case TO_PARTICLE_LOST:
    return f->lost[root->index] + first;
  case TO_PARTICLE_OBSERVED:
    return f->observed[root->index] + first;
  case TO_NEIGHBOUR_FIELD:
    return f->new_field[root->index] + first + k * f->new_plane;
  case TO_NEIGHBOUR_OBSERVED:
    return f->observed[root->index] + first + k * f->new_plane;
  case TO_PLANE:
    return r->plane + ((size_t)root->index * MOST_NEIGHBOURS + (size_t)k) * LANES;
  default:
    return r->slot + (size_t)root->index * LANES;
  }
}

static bool is_present(const pl_family *f, long first, long k, long q) {
  if (f->neighbour && k >= f->neighbours / 2)
    return f->incoming[first + q] >> (k - f->neighbours / 2) & 1;
  const long half = f->neighbours / 2, to = k < half ? 0 : f->offset[k];
  return f->bonds[first + to + q] >> (k < half ? k : k - half) & 1;
}

/* `factor` NULL unless the root fuses. */
static void store(family_runner *r, const segment_root *root, const double *value,
                  const double *factor, const pl_family *f, long first, long k, long lanes) {
  double *to = target_of(r, root, f, first, k);
  const bool asks = segment_asks(root);
  for (long q = 0; q < lanes; q++) {
    const bool present = !asks || is_present(f, first, k, q);
    switch (root->target) {
    case TO_SUM:
      if (factor)
        to[q] = present ? pl_fma(value[q], factor[q], to[q]) : to[q];
      else
        to[q] += present ? value[q] : 0;
      break;
    case TO_PARTICLE_LOST:
      to[q] += value[q];
      break;
    case TO_LARGEST:
      to[q] = present ? pl_max(to[q], value[q]) : to[q];
      break;
    case TO_SMALLEST:
      to[q] = present ? pl_min(to[q], value[q]) : to[q];
      break;
    default:
      to[q] = present ? value[q] : 0;
    }
  }
}

/* A value of a bond at both of its ends; `factor` as above. */
static void store_at_ends(family_runner *r, const segment_root *root, const double *value,
                          const double *factor, const pl_family *f, long first, long k,
                          long lanes) {
  const long there = first + f->offset[k];
  double *far = root->target == TO_SUM
                    ? f->sum[root->sum] + there
                    : f->new_field[root->index] + there + (k + f->neighbours / 2) * f->new_plane;
  for (long q = 0; q < lanes; q++) {
    const double here = is_present(f, first, k, q) ? value[q] : 0;
    if (root->target == TO_SUM)
      far[q] = pl_fma(root->parity * here, factor && here != 0 ? factor[q] : 1, far[q]);
    else if (!f->ahead_only)
      far[q] = here;
  }
  if (root->target == TO_SUM || !f->ahead_only) store(r, root, value, factor, f, first, k, lanes);
}

/* What the particles have got from the far sides of their bonds. */
static void take_sums(family_runner *r, const segment *a, const pl_family *f, long first,
                      long lanes) {
  for (int n = 0; n < a->root_count; n++) {
    if (a->roots[n].target != TO_SUM) continue;
    double *slot = r->slot + (size_t)a->roots[n].index * LANES,
           *got = f->sum[a->roots[n].sum] + first;
    for (long q = 0; q < lanes; q++) {
      slot[q] += got[q];
      got[q] = 0;
    }
  }
}

static void start_reductions(family_runner *r, const segment *a) {
  for (int k = 0; k < a->root_count; k++) {
    const segment_target t = a->roots[k].target;
    if (t != TO_SUM && t != TO_LARGEST && t != TO_SMALLEST) continue;
    const double start = t == TO_SUM ? 0 : t == TO_LARGEST ? -PL_INFINITY : PL_INFINITY;
    double *to = r->slot + (size_t)a->roots[k].index * LANES;
    for (int q = 0; q < LANES; q++)
      to[q] = start;
  }
}

/* --- running ---------------------------------------------------------------------------------- */

static void run_segment(family_runner *r, interpreter *run, const family_pass *now,
                        const segment *a, const pl_family *f, long first, long lanes,
                        const double *uniforms) {
  const long loops = a->kind == OVER_PARTICLES    ? 1
                     : a->kind == OVER_NEIGHBOURS ? f->neighbours
                                                  : f->neighbours / 2;
  if (a->kind != OVER_PARTICLES) start_reductions(r, a);
  point_at_particles(r, f, first);
  for (int u = 0; u < r->plan->uniform_count; u++)
    r->parameters[r->plan->law->parameters.count + u] = uniforms + u;
  for (long k = 0; k < loops; k++) {
    if (a->kind != OVER_PARTICLES) {
      point_at_neighbour(r, f, first, k, uniforms);
      point_at_planes(r, now, k);
    }
    interpreter_inputs in = inputs_of(r);
    interpreter_run(run, &in, (int)lanes, r->result);
    for (int n = 0, factors = a->root_count; n < a->root_count; n++) {
      const bool fuses = segment_fuses(r->plan->graph, &a->roots[n]);
      const double *factor = fuses ? r->result[factors++] : NULL;
      if (a->kind == OVER_PAIRS)
        store_at_ends(r, &a->roots[n], r->result[n], factor, f, first, k, lanes);
      else
        store(r, &a->roots[n], r->result[n], factor, f, first, k, lanes);
    }
  }
  if (a->kind == OVER_PAIRS) take_sums(r, a, f, first, lanes);
}

void family_runner_run(family_runner *r, runner_program which, int number, const double *uniforms,
                       const pl_family *f) {
  const family_pass *now = &program_of(r->plan, which)->passes[number];
  if (f->ahead_only && !program_is_paired(now)) return;
  for (long first = 0; first < f->count; first += LANES) {
    const long left = f->count - first, lanes = left < LANES ? left / PL_LANES * PL_LANES : LANES;
    for (int s = 0; s < now->segment_count; s++) {
      run_segment(r, r->run[which][number][s], now, &now->segments[s], f, first, lanes, uniforms);
      if (f->ahead_only && now->segments[s].kind == OVER_PAIRS) break;
    }
  }
}
