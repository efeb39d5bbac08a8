/* `perilat check` and `perilat info` as commands: a path is no deck, a law is meant for a setting,
   and what a law implies is said with what it is measured on. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

static const char path_of_bond[] = "&material  model = 'elastic_central'  /\n"
                                   "&path  quantity = 'stretch'  value = 1e-4  rise = '1 s'  /\n";

static void a_path_is_shown_the_way_to_drive(void **state) {
  workplace *w = *state;
  static const char *const commands[] = {"run", "build -o solver", "info"};
  write_text(w, "path.nml", path_of_bond);
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
    char arguments[100];
    snprintf(arguments, sizeof arguments, "%s path.nml", commands[k]);
    expect(w, arguments, 1, "`path.nml` is a path for `perilat drive`");
    assert_non_null(strstr(w->said, "perilat drive path.nml"));
  }
  expect(w, "check path.nml", 0, "path.nml: no errors; a path that drives one bond");
  assert_non_null(strstr(w->said, "perilat drive path.nml"));
  expect(w, "drive path.nml", 0, "elastic_central");
  /* a deck that is wrong otherwise stays a deck */
  write_text(w, "wrong.nml", "&simulation  end_time = '1 ms'  /\n&boddy  /\n");
  expect(w, "check wrong.nml", 1, "there is no group `&boddy`");
}

static const char law_for_space[] = "model solid\n  law central bond\n  for plane_strain, space\n"
                                    "  parameter EA  = 2 [MN]         in (0, inf)\n"
                                    "  parameter rho = 2300 [kg/m^3]  in (0, inf)\n"
                                    "  force N = EA*stretch\nend model\n";

static void a_law_runs_in_the_setting_it_is_meant_for(void **state) {
  workplace *w = *state;
  write_text(w, "solid.plm", law_for_space);
  write_text(w, "solid_path.nml", path_of_bond);
  expect(w, "check solid.plm", 0, "no errors");
  expect(w, "run beam.nml --set material.model=./solid.plm", 1,
         "the law `solid` is meant for plane_strain, space, but this lattice is in plane_stress");
  assert_non_null(strstr(w->said, "[conflict]"));
  /* a bond on its own is of the first setting that its law names */
  expect(w, "drive ./solid.plm solid_path.nml", 0, "time");
  expect(w, "info solid.plm", 0, "t = 100 mm, plane strain:");
  expect(w, "info solid.plm --lattice cubic", 0,
         "On a cubic lattice of 6 neighbours, s = 10 mm, space:");
}

static const char ageing_law[] = "model ageing\n  law central bond\n"
                                 "  parameter k   = 10 [MN]        in (0, inf)\n"
                                 "  parameter T_0 = 24 [h]         in (0, inf)\n"
                                 "  parameter rho = 2323 [kg/m^3]  in (0, inf)\n"
                                 "  state age on bond = 0 [s]\n  age = previous(age) + dt\n"
                                 "  force N = k*(1 + age/T_0)*stretch\nend model\n";

/* The same cycle, with the same gain. */
static void info_says_of_a_law_what_check_says(void **state) {
  workplace *w = *state;
  char gain[256];
  write_text(w, "ageing.plm", ageing_law);
  expect(w, "check ageing.plm", 1, "[dissipation]");
  snprintf(gain, sizeof gain, "%.120s", strstr(w->said, "a closed cycle gives"));
  expect(w, "info ageing.plm", 1, gain);
  expect(w, "info ageing.plm --set T_0='24 h'", 1, "[dissipation]");
}

static void what_is_accepted_in_vain_is_shown(void **state) {
  workplace *w = *state;
  static const char *const forces[] = {"k*stretch", "k*(stretch - 1e-4)"};
  static const char *const shown[] = {"`accept rest-force`: its check finds nothing here",
                                      "0 warnings, 1 finding accepted"};
  for (int k = 0; k < 2; k++) {
    char text[512];
    snprintf(text, sizeof text,
             "model spring\n  law central bond\n  parameter k = 10 [MN] in (0, inf)\n"
             "  parameter rho = 2323 [kg/m^3] in (0, inf)\n  force N = %s\n"
             "  accept rest-force \"prestressed\"\nend model\n",
             forces[k]);
    write_text(w, "accepting.plm", text);
    expect(w, "check accepting.plm", 0, shown[k]);
    assert_null(strstr(w->said, shown[1 - k]));
  }
}

