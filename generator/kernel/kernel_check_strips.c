#include "generator/kernel/kernel_check_strips.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/random_values.h"
#include "generator/plan/plan.h"

enum {
  SITES = 1024,
  EACH = 4,           /* components of a motion; the last one of bonds that twist */
  MOTIONS = 4 * EACH, /* planes: displacement of i, of j, velocity of i, of j */
  DIRECTION = 5,
  RUN = 256, /* bonds of one kind: a part of a strip (stages.h) */
  SPINNING_EACH = 64
};

/* --- arrays ----------------------------------------------------------------------------------- */

/* What a strip reads, and twice, for either reader, what it writes. */
typedef struct strip_arrays {
  const pl_law *law;
  int kept_planes;    /* the fields, then the two dissipated energies: updated in place */
  double **motion;    /* [MOTIONS][SITES + 1]: far ends stand one further than near ends */
  double **parameter; /* [varying][SITES] */
  double **before;    /* [kept_planes][SITES] */
  double **kept[2];   /* [kept_planes][SITES] */
  double **force[2], **observed[2];
  int64_t *flags;
  bool unheld;
} strip_arrays;

static strip_arrays arrays_new(const pl_law *kernel) {
  strip_arrays a = {.law = kernel,
                    .kept_planes = kernel->field_count + PL_LOSSES,
                    .motion = planes_new(MOTIONS, SITES + 1)};
  a.parameter = planes_new(kernel->varying_count, SITES);
  a.before = planes_new(a.kept_planes, SITES);
  for (int side = 0; side < 2; side++) {
    a.kept[side] = planes_new(a.kept_planes, SITES);
    a.force[side] = planes_new(kernel->force_planes, SITES);
    a.observed[side] = planes_new(1 + kernel->output_count, SITES);
  }
  a.flags = must_calloc(SITES, sizeof *a.flags);
  return a;
}

static void arrays_free(strip_arrays *a) {
  planes_free(a->motion, MOTIONS);
  planes_free(a->parameter, a->law->varying_count);
  planes_free(a->before, a->kept_planes);
  for (int side = 0; side < 2; side++) {
    planes_free(a->kept[side], a->kept_planes);
    planes_free(a->force[side], a->law->force_planes);
    planes_free(a->observed[side], 1 + a->law->output_count);
  }
  free(a->flags);
}

/* --- random bonds ----------------------------------------------------------------------------- */

/* What loops that rely on what is expected find in a part: anything; bonds that turn little, but
   may stretch; that do neither, but some of whose ends spin; that are all as expected. */
enum { ANY, TURN_LITTLE, SOME_SPIN, AS_EXPECTED, KINDS };

/* Bond q turned as a whole by up to 14 rad, then deformed and rotated at its ends by any small
   or large amount, as far as its run is of the kind. */
static void fill_motion(strip_arrays *a, const pl_bond_class *b, uint64_t *seed) {
  for (int q = 0; q < SITES; q++) {
    const int kind = q / RUN % KINDS;
    double turn = kind != ANY ? draw_size(seed, -9, -2)
                  : q % 3     ? draw_uniform(seed, -14, 14)
                              : draw_size(seed, -9, 0);
    double stretched = 1 + pl_fmax(draw_size(seed, -8, kind < SOME_SPIN ? 0 : -2), -0.9);
    double across =
        stretched * (pl_cos(turn) * b->chord[0] - pl_sin(turn) * b->chord[1]) - b->chord[0];
    double along =
        stretched * (pl_sin(turn) * b->chord[0] + pl_cos(turn) * b->chord[1]) - b->chord[1];
    double x = b->s * draw_size(seed, -7, 0), y = b->s * draw_size(seed, -7, 0);
    double near[3] = {x, y, turn + draw_size(seed, -9, 0)};
    double far[3] = {x + across, y + along, turn + draw_size(seed, -9, 0)};
    if (kind == SOME_SPIN && q % SPINNING_EACH == 0)
      *(q & SPINNING_EACH ? &near[2] : &far[2]) += draw_uniform(seed, -14, 14);
    for (int k = 0; k < 3 || k < a->law->dof; k++) {
      a->motion[k][q] = k < 3 ? near[k] : draw_size(seed, -9, 0);
      a->motion[EACH + k][q + 1] = k < 3 ? far[k] : draw_size(seed, -9, 0);
      a->motion[2 * EACH + k][q] = draw_size(seed, -6, 3);
      a->motion[3 * EACH + k][q + 1] = draw_size(seed, -6, 3);
    }
  }
}

/* An eighth of the bonds is absent; of every second strip an eighth is protected. Bits of other
   directions mean nothing here. */
static int64_t draw_flags(bool unheld, uint64_t *seed) {
  const int64_t mine = PL_PRESENT(DIRECTION) | PL_PROTECTED(DIRECTION);
  uint64_t kind = draw_bits(seed) % 8;
  int64_t others = (int64_t)draw_bits(seed) & ~mine;
  return others | (kind ? PL_PRESENT(DIRECTION) : 0) |
         (kind == 1 && !unheld ? PL_PROTECTED(DIRECTION) : 0);
}

