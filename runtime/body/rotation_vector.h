/* What a particle has turned in space: a rotation vector, the angle (rad) along the axis. It may be
   longer than a turn. */
#ifndef PERILAT_RUNTIME_ROTATION_VECTOR_H
#define PERILAT_RUNTIME_ROTATION_VECTOR_H

/* r, then a turn by a: exp(a) exp(r). Of all vectors of that rotation, which are whole turns apart,
   the one nearest to r + a, so that turns about one axis add up. */
void rotation_vector_turn(double r[3], const double a[3]);
/* The same of `count` particles, by step times their rates, with the same bits; where all turn by
   less than a quarter of a radian, several times as fast. */
void rotation_vector_turn_all(long count, double step, const double *const rate[3],
                              double *const r[3]);

/* Components that are held, as bits: 1, 2, 4.

   A particle that turns by dw about axes that stand still changes component c by g_c . dw, with
     g_c = e_c + r x e_c/2 + b r x (r x e_c),   b = (1 - |r|/2 cot(|r|/2))/|r|^2,
   so that what holds or drives c is a moment along g_c: it does no work where c stays.

   Changes the rate w along these as little as can be (to rounding), so that a step from r brings
   the held components to their targets. Not where r is a whole turn. */
void rotation_vector_reach(const double r[3], double step, int held, const double target[3],
                           double w[3]);
/* Takes the part of a moment out that what is held bears. */
void rotation_vector_release(const double r[3], int held, double moment[3]);

#endif
