#include "generator/playground/fused.h"

/* Calls of fma of the whole program come here; the linker has given the library's another name. */
double __wrap_fma(double a, double b, double c);
double __real_fma(double a, double b, double c);

double __wrap_fma(double a, double b, double c) {
  if (fused_is_safe(a, b, c)) return fused_safe(a, b, c);
  return a == 0 || b == 0 ? a * b + c : __real_fma(a, b, c);
}