static void fill_bonds(strip_arrays *a, const double *parameters, uint64_t *seed) {
  const int fields = a->law->field_count;
  a->unheld = draw_bits(seed) % 2;
  for (int q = 0; q < SITES; q++) {
    a->flags[q] = draw_flags(a->unheld, seed);
    for (int k = 0; k < a->law->varying_count; k++)
      a->parameter[k][q] = parameters[a->law->varying[k]] * draw_uniform(seed, 0.95, 1.05);
    for (int k = 0; k < a->kept_planes; k++)
      a->before[k][q] = k < fields ? draw_field(seed, &a->law->fields[k]) : draw_size(seed, -6, 0);
  }
}

/* --- the functions ---------------------------------------------------------------------------- */

typedef struct strip_pass {
  program_task task;
  const char *name;
  size_t function; /* offset in pl_law */
} strip_pass;

static const strip_pass passes[] = {
#define X(task, member) {task, #member, offsetof(pl_law, member)},
    STRIP_PROGRAMS(X)
#undef X
};

static pl_strip strip_of(const strip_arrays *a, int side) {
  const int fields = a->law->field_count;
  pl_strip s = {.size = sizeof s,
                .count = SITES,
                .direction = DIRECTION,
                .flags = a->flags,
                .unheld = a->unheld,
                .time_step = 1.7e-7,
                .advance = 0.3,
                .parameter = (const double *const *)a->parameter,
                .field = a->kept[side],
                .force = a->force[side],
                .observed = a->observed[side],
                .dissipated_state = a->kept[side][fields],
                .dissipated_rate = a->kept[side][fields + 1],
                .given_by_rest = a->kept[side][fields + 2]};
  for (int k = 0; k < EACH; k++) {
    s.displacement_i[k] = a->motion[k];
    s.displacement_j[k] = a->motion[EACH + k] + 1;
    s.velocity_i[k] = a->motion[2 * EACH + k];
    s.velocity_j[k] = a->motion[3 * EACH + k] + 1;
  }
  return s;
}

static void run_pass(const law_readers *l, const strip_arrays *a, const strip_pass *p, int side) {
  for (int k = 0; k < a->kept_planes; k++)
    memcpy(a->kept[side][k], a->before[k], SITES * sizeof(double));
  planes_poison(a->force[side], a->law->force_planes, SITES);
  planes_poison(a->observed[side], 1 + a->law->output_count, SITES);
  pl_strip strip = strip_of(a, side);
  pl_strip_function run;
  memcpy(&run, (const char *)l->law[side] + p->function, sizeof run);
  run(l->law[side], l->uniforms[side], &strip);
}

/* --- what they wrote -------------------------------------------------------------------------- */

static void compare_pass(const strip_arrays *a, const strip_pass *p, comparison *c) {
  const pl_law *kernel = a->law;
  const char *energies[PL_LOSSES] = {"dissipated_state", "dissipated_rate", "given_by_rest"};
  for (int k = 0; p->task != PROGRAM_OBSERVE && k < kernel->force_planes; k++)
    comparison_add(c, p->name, "force", k, a->force[0][k], a->force[1][k], SITES);
  for (int k = 0; p->task == PROGRAM_OBSERVE && k <= kernel->output_count; k++)
    comparison_add(c, p->name, k ? kernel->outputs[k - 1].name : "stored energy", -1,
                   a->observed[0][k], a->observed[1][k], SITES);
  for (int k = 0; k < a->kept_planes; k++) {
    const int energy = k - kernel->field_count;
    comparison_add(c, p->name, energy < 0 ? kernel->fields[k].name : energies[energy], -1,
                   a->kept[0][k], a->kept[1][k], SITES);
  }
}

static bool may_change(const strip_arrays *a, const strip_pass *p, int plane, long q) {
  if (!(a->flags[q] & PL_PRESENT(DIRECTION))) return false;
  if (plane >= a->law->field_count) return p->task == PROGRAM_LEDGER;
  bool damage = a->law->fields[plane].kind == PL_FIELD_DAMAGE;
  return p->task != PROGRAM_OBSERVE && !(damage && (a->flags[q] & PL_PROTECTED(DIRECTION)));
}

/* Both readers share one graph, so what it means to be absent or protected is checked on its own.
 */
static void find_misplaced(const strip_arrays *a, const strip_pass *p, comparison *c) {
  for (int k = 0; k < a->kept_planes; k++)
    for (long q = 0; q < SITES; q++)
      c->misplaced += !may_change(a, p, k, q) &&
                      memcmp(&a->kept[0][k][q], &a->before[k][q], sizeof(double)) != 0;
  double *const *written = p->task != PROGRAM_OBSERVE ? a->force[0] : a->observed[0];
  const int planes = p->task != PROGRAM_OBSERVE ? a->law->force_planes : 1 + a->law->output_count;
  for (int k = 0; k < planes; k++)
    for (long q = 0; q < SITES; q++)
      c->misplaced += !(a->flags[q] & PL_PRESENT(DIRECTION)) && written[k][q] != 0;
}

long kernel_check_strips(const law_readers *l, long wanted, uint64_t *seed, comparison *c) {
  strip_arrays a = arrays_new(l->law[0]);
  long done = 0;
  for (; done < wanted; done += SITES)
    for (size_t k = 0; k < sizeof passes / sizeof *passes; k++) {
      fill_motion(&a, l->bonds, seed);
      fill_bonds(&a, l->parameters, seed);
      run_pass(l, &a, &passes[k], 0);
      run_pass(l, &a, &passes[k], 1);
      compare_pass(&a, &passes[k], c);
      find_misplaced(&a, &passes[k], c);
    }
  arrays_free(&a);
  return done;
}
