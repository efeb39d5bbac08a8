/* A law's text reaches the C compiler as checked names, numbers and escaped texts only, whatever it
   is made of: the C holds nothing else, compiles, computes what the interpreter does and gives
   every text back as it was written. */
#include <ctype.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <strings.h>

#include <cmocka.h>

#include "dsl/semantics/law_check.h"
#include "generator/emit/descriptor.h"
#include "generator/emit/emit.h"
#include "generator/kernel/toolchain.h"
#include "generator/target/words_c.h"
#include "tests/fuzz/c_alphabet.h"
#include "tests/generator/law_text.h"

/* --- what is done with every law
 * ------------------------------------------------------------------ */

static char *emitted(const tested_law *t, char **key) {
  char *unkeyed = emit_kernel(t->plan);
  *key = toolchain_key(unkeyed);
  char *text = descriptor_keyed(unkeyed, *key);
  free(unkeyed);
  return text;
}

static void no_stray(const char *c) {
  const char *stray = c_stray(c);
  if (stray) fail_msg("the emitted C holds: %.60s", stray);
}

static void same_tables(const pl_law *a, const pl_law *b) {
  assert_string_equal(a->name, b->name);
  assert_int_equal(a->parameter_count, b->parameter_count);
  for (int k = 0; k < a->parameter_count; k++) {
    assert_string_equal(a->parameters[k].name, b->parameters[k].name);
    assert_string_equal(a->parameters[k].unit, b->parameters[k].unit);
    assert_string_equal(a->parameters[k].doc ? a->parameters[k].doc : "",
                        b->parameters[k].doc ? b->parameters[k].doc : "");
    assert_true(a->parameters[k].initial == b->parameters[k].initial ||
                (isnan(a->parameters[k].initial) && isnan(b->parameters[k].initial)));
  }
  assert_int_equal(a->field_count, b->field_count);
  for (int k = 0; k < a->field_count; k++) {
    assert_string_equal(a->fields[k].name, b->fields[k].name);
    assert_string_equal(a->fields[k].doc ? a->fields[k].doc : "",
                        b->fields[k].doc ? b->fields[k].doc : "");
  }
  assert_int_equal(a->size, b->size);
  assert_int_equal(a->state_input_count, b->state_input_count);
  for (int k = 0; k < a->state_input_count; k++) {
    assert_string_equal(a->state_inputs[k].name, b->state_inputs[k].name);
    assert_string_equal(a->state_inputs[k].unit, b->state_inputs[k].unit);
  }
}

/* The compiled kernel answers as the interpreter: a name that means something to C would change
 * what is computed. */
static void same_answers(const tested_law *t, const pl_law *compiled) {
  if (t->kernel->field_count > MOST_FIELDS) return; /* more than law_text.h has room for */
  tested_law as_compiled = *t;
  as_compiled.kernel = (pl_law *)(size_t)compiled;
  for (int k = -3; k <= 3; k++) {
    tested_state a = {.stretch = 1e-4 * k, .rate = 0.1}, b = a;
    evaluate_law(t, &a, 0);
    evaluate_law(&as_compiled, &b, 0);
    assert_true(a.N == b.N && isfinite(a.N));
    assert_memory_equal(a.new_field, b.new_field, (size_t)t->kernel->field_count * sizeof(double));
  }
}

/* `text` must be a law without errors. */
static void through_the_compiler(const char *text) {
  tested_law *t = open_law(text);
  assert_non_null(t->plan);
  char error[2000] = "", *key, *c = emitted(t, &key);
  no_stray(c);
  loaded_kernel kernel = {0};
  if (!toolchain_load(c, key, &kernel, error, sizeof error))
    fail_msg("the C does not compile: %s", error);
  same_tables(t->kernel, kernel.law);
  same_answers(t, kernel.law);
  toolchain_unload(&kernel);
  free(c);
  free(key);
  close_law(t);
}

/* --- names
 * ------------------------------------------------------------------------------------------ */

