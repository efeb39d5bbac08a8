/* Generated C: literals, names, and the text of whole kernels made from graphs that are written by
 * hand: hostile names, awkward expressions, and the loop that must vectorise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "generator/emit/descriptor.h"
#include "generator/emit/emit.h"
#include "generator/ir/interpret.h"
#include "generator/kernel/toolchain.h"
#include "generator/kernel/toolchain_compiler.h"
#include "generator/plan/plan_roots.h"
#include "generator/target/c_text.h"

#define ERROR_SIZE 2000

/* --- literals and names ----------------------------------------------------------------------- */

static void numbers_read_back_to_the_same_bits(void **state) {
  (void)state;
  const double values[] = {0,
                           -0.0,
                           1,
                           -1,
                           0.1,
                           1.0 / 3,
                           1e300,
                           -1e-300,
                           5e-324,
                           1.18e-4,
                           2323,
                           30e9,
                           1e22,
                           1e23,
                           415,
                           0x1.fffffffffffffp1023,
                           123456789012345678.0};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
    c_text t = {0};
    c_text_number(&t, values[k]);
    const char *digits = t.text + (t.text[0] == '(');
    double back = strtod(digits, NULL);
    assert_memory_equal(&back, &values[k], sizeof back);
    assert_non_null(strpbrk(t.text, ".e")); /* an integer literal would divide as integers */
    free(t.text);
  }
}

static void strings_cannot_leave_their_quotes(void **state) {
  (void)state;
  c_text t = {0};
  c_text_string(&t, "a\"b\\c\n?\?/*\xc3\xbc%s");
  assert_string_equal(t.text, "\"a\\042b\\134c\\012\\077\\077/*\\303\\274\\045s\"");
  free(t.text);
  t = (c_text){0};
  c_text_string(&t, NULL);
  assert_string_equal(t.text, "0");
  free(t.text);
}

static void names_are_identifiers_and_unique(void **state) {
  (void)state;
  c_names n = {0};
  assert_string_equal(c_names_make(&n, "omega"), "omega");
  assert_string_equal(c_names_make(&n, "omega"), "omega_2");
  assert_string_equal(c_names_make(&n, "omega"), "omega_3");
  assert_string_equal(c_names_make(&n, "omega_2"), "omega_2_2");
  assert_string_equal(c_names_make(&n, "double"), "x_double");
  assert_string_equal(c_names_make(&n, "pl_exp"), "x_pl_exp");
  assert_string_equal(c_names_make(&n, "unix"), "x_unix");
  assert_string_equal(c_names_make(&n, "S_p'"), "S_p_");
  assert_string_equal(c_names_make(&n, "1; system(\"x\")"), "x1__system__x__");
  assert_string_equal(c_names_make(&n, "__LINE__"), "x__LINE__");
  assert_true(c_names_reserve(&n, "law"));
  assert_false(c_names_reserve(&n, "law"));
  assert_string_equal(c_names_make(&n, "law"), "law_2");
  for (int k = 0; k < 1000; k++)
    assert_non_null(c_names_make(&n, "many"));
  assert_string_equal(c_names_make(&n, "many"), "many_1001");
  c_names_clear(&n);
}

/* --- a plan by hand --------------------------------------------------------------------------- */

enum { ROOM = 300 }; /* roots and fields */

typedef struct hand_made {
  tree tree;
  symbol symbols[3], *parameters[1], *outputs[1], *lists[ROOM];
  stmt declared;
  source_set sources;
  law law;
  kernel_plan plan;
} hand_made;

static symbol hand_symbol(symbol_kind kind, const char *name, double initial) {
  return (symbol){
      .kind = kind, .name = name, .initial = initial, .has_default = true, .doc = "a \"doc\" ?\?/"};
}

