/* Decks with holes by the program itself: Kirsch's plate, a tunnel below a blast, a crack that runs
   into a hole. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct table { /* of a history */
  double time[1024], value[1024];
  int count;
} table;

/* What a command prints, in one text. */
static const char *said_by(const char *command) {
  static char text[65536];
  FILE *in = popen(command, "r");
  assert_non_null(in);
  const size_t length = fread(text, 1, sizeof text - 1, in);
  text[length] = '\0';
  assert_int_equal(pclose(in), 0);
  return text;
}

/* Runs a deck of examples/ with a change, and reads one history. */
static table history_of(const char *deck, const char *change, const char *name) {
  char command[2048];
  table t = {.count = 0};
  snprintf(command, sizeof command,
           "folder=$(mktemp -d) && '%s' run '%s/examples/%s' %s --set output.result=$folder/r.h5 "
           ">/dev/null 2>&1 && '%s' export --history '%s' $folder/r.h5; rm -r $folder",
           PERILAT_PROGRAM, SOURCE_DIR, deck, change, PERILAT_PROGRAM, name);
  for (const char *line = said_by(command); line; line = strchr(line, '\n')) {
    line += *line == '\n';
    if (t.count < 1024 && sscanf(line, "%lf,%lf", &t.time[t.count], &t.value[t.count]) == 2)
      t.count++;
  }
  assert_true(t.count > 0);
  return t;
}

static double last(const table *t) {
  return t->value[t->count - 1];
}

static void a_plate_with_a_hole(void **state) {
  (void)state;
  const table top = history_of("plate_with_hole/hole.nml", "--set mesh.nodes=41,41", "top"),
              side = history_of("plate_with_hole/hole.nml", "--set mesh.nodes=41,41", "side");
  print_message("plate with a hole: %.4f on top, %.4f at its side\n", last(&top), last(&side));
  assert_true(fabs(last(&top) - 3) < 0.03 * 3 && fabs(last(&side) + 1) < 0.03);
}

/* K is in proportion to the pressure as long as nothing grows; before the wave nothing is, and the
   first that comes is pressure on the faces. */
static void a_tunnel_below_a_blast(void **state) {
  (void)state;
  const table once = history_of("cavern/tunnel.nml", "", "roof/K_I"),
              twice = history_of("cavern/tunnel.nml", "--set traction.stress=-4e7", "roof/K_I"),
              alone = history_of("cavern/tunnel.nml", "--set simulation.threads=1", "roof/K_I");
  const double c_d = sqrt(72e9 / 2650);
  double most = 0, least = 0, before = 0, after_least = 0;
  assert_true(once.count == twice.count && once.count == alone.count);
  for (int k = 0; k < once.count; k++) {
    most = fmax(most, once.value[k]);
    if (once.value[k] < least) {
      least = once.value[k];
      after_least = once.time[k];
    }
    assert_true(alone.value[k] == once.value[k]);
    assert_true(fabs(twice.value[k] - 2 * once.value[k]) < 1e-6 * 7e6);
    if (once.time[k] < 0.8 * 7.2 / c_d) before = fmax(before, fabs(once.value[k]));
  }
  print_message("tunnel: K_I from %.2f to %.2f MPa m^(1/2)\n", 1e-6 * least, 1e-6 * most);
  assert_true(before < 0.01 * most && least < -1e6 && most > 6.5e6 && most < 7.6e6);
  assert_true(fabs(after_least - 8 / c_d) < 0.1e-3);
}

/* A crack from the left edge towards the middle of a round hole, pulled open. */
static const char *const deck_of_run =
    "&simulation end_time = '0.4 ms' step_safety = 0.8 /\n"
    "&mesh name = 'plate' size = '200 mm', '100 mm' nodes = 81, 42 thickness = '10 mm' method = "
    "'element_free' /\n"
    "&notch mesh = 'plate' shape = 'disc' centre = '120 mm', '50 mm' radius = '15 mm' /\n"
    "&material mesh = 'plate' model = 'elastic' E = '30 GPa' nu = 0.2 rho = 2400 /\n"
    "&crack name = 'crack' mesh = 'plate' points = 0, '50 mm', '60 mm', '50 mm' grows = .true. "
    "model = 'lefm' K_Ic = '0.1 MPa*m^(1/2)' v_0 = '400 m/s' /\n"
    "&crack name = 'wall' mesh = 'plate' points = '134 mm', '50 mm', '150 mm', '50 mm' /\n"
    "&tips half_size = 4 check_steps = 10 updates = 5 /\n"
    "&traction mesh = 'plate' from = 0, '100 mm' to = '200 mm', '100 mm' component = 'y' stress = "
    "'1 MPa' /\n"
    "&traction mesh = 'plate' from = 0, 0 to = '200 mm', 0 component = 'y' stress = '-1 MPa' /\n"
    "&output result = 'r.h5' frames = 8 sample = '5 us' /\n";

static void a_crack_runs_into_a_hole(void **state) {
  (void)state;
  char command[4096];
  double x = 0, length = 0, wall = 0, speed = 1;
  snprintf(
      command, sizeof command,
      "folder=$(mktemp -d) && cd $folder && cat > d.nml <<'END'\n%sEND\n'%s' run d.nml 2>&1 && "
      "for n in crack/x crack/length crack/speed wall/length; do '%s' export --history $n r.h5 | "
      "tail -n 1; done; cd /; rm -r $folder",
      deck_of_run, PERILAT_PROGRAM, PERILAT_PROGRAM);
  const char *said = said_by(command), *values = said;
  if (!strstr(said, "has run into a hole")) print_message("%s\n", said);
  assert_non_null(strstr(said, "has run into a hole"));
  for (const char *line = said; (line = strchr(line, '\n')) && line[1]; line++)
    if (strncmp(line + 1, "0.0003", 6) == 0 || strncmp(line + 1, "0.0004", 6) == 0) {
      values = line + 1;
      break;
    }
  assert_int_equal(
      sscanf(values, "%*[^,],%lf %*[^,],%lf %*[^,],%lf %*[^,],%lf", &x, &length, &speed, &wall), 4);
  assert_true(fabs(x - 0.105) < 1e-4 && fabs(length - 0.105) < 1e-4 && speed == 0);
  assert_true(fabs(wall - 0.015) < 1e-9); /* what of it is outside of the hole */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_plate_with_a_hole),
      cmocka_unit_test(a_tunnel_below_a_blast),
      cmocka_unit_test(a_crack_runs_into_a_hole),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
