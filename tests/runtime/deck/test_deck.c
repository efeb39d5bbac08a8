/* Decks become plain structures in SI; overrides replace keys; the reference in runtime/README.md
   is that of the table (PERILAT_BLESS=1 rewrites it); no damaged deck crashes the reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/deck/deck_groups.h"
#include "runtime/deck/deck_read.h"

static const char beam[] =
    "! Notched beam D6 in three-point bending (Asadollahi 2014, chapter 4)\n"
    "&simulation  title = 'D6, s = 6.35 mm'  end_time = '60 ms'  step_safety = 0.25  /\n"
    "&lattice     name = 'concrete'  kind = 'hexagonal'  spacing = '6.35 mm'  thickness = '152.4 "
    "mm'  /\n"
    "&material    lattice = 'concrete'  model = 'mplm_bilinear'  E = '30 GPa'  S_t = 1.18e-4  /\n"
    "&body        lattice = 'concrete'  shape = 'rectangle'  corner = 0, 0  size = '457.2 mm', "
    "'152.4 mm'  /\n"
    "&notch       lattice = 'concrete'  shape = 'rectangle'  corner = '227.33 mm', 0  size = '2.54 "
    "mm', '50.8 mm'  /\n"
    "&region      name = 'loader'  shape = 'point'  at = '228.6 mm', '148.5 mm'  /\n"
    "&region      name = 'left foot'  shape = 'point'  at = '38.1 mm', 0  /\n"
    "&region      name = 'notch left'  shape = 'point'  at = '222.25 mm', 0  /\n"
    "&region      name = 'notch right'  shape = 'point'  at = '234.95 mm', 0  /\n"
    "&support     region = 'left foot'  fix = 'y'  /\n"
    "&drive       region = 'loader'  component = 'y'  velocity = '-20 mm/s'  start = '4 ms'  /\n"
    "&monitor     name = 'load'  kind = 'reaction'  region = 'loader'  component = 'y'  average = "
    "'0.1 ms'  /\n"
    "&monitor     name = 'cmod'  kind = 'opening'  between = 'notch left', 'notch right'  "
    "component = 'x'  zero_at = '4 ms'  /\n"
    "&protect     region = 'left foot'  radius = 1.01  /           ! bonds there take no damage\n"
    "&damping     kind = 'mass'  rate = '1000 1/s'  until = '2.4 ms'  /\n"
    "&stop        monitor = 'load'  below = 0.05  of = 'peak'  /\n"
    "&output      result = 'd6.h5'  frames = 60  fields = 'displacement', 'damage'  /\n";

/* What every group can hold besides. */
static const char wall[] =
    "&simulation end_time = 2 step = '1 us' threads = 3 /\n"
    "&lattice name = 'a' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 17 origin = "
    "'1 mm', 0.002\n"
    "  stiffness_thickness = '5 in' mass_thickness = 0.2 setting = 'plane_strain' /\n"
    "&lattice name = 'b' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = '0.3 rad' /\n"
    "&material lattice = 'b' model = 'own/law.plm' onset = 'rankine' e = '25 GPa' S_t = 1.18d-4 nu "
    "= '20 %' /\n"
    "&material lattice = 'a' model = 'pmb' /\n"
    "&body lattice = 'a' shape = 'disc' centre = 0, '1 m' radius = '50 cm' inner_radius = 0.1 /\n"
    "&body lattice = 'b' shape = 'polygon' points = 0, 0, '1 m', 0, 0, '100 cm' /\n"
    "&notch lattice = 'a' shape = 'point' at = 1, 2 within = '3 mm' cut_bonds = .false. /\n"
    "&region name = 'top' lattice = 'b' shape = 'rectangle' corner = -1, 0 size = 2, 1 /\n"
    "&region name = 'it''s' lattice = 'a' shape = 'point' at = 0, 0 /\n"
    "&support region = 'top' fix = 'x', 'rotation' /\n"
    "&support region = 'it''s' fix = 'xy' /\n"
    "&drive region = 'top' component = 'y' displacement = '-1 mm' history = 'cosine' rise = '0.5 "
    "s' /\n"
    "&drive region = 'it''s' component = 'rotation' velocity = '90 deg/s' rise = '10 ms' /\n"
    "&force region = 'top' component = 'x' total = '2 kN' times = 0, '1 s', 1.5 values = 0, 1, "
    "-0.5 start = '0.1 s' /\n"
    "&force region = 'top' moment = '3 N*m' history = 'ramp' rise = 1 /\n"
    "&end_moment region = 'top' moment = '9.12 N*m' history = 'ramp and hold' rise = '4 ms' /\n"
    "&damping rate = 5 /\n"
    "&monitor name = 'n' kind = 'damaged' above = 0.3 scale = -1 /\n"
    "&monitor name = 'turn' kind = 'velocity' region = 'it''s' component = 'rotation' /\n"
    "&stop monitor = 'turn' above = '2 rad/s' after = '0.5 s' /\n"
    "&frame at = '1 ms', 2, 0 /\n"
    "&frame monitor = 'turn' below = '20 %' of = 'peak' after = '0.25 s' /\n"
    "&output sample = '1 ms' energy = F fields = 'force' /\n"
    "&checkpoint interval = '5 min' /\n";

