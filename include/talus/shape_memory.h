/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A level set (shapes.h) that remembers its values at the last points it was
 * asked for: corners are shared by leaves, up to eight in 3D, and functions of
 * a case are slow. The values are the same bit for bit, as a level set depends
 * on its point alone. Not collective.
 */
#ifndef TALUS_SHAPE_MEMORY_H
#define TALUS_SHAPE_MEMORY_H

#include "talus/shapes.h"

struct shape_memory;

/* Make a memory of f, which the caller destroys; `context` is borrowed. */
struct shape_memory *shape_memory_new(shape_level_set f, void *context);
void shape_memory_destroy(struct shape_memory *memory);

/* Return f(x); the context is the memory. */
double shape_memory_value(void *memory, const double x[3]);

#endif
