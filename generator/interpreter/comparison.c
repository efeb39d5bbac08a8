#include "generator/interpreter/comparison.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/kernel.h"

static const uint64_t poison = UINT64_C(0x7ff4dead00000bad);

static bool is_poison(double value) {
  return memcmp(&value, &poison, sizeof value) == 0;
}

double ulps_between(double a, double b) {
  if (a == b || (isnan(a) && isnan(b))) return 0;
  if (!isfinite(a) || !isfinite(b)) return INFINITY;
  double larger = pl_fmax(fabs(a), fabs(b));
  return fabs(a - b) / (larger - nextafter(larger, 0)); /* finite spacing for the largest too */
}

void comparison_add(comparison *c, const char *pass, const char *what, int number,
                    const double *kernel, const double *interpreter, long count) {
  c->values += count;
  for (long q = 0; q < count; q++) {
    c->unwritten += is_poison(kernel[q]) || is_poison(interpreter[q]);
    double distance = ulps_between(kernel[q], interpreter[q]);
    if (distance <= c->largest_ulps) continue;
    c->largest_ulps = distance;
    c->kernel = kernel[q];
    c->interpreter = interpreter[q];
    if (number < 0)
      snprintf(c->worst, sizeof c->worst, "%s: %s", pass, what);
    else
      snprintf(c->worst, sizeof c->worst, "%s: %s %d", pass, what, number);
  }
}

/* Each plane on its own, so that an access past its end is one past an allocation. */
double **planes_new(int planes, long count) {
  double **p = must_calloc((size_t)planes + 1, sizeof *p);
  size_t bytes = ((size_t)count * sizeof(double) / PL_ALIGNMENT + 1) * PL_ALIGNMENT;
  for (int k = 0; k < planes; k++) {
    p[k] = must_align(PL_ALIGNMENT, bytes);
    memset(p[k], 0, bytes);
  }
  return p;
}

void planes_free(double **p, int planes) {
  for (int k = 0; k < planes; k++)
    free(p[k]);
  free(p);
}

void planes_poison(double *const *p, int planes, long count) {
  for (int k = 0; k < planes; k++)
    for (long q = 0; q < count; q++)
      memcpy(&p[k][q], &poison, sizeof poison);
}
