#include "generator/exercise/path_sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "generator/drive/drive_motion.h"
#include "runtime/base/random_number.h"

enum {
  STATES_OF_ONE = 25, /* of a random path */
  CORNERS = 9,        /* of one, the beginning among them */
  VARIANTS = 3,       /* of a path that is given */
  TRIES = 8           /* to find values that the law's bounds allow */
};

typedef struct sampling {
  arena *memory;
  const exercise_item *item;
  uint64_t seed, drawn;
  double reach[DRIVE_QUANTITY_COUNT]; /* how far each quantity goes; 0: it is not prescribed */
  double duration;                    /* s */
  const char *solution;
  driven_law *kept; /* of the solution */
} sampling;

static double draw(sampling *s) {
  return random_unit(random_mix(s->seed + random_mix(++s->drawn)));
}

/* --- what is prescribed ----------------------------------------------------------------------- */

static bool is_sampled(int quantity) {
  return quantity != DRIVE_STRETCH_RATE && quantity < DRIVE_STRESS_XX;
}

static void measure(sampling *s, const path_case *known, int count) {
  for (int k = 0; k < count; k++) {
    const drive_input *in = known[k].in;
    long times;
    double *t = drive_corners(in, &times);
    for (int q = 0; q < DRIVE_QUANTITY_COUNT; q++)
      for (long c = 0; is_sampled(q) && drive_prescribes(in, (drive_quantity)q) && c < times; c++)
        s->reach[q] = pl_fmax(s->reach[q], fabs(drive_at(in, (drive_quantity)q, t[c])));
    free(t);
    if (k == 0) s->duration = drive_end(in);
  }
}

/* A table of straight lines between random values. */
static drive_piece random_piece(sampling *s, int quantity) {
  double *times = arena_alloc(s->memory, CORNERS * sizeof *times),
         *values = arena_alloc(s->memory, CORNERS * sizeof *values),
         *integrals = arena_alloc(s->memory, CORNERS * sizeof *integrals);
  for (int k = 0; k < CORNERS; k++) {
    times[k] = s->duration * k / (CORNERS - 1);
    values[k] = k ? s->reach[quantity] * (2 * draw(s) - 1) : 0;
  }
  time_table_integrals(times, values, CORNERS, integrals);
  return (drive_piece){.quantity = (drive_quantity)quantity,
                       .f = {.shape = TIME_TABLE,
                             .value = 1,
                             .times = times,
                             .values = values,
                             .integrals = integrals,
                             .count = CORNERS}};
}

static void draw_path(sampling *s, drive_input *in) {
  in->pieces = arena_alloc(s->memory, DRIVE_QUANTITY_COUNT * sizeof *in->pieces);
  in->piece_count = in->expect_count = 0;
  in->simulation.steps = STATES_OF_ONE;
  in->simulation.end_time = -1;
  for (int q = 0; q < DRIVE_QUANTITY_COUNT; q++)
    if (s->reach[q] > 0) in->pieces[in->piece_count++] = random_piece(s, q);
}

/* --- values ----------------------------------------------------------------------------------- */

/* One value times a factor between the bounds, as many times smaller as larger. */
static void vary_one(drive_input *in, const char *name, double factor) {
  deck_material *m = &in->material;
  if (strcmp(name, "s") == 0) {
    in->bond.spacing *= factor;
    in->particle.spacing *= factor;
  } else if (strcmp(name, "t") == 0) {
    in->bond.thickness *= factor;
    in->particle.thickness *= factor;
  }
  for (int k = 0; k < m->assignment_count; k++)
    if (strcasecmp(m->assignments[k].name, name) == 0) m->assignments[k].value *= factor;
}

/* `share` of the way from 1 to the bounds. */
static drive_input *varied(sampling *s, const drive_input *from, const double *drawn,
                           double share) {
  const exercise_item *item = s->item;
  drive_input *in = arena_alloc(s->memory, sizeof *in);
  *in = *from;
  const size_t bytes = (size_t)from->material.assignment_count * sizeof(deck_assignment);
  in->material.assignments = arena_alloc(s->memory, bytes + 1);
  if (bytes) memcpy(in->material.assignments, from->material.assignments, bytes);
  const double low = pl_log(item->within[0]), high = pl_log(item->within[1]);
  for (int k = 0; k < item->vary_count; k++)
    vary_one(in, item->vary[k], pl_exp(share * (low + (high - low) * drawn[k])));
  return in;
}

/* --- cases ------------------------------------------------------------------------------------ */

static bool refer(sampling *s, path_case *c, diagnostics *d) {
  c->plain = NULL;
  if (path_case_refer(c, s->memory, s->solution, s->kept, d)) return true;
  path_case_close(c);
  return false;
}

/* Values that the law refuses are drawn nearer to those at hand; the last refusal is heard. */
static bool make_case(sampling *s, path_case *c, const drive_input *from, diagnostics *d) {
  double *drawn = arena_alloc(s->memory, ((size_t)s->item->vary_count + 1) * sizeof *drawn);
  for (int k = 0; k < s->item->vary_count; k++)
    drawn[k] = draw(s);
  double share = 1;
  for (int k = 0; k < TRIES; k++, share /= 2) {
    diagnostics unheard;
    diag_begin(&unheard, d->sources);
    c->in = varied(s, from, drawn, share);
    const bool good = refer(s, c, &unheard);
    diag_clear(&unheard);
    if (good) return true;
  }
  return refer(s, c, d);
}

path_case *path_samples(arena *a, const exercise_item *item, const path_case *known,
                        int known_count, const char *solution, driven_law *kept, uint64_t seed,
                        int *count, diagnostics *d) {
  sampling s = {
      .memory = a, .item = item, .seed = random_mix(seed), .solution = solution, .kept = kept};
  const bool given = item->found_count > 0;
  const int paths = (item->states + STATES_OF_ONE - 1) / STATES_OF_ONE,
            all = given       ? VARIANTS * known_count
                  : paths > 1 ? paths
                              : 1;
  path_case *cases = arena_alloc(a, ((size_t)all + 1) * sizeof *cases);
  measure(&s, known, known_count);
  bool good = known_count > 0;
  for (*count = 0; good && *count < all; ++*count) {
    const path_case *from = &known[given ? *count % known_count : 0];
    path_case *c = &cases[*count];
    drive_input path = *from->in;
    *c =
        (path_case){.item = item, .number = *count + 1, .own_count = from->own_count, .varied = ""};
    if (!given) draw_path(&s, &path);
    good = make_case(&s, c, &path, d);
    if (!good) break;
  }
  if (good) return cases;
  for (int k = 0; k < *count; k++)
    path_case_close(&cases[k]);
  return NULL;
}
