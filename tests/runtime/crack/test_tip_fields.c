/* Fields of a running tip against known values and the equations of motion; stress intensity
   factors of these fields by the interaction integral. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/crack/interaction_integral.h"
#include "runtime/crack/tip_fields.h"
#include "runtime/crack/wave_speeds.h"

static crack_medium medium(double E, double nu, double rho, bool strain) {
  const double mu = E / (2 * (1 + nu));
  if (strain) {
    E /= 1 - nu * nu;
    nu /= 1 - nu;
  }
  const double D11 = E / (1 - nu * nu);
  return crack_medium_of(D11, nu * D11, mu, rho);
}

static void speeds_are(double E, double nu, double rho, bool strain, double c_d, double c_s,
                       double c_R) {
  const crack_medium m = medium(E, nu, rho, strain);
  assert_true(fabs(m.c_d - c_d) < 0.6 && fabs(m.c_s - c_s) < 0.6 && fabs(m.c_R - c_R) < 0.6);
  assert_true(fabs(rayleigh_function(&m, m.c_R)) < 1e-12);
  assert_true(fabs(m.modulus - (strain ? E / (1 - nu * nu) : E)) < 1e-12 * E);
}

static void speeds_of_waves(void **state) {
  (void)state;
  speeds_are(31.37e9, 0.2, 2400, false, 3690, 2334, 2112);
  speeds_are(31.37e9, 0.2, 2400, true, 3811, 2334, 2126);
  speeds_are(30e9, 0.2, 2400, false, 3608, 2282, 2066);
  speeds_are(30e9, 0.2, 2400, true, 3727, 2282, 2079);
  speeds_are(190e9, 0.3, 8000, false, 5109, 3022, 2769);
  speeds_are(190e9, 0.3, 8000, true, 5654, 3022, 2803);
}

static void near(double found, double known, double digits) {
  assert_true(fabs(found - known) <= digits * fabs(known));
}

/* Figures of a program of its own, to seven digits. */
static void known_fields(void **state) {
  (void)state;
  const crack_medium m = medium(31.37e9, 0.2, 2400, false);
  const double v = 0.5 * m.c_s;
  const tip_field one = tip_field_at(&m, 1, v, 1e-3, 0.5e-3),
                  two = tip_field_at(&m, 2, v, 1e-3, 0.5e-3);
  const double of_one[] = {1.004648e-12, 1.572668e-13, 13.75768,    13.68137, 2.69784,
                           -4.09957e-7,  1.11522e-7,   -5.16782e-3, .236153},
               of_two[] = {6.833745e-13, -8.827113e-13, -8.57727, 2.46278, 9.85111,
                           3.37365e-7,   5.92705e-7,    .442365,  .432370};
  for (int mode = 0; mode < 2; mode++) {
    const tip_field *f = mode ? &two : &one;
    const double *known = mode ? of_two : of_one;
    const double found[] = {f->u[0],           f->u[1],        f->stress[0],   f->stress[1],
                            f->stress[2],      f->velocity[0], f->velocity[1], f->acceleration[0],
                            f->acceleration[1]};
    for (int k = 0; k < 9; k++)
      near(found[k], known[k], 3e-6);
  }
  near(rayleigh_function(&m, v), .223835, 3e-6);
  /* A_I, A_II of Freund (1990): G = (1 - nu)/(2 mu) (A_I K_I^2 + A_II K_II^2) */
  const double of_mode[] = {1.324471, 1.209071};
  for (int mode = 1; mode <= 2; mode++)
    near(m.mu / (0.8 * tip_factor(&m, mode, v)), of_mode[mode - 1], 1e-6);
  const double rest[2] = {1, 0};
  near(m.modulus * tip_energy_release(&m, 0.01 * m.c_s, rest), 1.000078, 1e-6);
}