/* One parameter, one damage, one output. */
static hand_made *hand_new(const char *parameter, const char *field) {
  hand_made *h = calloc(1, sizeof *h);
  assert_non_null(h);
  h->tree.name = "by_hand";
  h->tree.law = LAW_MICROPOLAR_BOND;
  h->symbols[0] = hand_symbol(SYMBOL_PARAMETER, parameter, 0.25);
  h->symbols[0].declared = &h->declared;
  h->symbols[1] = hand_symbol(SYMBOL_DAMAGE, field, 0);
  h->symbols[2] = hand_symbol(SYMBOL_OUTPUT, "shown", 0);
  h->parameters[0] = &h->symbols[0];
  h->lists[0] = &h->symbols[1];
  h->outputs[0] = &h->symbols[2];
  h->law.tree = &h->tree;
  h->law.sources = &h->sources;
  h->law.parameters = (symbol_list){h->parameters, 1};
  h->law.fields = (symbol_list){h->lists, 1};
  h->law.outputs = (symbol_list){h->outputs, 1};
  h->plan = (kernel_plan){.law = &h->law,
                          .graph = ir_new(),
                          .memory = arena_new(),
                          .dimensions = 2,
                          .dof = 3,
                          .force_planes = 4};
#define X(task, member) plan_single(&h->plan, task, #member, OVER_BONDS);
  STRIP_PROGRAMS(X)
#undef X
  plan_single(&h->plan, PROGRAM_STATES, "states", OVER_BONDS);
  plan_single(&h->plan, PROGRAM_TANGENT, "tangent", OVER_BONDS);
  plan_single(&h->plan, PROGRAM_BOUNDS, "bounds", OVER_BODY);
  return h;
}

static void hand_free(hand_made *h) {
  ir_free(h->plan.graph);
  arena_free(h->plan.memory);
  free(h->plan.uniforms);
  free(h);
}

static void add_root(hand_made *h, program_task task, ir_node n, segment_target target, int index) {
  segment *a = plan_segment(&h->plan, task);
  segment_add(h->plan.memory, a,
              (segment_root){.node = n, .target = target, .over = a->kind, .index = index});
}

/* Body nodes that others read. */
static void find_uniforms(hand_made *h) {
  const ir *g = h->plan.graph;
  int count = ir_count(g);
  h->plan.uniforms = calloc((size_t)count, sizeof *h->plan.uniforms);
  for (ir_node n = 0; n < count; n++) {
    bool read = false;
    for (ir_node user = n; user < count && !read; user++)
      for (int k = 0; k < ir_arity(ir_operation(g, user)); k++)
        read |= ir_operand(g, user, k) == n && ir_place(g, user) > ON_BODY;
    if (read && ir_place(g, n) <= ON_BODY && ir_operation(g, n) != IR_CONSTANT)
      h->plan.uniforms[h->plan.uniform_count++] = n;
  }
}

static ir_node un(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}
static ir_node bi(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}
static ir_node number(ir *g, double x) {
  return ir_constant(g, x);
}

static ir_node named(ir *g, ir_node n, const char *name) {
  ir_set_name(g, n, name, (span){0, 0, 0});
  return n;
}

static loaded_kernel load(const hand_made *h, char **text) {
  char error[ERROR_SIZE] = "";
  loaded_kernel k;
  char *unkeyed = emit_kernel(&h->plan), *key = toolchain_key(unkeyed);
  *text = descriptor_keyed(unkeyed, key);
  if (!toolchain_load(*text, key, &k, error, sizeof error)) fail_msg("%s", error);
  assert_string_equal(k.law->key, key);
  free(unkeyed);
  free(key);
  return k;
}

/* --- every operation -------------------------------------------------------------------------- */

/* All operations of one and two operands on two inputs and on each other's results, a level deep,
   so that each stands inside each; the sum over k of the values cannot hide a single wrong one
   because each is its own output. */