/* Nikravesh 2017: the hexagon has E and nu exactly, fcc with second neighbours, too. */
static void laws_of_families_are_put_on_lattices(void **state) {
  workplace *w = *state;
  expect(w, "info splm_elastic --spacing '5 mm'", 0,
         "On a hexagonal lattice, s = 5 mm, t = 100 mm");
  assert_non_null(strstr(w->said, "E = 25.131 GPa along x, 25.131 GPa along y; nu = 0.2, 0.2"));
  assert_non_null(strstr(w->said, "3 passes"));
  assert_non_null(strstr(w->said, "stable step"));
  expect(w, "info splm_elastic --lattice fcc --shells 2", 0, "On an fcc lattice of 18 neighbours");
  assert_non_null(strstr(w->said, "E = 25.131 GPa along x"));
  assert_null(strstr(w->said, "longitudinal 0 m/s"));
  expect(w, "info lps --lattice square --horizon 3 --json", 0, "\"neighbours\": 28");
  expect(w, "info lps --lattice kagome", 1, "there is no lattice `kagome`");
  expect(w, "info lps --horizon 3 --shells 2", 1, "exclude each other");
  expect(w, "info lps --horizon far", 1, "--horizon needs a number from 1 to 8");
  expect(w, "info lps --lattice cubic --horizon 7", 1, "no neighbours, or more than");
  expect(w, "info mplm_bilinear --lattice square", 0, "On a square lattice of 4 neighbours");
  expect(w, "info mplm_space", 0,
         "E = 30 GPa along x, 30 GPa along y; nu = 0.2, 0.2; G = 12.5 GPa");
}

static void what_a_law_implies_says_what_it_is_measured_on(void **state) {
  workplace *w = *state;
  expect(w, "info mplm_bilinear --spacing '6.35 mm' --thickness '152.4 mm'", 0,
         "81.5872 N/m of a crack across it that cuts no other bonds, one in sqrt(3)/2*s*t");
  assert_non_null(strstr(w->said, "sides held"));
  expect(w, "info cohesive --set G_f='100 N/m'", 0,
         "115.47 N/m of a straight crack across the rows (opens along x), 100 N/m along them");
  /* both by two bonds of 0.05 J: in sqrt(3)/2 s t and in s t, s = 10 mm, t = 100 mm */
  assert_non_null(strstr(w->said, "costs 0.05 J: 57.735 N/m of a crack across it"));
  assert_non_null(strstr(w->said, "two in sqrt(3)/2*s*t across the rows, two in s*t along them"));
  expect(w, "info cohesive --json", 0, "\"crack_energy\": [");
}

static const char deck_of_families[] =
    "&simulation  title = 'family'  end_time = '5 us'  /\n"
    "&lattice     name = 'concrete'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '100 mm'  "
    "/\n"
    "&material    lattice = 'concrete'  model = 'splm_elastic'  /\n"
    "&body        lattice = 'concrete'  shape = 'rectangle'  corner = 0, 0  size = '60 mm', '60 "
    "mm'  /\n"
    "&output      result = 'family.h5'  /\n";

/* Its kernel against the interpreter; its mechanics on the lattice of the deck. */
static void decks_of_families_are_checked(void **state) {
  workplace *w = *state;
  write_text(w, "family.nml", deck_of_families);
  expect(w, "run family.nml --check-kernel", 0,
         "kernel check: splm_elastic and its interpreter give the same bits");
  assert_non_null(strstr(w->said, "random bonds of families in each of 4 passes"));
  expect(w, "check family.nml", 0, "no errors");
  assert_null(strstr(w->said, "[patch]"));
  expect(w, "check family.nml --set lattice.kind=square --set lattice.shells=2", 0, "[patch]");
  assert_non_null(strstr(w->said, "particles of a square lattice"));
}

/* --- a law on the lattice of its deck --------------------------------------------------------- */

