/* What emitted C may consist of, read without trusting the emitter: the law's own text may appear
   as plain names, numbers, lines in comments and escaped texts, and as nothing else. */
#ifndef PERILAT_TESTS_C_ALPHABET_H
#define PERILAT_TESTS_C_ALPHABET_H

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

/* Words that mean something to C and that kernels are written with. Another word of C (asm, goto,
   __asm__, a name that begins with _ or pl_) is a stray. */
static const char *const c_own_words[] = {"static",
                                          "const",
                                          "double",
                                          "long",
                                          "int32_t",
                                          "int64_t",
                                          "unsigned",
                                          "char",
                                          "void",
                                          "restrict",
                                          "for",
                                          "while",
                                          "continue",
                                          "if",
                                          "return",
                                          "__builtin_inf",
                                          "__builtin_nan",
                                          "pl_law",
                                          "pl_strip",
                                          "pl_bond_class",
                                          "pl_parameter",
                                          "pl_points",
                                          "pl_rectangles",
                                          "pl_rectangle",
                                          "pl_rectangle_strain",
                                          "pl_rectangle_push",
                                          "pl_rectangle_ends",
                                          "pl_rectangle_begin",
                                          "pl_rectangle_keep",
                                          "pl_rectangle_sum",
                                          "pl_rectangle_end",
                                          "PL_UNROLL_4",
                                          "pl_tips",
                                          "pl_field",
                                          "pl_output",
                                          "pl_input",
                                          "pl_states",
                                          "sizeof",
                                          "PL_FIELD_STATE",
                                          "PL_FIELD_DAMAGE",
                                          "PL_FIELD_OUTPUT",
                                          "PL_ON_BOND",
                                          "PL_ON_PARTICLE",
                                          "PL_ON_NEIGHBOUR",
                                          "PL_ON_POINT",
                                          "PL_ON_TIP",
                                          "PL_KERNEL_ABI",
                                          "PL_ROWS",
                                          "PL_LIST",
                                          "PL_ALIGNMENT",
                                          "PL_MAX_DIRECTIONS",
                                          "pl_family",
                                          "pl_family_function",
                                          "enum",
                                          "uint64_t",
                                          "UINT64_C",
                                          "_Alignas",
                                          "PL_LANES",
                                          "PL_PRESENT",
                                          "PL_PROTECTED",
                                          "PL_RARE",
                                          "PL_PASS",
                                          "PL_APART",
                                          "PL_INDEPENDENT",
                                          "pl_abs",
                                          "pl_fma",
                                          "pl_sqrt",
                                          "pl_inverse_root",
                                          "pl_cbrt",
                                          "pl_exp",
                                          "pl_log",
                                          "pl_sin",
                                          "pl_cos",
                                          "pl_tan",
                                          "pl_tanh",
                                          "pl_log10",
                                          "pl_asin",
                                          "pl_acos",
                                          "pl_sinh",
                                          "pl_cosh",
                                          "pl_atan2",
                                          "pl_sign",
                                          "pl_min",
                                          "pl_max",
                                          "pl_pow",
                                          "pl_wrap_angle",
                                          "pl_search_place",
                                          "pl_search_from",
                                          "pl_search",
                                          "PL_SEARCH_STEPS",
                                          "pl_smaller",
                                          "pl_larger",
                                          "pl_to_bits"};
/* Words of C that kernels are not written with. */
static const char *const c_foreign_words[] = {
    "asm",    "auto",   "break",    "case",     "default", "do",     "else",   "extern", "float",
    "goto",   "inline", "int",      "register", "short",   "signed", "struct", "switch", "typedef",
    "typeof", "union",  "volatile", "linux",    "unix",    "NULL",   "bool",   "true",   "false"};
/* Functions that a kernel defines. */
static const char *const c_own_functions[] = {"prepare",
                                              "bounds",
                                              "size_bounds",
                                              "rows",
                                              "rows_ledger",
                                              "rows_observe",
                                              "states",
                                              "tangent",
                                              "point_step",
                                              "point_ledger",
                                              "point_observe",
                                              "point_tangent",
                                              "rectangle_step",
                                              "rectangle_ledger",
                                              "tip_look",
                                              "perilat_kernel",
                                              "step_0",
                                              "step_1",
                                              "step_2",
                                              "step_3",
                                              "step_4",
                                              "step_5",
                                              "step_6",
                                              "step_7",
                                              "changed_plane",
                                              "changed_marks",
                                              "changes",
                                              "losses_0",
                                              "losses_1",
                                              "losses_2",
                                              "losses_3",
                                              "losses_4",
                                              "losses_5",
                                              "losses_6",
                                              "losses_7",
                                              "observe_0",
                                              "observe_1",
                                              "observe_2",
                                              "observe_3",
                                              "observe_4",
                                              "observe_5",
                                              "observe_6",
                                              "observe_7",
                                              "rows_unusual",
                                              "rows_ledger_unusual",
                                              "rows_observe_unusual"};

static inline bool c_word_in(const char *const *words, size_t count, const char *at,
                             size_t length) {
  for (size_t k = 0; k < count; k++)
    if (strlen(words[k]) == length && memcmp(words[k], at, length) == 0) return true;
  return false;
}
#define C_WORD_IN(words, at, length) c_word_in(words, sizeof(words) / sizeof *(words), at, length)

