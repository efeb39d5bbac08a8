/* Rewrites of a graph that go beyond what ir_make simplifies: they may change the last bits of a
   value, so each says what it assumes. Every reader of the graph sees the rewritten form, so all of
   them still agree to the bit. */
#ifndef PERILAT_GENERATOR_REWRITE_H
#define PERILAT_GENERATOR_REWRITE_H

#include "generator/ir/ir.h"

/* The roots with the given input nodes set to zero, where 0*x = 0 and 0/x = 0: assumes that x is
   finite, and not 0 as a divisor. */
void rewrite_zero(ir *g, const ir_node *roots, int root_count, const ir_node *inputs,
                  int input_count, ir_node *out);

/* x/u with u the same for all bonds becomes x*(1/u), so that 1/u is hoisted; several divisions by
   one denominator share its reciprocal, and so do divisions toward each neighbour by a value of the
   particle; so does what changes where it is divided by what lasts (the number of a particle's
   bonds, say), whose reciprocal needs not wait. A quotient is off by 1.5 units in the last place at
   most instead of 0.5. Assumes that 1/u does not overflow. */
void rewrite_reciprocals(ir *g, const ir_node *roots, int root_count, ir_node *out);

/* A choice between two quotients, each of which nothing else needs, divides what it has chosen: the
   same bits. */
void rewrite_choices(ir *g, const ir_node *roots, int root_count, ir_node *out);

/* Factors that are the same for all bonds become one, which is hoisted: u*(v*x) = (u*v)*x; to that
   end they move out of products that nothing else needs, out of sizes, and out of the larger or
   smaller of two, which becomes a choice where a choice keeps its NaN. Assumes that products of
   such factors neither overflow nor underflow. */
void rewrite_factors(ir *g, const ir_node *roots, int root_count, ir_node *out);

/* a*b + c, where it differs from bond to bond and a*b has no name, becomes one operation that
   rounds once: faster, and closer to the exact sum. What is a difference of equal products in the
   roots need not be exactly 0 afterwards. */
void rewrite_fused(ir *g, const ir_node *roots, int root_count, ir_node *out);

/* True when any root needs any of the nodes. */
bool rewrite_depends(const ir *g, const ir_node *roots, int root_count, const ir_node *nodes,
                     int node_count);

/* Degree p of a function that is positively homogeneous in the inputs x for reasons visible in the
   graph: f(a x) = a^p f(x) for a > 0. REWRITE_ZERO for a function that is identically 0; NAN where
   nothing can be said. Degree 1 covers linear functions and cases such as k_t x for x > 0, k_c x
   otherwise. */
#define REWRITE_ZERO (-1.0e300)
double rewrite_degree(const ir *g, ir_node f, const ir_node *x, int count);

/* Whether b is NaN wherever a is, for reasons visible in the graph near both. Overflow is left
 * aside. */
bool rewrite_nan_follows(const ir *g, ir_node a, ir_node b);

/* The largest of what is added up to a value, as a measure of its rounding. */
ir_node rewrite_size(ir *g, ir_node n);

#endif
