/* Monitors of every kind that watched.h has, of a body with a region `mid`, some of them means over
   the time `mean`: for runs that must come to the same bits. */
#ifndef PERILAT_TESTS_WATCH_ALL_H
#define PERILAT_TESTS_WATCH_ALL_H

#define WATCH_ALL(mean)                                                                            \
  "&monitor name = 'w1' kind = 'momentum' component = 'x' average = " mean " /\n"                  \
  "&monitor name = 'w2' kind = 'angular_momentum' about = 0.05, 0.03 /\n"                          \
  "&monitor name = 'w3' kind = 'energy' component = 'stored' region = 'mid' zero_at = 5e-5 /\n"    \
  "&monitor name = 'w4' kind = 'energy' component = 'kinetic' /\n"                                 \
  "&monitor name = 'w5' kind = 'acceleration' component = 'y' region = 'mid' average = " mean      \
  " /\n"                                                                                           \
  "&monitor name = 'w6' kind = 'acceleration' component = 'x' at = 0.04, 0.02 /\n"                 \
  "&monitor name = 'w7' kind = 'force' at = 0.03, 0 normal = 1, 0.1 average = " mean " /\n"        \
  "&monitor name = 'v3' kind = 'moment' at = 0.03, 0.01 normal = 1, 0.1 average = " mean " /\n"    \
  "&monitor name = 'w8' kind = 'stress' region = 'mid' component = 'xy' average = " mean " /\n"    \
  "&monitor name = 'w9' kind = 'strain' region = 'mid' component = 'xx' average = " mean " /\n"    \
  "&monitor name = 'v1' kind = 'tip' at = 0.1, 0 direction = -1, 0.1 above = 0.1 average = " mean  \
  " /\n"                                                                                           \
  "&monitor name = 'v4' kind = 'crack_width' from = 0.02, 0.02 to = 0.04, 0.025 above = 0.1 "      \
  "average = " mean " /\n"                                                                         \
  "&monitor name = 'v2' kind = 'tip_speed' at = 0, 0 direction = 1, 0 above = 0.1 average = 1e-5 " \
  "/\n"

#endif
