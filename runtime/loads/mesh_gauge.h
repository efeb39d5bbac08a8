/* What a gauge on a mesh shows: displacement, velocity, acceleration, strain and stress at a place
   itself, or of a region's nodes in the mean. Of element-free nodes the values are parameters, so
   the field is looked at where they stand. */
#ifndef PERILAT_RUNTIME_MESH_GAUGE_H
#define PERILAT_RUNTIME_MESH_GAUGE_H

#include "dsl/base/diagnostics.h"
#include "runtime/continuum/cells.h"
#include "runtime/loads/load_steps.h"

typedef struct mesh_gauge mesh_gauge;

/* At the monitor's place, or on `count` sites of its region. What is pointed at must outlive it;
   NULL with a diagnostic where the place is not in the mesh. A
   stress is that of the law there at the strain there, with the states of the point of integration
   nearest to it. */
mesh_gauge *mesh_gauge_new(const deck_monitor *m, const int32_t *sites, long count, const cells *c,
                           const loads *l, const body *w, diagnostics *d);
void mesh_gauge_free(mesh_gauge *g);

/* What the monitor shows of the state after `step` steps, which was observed: m, m/s, m/s^2, 1,
   Pa. */
double mesh_gauge_value(mesh_gauge *g, long step);
/* Velocity over the last step, m/s. */
double mesh_gauge_velocity(mesh_gauge *g);

#endif
