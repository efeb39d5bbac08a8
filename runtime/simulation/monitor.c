#include "runtime/simulation/monitor.h"

#include <math.h>

#include "runtime/simulation/monitor_values.h"

static void push(monitor *m, double value) {
  m->ring[m->state.filled++ % m->window] = value;
}

/* Of the last `most` values, and of one more that is not in the ring. From the oldest value to the
   newest, so that a resumed run sums in the same order. */
static double mean_of_ring(const monitor *m, long most, const double *more) {
  const int64_t count = m->state.filled < most ? m->state.filled : most;
  double sum = 0;
  for (int64_t k = m->state.filled - count; k < m->state.filled; k++)
    sum += m->ring[k % m->window];
  return more ? (sum + *more) / (double)(count + 1) : sum / (double)count;
}

/* Slope over time of the straight line that fits the same values best. */
static double slope_of_ring(const monitors *all, const monitor *m, long most, const double *more) {
  const int64_t count = m->state.filled < most ? m->state.filled : most,
                values = count + (more != NULL);
  const double n = (double)values, middle = 0.5 * (n - 1);
  double sum = more ? (n - 1 - middle) * *more : 0;
  for (int64_t k = 0; k < count; k++)
    sum += ((double)k - middle) * m->ring[(m->state.filled - count + k) % m->window];
  return values > 1 ? sum / (n * (n * n - 1) / 12 * all->interval) : 0;
}

/* Velocity over the time of the states in the window: from half a step before the first of them to
   half a step after the present one. */
static double acceleration_of_ring(const monitors *all, const monitor *m, double now) {
  const int64_t count = m->state.filled < m->window ? m->state.filled : m->window;
  const double first = m->ring[(m->state.filled - count) % m->window],
               last = m->ring[(m->state.filled - 1) % m->window];
  return (last - first + now * all->interval) / ((double)count * all->interval);
}

static double reduced(const monitors *all, const monitor *m, long most, const double *more) {
  return m->deck->kind == MONITOR_TIP_SPEED ? slope_of_ring(all, m, most, more)
                                            : mean_of_ring(m, most, more);
}

/* Its window holds what steps made of velocities, not states. */
static bool is_over_steps(const monitor *m) {
  return m->known == KNOWN_AFTER_STEP &&
         (m->deck->kind == MONITOR_VELOCITY || m->deck->kind == MONITOR_STAMP_VELOCITY ||
          m->deck->kind == MONITOR_ACCELERATION);
}

static double averaged(const monitors *all, const monitor *m, long step) {
  const bool late = m->known == KNOWN_ONE_LATE;
  if (m->window > 1 && !late && m->state.filled > 0) {
    if (m->deck->kind == MONITOR_ACCELERATION && is_over_steps(m))
      return acceleration_of_ring(all, m, monitor_value_now(all, m, step));
    return reduced(all, m, m->window, NULL);
  }
  const double now = monitor_value_now(all, m, step);
  return m->window > 1 && late ? reduced(all, m, m->window - 1, &now) : now;
}

static bool is_late(const monitor *m) {
  return m->window > 1 && m->known == KNOWN_ONE_LATE;
}

void monitors_part(monitors *all, long step, bool first) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    if (m->window > 1 && is_over_steps(m)) m->state.parts += monitor_value_of_step(all, m, step);
    if (first && is_late(m)) push(m, monitor_value_of_step(all, m, step));
  }
}

/* The mean over the parts of the step. */
static double over_parts(monitor *m, double last, long parts) {
  if (parts == 1 || !is_over_steps(m)) return last;
  const double sum = m->state.parts + last;
  m->state.parts = 0;
  return sum / (double)parts;
}

void monitors_step(monitors *all, long step, long parts) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    const bool pushed = parts > 1 && is_late(m);
    if (m->window > 1 && m->known != KNOWN_WHEN_OBSERVED && !pushed &&
        (step > 0 || (m->known == KNOWN_AFTER_STEP && !is_over_steps(m))))
      push(m, over_parts(m, monitor_value_of_step(all, m, step), parts));
  }
}

bool monitors_due(const monitors *all, long position) {
  for (int i = 0; i < all->count; i++) {
    const monitor *m = &all->items[i];
    if (position == m->zero_step || (m->window > 1 && m->known == KNOWN_WHEN_OBSERVED)) return true;
  }
  return false;
}

void monitors_look(monitors *all, long step, long position) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    if (m->window > 1 && m->known == KNOWN_WHEN_OBSERVED) push(m, monitor_value_now(all, m, step));
    if (position == m->zero_step) m->state.zero = averaged(all, m, step);
  }
}

void monitors_sample(monitors *all, long step, double time, double *values) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    values[i] = m->deck->scale * (averaged(all, m, step) - m->state.zero);
    if (fabs(values[i]) <= fabs(m->state.peak)) continue;
    m->state.peak = values[i];
    m->state.peak_time = time;
  }
}

bool monitors_meet(const monitors *all, const deck_stop *stop, double time, const double *values) {
  const int i = deck_find_monitor(all->deck, stop->monitor);
  if (i < 0 || time < stop->after) return false;
  const double peak = fabs(all->items[i].state.peak), value = fabs(values[i]);
  const double level = stop->of_peak ? stop->level * peak : stop->level;
  if (stop->of_peak && peak == 0) return false;
  return stop->below ? value < level : value > level;
}

int monitors_stop(const monitors *all, double time, const double *values) {
  for (int i = 0; i < all->deck->stop_count; i++)
    if (monitors_meet(all, &all->deck->stops[i], time, values)) return i;
  return -1;
}