/* Each returns the length of what it reads at the place, or 0. */
static inline size_t c_word(const char *at) {
  size_t n = 0;
  while ((at[n] >= 'a' && at[n] <= 'z') || (at[n] >= 'A' && at[n] <= 'Z') || at[n] == '_' ||
         (n && at[n] >= '0' && at[n] <= '9'))
    n++;
  if (n == 0) return 0;
  const bool own = C_WORD_IN(c_own_words, at, n);
  const bool reserved = at[0] == '_' || strncmp(at, "pl_", 3) == 0 || strncmp(at, "PL_", 3) == 0 ||
                        C_WORD_IN(c_foreign_words, at, n);
  const bool called = at[n + strspn(at + n, " ")] == '(';
  if (n > 96 || (reserved && !own) || (called && !own && !C_WORD_IN(c_own_functions, at, n)))
    return 0;
  return n;
}

static inline size_t c_number(const char *at) {
  size_t n = strspn(at, "0123456789");
  if (n && at[n] == '.') n += 1 + strspn(at + n + 1, "0123456789");
  if (n && at[n] == 'e') {
    size_t sign = at[n + 1] == '+' || at[n + 1] == '-',
           digits = strspn(at + n + 1 + sign, "0123456789");
    n += digits ? 1 + sign + digits : 0;
  }
  return n && !isalnum((unsigned char)at[n]) && at[n] != '_' ? n : 0;
}

/* Letters, digits, harmless marks and octal escapes of three digits. */
static inline size_t c_quoted(const char *at) {
  if (*at != '"') return 0;
  size_t n = 1;
  while (at[n] && at[n] != '"') {
    const char c = at[n];
    if (c == '\\' && strspn(at + n + 1, "01234567") >= 3)
      n += 4;
    else if ((c > 0 && isalnum((unsigned char)c)) || strchr(" _+-*/^.,;:()[]'=<>", c))
      n++;
    else
      return 0;
  }
  return at[n] ? n + 1 : 0;
}

/* How a loop was cut: numbers and small letters. */
static inline size_t c_decision(const char *at) {
  static const char begin[] = "/* ";
  if (strncmp(at, begin, 3) != 0) return 0;
  const size_t number = strspn(at + 3, "0123456789");
  if (strncmp(at + 3, "one loop", 8) != 0 &&
      (!number || strncmp(at + 3 + number, " loops", 6) != 0))
    return 0;
  const size_t length = 3 + strspn(at + 3, "abcdefghijklmnopqrstuvwxyz0123456789, ");
  return strncmp(at + length, "*/", 2) == 0 ? length + 2 : 0;
}

static inline size_t c_comment(const char *at) {
  static const char begins[] = "/* line ";
  static const char *const whole[] = {"/* particle by particle */", "/* neighbour by neighbour */",
                                      "/* both sides of what was expected */",
                                      "/* bond by bond, for both ends */"};
  for (size_t k = 0; k < sizeof whole / sizeof *whole; k++)
    if (strncmp(at, whole[k], strlen(whole[k])) == 0) return strlen(whole[k]);
  const size_t decision = c_decision(at);
  if (decision) return decision;
  const size_t head = sizeof begins - 1;
  if (strncmp(at, begins, head) != 0) return 0;
  const size_t digits = strspn(at + head, "0123456789");
  return digits && strncmp(at + head + digits, " */", 3) == 0 ? head + digits + 3 : 0;
}

/* Which of the parts that are compiled at the same time a function is in. */
static inline size_t c_part(const char *at) {
  static const char begin[] = "#if PL_IN_PART(", end[] = "#endif\n";
  if (strncmp(at, end, sizeof end - 1) == 0) return sizeof end - 1;
  const size_t head = sizeof begin - 1;
  if (strncmp(at, begin, head) != 0) return 0;
  const size_t digits = strspn(at + head, "0123456789");
  return digits && strncmp(at + head + digits, ")\n", 2) == 0 ? head + digits + 2 : 0;
}

static inline size_t c_mark(const char *at) {
  if (at[0] == '/' && (at[1] == '/' || at[1] == '*')) return 0; /* a comment of another form */
  if (at[0] == '?' && at[1] == '?') return 0;                   /* a trigraph */
  return *at && strchr(" \n(){}[];,=+-*/<>&|?:!.", *at) ? 1 : 0;
}

/* End of the fixed text that kernels begin with: it holds nothing of the law. NULL: it is not
 * there. */
static inline const char *c_begin(const char *text) {
  static const char mark[] = "#define PL_IN_PART(part) 1\n#endif\n";
  const char *at = strstr(text, mark);
  return at ? at + sizeof mark - 1 : NULL;
}

/* First place in a kernel's own part where something stands that no kernel is written with; NULL
 * when all is well. */
static inline const char *c_stray(const char *text) {
  const char *at = c_begin(text);
  if (!at) return text;
  long open = 0;
  while (*at) {
    size_t n = c_word(at);
    n = n ? n : c_number(at);
    n = n ? n : c_quoted(at);
    n = n ? n : c_comment(at);
    n = n ? n : c_part(at);
    n = n ? n : c_mark(at);
    open += strchr("({[", *at) ? 1 : strchr(")}]", *at) ? -1 : 0;
    if (!n || open < 0) return at;
    at += n;
  }
  return open == 0 ? NULL : at;
}

#endif