typedef struct reading {
  source_set sources;
  diagnostics d;
  arena *memory;
  const deck *k;
} reading;

static const char *deck_name = "decks/d6_s6.35.nml"; /* files are beside it */

static void read_bytes(reading *r, const char *text, size_t length, const char *const *sets,
                       int set_count) {
  deck_override overrides[8] = {{0}};
  for (int i = 0; i < set_count; i++)
    overrides[i].text = sets[i];
  *r = (reading){.memory = arena_new()};
  int file = source_add(&r->sources, deck_name, text, length);
  diag_begin(&r->d, &r->sources);
  r->k = deck_read(r->memory, &r->sources, file, overrides, set_count, &r->d);
}

static void read_good(reading *r, const char *text, const char *const *sets, int set_count) {
  read_bytes(r, text, strlen(text), sets, set_count);
  diag_print(&r->d, stderr);
  assert_int_equal(r->d.count, 0);
  assert_non_null(r->k);
}

static void end(reading *r) {
  diag_clear(&r->d);
  source_clear(&r->sources);
  arena_free(r->memory);
}

/* Products of decimal numbers and unit factors: a rounding or two. */
static void near(double got, double expected) {
  if (!(fabs(got - expected) <= 4e-16 * fabs(expected)))
    fail_msg("%.17g instead of %.17g", got, expected);
}

static void the_beam_is_read(void **state) {
  (void)state;
  reading r;
  read_good(&r, beam, NULL, 0);
  const deck *k = r.k;
  assert_string_equal(k->simulation.title, "D6, s = 6.35 mm");
  near(k->simulation.end_time, 0.06);
  near(k->simulation.step_safety, 0.25);
  near(k->lattices[0].spacing, 6.35e-3);
  near(k->lattices[0].thickness, 0.1524);
  assert_string_equal(k->materials[0].model, "mplm_bilinear");
  assert_int_equal(k->materials[0].assignment_count, 2);
  const deck_assignment *e = &k->materials[0].assignments[0];
  assert_string_equal(e->name, "E");
  near(e->value, 30e9);
  assert_true(e->has_unit && e->dim.twelfths[0] == -12 && e->dim.twelfths[1] == 12 &&
              e->dim.twelfths[2] == -24);
  assert_false(k->materials[0].assignments[1].has_unit);
  assert_int_equal(k->bodys[0].shape.kind, SHAPE_RECTANGLE);
  near(k->bodys[0].shape.size[0], 0.4572);
  near(k->notchs[0].shape.corner[0], 0.22733);
  assert_true(k->notchs[0].cut_bonds);
  assert_int_equal(k->region_count, 4);
  assert_int_equal(deck_find_region(k, "notch right"), 3);
  assert_int_equal(deck_find_region(k, "notch"), -1);
  assert_string_equal(k->regions[1].lattice, "concrete");
  assert_true(k->regions[1].shape.within == 0);
  assert_int_equal(k->supports[0].fix, FIX_Y);
  near(k->drives[0].motion.value, -0.02);
  near(k->drives[0].motion.start, 4e-3);
  assert_int_equal(k->drives[0].motion.shape, TIME_CONSTANT);
  assert_int_equal(k->drives[0].component, 1);
  near(k->monitors[0].average, 1e-4);
  assert_true(k->monitors[0].zero_at < 0);
  near(k->monitors[1].zero_at, 4e-3);
  assert_string_equal(k->monitors[1].between[1], "notch right");
  near(k->protects[0].radius, 1.01);
  near(k->dampings[0].rate, 1000);
  near(k->dampings[0].until, 2.4e-3);
  assert_true(k->stops[0].below && k->stops[0].of_peak);
  near(k->stops[0].level, 0.05);
  assert_string_equal(k->output.result, "d6.h5");
  assert_int_equal(k->output.frames, 60);
  end(&r);
}