static const char *const hostile_names[] = {
    /* words of C, of its dialects, of compilers */
    "auto", "break", "case", "char", "const", "continue", "default", "double", "do", "else", "enum",
    "extern", "float", "goto", "if", "inline", "int", "long", "register", "restrict", "return",
    "short", "signed", "sizeof", "static", "struct", "switch", "typedef", "typeof", "union",
    "unsigned", "void", "volatile", "while", "asm", "__asm__", "_Generic", "_Atomic", "_Bool",
    "_Complex", "_Imaginary", "_Noreturn", "_Static_assert", "_Thread_local", "_Alignas",
    "__attribute__", "__extension__", "__builtin_trap", "__builtin_inf", "_Pragma", "__real__",
    "__typeof__", "__int128", "nullptr", "constexpr", "alignof", "bool", "true", "false", "wchar_t",
    "thread_local", "_BitInt", "__label__",
    /* macros */
    "__FILE__", "__LINE__", "__DATE__", "__COUNTER__", "__func__", "__VA_ARGS__", "__STDC__",
    "__GNUC__", "__INT_MAX__", "linux", "unix", "i386", "NULL", "NAN", "INFINITY", "HUGE_VAL",
    "M_PI", "EOF", "INT64_C", "UINT64_MAX", "SIZE_MAX", "INT32_MIN", "WINT_MAX", "errno", "assert",
    "stdin", "offsetof", "defined", "include", "define", "pragma",
    /* the prelude's and the kernel's own */
    "pl_law", "pl_strip", "pl_sqrt", "PL_RARE", "PL_PASS", "PL_INDEPENDENT", "PL_LANES",
    "PL_PRESENT", "PL_KERNEL_ABI", "PL_HALF_PI_HI", "law", "uniforms", "strip", "count", "q",
    "flags", "i", "j", "in_", "out", "given", "bonds", "present", "present_bit", "protected",
    "protected_bit", "lower", "upper", "low_open", "high_open", "parameters", "law_parameters",
    "law_fields", "the_law", "perilat_kernel", "prepare", "rows", "rows_ledger", "rows_observe",
    "states", "tangent", "to_0", "value_0", "values_0", "far_1", "at_u_ix", "at_force_0",
    "at_field_0", "at_out_0", "u_ix", "d_x", "e_x", "shared", "per_length", "chord_x",
    "class_chord_x", "v1", "v12", "v2_2", "old_x", "old_omega", "omega_2", "time_step", "f_x",
    "moment_i", "changed", "unusual", "owned", "owner", "half", "back", "int32_t", "int64_t",
    "uint8_t", "large", "largest_0", "rows_unusual",
    /* functions that compilers know by name */
    "main", "printf", "memcpy", "malloc", "system", "exit", "fabs", "fma", "pow", "floor", "round",
    "isnan", "signbit", "gamma", "y0", "j1", "abort", "_exit", "alloca", "cold", "vectorize",
    "ivdep", "optimize", "x_int", "x_", "x__2", "_", "__", "_0", "Xx_xX",
    "a23456789012345678901234567890123456789012345678901234567890123",
    "a23456789012345678901234567890123456789012345678901234567890124"};
enum { NAMES = sizeof hostile_names / sizeof *hostile_names };

/* Does the language take the name for a definition? Where it does not, it says so. */
static bool is_taken(const char *name) {
  char text[400];
  snprintf(text, sizeof text,
           "model m\n  law central bond\n  parameter rho = 1 [kg/m^3]\n  %s = 2*stretch\n"
           "  force N = 1 [N]*%s\nend model\n",
           name, name);
  arena *memory = arena_new();
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  const parse_options options = {NULL, NULL};
  tree *parsed = parse_model(memory, &sources, source_add(&sources, "n.plm", text, strlen(text)),
                             &options, &said);
  law *l = parsed && !said.errors ? law_check(memory, parsed, &sources, NULL, 0, &said) : NULL;
  assert_true((l != NULL) == (said.errors == 0));
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return l != NULL;
}

/* X(role, how a name is declared, what joins the force) */
#define ROLES(X)                                                                                   \
  X(parameter, "  parameter %s = 0.001\n", " + %s")                                                \
  X(constant, "  constant %s = 0.001*rho/(1 [kg/m^3])\n", " + %s")                                 \
  X(definition, "  %s = 0.001*abs(stretch)\n", " + %s")                                            \
  X(state, "  state %s = 0\n", " + %s")                                                            \
  X(output, "  output %s = stretch\n", "")

