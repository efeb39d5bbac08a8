#include "generator/interpreter/interpreted_family.h"

#include "dsl/base/elementary.h"
#include "generator/lower/kinematics.h"
#include "generator/plan/program_facts.h"

enum { LANES = RUNNER_LANES, MOST_NEIGHBOURS = RUNNER_NEIGHBOURS };
_Static_assert(FAMILY_CHUNK == INTERPRET_LANES, "a chunk is what the interpreter takes at a time");

/* --- inputs ----------------------------------------------------------------------------------- */

static bool is_of_particle(const runner *r, int field) {
  return r->plan->law->fields.items[field]->place <= ON_PARTICLE;
}

static const double *motion_of(const pl_family *f, int end) {
  const ends_origin *o = &ends_origins[end];
  return o->array == FROM_VELOCITY ? f->velocity[o->component] : f->displacement[o->component];
}

/* What a segment of the particles reads: neighbours are not touched. */
static void point_at_particles(runner *r, const pl_family *f, long first) {
  const double **ends = r->at[IR_FROM_ENDS];
  for (int k = 0; k < r->plan->links.of_particles; k++)
    r->at[IR_FROM_LINK][k] = f->link[k] + first;
  for (int k = 0; k < r->plan->law->fields.count; k++)
    r->at[IR_FROM_FIELD][k] = f->old_field[k] + first;
  for (int k = 0; k < r->plan->variation.varying_count; k++)
    r->at[IR_FROM_PARTICLE_PARAMETER][k] = f->parameter[k] + first;
  for (int k = 0; r->plan->reads_shape && k < PL_SHAPE_PLANES(r->plan->dimensions); k++)
    r->at[IR_FROM_SHAPE][k] = f->shape[k] + first;
  for (int n = 0; n < r->motion_count[OF_I]; n++) {
    const int end = r->motion[OF_I][n];
    ends[end] = motion_of(f, end) + first;
  }
  for (long q = 0; q < LANES && first + q < f->count; q++)
    r->protection[0][q] = f->held[first + q] ? 1 : 0;
  ends[ENDS_HELD_I] = r->protection[0];
  if (r->plan->reads_share) ends[ENDS_SHARE_I] = f->share + first;
  if (r->plan->variation.sizes) ends[ENDS_SIZE_I] = f->own_size + first;
  if (f->volume) ends[ENDS_VOLUME_I] = f->volume + first;
  if (f->mass) ends[ENDS_MASS_I] = f->mass + first;
  ends[ENDS_TIME_STEP] = &f->time_step;
  ends[ENDS_ADVANCE] = &f->advance;
}

/* Where the values of neighbour k of the chunk's particles stand, given where those of the run's
   particles begin: on rows further along the same array, on lists gathered into the next buffer. */
static const double *at_offset(runner *r, const pl_family *f, const double *values, long first,
                               long k, const long *offset) {
  if (!f->neighbour) return values + first + offset[k];
  const int32_t *to = f->neighbour + k * f->plane + first;
  double *buffer = r->gathered + (size_t)r->gathered_count++ * LANES;
  for (long q = 0; q < LANES && first + q < f->count; q++)
    buffer[q] = values[first + q + to[q]];
  return buffer;
}

static const double *at_neighbours(runner *r, const pl_family *f, const double *values, long first,
                                   long k) {
  return at_offset(r, f, values, first, k, f->offset);
}

/* The same of links. */
static const double *at_links(runner *r, const pl_family *f, const double *values, long first,
                              long k) {
  return at_offset(r, f, values, first, k, f->link_offset);
}

static void point_at_motion(runner *r, const pl_family *f, long first, long k) {
  for (int n = 0; n < r->motion_count[OF_J]; n++) {
    const int end = r->motion[OF_J][n];
    r->at[IR_FROM_ENDS][end] = at_neighbours(r, f, motion_of(f, end), first, k);
  }
  for (long q = 0; q < LANES && first + q < f->count; q++) {
    const long to = f->neighbour ? f->neighbour[k * f->plane + first + q] : f->offset[k];
    r->protection[1][q] = f->held[first + q + to] ? 1 : 0;
  }
  r->at[IR_FROM_ENDS][ENDS_HELD_J] = r->protection[1];
}

static double *shared_plane(const pl_family *f, int index, long owned) {
  const shared_place at = program_shared_place(index);
  return f->bond_link[at.link] + (owned + (at.upper ? f->neighbours / 2 : 0)) * f->link_plane;
}