static int make_expressions(ir *g, ir_node x, ir_node y, ir_node *out, int room) {
  ir_node first[64];
  int n = 0, count = 0;
  for (int op = IR_ADD; op < IR_FAMILY_SUM; op++) {
    int arity = ir_arity((ir_op)op);
    first[n++] = arity == 1     ? un(g, (ir_op)op, x)
                 : arity == 2   ? bi(g, (ir_op)op, x, y)
                 : op == IR_FMA ? ir_make(g, IR_FMA, x, y, x)
                                : ir_make(g, IR_SELECT, bi(g, IR_LT, x, y), x, y);
  }
  for (int a = 0; a < n; a++)
    for (int op = IR_ADD; op < IR_FAMILY_SUM && count + 2 < room; op++) {
      ir_node b = first[(7 * a + op) % n];
      if (ir_arity((ir_op)op) == 1)
        out[count++] = un(g, (ir_op)op, first[a]);
      else if (op == IR_SELECT)
        out[count++] = ir_make(g, IR_SELECT, bi(g, IR_LE, first[a], b), b,
                               ir_make(g, IR_SELECT, bi(g, IR_LT, y, b), x, first[a]));
      else if (op == IR_FMA) {
        out[count++] = ir_make(g, IR_FMA, first[a], b, x);
        out[count++] = ir_make(g, IR_FMA, y, un(g, IR_NEG, b), first[a]);
      } else {
        out[count++] = bi(g, (ir_op)op, first[a], b);
        out[count++] = bi(g, (ir_op)op, b, first[a]);
      }
    }
  return count;
}

enum { STATES = 49, MOST_EXPRESSIONS = 1500 };

/* Finite, signed zero, infinite and NaN states. */
static void fill_states(double *x, double *y, double *field) {
  static const double special[7] = {0.0, -0.0, 1.5, -0.75, 3e5, INFINITY, NAN};
  for (int q = 0; q < STATES; q++) {
    x[q] = special[q % 7];
    y[q] = special[q / 7];
    field[q] = 0;
  }
}

static double **new_planes(int count) {
  double **planes = calloc((size_t)count, sizeof *planes);
  for (int k = 0; k < count; k++) {
    planes[k] = malloc(STATES * sizeof **planes);
    for (int q = 0; q < STATES; q++)
      planes[k][q] = -12345; /* no result */
  }
  return planes;
}

static void free_planes(double **planes, int count) {
  for (int k = 0; k < count; k++)
    free(planes[k]);
  free(planes);
}

static void interpret(const ir *g, const ir_node *nodes, int count, const double *x,
                      const double *y, double **planes) {
  interpreter *p = interpreter_new(g, nodes, count);
  const double *quantities[QUANTITY_COUNT] = {[QUANTITY_STRETCH] = x, [QUANTITY_STRETCH_RATE] = y};
  const unsigned char strides[QUANTITY_COUNT] = {
      [QUANTITY_STRETCH] = 1, [QUANTITY_STRETCH_RATE] = 1};
  interpreter_inputs inputs = {.values = {[IR_FROM_QUANTITY] = quantities},
                               .stride = {[IR_FROM_QUANTITY] = strides}};
  interpreter_run(p, &inputs, STATES, planes);
  interpreter_free(p);
}

/* The same bits in C and in the interpreter; NaN for NaN. */
static void assert_same_bits(const ir *g, const pl_law *kernel, const ir_node *nodes, int count) {
  double x[STATES], y[STATES], field[STATES];
  const double **in = calloc((size_t)count + 8, sizeof *in);
  double **out = new_planes(count), **expected = new_planes(count);
  fill_states(x, y, field);
  for (int k = 0; k < count + 8; k++)
    in[k] = k == 0 ? x : k == 1 ? y : field;
  const pl_states s = {.size = sizeof s,
                       .count = STATES,
                       .in = in,
                       .field = in + 5,
                       .out = out,
                       .new_field = count > 3 ? out + 3 : out};
  kernel->states(kernel, NULL, &s);
  interpret(g, nodes, count, x, y, expected);
  for (int k = 0; k < count; k++)
    for (int q = 0; q < STATES; q++) {
      double a = out[k][q], b = expected[k][q];
      if (memcmp(&a, &b, sizeof a) != 0 && !(isnan(a) && isnan(b)))
        fail_msg("%s at (%g, %g): %.17g, interpreter %.17g", ir_op_name(ir_operation(g, nodes[k])),
                 x[q], y[q], a, b);
    }
  free_planes(out, count);
  free_planes(expected, count);
  free(in);
}