static void write_central(const workplace *w, const char *name, const char *body) {
  char text[1000], file[100];
  snprintf(text, sizeof text,
           "model %s\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
           "  parameter rho = 2400 [kg/m^3] in (0, inf)\n%send model\n",
           name, body);
  snprintf(file, sizeof file, "%s.plm", name);
  write_text(w, file, text);
}

#define DECK_WITH(lattice, body, law)                                                              \
  "&simulation  end_time = 1  /\n&output  frames = 1  /\n&lattice  name = 'l' " lattice " /\n"     \
  "&material  lattice = 'l'  model = './" law ".plm'  /\n" body

static const char block[] = "&body  lattice = 'l'  shape = 'box'  corner = 3*0  size = 3*0.05 /\n",
                  plate[] = "&body  lattice = 'l'  shape = 'rectangle'  corner = 0, 0  size = "
                            "2*0.05 /\n";

static void bonds_are_told_the_same_wherever_a_law_is_asked(void **state) {
  workplace *w = *state;
  char text[1000];
  write_central(w, "by_horizon", "  constant c = E*s*horizon\n  force N = -c*stretch\n");
  write_central(w, "by_volume", "  force N = -E*V/s*stretch\n");
  write_central(w, "over_both",
                "  force N = E*V/horizon*stretch + 0*m*E/rho/s*stretch/area*s**2\n");
  expect(w, "check by_horizon.plm", 1, "[stiffness]");
  expect(w, "check by_volume.plm", 1, "[stiffness]");
  expect(w, "check over_both.plm", 0, "no errors");
  snprintf(text, sizeof text, DECK_WITH("kind = 'fcc' spacing = '10 mm'", "%s", "by_volume"),
           block);
  write_text(w, "fcc.nml", text);
  expect(w, "check fcc.nml", 1, "[stiffness]");
  expect(w, "check fcc.nml --set material.model=./by_horizon.plm", 1, "[stiffness]");
  write_central(w, "in_space", "  force N = E*V/horizon*stretch\n");
  expect(w, "check fcc.nml --set material.model=./in_space.plm", 0, "no errors");
  /* a path tells it as a run does: horizon 10 mm, E V/horizon 1e-4 */
  write_text(w, "path.nml",
             "&material  model = './in_space.plm'  /\n"
             "&path  quantity = 'stretch'  value = 1e-4  rise = '1 s'  /\n"
             "&expect  quantity = 'peak N'  formula = 'E*V/s*1e-4'  tolerance = "
             "1e-12  /\n");
  expect(w, "drive path.nml", 0, "1 of 1 expectations hold");
}

static void a_length_of_its_own_is_judged_on_the_lattice_of_the_deck(void **state) {
  workplace *w = *state;
  char text[1000];
  write_central(w, "repulsion",
                "  parameter reach = 2 [m] in (0, inf)\n"
                "  force N = | 1e-3*E*(length - reach)*1 [m] when length < reach\n"
                "            | 0 [N] otherwise\n");
  write_text(w, "points.csv", "x [m], y [m], z [m], volume [m^3]\n0, 0, 0, 1\n2, 0, 0, 1\n");
  shell(w, "sed -i 's/law central bond/law central bond\\n  for space, irregular/' repulsion.plm");
  snprintf(text, sizeof text,
           DECK_WITH("kind = 'particles' setting = 'space' file = 'points.csv' neighbours = 1", "",
                     "repulsion"));
  write_text(w, "two.nml", text);
  expect(w, "check repulsion.plm", 1, "[rest-force]");
  expect(w, "check two.nml", 0, "no errors");
  /* that the two verdicts differ both say */
  assert_non_null(strstr(w->said, "with these values on this lattice, but not with all"));
  expect(w, "check two.nml --set material.reach=2.1", 1, "[rest-force]");
}