typedef struct role {
  const char *what, *declared, *used;
} role;
static const role roles[] = {
#define X(name, declared, used) {#name, declared, used},
    ROLES(X)
#undef X
};

static void put(FILE *out, const char *format, const char *name) {
  const char *mark = strstr(format, "%s");
  if (mark)
    fprintf(out, "%.*s%s%s", (int)(mark - format), format, name, mark + 2);
  else
    fputs(format, out);
}

static void names_stay_names(void **state) {
  (void)state;
  int taken = 0;
  for (int k = 0; k < NAMES; k++)
    taken += is_taken(hostile_names[k]);
  assert_true(taken > NAMES / 2); /* or there would be little to see below */
  for (size_t r = 0; r < sizeof roles / sizeof *roles; r++) {
    const bool is_state = strcmp(roles[r].what, "state") == 0;
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    fprintf(out, "model %s\n  law central bond\n  parameter rho = 2323 [kg/m^3]\n", "linux");
    const int step =
        is_state ? 5 : 1; /* every state is written by every pass: the compiler would take long */
    for (int k = 0; k < NAMES; k += step)
      if (is_taken(hostile_names[k])) put(out, roles[r].declared, hostile_names[k]);
    for (int k = 0; is_state && k < NAMES; k += step)
      if (is_taken(hostile_names[k]))
        fprintf(out, "  %s = max(previous(%s), 0.001*abs(stretch))\n", hostile_names[k],
                hostile_names[k]);
    fprintf(out, "  force N = 1 [N]*stretch*((1");
    for (int k = 0, written = 0; k < NAMES; k += step)
      if (is_taken(hostile_names[k]) && *roles[r].used) {
        put(out, roles[r].used, hostile_names[k]);
        if (++written % 20 == 0) fprintf(out, written % 100 ? " &\n    " : ") &\n    + (1");
      }
    fprintf(out, "))\nend model\n");
    fclose(out);
    through_the_compiler(text);
    free(text);
  }
}

/* --- names that the words of the target use --------------------------------------------------- */

static const char *const words[] = {
#define X(name, text) text,
    C_WORDS(X)
#undef X
};

enum { MOST_WORDS = 500 };
typedef struct name_list {
  char name[MOST_WORDS][64];
  int count;
} name_list;

static void add_name(name_list *all, const char *name) {
  for (int k = 0; k < all->count; k++)
    if (strcasecmp(all->name[k], name) == 0) return;
  if (!is_taken(name)) return;
  assert_true(all->count < MOST_WORDS);
  strcpy(all->name[all->count++], name);
}

/* Adds the identifiers of a piece of C, but members and comments; what stands in a hole is 0:
   slot_$1 gives slot_0. */
static void add_identifiers(name_list *all, const char *c) {
  while (*c) {
    char name[64];
    size_t n = 0;
    const bool member = c[0] == '-' && c[1] == '>';
    if (c[0] == '/' && c[1] == '*') c = strstr(c, "*/");
    for (c += 2 * member; isalnum((unsigned char)*c) || *c == '_' || (n && *c == '$'); c++) {
      assert_true(n + 1 < sizeof name);
      name[n++] = *c == '$' ? '0' : *c;
      if (*c == '$') c++;
    }
    name[n] = 0;
    if (n && !member && isalpha((unsigned char)*name)) add_name(all, name);
    if (!n) c++;
  }
}

/* Some of the names as parameters that the innermost loop reads. */
static char *law_of_names(const name_list *names, int first, int end, bool damaged) {
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  fprintf(out, "model m\n  law state\n  parameter rho = 2323 [kg/m^3]\n");
  for (int k = first; k < end; k++)
    fprintf(out, "  parameter %s = 0.1\n", names->name[k]);
  if (damaged)
    fprintf(out, "  damage broken on bond\n  broken[j] = | 1 when stretch[j] >= 0.01 jump\n"
                 "              | 0 otherwise\n");
  fprintf(out, "  force state T[j] = 1 [N/m^6]*%s((0", damaged ? "(1 - broken[j])*" : "");
  for (int k = first; k < end; k++)
    fprintf(out, "%s + min(stretch[j], %s)", k % 50 ? k % 4 ? "" : " &\n    " : ") &\n    + (0",
            names->name[k]);
  fprintf(out, "))\nend model\n");
  fclose(out);
  return text;
}