static void what_is_not_written_has_its_default(void **state) {
  (void)state;
  char text[sizeof(beam)];
  strcpy(text, beam);
  *strstr(text, "&protect") = '\0'; /* the rest goes */
  reading r;
  read_good(&r, text, NULL, 0);
  const deck *k = r.k;
  assert_true(k->simulation.step == 0 && k->simulation.threads == 0);
  assert_string_equal(k->output.result, "d6_s6.35.h5");
  assert_int_equal(k->output.frames, 20);
  near(k->output.sample, 0); /* the run chooses */
  assert_int_equal(k->output.field_count, 2);
  assert_string_equal(k->output.fields[1], "damage");
  assert_true(k->output.energy);
  near(k->checkpoint.interval, 600);
  near(k->lattices[0].mass_thickness, 0.1524);
  near(k->lattices[0].stiffness_thickness, 0.1524);
  assert_string_equal(k->lattices[0].setting, "plane_stress");
  assert_true(k->monitors[0].scale == 1 && k->monitors[0].above == 0);
  end(&r);
}

static void every_kind_of_value(void **state) {
  (void)state;
  reading r;
  read_good(&r, wall, NULL, 0);
  const deck *k = r.k;
  near(k->simulation.step, 1e-6);
  assert_string_equal(k->simulation.title, "d6_s6.35");
  assert_int_equal(k->simulation.threads, 3);
  near(k->lattices[0].rotation, 17 * M_PI / 180);
  near(k->lattices[1].rotation, 0.3);
  near(k->lattices[0].origin[0], 1e-3);
  near(k->lattices[0].stiffness_thickness, 0.127);
  near(k->lattices[0].mass_thickness, 0.2);
  assert_string_equal(k->lattices[0].setting, "plane_strain");
  const deck_assignment *a = k->materials[0].assignments;
  assert_string_equal(a[0].word, "rankine");
  near(a[2].value, 1.18e-4);
  near(a[3].value, 0.2);
  near(k->bodys[0].shape.radius, 0.5);
  near(k->bodys[0].shape.inner_radius, 0.1);
  assert_int_equal(k->bodys[1].shape.point_count, 3);
  near(k->bodys[1].shape.points[5], 1);
  assert_false(k->notchs[0].cut_bonds);
  near(k->notchs[0].shape.within, 3e-3);
  assert_string_equal(k->regions[1].name, "it's");
  assert_int_equal(k->supports[0].fix, FIX_X | FIX_ROTATION);
  assert_int_equal(k->supports[1].fix, FIX_X | FIX_Y);
  assert_true(isinf(k->dampings[0].until));
  assert_int_equal(k->monitors[0].kind, MONITOR_DAMAGED);
  assert_true(k->stops[0].level == 2 && !k->stops[0].below && k->stops[0].after == 0.5);
  assert_true(k->frames[0].at_count == 3 && !k->frames[0].event.monitor);
  near(k->frames[0].at[0], 1e-3);
  assert_true(k->frames[0].at[1] == 2 && k->frames[0].at[2] == 0);
  assert_true(k->frames[1].at_count == 0 && k->frames[1].event.below);
  assert_true(k->frames[1].event.of_peak && k->frames[1].event.after == 0.25);
  near(k->frames[1].event.level, 0.2);
  assert_string_equal(k->frames[1].event.monitor, "turn");
  assert_false(k->output.energy);
  near(k->checkpoint.interval, 300);
  end(&r);
}