/* What the owner of the bond has left. At the end of a block another one may be writing zeros over
   zeros where no site is. */
static void point_at_shared(runner *r, const pl_family *f, long first, long k) {
  const long half = f->neighbours / 2;
  for (int n = 0; n < 2 * r->plan->links.of_bonds; n++) {
    double *opposite = r->opposite + (size_t)n * LANES;
    r->at[IR_FROM_SHARED][n] = k < half ? shared_plane(f, n, k) + first
                                        : at_links(r, f, shared_plane(f, n, k - half), first, k);
    for (long q = 0; k >= half && q < LANES && first + q < f->count; q++)
      opposite[q] = -r->at[IR_FROM_SHARED][n][q];
    r->at[IR_FROM_SHARED_ODD][n] = k < half ? r->at[IR_FROM_SHARED][n] : opposite;
  }
}

static void point_at_list(runner *r, const pl_family *f, long first, long k) {
  const double **ends = r->at[IR_FROM_ENDS];
  static const ends_input chord[] = {ENDS_CHORD_X, ENDS_CHORD_Y, ENDS_CHORD_Z};
  for (int d = 0; d < r->plan->dimensions; d++)
    ends[chord[d]] = f->chord[d] + k * f->plane + first;
  ends[ENDS_REFERENCE_LENGTH] = f->length + k * f->plane + first;
  ends[ENDS_VOLUME_J] = at_neighbours(r, f, f->volume, first, k);
}

/* On bonds each neighbour has a plane. */
static void point_at_parameters(runner *r, const pl_family *f, long first, long k) {
  const double **ends = r->at[IR_FROM_ENDS];
  const bool on_bonds = r->plan->law->tree->law != LAW_STATE;
  for (int n = 0; n < r->plan->variation.varying_count; n++)
    if (on_bonds)
      r->at[IR_FROM_BOND_PARAMETER][n] = f->parameter[n] + k * f->plane + first;
    else
      r->at[IR_FROM_NEIGHBOUR_PARAMETER][n] = at_neighbours(r, f, f->parameter[n], first, k);
  if (f->mass) ends[ENDS_MASS_J] = at_neighbours(r, f, f->mass, first, k);
  if (r->plan->reads_share) ends[ENDS_SHARE_J] = at_neighbours(r, f, f->share, first, k);
  if (r->plan->variation.sizes) ends[ENDS_SIZE_J] = at_neighbours(r, f, f->own_size, first, k);
}

static void point_at_neighbour(runner *r, const pl_family *f, long first, long k,
                               const double *uniforms) {
  const long half = f->neighbours / 2, back = k < half ? k + half : k - half;
  const kernel_plan *p = r->plan;
  r->gathered_count = 0;
  if (!f->neighbour) runner_take_uniforms(r, uniforms + k * p->uniform_count);
  for (int n = 0; n < p->links.of_particles; n++)
    r->at[IR_FROM_NEIGHBOUR_LINK][n] = at_links(r, f, f->link[n], first, k);
  for (int n = 0; n < p->links.of_bonds; n++) {
    r->at[IR_FROM_BOND_LINK][n] = f->bond_link[n] + first + k * f->link_plane;
    r->at[IR_FROM_NEIGHBOUR_BOND_LINK][n] =
        at_links(r, f, f->bond_link[n] + back * f->link_plane, first, k);
  }
  for (int n = 0; n < p->law->fields.count; n++) {
    const long plane = is_of_particle(r, n) ? 0 : f->plane;
    r->at[IR_FROM_FIELD][n] = f->old_field[n] + first + k * plane;
    if (f->new_field)
      r->at[IR_FROM_NEW_FIELD][n] =
          f->new_field[n] + first + (is_of_particle(r, n) ? 0 : k * f->new_plane);
    r->at[IR_FROM_NEIGHBOUR_FIELD][n] =
        at_neighbours(r, f, f->old_field[n] + back * plane, first, k);
  }
  point_at_parameters(r, f, first, k);
  point_at_shared(r, f, first, k);
  point_at_motion(r, f, first, k);
  if (f->neighbour) point_at_list(r, f, first, k);
}

static void point_at_planes(runner *r, const program_pass *now, long k) {
  for (int n = 0; n < now->plane_count; n++)
    r->at[IR_FROM_PLANE][n] = r->plane + ((size_t)n * MOST_NEIGHBOURS + (size_t)k) * LANES;
}

/* --- outputs ---------------------------------------------------------------------------------- */