static void compiles_for(const char *text, int neighbours, kernel_form form) {
  char error[2000] = "";
  loaded_kernel kernel = {0};
  tested_law *t = open_law(text);
  assert_non_null(t->law);
  kernel_plan *of_text = t->plan;
  t->law->neighbours = neighbours;
  t->plan = plan_kernel(t->law, &t->said);
  assert_int_equal(t->plan->form, form);
  char *key, *c = emitted(t, &key);
  if (!toolchain_load(c, key, &kernel, error, sizeof error))
    fail_msg("the C does not compile: %s", error);
  toolchain_unload(&kernel);
  free(c);
  free(key);
  plan_free(t->plan);
  t->plan = of_text;
  close_law(t);
}

/* In every form that the passes of a law of families have. */
static void the_loops_own_names_may_be_a_laws(void **state) {
  (void)state;
  static name_list names;
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    add_identifiers(&names, words[k]);
  assert_true(names.count > 50);
  char *elastic = law_of_names(&names, 0, names.count, false);
  compiles_for(elastic, 0, FORM_LOOPS);
  compiles_for(elastic, 6, FORM_UNROLLED);
  free(elastic);
  for (int first = 0; first < names.count; first += 24) {
    const int end = first + 24 < names.count ? first + 24 : names.count;
    char *damaged = law_of_names(&names, first, end, true);
    compiles_for(damaged, 18, FORM_PAIRS);
    free(damaged);
  }
}

/* --- texts
 * ------------------------------------------------------------------------------------------ */

static const char *const hostile_texts[] = {"*/ int x; /*",
                                            "/* never closed",
                                            "// to the end",
                                            "a \\",
                                            "a \\n\\x41\\101\\0 b",
                                            "what?"
                                            "?/",
                                            "a ?"
                                            "?> ?"
                                            "?= ?"
                                            "?!",
                                            "#include </etc/passwd>",
                                            "#define double int",
                                            "%s%n%d%%",
                                            "`id` $(id) ${HOME}",
                                            "'; system('x'); '",
                                            "@ ~ | ^ & !",
                                            "\xc3\xa9\xe2\x82\xac \xf0\x9f\x98\x80",
                                            "\xe2\x80\xae right to left",
                                            "\xe2\x80\xa8 line separator",
                                            "\xff\xfe not UTF-8",
                                            "tab\tand \v \f",
                                            "_Pragma(message)",
                                            "__asm__(hlt)",
                                            "\177 delete",
                                            "{{{{ )))) ]]",
                                            "\x1b[31m escape"};

static const char frame_of_texts[] =
    "!> %s\nmodel m\n  law central bond\n  parameter rho = 2323 [kg/m^3] \"%s\"\n"
    "  ! HOSTILE %s\n  parameter E = 30 [GPa] \"%s\"\n"
    "  !> %s\n  !> HOSTILE_DOC \" %s\n  damage omega = max(previous(omega), min(1, abs(stretch)))\n"
    "  force N = (1 - omega)*E*area*stretch ! HOSTILE %s\nend model\n";

/* Where the language refuses a text, it says so; otherwise it arrives whole and comments do not
 * arrive at all. */
static void texts_stay_texts(void **state) {
  (void)state;
  int arrived = 0;
  for (size_t k = 0; k < sizeof hostile_texts / sizeof *hostile_texts; k++) {
    const char *h = hostile_texts[k];
    char text[2000];
    snprintf(text, sizeof text, frame_of_texts, h, h, h, h, h, h, h);
    tested_law *t = open_law(text);
    if (t->plan) {
      arrived++;
      char *c = emit_kernel(t->plan);
      no_stray(c);
      assert_null(strstr(c, "HOSTILE "));
      free(c);
      assert_string_equal(t->kernel->parameters[0].doc, h);
      close_law(t);
      if (k % 3 == 0) /* the compiler takes a while */
        through_the_compiler(text);
      continue;
    }
    assert_true(t->said.errors > 0);
    diag_clear(&t->said);
    source_clear(&t->sources);
    arena_free(t->memory);
    free(t);
  }
  assert_true(arrived > 15);
}