static void loads_in_time(void **state) {
  (void)state;
  reading r;
  read_good(&r, wall, NULL, 0);
  const deck *k = r.k;
  assert_true(k->drives[0].is_displacement && !k->drives[1].is_displacement);
  near(time_function_at(&k->drives[0].motion, 0.25), -0.5e-3);
  near(time_function_at(&k->drives[1].motion, 1), M_PI / 2); /* a rise alone: ramp and hold */
  near(time_function_at(&k->drives[1].motion, 5e-3), M_PI / 4);
  near(time_function_at(&k->forces[0].force, 1.1), 2000);
  near(time_function_at(&k->forces[0].force, 1.35), 500);
  near(time_function_at(&k->forces[0].force, 2), -1000);
  assert_int_equal(k->forces[1].component, 2);
  near(time_function_at(&k->forces[1].force, 2), 6);
  near(time_function_at(&k->end_moments[0].moment, 3e-3), 6.84);
  end(&r);
}

static bool stands(const reading *r, span where, const char *text) {
  const source *s = &r->sources.items[where.file];
  return where.end - where.begin == strlen(text) &&
         memcmp(s->text + where.begin, text, strlen(text)) == 0;
}

static void places_of_values(void **state) {
  (void)state;
  static const char *const sets[] = {"lattice.spacing=3.175 mm"};
  reading r;
  read_good(&r, beam, sets, 1);
  assert_true(stands(&r, deck_where(&r.k->drives[0].item, "velocity"), "'-20 mm/s'"));
  assert_true(stands(&r, deck_where(&r.k->drives[0].item, "rise"), "&drive"));
  assert_true(stands(&r, deck_where(&r.k->lattices[0].item, "spacing"), "3.175 mm"));
  assert_true(stands(&r, r.k->materials[0].assignments[1].name_where, "S_t"));
  end(&r);
}

static void overrides_replace_and_add(void **state) {
  (void)state;
  static const char *const sets[] = {"drive.velocity=-5 mm/s",  "region[loader].at=0.1, 140 mm",
                                     "region[2].at='30 mm', 0", "material.e=25 GPa",
                                     "checkpoint.interval=60",  "support[left foot].fix=x, y",
                                     "monitor[cmod].scale=-1",  "output.result=out/d6.h5"};
  reading r;
  read_good(&r, beam, sets, 8);
  const deck *k = r.k;
  near(k->drives[0].motion.value, -0.005);
  near(k->regions[0].shape.at[0], 0.1);
  near(k->regions[0].shape.at[1], 0.14);
  near(k->regions[1].shape.at[0], 0.03);
  near(k->materials[0].assignments[0].value, 25e9);
  assert_int_equal(k->materials[0].assignment_count, 2); /* E and e are one */
  near(k->checkpoint.interval, 60);
  assert_int_equal(k->supports[0].fix, FIX_X | FIX_Y);
  assert_true(k->monitors[1].scale == -1 && k->monitors[0].scale == 1);
  assert_string_equal(k->output.result, "out/d6.h5");
  end(&r);
}

/* A clockwise polygon with arcs comes counter-clockwise, each arc on its edge; components are
   degrees of freedom. */
