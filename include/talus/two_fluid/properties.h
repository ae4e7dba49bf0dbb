/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Properties of grains and fluid in leaves and at faces, from alpha, u_s and
 * u_f: drag, granular temperature, pressure of the grains, viscosities. */
#ifndef TALUS_TWO_FLUID_PROPERTIES_H
#define TALUS_TWO_FLUID_PROPERTIES_H

#include <stdint.h>

#include "talus/two_fluid_grains.h"

struct two_fluid;

/* Fill alpha and the velocities, and set the surface, shear rates, drag, Theta
 * and p_s (filled). The shear rate of a leaf is that of grains that slide past
 * each other, sqrt(2 (D:D - (tr D)^2)): grains that are squeezed or expand
 * along one axis, as beds do that settle, do not dilate for that.
 * Collective. */
void two_fluid_properties(struct two_fluid *sim);
/* Set the shear rates of the grains in leaves; both velocities are filled.
 * Collective. */
void two_fluid_shear_leaves(struct two_fluid *sim);
/* Set eta_f, kappa_f of both phases from p_s and the shear rates of velocities
 * that are filled. Friction has p_s as dilatancy will raise it over dt, p_s + C
 * gamma dt, else dense grains would shear far beyond the strain that makes them
 * hold before p_s is felt. Friction has p_s of both leaves of a face with X of
 * the shear rate there, and on walls the weight of the grains that lie on the
 * wall; faces to leaves without grains have none. With an exact yield eta_f is
 * what friction has beyond that at rest, where X = 0, and yield.tau_y that.
 * Collective. */
void two_fluid_viscosities(struct two_fluid *sim);
/* Return P of leaf i at a solid fraction alpha, at least that of surface.h
 * where the bed ends, with the phi_p that shear will have made of that of the
 * leaf in dt: grains that are too dense for their shear push at once, and are
 * let go as they expand. slope: unless NULL, dP/dalpha. */
double two_fluid_law(const struct two_fluid *sim, int32_t i, double alpha,
                     double dt, double *slope);
/* Return the plastic packing of leaf i after dt of shear at alpha, beyond the
 * shear rate at which grains below their yield stress creep for eta_max; with
 * an exact yield faces that hold do not shear. */
double two_fluid_next_packing(const struct two_fluid *sim, int32_t i,
                              double alpha, double dt);
/* Give leaves without grains the velocity of the grains around them, else that
 * of the fluid, and fill u_s. alpha is filled. Collective. */
void two_fluid_calm(struct two_fluid *sim);
/* Return how slow the grains of leaf i are, 1: at rest; 0 where they or the
 * fluid past them move by 0.1 dt |g|. */
double two_fluid_slowness(const struct two_fluid *sim, int32_t i);
/* Return that, less where they carry less than half their weight; 0 where they
 * carry nothing. */
double two_fluid_stillness(const struct two_fluid *sim, int32_t i);

#endif