static void every_operation_has_the_bits_of_the_interpreter(void **state) {
  (void)state;
  hand_made *h = hand_new("p", "w");
  ir_node all[MOST_EXPRESSIONS];
  ir *g = h->plan.graph;
  ir_node x = ir_input(g, IR_FROM_QUANTITY, QUANTITY_STRETCH, "stretch", ON_BOND);
  ir_node y = ir_input(g, IR_FROM_QUANTITY, QUANTITY_STRETCH_RATE, "stretch_rate", ON_BOND);
  int count = make_expressions(g, x, y, all, MOST_EXPRESSIONS);
  assert_true(count > 500);
  for (int begin = 0; begin < count; begin += ROOM) {
    int n = count - begin < ROOM ? count - begin : ROOM;
    plan_segment(&h->plan, PROGRAM_STATES)->root_count = 0;
    for (int k = 0; k < n; k++)
      add_root(h, PROGRAM_STATES, all[begin + k], TO_OUT, k);
    for (int k = 0; k < n - 3; k++)
      h->lists[k] = &h->symbols[1];
    h->law.fields = (symbol_list){h->lists, n > 3 ? n - 3 : 0};
    char *text;
    loaded_kernel loaded = load(h, &text);
    assert_same_bits(g, loaded.law, all + begin, n);
    toolchain_unload(&loaded);
    free(text);
  }
  hand_free(h);
}

/* --- a beam of a lattice ---------------------------------------------------------------------- */

static ir_node parameter(ir *g, int k, const char *name) {
  return ir_input(g, IR_FROM_PARAMETER, k, name, ON_BODY);
}

/* (1 - a)(x - b)/x, the shape of every line of the softening law (Asadollahi 2014, eq 3.15). */
static ir_node softening(ir *g, ir_node x, ir_node factor, ir_node begin) {
  return ir_div(g, ir_mul(g, factor, ir_sub(g, x, begin)), x);
}

static ir_node bilinear_damage(ir *g, const bond_kinematics *k, ir_node twice_i, ir_node twice_j) {
  ir_node two_over_s = ir_div(g, number(g, 2), k->s), S_t = parameter(g, 2, "S_t");
  ir_node psi = bi(g, IR_MAX, un(g, IR_ABS, ir_mul(g, two_over_s, twice_i)),
                   un(g, IR_ABS, ir_mul(g, two_over_s, twice_j)));
  ir_node beta_s = ir_mul(g, parameter(g, 3, "beta"), k->s);
  ir_node eps = named(g, ir_add(g, k->stretch, ir_mul(g, beta_s, psi)), "eps_mp");
  ir_node last = ir_mul(g, number(g, 415), S_t), knee = ir_mul(g, number(g, 20), S_t);
  ir_node rule = ir_select(g, bi(g, IR_LE, eps, last), softening(g, eps, number(g, 1.0004), knee),
                           number(g, 1));
  rule = ir_select(g, bi(g, IR_LE, eps, knee), softening(g, eps, number(g, 0.95), S_t), rule);
  rule = ir_select(g, bi(g, IR_LE, eps, S_t), number(g, 0), rule);
  ir_node old = ir_input(g, IR_FROM_FIELD, 0, "omega", ON_BOND);
  ir_node grown = bi(g, IR_MIN, bi(g, IR_MAX, old, rule), number(g, 1));
  ir_node held = bi(g, IR_LT, number(g, 0), kinematics_input(g, ENDS_PROTECTED));
  return named(g, ir_select(g, held, old, grown), "omega");
}