static void verdicts_that_depend_on_values_say_so(void **state) {
  workplace *w = *state;
  char text[1000];
  write_central(w, "turning",
                "  parameter c = 0.4 in [0, 1]\n  force N = (1 - 2*c)*E*s*t*stretch\n");
  snprintf(text, sizeof text,
           DECK_WITH("kind = 'hexagonal' spacing = '10 mm' thickness = '10 mm'", "%s", "turning"),
           plate);
  write_text(w, "deck.nml", text);
  expect(w, "check turning.plm", 1, "a deck is judged with its own values");
  expect(w, "check deck.nml", 0, "but not with all that its bounds allow");
  expect(w, "check deck.nml --set material.c=0.6", 1, "[stiffness]");
  shell(w,
        "cat deck.nml > regional.nml; echo \"&region name = 'r' shape = 'disc' centre = 0, 0 "
        "radius = '30 mm' / &material lattice = 'l' region = 'r' model = './turning.plm' c = 0.6 "
        "E = '3 GPa' /\" >> regional.nml");
  expect(w, "check regional.nml", 1, "[stiffness]");
  expect(w, "check turning.plm --set c=0.4", 0, "no errors");
  expect(w, "info turning.plm --set E='30 GPa' --set c=0.4 --spacing 10mm", 0,
         "but not with all that its bounds allow");
  expect(w, "info turning.plm --set E='30 GPa' --set c=0.6 --spacing 10mm", 1, "[stiffness]");
}

/* --- one verdict ------------------------------------------------------------------------------ */

static void commands_agree(void **state) {
  workplace *w = *state;
  char text[1000];
  /* a horizon that reaches the nearest neighbours only */
  expect(w, "info mplm_bilinear --horizon 1.2", 0, "stable step");
  expect(w, "check beam.nml --set lattice.horizon=1.2", 0, "no errors");
  expect(w, "info mplm_bilinear --horizon 1.8", 0, "stable step");
  expect(w, "check beam.nml --set lattice.horizon=1.8", 0, "no errors");
  /* random fields are for all laws */
  write_central(w, "plain", "  force N = E*s*t*stretch\n");
  snprintf(text, sizeof text,
           DECK_WITH("kind = 'square' spacing = '10 mm' thickness = '10 mm'",
                     "%s&field  parameter = 'E'  distribution = 'normal'  cv = 0.1  /\n", "plain"),
           plate);
  write_text(w, "field.nml", text);
  expect(w, "check field.nml", 0, "E differs from bond to bond");
  expect(w, "check field.nml --set material.model=splm_elastic", 0,
         "E differs from particle to particle");
  expect(w, "check field.nml --set material.model=splm_elastic --set field.on=bond", 1,
         "its parameters have values on particles");
  expect(w, "check field.nml --set material.model=splm_elastic --set lattice.kind=blue_noise", 0,
         "E differs from particle to particle");
  /* upper and lower case differ in laws */
  expect(w, "info plain.plm", 0, "stable step           2");
  shell(w, "sed 's/rho/Rho/' plain.plm > other.plm");
  expect(w, "info other.plm", 0, "the law has no `rho`");
  snprintf(text, sizeof text,
           DECK_WITH("kind = 'hexagonal' spacing = '10 mm' thickness = '10 mm'", "%s", "other"),
           plate);
  write_text(w, "other.nml", text);
  expect(w, "check other.nml", 1, "write `rho` for `Rho`");
}

static void bonds_of_plane_strain_are_asked_for(void **state) {
  workplace *w = *state;
  char text[1000];
  static const char *const laws[] = {"mplm_bilinear", "mplm_concrete", "elastic_micropolar"};
#define IN_PLANE_STRAIN "check beam.nml --set lattice.setting=plane_strain --set material.model="
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    char command[200];
    snprintf(command, sizeof command, IN_PLANE_STRAIN "%s", laws[k]);
    expect(w, command, 0, "no errors");
    assert_null(strstr(w->said, "warning"));
    snprintf(command, sizeof command, IN_PLANE_STRAIN "%s --set material.nu=0.26", laws[k]);
    expect(w, command, 1, "`nu` = 0.26 is not in [0, 0.25]");
    snprintf(command, sizeof command,
             "check beam.nml --set material.model=%s --set material.nu=0.26", laws[k]);
    expect(w, command, 0, "no errors");
  }
  expect(w, IN_PLANE_STRAIN "elastic_central", 1,
         "is meant for plane_stress, but this lattice is in plane_strain");
  write_central(w, "plain", "  force N = sqrt(3)/2/(1 - 1/16)*E*s*t*stretch\n");
  snprintf(text, sizeof text,
           DECK_WITH("kind = 'hexagonal' spacing = '10 mm' thickness = '10 mm' setting = "
                     "'plane_strain'",
                     "%s", "plain"),
           plate);
  write_text(w, "strain.nml", text);
  expect(w, "check strain.nml", 0, "does not say for which setting it is");
  shell(w, "sed -i 's/law central bond/law central bond\\n  for plane_strain/' plain.plm");
  expect(w, "check strain.nml", 0, "no errors");
  assert_null(strstr(w->said, "warning"));
}

