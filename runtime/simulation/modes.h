/* How the bodies of a run swing by themselves: the lowest frequencies and shapes of all of them
   together, with their links and point masses, about the virgin state. What a support or a drive
   has to do with is held for good; mass damping, applied forces and contact do not count.
   Stiffnesses are differences of the laws' own forces on either side of rest, the mean where these
   differ. */
#ifndef PERILAT_RUNTIME_MODES_H
#define PERILAT_RUNTIME_MODES_H

enum { MODES_MOST = 100, MODES_MOST_RIGID = 12, MODES_SHARES = 4 };

typedef struct mode {
  double omega; /* rad/s, of six significant digits; 0: a rigid motion or a mechanism */
  double
      residual; /* omega surely lies within this part of it, but for rounding; NaN where it is 0 */
  double share[MODES_SHARES]; /* of the kinetic energy: along x, y, z, and turning; in sum 1 */
  double **shape; /* [bodies][dof * size of its rows] m, rad; of modal mass 1 kg, the sum of the
                     masses times its squares */
} mode;

typedef struct mode_count {
  long freedoms; /* components of particles that nothing holds */
  int rigid;     /* motions that nothing resists: the first MODES_MOST_RIGID of them */
  int found;     /* of those that something resists, the lowest */
} mode_count;

struct simulation;
/* modes[most] of a run before its first step, whose state stays as it is; to be freed. Returns
   NULL, or why there are none. */
const char *modes_find(struct simulation *s, int most, mode *modes, mode_count *count);
void modes_free(mode *modes, int count, int body_count);

#endif