/* The micropolar law with bilinear softening and damping, as one pass over strips. */
static void plan_strips(hand_made *h, program_task task) {
  ir *g = h->plan.graph;
  bond_kinematics k = kinematics_bond(g, true, false);
  ir_node two = number(g, 2), one = number(g, 1);
  ir_node twice_i = ir_add(g, ir_mul(g, two, k.theta_i), k.theta_j);
  ir_node twice_j = ir_add(g, ir_mul(g, two, k.theta_j), k.theta_i);
  ir_node omega = bilinear_damage(g, &k, twice_i, twice_j);
  ir_node left = named(g, ir_sub(g, one, omega), "left");
  ir_node N_el = named(g, ir_mul(g, ir_mul(g, left, parameter(g, 0, "EA")), k.stretch), "N_el");
  ir_node rate = ir_div(g, k.stretch_rate, number(g, 10));
  ir_node soft = ir_div(g, rate, ir_add(g, one, un(g, IR_ABS, rate)));
  ir_node damping = ir_mul(g, ir_mul(g, number(g, 0.05), un(g, IR_ABS, N_el)), soft);
  ir_node N = named(g, ir_add(g, N_el, damping), "N");
  ir_node stiffness = ir_mul(g, left, ir_div(g, ir_mul(g, two, parameter(g, 1, "EI")), k.s));
  ir_node M_i = named(g, ir_mul(g, stiffness, twice_i), "M_i");
  ir_node M_j = named(g, ir_mul(g, stiffness, twice_j), "M_j");
  bond_forces f = kinematics_forces(g, &k, N, M_i, M_j);
  add_root(h, task, f.f_x, TO_FORCE, 0);
  add_root(h, task, f.f_y, TO_FORCE, 1);
  add_root(h, task, f.moment_i, TO_FORCE, 2);
  add_root(h, task, f.moment_j, TO_FORCE, 3);
  add_root(h, task, omega, TO_FIELD, 0);
}

static hand_made *beam_new(void) {
  hand_made *h = hand_new("EA", "omega");
  plan_strips(h, PROGRAM_STEP);
  find_uniforms(h);
  return h;
}

/* Compiles `text` with more flags; what the compiler says (malloc'ed), or NULL when there is no
 * such compiler. */
static char *compiler_says(const char *text, const char *compiler, const char *more) {
  char path[] = "emitted_XXXXXX.c", command[1000];
  snprintf(command, sizeof command, "%s --version >/dev/null 2>&1", compiler);
  if (system(command) != 0) return NULL;
  int file = mkstemps(path, 2);
  assert_true(file >= 0);
  assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
  close(file);
  snprintf(command, sizeof command, "%s %s %s %s 2>&1", compiler, toolchain_flags(), more, path);
  FILE *in = popen(command, "r");
  assert_non_null(in);
  const size_t room = 1 << 22;
  char *said = calloc(1, room);
  assert_true(fread(said, 1, room - 1, in) < room - 1);
  int status = pclose(in);
  unlink(path);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_msg("%s: %s", command, said);
  return said;
}

static char *text_of(const hand_made *h) {
  return emit_kernel(&h->plan);
}

/* Number of the line on which `at` stands in `text`. */
static int line_at(const char *text, const char *at) {
  int line = 1;
  for (const char *c = text; c < at; c++)
    line += *c == '\n';
  return line;
}