static double *target_of(runner *r, const segment_root *root, const pl_family *f, long first,
                         long k) {
  const bool own = root->over == OVER_PARTICLES;
  switch (root->target) {
  case TO_LINK:
    return own ? f->link[root->index] + first
               : f->bond_link[root->index] + first + k * f->link_plane;
  case TO_SHARED:
    return shared_plane(f, root->index, k) + first;
  case TO_FIELD:
    return f->new_field[root->index] + first + (own ? 0 : k * f->new_plane);
  case TO_FORCE:
    return own ? f->force[root->index] + first
               : f->force_state[root->index] + first + k * f->new_plane;
  case TO_DISSIPATED_STATE:
  case TO_DISSIPATED_RATE:
  case TO_GIVEN_BY_REST:
    return f->lost[root->index] + first;
  case TO_OBSERVED:
    return f->observed[root->index] + first + (own ? 0 : k * f->new_plane);
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
static void store(runner *r, const segment_root *root, const double *value, const double *factor,
                  const pl_family *f, long first, long k, long lanes) {
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
    case TO_DISSIPATED_STATE:
    case TO_DISSIPATED_RATE:
    case TO_GIVEN_BY_REST:
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

/* A value of a bond at both of its ends; `second`: a factor as above, or what the far end has. */
static void store_at_ends(runner *r, const segment_root *root, const double *value,
                          const double *second, const pl_family *f, long first, long k,
                          long lanes) {
  const bool own = segment_has_far(root);
  const double *factor = own ? NULL : second, *value_there = own ? second : value;
  const long there = first + f->offset[k];
  double *far = root->target == TO_SUM
                    ? f->sum[root->sum] + there
                    : f->new_field[root->index] + there + (k + f->neighbours / 2) * f->new_plane;
  for (long q = 0; q < lanes; q++) {
    const double here = is_present(f, first, k, q) ? value_there[q] : 0;
    if (root->target == TO_SUM)
      far[q] =
          pl_fma(own ? here : root->parity * here, factor && here != 0 ? factor[q] : 1, far[q]);
    else if (!f->ahead_only)
      far[q] = here;
  }
  if (root->target == TO_SUM || !f->ahead_only) store(r, root, value, factor, f, first, k, lanes);
}

/* What the particles have got from the far sides of their bonds. */
static void take_sums(runner *r, const segment *a, const pl_family *f, long first, long lanes) {
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

static void start_reductions(runner *r, const segment *a) {
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

static void run_segment(runner *r, interpreter *run, const program_pass *now, const segment *a,
                        const pl_family *f, long first, long lanes, const double *uniforms) {
  const long loops = a->kind == OVER_PARTICLES    ? 1
                     : a->kind == OVER_NEIGHBOURS ? f->neighbours
                                                  : f->neighbours / 2;
  if (a->kind != OVER_PARTICLES) start_reductions(r, a);
  point_at_particles(r, f, first);
  runner_take_uniforms(r, uniforms);
  for (long k = 0; k < loops; k++) {
    if (a->kind != OVER_PARTICLES) {
      point_at_neighbour(r, f, first, k, uniforms);
      point_at_planes(r, now, k);
    }
    interpreter_run(run, &r->in, (int)lanes, r->result);
    for (int n = 0, seconds = a->root_count; n < a->root_count; n++) {
      const segment_root *root = &a->roots[n];
      const bool has = segment_fuses(r->plan->graph, root) || segment_has_far(root);
      const double *second = has ? r->result[seconds++] : NULL;
      if (a->kind == OVER_PAIRS)
        store_at_ends(r, root, r->result[n], second, f, first, k, lanes);
      else
        store(r, root, r->result[n], second, f, first, k, lanes);
    }
  }
  if (a->kind == OVER_PAIRS) take_sums(r, a, f, first, lanes);
}

void interpreted_family(runner *r, program_task task, int number, const double *uniforms,
                        const pl_family *f) {
  const program_pass *now = &r->plan->programs[task].passes[number];
  if (f->ahead_only && !program_is_paired(now)) return;
  for (long first = 0; first < f->count; first += LANES) {
    const long left = f->count - first, lanes = left < LANES ? left / PL_LANES * PL_LANES : LANES;
    for (int s = 0; s < now->segment_count; s++) {
      run_segment(r, r->run[task][number][s], now, &now->segments[s], f, first, lanes, uniforms);
      if (f->ahead_only && now->segments[s].kind == OVER_PAIRS) break;
    }
  }
}
