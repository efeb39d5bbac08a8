#include "runtime/continuum/frequency_limit.h"

#include <math.h>

#include "runtime/base/pool.h"
#include "runtime/base/random_number.h"

typedef void product(const void *of, const double *const u[2], double *const f[2], int rows);

static void by_stencil(const void *of, const double *const u[2], double *const f[2], int rows) {
  node_stencil_multiply(of, u, f, 0, rows);
}

static void by_matrix(const void *of, const double *const u[2], double *const f[2], int rows) {
  node_matrix_multiply(of, u, f, 0, rows);
}

static double highest(const node_layout *l, product *multiply, const void *of, const double *mass,
                      const unsigned char *held) {
  const int nodes = l->nodes[0] * l->nodes[1];
  pool *memory = pool_new();
  double *v[2], *f[2], found = 0;
  for (int d = 0; d < 2; d++) {
    v[d] = pool_doubles(memory, l->size);
    f[d] = pool_doubles(memory, l->size);
    for (int n = 0; n < nodes; n++)
      if (!held[2 * n + d] && mass[n] > 0)
        v[d][node_layout_at(l, n)] = random_unit(random_mix((uint64_t)(2 * n + d))) - 0.5;
  }
  for (int round = 0; round < FREQUENCY_PRODUCTS; round++) {
    multiply(of, (const double *const *)v, f, l->nodes[1]);
    double elastic = 0, kinetic = 0, size = 0;
    for (int d = 0; d < 2; d++)
      for (int n = 0; n < nodes; n++) {
        const long at = node_layout_at(l, n);
        if (held[2 * n + d] || !(mass[n] > 0)) continue;
        elastic += v[d][at] * f[d][at];
        kinetic += mass[n] * v[d][at] * v[d][at];
        v[d][at] = f[d][at] / mass[n];
        size = fabs(v[d][at]) > size ? fabs(v[d][at]) : size;
      }
    if (!(kinetic > 0) || !(size > 0)) break;
    found = sqrt(elastic / kinetic);
    for (int d = 0; d < 2; d++)
      for (long at = 0; at < l->size; at++)
        v[d][at] /= size;
  }
  pool_free(memory);
  return found;
}

double frequency_limit(const node_stencil *k, const double *mass, const unsigned char *held) {
  return highest(&k->layout, by_stencil, k, mass, held);
}

double frequency_limit_of_matrix(const node_matrix *k, const double *mass,
                                 const unsigned char *held) {
  return highest(&k->layout, by_matrix, k, mass, held);
}