/* D_ijkl u_k,lj = rho a_i by differences; no traction on the faces behind the tip. */
static void fields_obey_the_equations_of_motion(void **state) {
  (void)state;
  const crack_medium m = medium(30e9, 0.2, 2400, true);
  const double by = 1e-7;
  for (int mode = 1; mode <= 2; mode++)
    for (int speed = 0; speed < 3; speed++) {
      const double v = (double[]){0.05, 0.4, 0.8}[speed] * m.c_s, x = -0.7e-3, y = 1.1e-3;
      const tip_field f = tip_field_at(&m, mode, v, x, y), e = tip_field_at(&m, mode, v, x + by, y),
                      w = tip_field_at(&m, mode, v, x - by, y),
                      n = tip_field_at(&m, mode, v, x, y + by),
                      s = tip_field_at(&m, mode, v, x, y - by);
      const double force[2] = {(e.stress[0] - w.stress[0] + n.stress[2] - s.stress[2]) / (2 * by),
                               (e.stress[2] - w.stress[2] + n.stress[1] - s.stress[1]) / (2 * by)};
      const double size = fabs(e.stress[0] - w.stress[0]) / (2 * by) + fabs(force[1]);
      for (int k = 0; k < 2; k++) {
        assert_true(fabs(force[k] - m.density * f.acceleration[k]) < 1e-6 * size);
        assert_true(fabs((e.u[k] - w.u[k]) / (2 * by) - f.gradient[k][0]) <
                    1e-6 * fabs(f.gradient[k][0]) + 1e-15);
      }
      for (int side = -1; side <= 1; side += 2) {
        const tip_field face = tip_field_at(&m, mode, v, -1e-3, side * 1e-18);
        assert_true(fabs(face.stress[1]) < 1e-6 * 1 / sqrt(2 * M_PI * 1e-3));
        assert_true(fabs(face.stress[2]) < 1e-6 * 1 / sqrt(2 * M_PI * 1e-3));
      }
    }
}

/* --- the integral ----------------------------------------------------------------------------- */

enum { RINGS = 60, GAUSS = 4 };

/* From 0 to 1, fine at 0, with a border at the plateau's kink; and its slope. */
static double graded(double t, double *slope) {
  *slope = t < 0.5 ? 4 * pow(2 * t, 3) : 1;
  return t < 0.5 ? 0.5 * pow(2 * t, 4) : t;
}

/* Points in cells that grow away from the tip, so that the root at the tip is integrated well; body
   fields are those of K at that speed, in axes turned by the box's angle. */
static int fill_box(const crack_medium *m, const tip_box *b, double v, const double K[2],
                    tip_point *out) {
  static const double place[GAUSS] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                      0.8611363115940526},
                      weight[GAUSS] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                       0.3478548451374538};
  const double c = cos(b->angle), s = sin(b->angle);
  int count = 0;
  for (int quadrant = 0; quadrant < 4; quadrant++)
    for (int i = 0; i < RINGS; i++)
      for (int j = 0; j < RINGS; j++)
        for (int g = 0; g < GAUSS * GAUSS; g++) {
          const double sx = quadrant % 2 ? -b->behind : b->ahead,
                       sy = (quadrant / 2 ? -1 : 1) * b->across;
          const double t[2] = {(i + 0.5 * (1 + place[g % GAUSS])) / RINGS,
                               (j + 0.5 * (1 + place[g / GAUSS])) / RINGS};
          double stretched[2];
          const double x = sx * graded(t[0], &stretched[0]), y = sy * graded(t[1], &stretched[1]);
          const double area = fabs(sx * sy) * stretched[0] * stretched[1] * weight[g % GAUSS] *
                              weight[g / GAUSS] / (4 * RINGS * RINGS);
          tip_point *p = &out[count++];
          *p =
              (tip_point){.at = {b->at[0] + c * x - s * y, b->at[1] + s * x + c * y}, .area = area};
          double local[2][2] = {{0}}, slope[2][2] = {{0}}, stress[2][2] = {{0}}, vel[2] = {0},
                 acc[2] = {0};
          for (int mode = 1; mode <= 2; mode++) {
            const double part = K[mode - 1];
            const tip_field f = tip_field_at(m, mode, v, x, y);
            for (int k = 0; k < 2; k++) {
              vel[k] += part * f.velocity[k];
              acc[k] += part * f.acceleration[k];
              slope[k][0] += part * f.velocity_slope[k];
              for (int q = 0; q < 2; q++)
                local[k][q] += part * f.gradient[k][q];
            }
            stress[0][0] += part * f.stress[0];
            stress[1][1] += part * f.stress[1];
            stress[0][1] += part * f.stress[2];
          }
          stress[1][0] = stress[0][1];
          /* R^T a R; velocity gradients across the crack are not asked for */
          const double R[2][2] = {{c, s}, {-s, c}};
          for (int k = 0; k < 2; k++) {
            p->velocity[k] = R[0][k] * vel[0] + R[1][k] * vel[1];
            p->acceleration[k] = R[0][k] * acc[0] + R[1][k] * acc[1];
          }
          double turned[2][2];
          for (int k = 0; k < 2; k++)
            for (int q = 0; q < 2; q++) {
              double sum[3] = {0};
              for (int a = 0; a < 2; a++)
                for (int e = 0; e < 2; e++) {
                  sum[0] += R[a][k] * local[a][e] * R[e][q];
                  sum[1] += R[a][k] * slope[a][e] * R[e][q];
                  sum[2] += R[a][k] * stress[a][e] * R[e][q];
                }
              p->gradient[k][q] = sum[0];
              p->velocity_gradient[k][q] = sum[1];
              turned[k][q] = sum[2];
            }
          p->stress[0] = turned[0][0];
          p->stress[1] = turned[1][1];
          p->stress[2] = turned[0][1];
        }
  return count;
}