static void long_texts_and_numbers(void **state) {
  (void)state;
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  fputs("!> ", out);
  for (int k = 0; k < 30000; k++)
    fputs(k % 2 ? "\\" : "\"*/", out);
  fputs("\nmodel m\n  law central bond\n  parameter rho = 2323 [kg/m^3] \"", out);
  for (int k = 0; k < 30000; k++)
    fputc("\\?%*/#"[k % 6], out);
  fputs("\"\n  parameter a = 0.", out);
  for (int k = 0; k < 400; k++)
    fputc('0' + k % 10, out);
  fputs("\n  parameter b = 1d-300\n  parameter c = 1.7976931348623157e308\n"
        "  force N = 1 [N]*stretch*(1 + a + b + 1/c)\nend model\n",
        out);
  fclose(out);
  through_the_compiler(text);
  free(text);
}

/* --- the fixed part, and the check itself
 * ------------------------------------------------------------- */

static char *kernel_of(const char *text) {
  tested_law *t = open_law(text);
  assert_non_null(t->plan);
  char *c = emit_kernel(t->plan);
  close_law(t);
  return c;
}

/* What kernels begin with is the same for all laws: nothing of the law is in it. */
static void the_head_is_fixed(void **state) {
  (void)state;
  char *a = kernel_of("model a\n  law central bond\n  parameter rho = 1 [kg/m^3]\n  force N = 1 "
                      "[N]*stretch\nend model\n");
  char *b =
      kernel_of("!> text\nmodel other\n  law central bond\n  parameter rho = 2 [kg/m^3] \"x\"\n"
                "  state k = 0\n  k = max(previous(k), stretch)\n  force N = 2 [N]*(stretch + "
                "k)\nend model\n");
  const size_t length = (size_t)(c_begin(a) - a);
  assert_int_equal((size_t)(c_begin(b) - b), length);
  assert_memory_equal(a, b, length);
  free(a);
  free(b);
}

/* Each of these, put into a kernel, is found. */
static void strays_are_found(void **state) {
  (void)state;
  static const char *const strays[] = {"asm(x);",
                                       "#include <x>\n",
                                       "x = system(y);",
                                       "'a'",
                                       "\\\n",
                                       "/* note */",
                                       "// note\n",
                                       "int x;",
                                       "goto x;",
                                       "@",
                                       "`",
                                       "%",
                                       "$",
                                       "\"a\\n\"",
                                       "\"a%s\"",
                                       "\"\xc3\xa9\"",
                                       "\"open",
                                       "\xc3\xa9",
                                       ("?"
                                        "?/"),
                                       "__asm__ x;",
                                       "pl_evil(x);",
                                       "{",
                                       "}",
                                       "0x1;",
                                       "1.0f;",
                                       "/* line 1; */",
                                       "__builtin_trap();",
                                       "\t",
                                       "switch (x)",
                                       "do x;",
                                       "/* line 12 ",
                                       "x (y)",
                                       "1e;",
                                       "~x;",
                                       "^x;"};
  char *c = kernel_of("model a\n  law central bond\n  parameter rho = 1 [kg/m^3]\n  force N = 1 "
                      "[N]*stretch\nend model\n");
  assert_null(c_stray(c));
  const size_t at = (size_t)(strstr(c, "PL_RARE static") - c);
  for (size_t k = 0; k < sizeof strays / sizeof *strays; k++) {
    char *worse = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&worse, &length);
    fprintf(out, "%.*s%s%s", (int)at, c, strays[k], c + at);
    fclose(out);
    if (!c_stray(worse)) fail_msg("not found: %s", strays[k]);
    free(worse);
  }
  free(c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names_stay_names),       cmocka_unit_test(texts_stay_texts),
      cmocka_unit_test(long_texts_and_numbers), cmocka_unit_test(the_head_is_fixed),
      cmocka_unit_test(strays_are_found),       cmocka_unit_test(the_loops_own_names_may_be_a_laws),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
