/* Laws that are right: the bytes choose from a grammar, and what comes of it is a law in which
   names and units agree. So every input goes behind the checks of the text, which few do in
   fuzz_model.c. What must hold there is the same. */
#include "tests/fuzz/law_stages.h"
#include "tests/fuzz/recipe.h"

enum { LONGEST = 512, DEEPEST = 5, MOST_PIECES = 120, MOST_NAMES = 9 };

typedef struct writer {
  recipe from;
  FILE *out;
  const char *names[MOST_NAMES]; /* pure numbers that can be read here */
  int name_count;
  int pieces; /* written so far: no law grows without end */
} writer;

/* `#` is a number, `?` a condition, `~` a name or a plain number. */
static const char *const numbers[] = {"~",
                                      "(#+#)",
                                      "(#-#)",
                                      "(#*#)",
                                      "(#/#)",
                                      "(-#)",
                                      "#**2",
                                      "#**(-3)",
                                      "abs(#)**(1/2)",
                                      "#**#",
                                      "abs(#)",
                                      "sign(#)",
                                      "sqrt(#)",
                                      "cbrt(#)",
                                      "exp(#)",
                                      "log(#)",
                                      "sin(#)",
                                      "cos(#)",
                                      "tan(#)",
                                      "tanh(#)",
                                      "log10(#)",
                                      "asin(#)",
                                      "acos(#)",
                                      "sinh(#)",
                                      "cosh(#)",
                                      "dot((#, #), e)",
                                      "norm(cross(vector(#, #, #), e))",
                                      "dot(direction*#, e - (#, 0, #))",
                                      "e[x]",
                                      "atan2(#, #)",
                                      "min(#, #)",
                                      "max(#, #, #)",
                                      "positive_part(#)",
                                      "soft_sign(#)",
                                      "diff(#, stretch)",
                                      "diff(#, p)",
                                      "(| # when ? | # otherwise)",
                                      "(| # when ? jump | # when ? | # otherwise)",
                                      "f(#, #)",
                                      "~",
                                      "~"};
static const char *const conditions[] = {"# < #",     "# <= #",   "# > #", "# == #",
                                         "(? and ?)", "(? or ?)", "not ?", "# >= #"};
static const char *const plain[] = {
    "0",       "1",          "2",     "0.5",   "1e-4",  "(-1)", "1e-300",   "1e300",
    "(-0.3)",  "7",          "(1/3)", "shell", "(s/t)", "p",    "(V/s**3)", "(dt/(1 [s]))",
    "(m_i/m)", "(length/s)", "pi"};

#define PICK(list, number) (list)[(number) % (sizeof(list) / sizeof *(list))]

static void put_leaf(writer *w) {
  const unsigned which = recipe_byte(&w->from);
  const bool named = which % 3 != 0 && w->name_count;
  fputs(named ? w->names[which / 3 % (unsigned)w->name_count] : PICK(plain, which / 3), w->out);
}

static void put(writer *w, const char *form, int depth) {
  const bool enough = depth >= DEEPEST || w->pieces > MOST_PIECES;
  w->pieces++;
  for (; *form; form++)
    if (*form == '~' || (*form == '#' && enough))
      put_leaf(w);
    else if (*form == '#')
      put(w, PICK(numbers, recipe_byte(&w->from)), depth + 1);
    else if (*form == '?')
      put(w, enough ? "~ < ~" : PICK(conditions, recipe_byte(&w->from)), depth + 1);
    else
      fputc(*form, w->out);
}

static void name(writer *w, const char *one) {
  MUST(w->name_count < MOST_NAMES);
  w->names[w->name_count++] = one;
}

static void put_fields(writer *w, unsigned kinds) {
  if (kinds & 1) put(w, "state q=0\n", 0);
  if (kinds & 1) name(w, "q");
  put(w, "v=#\n", 0);
  name(w, "v");
  if (kinds & 1)
    put(w, kinds & 2 ? "flow q by # when ?\n" : kinds & 64 ? "rate q=(#)/(1 [s])\n" : "q=#\n", 0);
  if (kinds & 1) name(w, "previous(q)");
  if (kinds & 4) put(w, "damage w=#\n", 0);
  if (kinds & 4) name(w, "w");
}

static void put_results(writer *w, bool bends, unsigned kinds) {
  if (kinds & 8)
    put(w, "energy W=k*s*#\n", 0);
  else
    put(w, "force N=k*#\n", 0);
  if (bends && !(kinds & 8))
    put(w,
        kinds & 16 ? "force V=k*#*theta_i\n"
                   : "moment M_i=k*s*#*theta_i\nmoment M_j=k*s*#*theta_j\n",
        0);
  put(w, "output o=#\noutput o2=v+", 0);
  put(w, kinds & 4 ? "w\n" : "#\n", 0);
}

static void write_law(writer *w) {
  const unsigned kinds = recipe_byte(&w->from);
  const bool bends = kinds & 32;
  put(w, bends ? "model a\nlaw micropolar bond\n" : "model a\nlaw central bond\n", 0);
  put(w, "parameter k=5 [MN] in (0, inf)\nparameter p=0.2 in [0, 1)\nparameter e=(1, 0)\n", 0);
  put(w, "parameter rho=2 [kg/m^3]\nfield h on particle=0.3 in (0, 1)\n", 0);
  put(w, "function f(x, y)=x*y\n", 0);
  name(w, "stretch");
  name(w, "(stretch_rate*(1 [s]))");
  name(w, "h");
  if (bends) name(w, "(theta_i : theta_j)");
  if (bends) name(w, "norm(theta_i)");
  put_fields(w, kinds);
  put_results(w, bends, kinds);
  put(w, "end model\n", 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size > LONGEST) return 0;
  char *text = NULL;
  size_t length = 0;
  writer w = {.from = {data, data + size}, .out = open_memstream(&text, &length)};
  MUST(w.out);
  write_law(&w);
  fclose(w.out);
  if (getenv("FUZZ_VERBOSE")) fputs(text, stderr);
  MUST(check_law(text, length, fuzz_choose(data, size)));
  free(text);
  return 0;
}