static void the_loops_vectorise(void **state) {
  (void)state;
  hand_made *h = beam_new();
  char *text = text_of(h), place_of_loop[64];
  int loops = 0;
  char *gcc = compiler_says(text, "gcc", "-fopt-info-vec-optimized -o /dev/null");
  char *clang = compiler_says(text, "clang", "-Rpass=loop-vectorize -o /dev/null");
  const char *at = strstr(text, "PL_PASS void rows(const pl_law *law"),
             *end = at ? strstr(at, "\n}\n") : NULL;
  assert_non_null(end);
  while ((at = strstr(at, "  PL_INDEPENDENT\n")) && at < end) { /* all loops of the function */
    at += strlen("  PL_INDEPENDENT\n");
    const int line = line_at(text, at);
    snprintf(place_of_loop, sizeof place_of_loop, ".c:%d:3: optimized: loop vectorized", line);
    if (gcc && !strstr(gcc, place_of_loop))
      fail_msg("gcc does not vectorise line %d: %s", line, gcc);
    snprintf(place_of_loop, sizeof place_of_loop, ".c:%d:3: remark: vectorized loop", line);
    if (clang && !strstr(clang, place_of_loop))
      fail_msg("clang does not vectorise line %d: %s", line, clang);
    loops++;
  }
  assert_true(loops > 1);
  assert_true(gcc || clang);
  free(gcc);
  free(clang);
  free(text);
  hand_free(h);
}

/* The key of a kernel is a hash of its text. */
static void the_same_law_gives_the_same_text(void **state) {
  (void)state;
  hand_made *first = beam_new(), *second = beam_new();
  char *a = text_of(first), *b = text_of(second);
  assert_string_equal(a, b);
  free(a);
  free(b);
  hand_free(first);
  hand_free(second);
}

/* No call, in any of the code, but for what is not as expected; a call in a loop is what makes it
   slow without a word. */
static void the_assembly_calls_nothing(void **state) {
  (void)state;
  hand_made *h = beam_new();
  char *text = text_of(h);
  const char *const compilers[] = {"gcc", "clang"};
  for (int k = 0; k < 2; k++) {
    char *assembly = compiler_says(text, compilers[k], "-S -o -");
    for (const char *at = assembly; at && (at = strstr(at, "\tcall")); at++) {
      const char *apart = strstr(at, "_unusual");
      if (!apart || apart > at + strcspn(at, "\n")) fail_msg("%.60s", at);
    }
    free(assembly);
  }
  free(text);
  hand_free(h);
}

static void generated_c_has_no_warning(void **state) {
  (void)state;
  hand_made *h = beam_new();
  char *text = text_of(h);
  free(compiler_says(text, "gcc", "-Wall -Wextra -Werror -o /dev/null"));
  free(compiler_says(text, "clang",
                     "-Wall -Wextra -Werror -Wno-unused-command-line-argument -o /dev/null"));
  free(text);
  hand_free(h);
}

/* Names that would break or change the C if they went in as they are. */
static void hostile_names_do_no_harm(void **state) {
  (void)state;
  static const char *const names[] = {
      "double", "q",     "strip", "unix",        "NULL",      "pl_exp",  "at_u_ix",
      "flags",  "count", "rows",  "PL_LANES",    "int64_t",   "present", "uniforms",
      "law",    "exp",   "main",  "x; return 0", "*/ #error", "",        "\xc3\xa4"};
  enum { COUNT = sizeof names / sizeof *names };
  hand_made *h = hand_new("*/ \"); int main(", "?\?/\n#include <x>");
  h->tree.name = "a\\\" */ b";
  ir *g = h->plan.graph;
  ir_node x = ir_input(g, IR_FROM_ENDS, ENDS_U_IX, "q", ON_BOND), total = x;
  for (int k = 0; k < COUNT; k++)
    total = named(g, ir_add(g, total, ir_mul(g, x, parameter(g, k, names[k]))), names[k]);
  add_root(h, PROGRAM_STEP, total, TO_FORCE, 0);
  find_uniforms(h);
  char *text = text_of(h), *loaded_text;
  free(compiler_says(text, "gcc", "-Wall -Wextra -Werror -o /dev/null"));
  loaded_kernel k = load(h, &loaded_text);
  assert_string_equal(k.law->name, h->tree.name);
  assert_string_equal(k.law->parameters[0].name, h->symbols[0].name);
  assert_string_equal(k.law->fields[0].name, h->symbols[1].name);
  toolchain_unload(&k);
  free(loaded_text);
  free(text);
  hand_free(h);
}

/* --- strips ----------------------------------------------------------------------------------- */