static void intensity_of_exact_fields(void **state) {
  (void)state;
  const crack_medium m = medium(31.37e9, 0.2, 2400, false);
  const double K[2] = {2, -0.7}, at[2] = {0.3, -0.2};
  tip_point *points = must_alloc((size_t)(4 * RINGS * RINGS * GAUSS * GAUSS) * sizeof *points);
  for (int weight = 0; weight < 2; weight++)
    for (int speed = 0; speed < 3; speed++)
      for (int moved = 0; moved < 2; moved++) {
        const double v = (double[]){0.01, 0.3, 0.6}[speed] * m.c_s;
        const tip_box b = tip_box_of(at, 0.4 + speed, 0.01, moved ? 0.004 : 0.02, false,
                                     weight ? WEIGHT_PYRAMID : WEIGHT_PLATEAU);
        double found[2];
        const int count = fill_box(&m, &b, v, K, points);
        tip_intensity(&m, &b, points, count, v, found);
        for (int k = 0; k < 2; k++)
          assert_true(fabs(found[k] - K[k]) < 1e-6);
      }
  free(points);
}

static void weights_fall_to_nothing_at_the_box(void **state) {
  (void)state;
  const double at[2] = {1, 2}, by = 1e-7;
  for (int weight = 0; weight < 2; weight++)
    for (int moved = 0; moved < 2; moved++) {
      const tip_box b = tip_box_of(at, 0.7, 0.1, moved ? 0.03 : 1, false,
                                   weight ? WEIGHT_PYRAMID : WEIGHT_PLATEAU);
      const double c = cos(0.7), s = sin(0.7);
      double slope[2], ignored[2], lower[2], upper[2];
      assert_true(fabs(b.behind + b.ahead - 0.2) < 1e-15);
      tip_box_extent(&b, lower, upper);
      assert_true(fabs(tip_box_weight(&b, at, slope) - 1) < 1e-15);
      for (int k = 0; k < 100; k++) {
        const double x = -b.behind + (b.behind + b.ahead) * (k % 10 + 0.31) / 10,
                     y = -0.1 + 0.2 * (k / 10 + 0.57) / 10;
        double here[2] = {at[0] + c * x - s * y, at[1] + s * x + c * y};
        tip_box_weight(&b, here, slope);
        for (int a = 0; a < 2; a++) {
          assert_true(here[a] > lower[a] && here[a] < upper[a]);
          const double dx = a ? -s : c, dy = a ? c : s;
          const double high = tip_box_weight(&b, (double[2]){here[0] + by * dx, here[1] + by * dy},
                                             ignored),
                       low = tip_box_weight(&b, (double[2]){here[0] - by * dx, here[1] - by * dy},
                                            ignored);
          assert_true(fabs((high - low) / (2 * by) - slope[a]) < 1e-6 / 0.03);
        }
      }
      for (int side = 0; side < 4; side++) {
        const double x = side == 0   ? -b.behind
                         : side == 1 ? b.ahead
                                     : 0.01,
                     y = side == 2   ? -0.1
                         : side == 3 ? 0.1
                                     : 0.02;
        const double there[2] = {at[0] + c * x - s * y, at[1] + s * x + c * y};
        assert_true(fabs(tip_box_weight(&b, there, ignored)) < 1e-13);
      }
    }
  const tip_box small = tip_box_of(at, 0, 0.1, 0.03, true, WEIGHT_PLATEAU);
  assert_true(small.behind == 0.03 && small.ahead == 0.03 && small.across == 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(speeds_of_waves),
      cmocka_unit_test(known_fields),
      cmocka_unit_test(fields_obey_the_equations_of_motion),
      cmocka_unit_test(intensity_of_exact_fields),
      cmocka_unit_test(weights_fall_to_nothing_at_the_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
