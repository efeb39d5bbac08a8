/* Which of many points are near each other: the nearest ones of each, or all within a distance.
   Points are sorted into boxes of about two, so that the cost grows as their number does as long as
   nearly all are spread with some evenness.

   What is found does not depend on the order of the points: of points equally far away those with
   the smaller x, then y, then z are nearer. */
#ifndef PERILAT_RUNTIME_NEIGHBOUR_SEARCH_H
#define PERILAT_RUNTIME_NEIGHBOUR_SEARCH_H

#include <stdint.h>

typedef struct point_cloud {
  int dimensions; /* 2 or 3 */
  long count;
  const double *at[3]; /* [dimensions][count] m; finite */
} point_cloud;

typedef struct point_pair {
  int32_t i, j; /* i < j */
} point_pair;

typedef struct point_pairs {
  point_pair *items; /* each pair once; malloc'ed */
  long count;
  long crowded; /* a point with more neighbours than there may be: pairs are missing then; or -1 */
} point_pairs;

/* i and j are a pair when either is among the `nearest` nearest of the other. */
point_pairs pairs_of_nearest(const point_cloud *c, int nearest, int most);

/* i and j are a pair when they are at most `distance` (m) apart. */
point_pairs pairs_within(const point_cloud *c, double distance, int most);

/* The same where they are at most the mean of reach[i] and reach[j] (m) apart. */
point_pairs pairs_within_own(const point_cloud *c, const double *reach, int most);

/* near[count] becomes 1 for points at most `distance` (m) from one of the chosen, else 0. */
void points_near(const point_cloud *c, const int32_t *chosen, long chosen_count, double distance,
                 unsigned char *near);

#endif