/* Coefficients that are meant for other neighbours. */
static void a_modulus_that_was_not_asked_for_is_told(void **state) {
  workplace *w = *state;
  write_text(w, "space.nml",
             "&simulation end_time = '1 ms' /\n"
             "&lattice name = 'c' kind = 'fcc' spacing = '6 mm' shells = 2 /\n"
             "&material lattice = 'c' model = 'mplm_space' E = '30 GPa' /\n"
             "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.04, 0.04, 0.04 /\n");
  expect(w, "check space.nml", 0, "on this lattice E = 30 GPa, nu = 0.2000");
  expect(w, "check space.nml --set lattice.shells=1", 0, "GPa (E = 30 GPa was asked for), nu = ");
}

/* A chain has an area and no thickness, other lattices the other way round; families on a line
   resolve no strain. */
static void laws_have_the_section_that_they_read(void **state) {
  workplace *w = *state;
  static const char chain[] =
      "&simulation end_time = '1 ms' /\n"
      "&lattice name = 'l' kind = 'chain' spacing = '10 mm' area = '100 mm^2' /\n"
      "&material lattice = 'l' model = 'bar' /\n"
      "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.01 /\n";
  write_text(w, "chain.nml", chain);
  expect(w, "check chain.nml", 0, "along this chain E = 200 GPa");
  expect(w, "check chain.nml --set body.corner=0,0.001", 1, "the row of a chain goes through");
  char watched[sizeof chain + 200];
  snprintf(watched, sizeof watched,
           "%s&monitor name = 'e' kind = 'strain' at = 0, 0 component = 'xx' /\n", chain);
  write_text(w, "watched.nml", watched);
  expect(w, "check watched.nml", 1, "hint: along a chain it is the `stress` over E");
  expect(w, "check chain.nml --set material.model=mplm_bilinear", 1,
         "reads the thickness `t`, which a chain does not have");
  expect(w, "check chain.nml --set material.model=lps", 1,
         "reads whole families, but a chain has bonds along one line alone");
  expect(w, "check beam.nml --set material.model=bar", 1,
         "reads `area`, the cross-section of a bar, which chains and bars alone have");
  expect(w, "info bar", 0, "On a chain of 2 neighbours, s = 10 mm, A = 100 mm^2:");
  expect(w, "info bar --area '2 cm^2'", 0, "E = 200 GPa along it, EA = 40 MN");
  expect(w, "info bar --lattice square", 1, "which chains and bars alone have");
  write_text(w, "path.nml",
             "&material model = 'bar' /\n&path quantity = 'stretch' value = 1e-4 rise "
             "= '1 s' /\n");
  expect(w, "drive path.nml", 1, "the law `bar` reads `area`: `&bond` must give it");
  expect(w, "drive path.nml --set bond.area=1e-4", 0, "A = 100 mm^2");
  expect(w, "drive elastic_central path.nml --set bond.area=1e-4", 1,
         "the law `elastic_central` does not read `area`");
}

/* --- everything at once ----------------------------------------------------------------------- */

static const char many_faults[] =
    "&simulation  end_time = '1 ms'  /\n"
    "&lattice     name = 'l'  kind = 'hexagonal'  spacing = '5 mm'  thickness = '10 mm'  /\n"
    "&body        lattice = 'l'  shape = 'rectangle'  corner = 0, 0  size = 0.05, 0.02  /\n"
    "&material    lattice = 'l'  model = 'mplm_bilinear'  S_q = 1e-4  /\n"
    "&gravty      acceleration = 0, 1  /\n"
    "&region      name = 'all'  shape = 'rectangle'  corner = 0, 0  size = 0.05, 0.02  /\n"
    "&region      name = 'left'  shape = 'rectangle'  corner = 0, 0  size = 0.01, 0.02  /\n"
    "&region      name = 'far'  shape = 'rectangle'  corner = 1, 1  size = 0.01, 0.02  /\n"
    "&support     region = 'all'  fix = 'w'  /\n"
    "&initial_velocity  region = 'all'  component = 'x'  value = 1  /\n"
    "&initial_velocity  region = 'left'  component = 'x'  value = 2  /\n"
    "&monitor     name = 'm'  kind = 'field'  region = 'all'  field = 'omg'  /\n"
    "&output      fields = 'dmage'  /\n";