static void a_body_in_space(void **state) {
  (void)state;
  static const char block[] =
      "&simulation end_time = 1 /\n"
      "&lattice name = 'block' kind = 'fcc' spacing = '5 mm' shells = 2 rotation = 90 axis = 1, 1, "
      "0\n"
      "  origin = '1 mm', '2 mm', '3 mm' /\n"
      "&material lattice = 'block' model = 'm' /\n"
      "&body lattice = 'block' shape = 'extrusion' points = 0, 0, 0, 2, 3, 1 bulge = 0.1, 0.2, "
      "0.3\n"
      "  z = '-1 mm', '4 mm' /\n"
      "&notch lattice = 'block' shape = 'cylinder' from = 0, 0, 0 to = 0, 0, '9 mm' radius = 1 /\n"
      "&region name = 'end' shape = 'face' points = 0, 0, 1, 1, 0, 1, 0, 1, 1 /\n"
      "&support region = 'end' fix = 'xz' /\n"
      "&drive region = 'end' component = 'y' velocity = 1 /\n"
      "&force region = 'end' component = 'z' total = '2 kN' /\n"
      "&gravity acceleration = 0, 0, '-9.81 m/s^2' /\n"
      "&monitor name = 'held' kind = 'reaction' region = 'end' component = 'z' /\n"
      "&stop monitor = 'held' above = '1 kN' /\n";
  static const double points[] = {3, 1, 0, 2, 0, 0}, bulge[] = {0.2, 0.1, 0.3};
  reading r;
  read_good(&r, block, NULL, 0);
  const deck *k = r.k;
  assert_string_equal(k->lattices[0].setting, "space");
  assert_int_equal(k->lattices[0].shells, 2);
  near(k->lattices[0].rotation, 2 * atan(1));
  assert_true(k->lattices[0].axis[1] == 1 && k->lattices[0].axis[2] == 0);
  near(k->lattices[0].origin[2], 3e-3);
  const deck_shape *s = &k->bodys[0].shape;
  assert_int_equal(s->point_count, 3);
  for (int p = 0; p < 6; p++)
    near(s->points[p], points[p]);
  for (int p = 0; p < 3; p++)
    near(s->bulge[p], bulge[p]);
  assert_true(s->z[0] == -1e-3 && s->z[1] == 4e-3);
  near(k->notchs[0].shape.to[2], 9e-3);
  assert_int_equal(k->regions[0].shape.point_count, 3);
  assert_int_equal(k->supports[0].fix, FIX_X | FIX_Z);
  assert_int_equal(k->drives[0].component, 1);
  assert_int_equal(k->forces[0].component, 2);
  assert_int_equal(k->monitors[0].component, 2);
  assert_string_equal(deck_component_name(3, 2), "z");
  near(k->gravitys[0].acceleration[2], -9.81);
  near(k->stops[0].level, 1000);
  end(&r);
}

/* `&force force = ...` of older decks is `&force total = ...`, to the identity that a checkpoint
   asks for. */
static void a_key_under_its_former_name(void **state) {
  (void)state;
  static const char *const keys[] = {"total", "force", "Force"};
  static const char *const sets[] = {"force.total=3 kN", "force.force=3 kN"};
  char *identity = NULL;
  for (int k = 0; k < 6; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n"
             "&lattice name = 'l' kind = 'square' spacing = 1 thickness = 1 /\n"
             "&material lattice = 'l' model = 'm' /\n"
             "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = 9 /\n"
             "&region name = 'end' shape = 'point' at = 0, 0 /\n"
             "&force region = 'end' component = 'x' %s = '2 kN' /\n",
             keys[k % 3]);

    reading r;
    read_good(&r, text, &sets[k / 3], 1);
    near(time_function_at(&r.k->forces[0].force, 1), 3000);
    if (!identity) identity = strdup(r.k->identity);
    assert_string_equal(r.k->identity, identity);
    end(&r);
  }
  free(identity);
}

static uint32_t next_random(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)(*seed >> 33);
}