enum { STRIP = 2 * PL_LANES };

typedef struct strip_memory {
  _Alignas(PL_ALIGNMENT) double in[12][STRIP];
  _Alignas(PL_ALIGNMENT) double out[4][STRIP];
  _Alignas(PL_ALIGNMENT) double omega[STRIP];
  _Alignas(PL_ALIGNMENT) int64_t flags[STRIP];
  double *force[4], *field[1];
  pl_strip strip;
} strip_memory;

static void strip_fill(strip_memory *m) {
  for (int k = 0; k < 12; k++)
    for (int q = 0; q < STRIP; q++)
      m->in[k][q] = 1e-6 * sin(1 + 17 * k + q);
  for (int k = 0; k < 4; k++) {
    m->force[k] = m->out[k];
    for (int q = 0; q < STRIP; q++)
      m->out[k][q] = NAN;
  }
  for (int q = 0; q < STRIP; q++) {
    m->omega[q] = 0.25;
    m->flags[q] = PL_PRESENT(2);
  }
  m->field[0] = m->omega;
  m->strip = (pl_strip){.size = sizeof(pl_strip),
                        .count = STRIP,
                        .direction = 2,
                        .flags = m->flags,
                        .force = m->force,
                        .field = m->field};
  for (int k = 0; k < 3; k++) {
    m->strip.displacement_i[k] = m->in[k];
    m->strip.displacement_j[k] = m->in[3 + k];
    m->strip.velocity_i[k] = m->in[6 + k];
    m->strip.velocity_j[k] = m->in[9 + k];
  }
}

static void run_rows(const pl_law *kernel, strip_memory *m) {
  const double parameters[4] = {5e7, 3e2, 1.18e-4, 0.1};
  const pl_bond_class bonds = {
      .size = sizeof(pl_bond_class), .s = 6.35e-3, .chord = {6.35e-3, 0, 0}};
  double uniforms[64];
  assert_true(kernel->uniform_count <= 64);
  kernel->prepare(kernel, parameters, &bonds, uniforms);
  kernel->rows(kernel, uniforms, &m->strip);
}

/* Bond 3 is absent and lies between sites that hold nothing, not even numbers; bond 5 is protected.
 */
static void absent_bonds_carry_nothing_and_keep_their_fields(void **state) {
  (void)state;
  hand_made *h = beam_new();
  char *text;
  loaded_kernel k = load(h, &text);
  strip_memory m;
  strip_fill(&m);
  m.flags[3] = PL_PRESENT(1) | PL_PROTECTED(2);
  m.flags[5] |= PL_PROTECTED(2);
  for (int c = 0; c < 12; c++)
    m.in[c][3] = NAN;
  m.in[3][5] = m.in[3][6] = 1e-4; /* far beyond the strength */
  run_rows(k.law, &m);
  for (int c = 0; c < 4; c++)
    for (int q = 0; q < STRIP; q++)
      assert_true(q == 3 ? m.out[c][q] == 0 : isfinite(m.out[c][q]) && m.out[c][q] != 0);
  assert_true(m.omega[3] == 0.25);
  assert_true(m.omega[5] == 0.25);
  assert_true(m.omega[6] > 0.8 && m.omega[6] < 1);
  toolchain_unload(&k);
  free(text);
  hand_free(h);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers_read_back_to_the_same_bits),
      cmocka_unit_test(strings_cannot_leave_their_quotes),
      cmocka_unit_test(names_are_identifiers_and_unique),
      cmocka_unit_test(every_operation_has_the_bits_of_the_interpreter),
      cmocka_unit_test(the_same_law_gives_the_same_text),
      cmocka_unit_test(the_loops_vectorise),
      cmocka_unit_test(the_assembly_calls_nothing),
      cmocka_unit_test(generated_c_has_no_warning),
      cmocka_unit_test(hostile_names_do_no_harm),
      cmocka_unit_test(absent_bonds_carry_nothing_and_keep_their_fields),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