/* The lines that errors and warnings name, in their order: "4 5 8". */
static const char *lines_named(const workplace *w, const char *file, char text[200]) {
  const size_t length = strlen(file);
  size_t used = 0;
  text[0] = 0;
  for (const char *at = w->said; at; at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL) {
    int line, column;
    char kind[16];
    if (strncmp(at, file, length) != 0 ||
        sscanf(at + length, ":%d:%d: %15[a-z]", &line, &column, kind) != 3 ||
        strcmp(kind, "note") == 0)
      continue;
    used += (size_t)snprintf(text + used, 200 - used, "%s%d", used ? " " : "", line);
  }
  return text;
}

static void all_that_is_wrong_is_said_at_once(void **state) {
  workplace *w = *state;
  char text[200];
  write_text(w, "many.nml", many_faults);
  expect(w, "check many.nml", 1, "has no parameter `S_q`");
  assert_string_equal(lines_named(w, "many.nml", text), "4 5 8 9 11 12 13");
  expect(w, "run many.nml", 1, "given two initial velocities in x");
  assert_string_equal(lines_named(w, "many.nml", text), "4 5 8 9 11 12 13");
  /* what follows from something wrong is not said: bodies that are not known, a law that is not
     there */
  shell(w, "sed 's/[&]body /\\&bodyy /' many.nml > body.nml");
  expect(w, "check body.nml", 1, "there is no group `&bodyy`");
  assert_string_equal(lines_named(w, "body.nml", text), "3 4 5 9");
  shell(w, "sed '/[&]body/d' beam.nml > bodiless.nml");
  expect(w, "check bodiless.nml", 1, "the lattice `concrete` has no `&body`");
  assert_null(strstr(w->said, "empty-region"));
  expect(w, "check many.nml --set material.model=nope", 1, "there is no model `nope`");
  assert_string_equal(lines_named(w, "many.nml", text), "5 8 9 11");
  /* a law that breaks mechanics has no step to be unstable with */
  write_central(w, "away", "  force N = -E*s*t*stretch\n");
  expect(w, "check many.nml --set material.model=./away.plm --set material.S_q=", 1, "[stiffness]");
  assert_null(strstr(w->said, "unstable at rest"));
  assert_string_equal(lines_named(w, "many.nml", text), "5 8 9 11 12 13");
  /* the law's file first, in the order of its lines */
  write_text(w, "two.plm",
             "model two\n  law central bond\n  parameter E = 30 [GPa] in (0, inf)\n"
             "  parameter rho = 2400 [kg/m^3]\n  unused_one = stretch*alfa\n"
             "  force N = E*s*t*strech\nend model\n");
  expect(w, "check many.nml --set material.model=./two.plm", 1, "there is no quantity `strech`");
  assert_string_equal(lines_named(w, "././two.plm", text), "5 6");
  assert_string_equal(lines_named(w, "many.nml", text), "5 8 9 11");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_path_is_shown_the_way_to_drive, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_law_runs_in_the_setting_it_is_meant_for, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_a_law_implies_says_what_it_is_measured_on,
                                      set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(info_says_of_a_law_what_check_says, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_is_accepted_in_vain_is_shown, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(laws_of_families_are_put_on_lattices, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(decks_of_families_are_checked, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(bonds_are_told_the_same_wherever_a_law_is_asked,
                                      set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_length_of_its_own_is_judged_on_the_lattice_of_the_deck,
                                      set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(verdicts_that_depend_on_values_say_so, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(commands_agree, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_modulus_that_was_not_asked_for_is_told, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(laws_have_the_section_that_they_read, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(bonds_of_plane_strain_are_asked_for, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(all_that_is_wrong_is_said_at_once, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