/* Deletes, doubles, swaps in or overwrites pieces; most results are nonsense, some are legal. */
static size_t damage_text(char *text, size_t length, size_t room, uint64_t *seed) {
  static const char *const pieces[] = {
      "'",   "\"", "/",    "&", "=",  ",",     "!",   "1e999",   "nan",  "-1",
      "3*",  "(",  "\n",   "$", "'x", "&end ", "0",   ".true.",  "\xC3", "%",
      "**2", " '", "'mm'", "*", "..", "' m'",  "1e5", "&region", ";",    "\0"};
  for (uint32_t edits = 1 + next_random(seed) % 4; edits > 0 && length > 0; edits--) {
    size_t at = next_random(seed) % length, size = 1 + next_random(seed) % 12;
    const char *piece = pieces[next_random(seed) % 30];
    size_t piece_length = *piece ? strlen(piece) : 1;
    if (size > length - at) size = length - at;
    switch (next_random(seed) % 3) {
    case 0:
      memmove(text + at, text + at + size, length - at - size);
      length -= size;
      break;
    case 1:
      if (length + piece_length > room) break;
      memmove(text + at + piece_length, text + at, length - at);
      memcpy(text + at, piece, piece_length);
      length += piece_length;
      break;
    default:
      if (length + size > room) break;
      memmove(text + at + size, text + at, length - at);
      length += size;
    }
  }
  return length;
}

static void no_damaged_deck_crashes(void **state) {
  (void)state;
  enum { MUTATIONS = 20000 };
  const char *const originals[] = {beam, wall};
  char text[2 * sizeof(wall) + 2 * sizeof(beam)];
  uint64_t seed = 20140601;
  int read = 0;
  for (int i = 0; i < MUTATIONS; i++) {
    const char *original = originals[i % 2];
    memcpy(text, original, strlen(original));
    size_t length = damage_text(text, strlen(original), sizeof(text), &seed);
    reading r;
    read_bytes(&r, text, length, NULL, 0);
    assert_int_equal(r.k == NULL, r.d.errors > 0);
    read += r.k != NULL;
    if (i % 16 == 0) {
      FILE *nowhere = fopen("/dev/null", "w");
      diag_print(&r.d, nowhere);
      fclose(nowhere);
    }
    end(&r);
  }
  assert_true(read > MUTATIONS / 100 &&
              read < MUTATIONS / 2); /* the damage was neither nothing nor all */
}

static void no_damaged_override_crashes(void **state) {
  (void)state;
  static const char original[] = "region[left foot].at='30 mm', 0.1";
  uint64_t seed = 7;
  for (int i = 0; i < 2000; i++) {
    char text[256] = {0};
    memcpy(text, original, sizeof(original));
    size_t length = damage_text(text, strlen(original), sizeof(text) - 1, &seed);
    text[length] = '\0';
    const char *const sets[] = {text};
    reading r;
    read_bytes(&r, beam, strlen(beam), sets, 1);
    assert_int_equal(r.k == NULL, r.d.errors > 0);
    end(&r);
  }
}

/* Ten thousand regions that all carry one name, ten thousand drives of one region: quick to
   refuse. */
static void crowded_decks_are_refused(void **state) {
  (void)state;
  char *text = NULL;
  size_t length;
  FILE *out = open_memstream(&text, &length);
  fputs("&simulation end_time = 1 /\n", out);
  for (int i = 0; i < 4000; i++)
    fprintf(out, "&region name = 'r%d' shape = 'point' at = 0, 0 /\n", i);
  for (int i = 0; i < 4000; i++)
    fprintf(out, "&drive region = 'r%d' component = 'x' velocity = 1 /\n", i);
  fputs("&drive region = 'r7' component = 'x' velocity = 1 /\n", out);
  fclose(out);
  reading r;
  read_bytes(&r, text, length, NULL, 0);
  assert_int_equal(r.d.errors, 2); /* two motions, no lattice */
  end(&r);
  free(text);
}

static const char page_path[] = SOURCE_DIR "/runtime/README.md";

static char *read_file(const char *path) {
  FILE *in = fopen(path, "r");
  assert_non_null(in);
  assert_int_equal(fseek(in, 0, SEEK_END), 0);
  long length = ftell(in);
  assert_true(length >= 0);
  rewind(in);
  char *text = must_calloc((size_t)length + 1, 1);
  assert_int_equal(fread(text, 1, (size_t)length, in), length);
  fclose(in);
  return text;
}

