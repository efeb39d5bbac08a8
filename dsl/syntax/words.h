/* The words of the language: those that begin a line, and those that are never names. */
#ifndef PERILAT_DSL_WORDS_H
#define PERILAT_DSL_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/* clang-format off */
/* Words that begin a line; elsewhere they are ordinary names. X(token, text) */
#define LINE_WORDS(X)                                                                              \
  X(MODEL, "model") X(END, "end") X(LAW, "law") X(FOR, "for") X(PARAMETER, "parameter")            \
  X(CONSTANT, "constant") X(OPTION, "option") X(STATE, "state") X(DAMAGE, "damage")                \
  X(FUNCTION, "function") X(FORCE, "force") X(MOMENT, "moment") X(ENERGY, "energy")                \
  X(STRESS, "stress") X(STRAIN, "strain") X(YIELD, "yield") X(FLOW, "flow") X(OUTPUT, "output")    \
  X(NONCONSERVATIVE, "nonconservative") X(INCLUDE, "include") X(CRACK, "crack") X(GROW, "grow")   \
  X(TOWARD, "toward") X(SPEED, "speed") X(FAILED, "failed")  \
  X(REQUIRE, "require") X(ACCEPT, "accept") X(REST, "rest") X(RATE, "rate") X(FIELD, "field")

/* Words that are never names. X(token, text) */
#define RESERVED_WORDS(X)                                                                          \
  X(WHEN, "when") X(OTHERWISE, "otherwise") X(JUMP, "jump") X(IN, "in") X(AND, "and")              \
  X(OR, "or") X(NOT, "not") X(BY, "by") X(ALONG, "along") X(RETURNED, "returned") X(ON, "on")
/* clang-format on */

/* Is the first word of a text, behind comments, one of these? "" is a text without words. */
bool first_word_is(const char *text, const char *const *any, size_t count);

#endif