/* The deck on the reference page, which is indented by four blanks, is a good one. */
static void the_page_begins_with_a_good_deck(void **state) {
  (void)state;
  char *page = read_file(page_path);
  char *begin = strstr(page, "\n    ! "), *after = strstr(page, "\n## Notation");
  assert_true(begin && after && begin < after);
  *after = '\0';
  reading r;
  read_good(&r, begin, NULL, 0);
  assert_int_equal(r.k->support_count, 3);
  end(&r);
  free(page);
}

static void the_page_lists_every_unit(void **state) {
  (void)state;
  char *page = read_file(page_path);
  int count;
  const char *const *symbols = unit_symbols(&count);
  for (int i = 0; i < count; i++) {
    char shown[32];
    snprintf(shown, sizeof(shown), "`%s`", symbols[i]);
    bool plain = (unsigned char)symbols[i][0] < 0x80; /* the Greek spellings of um, us go unsaid */
    if (plain && !strstr(page, shown)) fail_msg("the page does not list the unit %s", shown);
  }
  free(page);
}

/* A file with a study alone, which names its decks. */
static bool is_study(const char *text) {
  bool whole = true;
  reading r = {.memory = arena_new()};
  const int file = source_add(&r.sources, "decks/study.nml", text, strlen(text));
  diag_begin(&r.d, &r.sources);
  const deck_study *study = deck_read_study(r.memory, &r.sources, file, &whole, &r.d);
  if (!whole) {
    diag_print(&r.d, stderr);
    assert_int_equal(r.d.count, 0);
    assert_true(study && study->decks.count > 0);
  }
  end(&r);
  return !whole;
}

static void the_examples_are_good_decks(void **state) {
  (void)state;
  glob_t found;
  assert_int_equal(glob(SOURCE_DIR "/examples/*/*.nml", 0, NULL, &found), 0);
  for (size_t i = 0; i < found.gl_pathc; i++) {
    char *text = read_file(found.gl_pathv[i]);
    reading r;
    if (!is_study(text)) {
      const char *other = deck_name;
      deck_name = found.gl_pathv[i];
      read_good(&r, text, NULL, 0);
      end(&r);
      deck_name = other;
    }
    free(text);
  }
  globfree(&found);
}

static void the_reference_is_up_to_date(void **state) {
  (void)state;
  static const char head[] = "## Groups\n\n";
  char *reference = NULL, *page = read_file(page_path);
  size_t length;
  FILE *out = open_memstream(&reference, &length);
  deck_reference(&deck_grammar_of_decks, out);
  fclose(out);
  char *groups = strstr(page, head);
  assert_non_null(groups);
  groups += strlen(head);
  bool same = strcmp(groups, reference) == 0;
  if (!same && getenv("PERILAT_BLESS")) {
    *groups = '\0';
    out = fopen(page_path, "w");
    assert_non_null(out);
    fprintf(out, "%s%s", page, reference);
    fclose(out);
    same = true;
  }
  free(page);
  free(reference);
  assert_true(same);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_beam_is_read),
                                     cmocka_unit_test(what_is_not_written_has_its_default),
                                     cmocka_unit_test(every_kind_of_value),
                                     cmocka_unit_test(loads_in_time),
                                     cmocka_unit_test(a_body_in_space),
                                     cmocka_unit_test(a_key_under_its_former_name),
                                     cmocka_unit_test(places_of_values),
                                     cmocka_unit_test(overrides_replace_and_add),
                                     cmocka_unit_test(no_damaged_deck_crashes),
                                     cmocka_unit_test(no_damaged_override_crashes),
                                     cmocka_unit_test(crowded_decks_are_refused),
                                     cmocka_unit_test(the_page_begins_with_a_good_deck),
                                     cmocka_unit_test(the_page_lists_every_unit),
                                     cmocka_unit_test(the_examples_are_good_decks),
                                     cmocka_unit_test(the_reference_is_up_to_date)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
