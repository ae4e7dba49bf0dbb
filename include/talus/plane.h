/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Planes that cut a cell: the geometry behind a piecewise-linear (PLIC)
 * surface. Pure functions, no allocation, no state.
 *
 * The cell is the unit cube centred on the origin, [-1/2, 1/2]^DIM; every
 * length below is in cell widths. The grains fill the half space
 *
 *   n . x <= alpha                                                       (1)
 *
 * so n points OUT of the grains. Talus keeps n with |n|_1 = sum_d |n_d| = 1,
 * but every function takes any length: only n/|n|_1 and alpha/|n|_1 matter.
 * The plane misses the interior of the cell when |alpha| >= |n|_1/2.
 *
 * With m_d = |n_d|/|n|_1 in ascending order, a = 1/2 - |alpha|/|n|_1 and
 * <t> = max(t, 0), the smaller of the two parts has the volume
 *
 *   V(a) = [a^DIM - sum_d <a - m_d>^DIM + <a - m_1 - m_2>^DIM]
 *          / (DIM! prod_d m_d),   0 <= a <= 1/2                        (2)
 *
 * [scardovelli_zaleski_2000]. Equation (2) divides small differences by small
 * products when an m_d tends to 0; the code uses the same polynomial, piece by
 * piece, with those products cancelled by hand, and is good to a few 1e-16 for
 * every n, zero components included. The inverse is analytic, with its cubic
 * pieces reduced to z^3 - 3 r^2 z = 2 r^3 sin(3 phi), whose wanted root is
 * z = -2 r sin(phi).
 *
 * A zero normal. A stencil may have no preferred direction (an isolated,
 * symmetric fragment). n = 0 then stands for a fog that fills the cell evenly:
 * plane_alpha returns c - 1/2, and every sub-box is filled to c.
 *
 * Sources:
 *  [scardovelli_zaleski_2000] Scardovelli & Zaleski, Analytical relations
 *    connecting linear interfaces and volume fractions in rectangular grids,
 *    J. Comput. Phys. 164 (2000) 228, doi:10.1006/jcph.2000.6567.
 *  [aulisa_2007] Aulisa, Manservisi, Scardovelli & Zaleski, Interface
 *    reconstruction with least-squares fit and split advection in
 *    three-dimensional Cartesian geometry, J. Comput. Phys. 225 (2007) 2301,
 *    doi:10.1016/j.jcp.2007.03.015.
 *  [pilliod_puckett_2004] Pilliod & Puckett, Second-order accurate
 *    volume-of-fluid algorithms for tracking material interfaces, J. Comput.
 *    Phys. 199 (2004) 465, doi:10.1016/j.jcp.2003.12.023.
 */
#ifndef TALUS_PLANE_H
#define TALUS_PLANE_H

#include <stdbool.h>

/* Cells of a stencil that reaches one cell in every direction, 3^DIM. */
enum { PLANE_STENCIL = DIM == 2 ? 9 : 27 };

/*
 * Return the fraction of the cell with n . x <= alpha, equation (2): 0 to 1.
 * Error below 1e-15; V(n, alpha) + V(-n, -alpha) = 1 to one rounding.
 */
double plane_volume(const double n[DIM], double alpha);

/*
 * Return the alpha for which plane_volume(n, alpha) = c; c is cut to [0, 1].
 * The volume of the result differs from c by less than 1e-15.
 */
double plane_alpha(const double n[DIM], double c);

/*
 * Return the fraction OF THE BOX lo[d] <= x[d] <= hi[d] with n . x <= alpha: 0
 * to 1. The box is any part of the cell (a child, the volume that crosses a
 * face in one step) or even outside it. The volumes of boxes that tile the cell
 * add up to plane_volume to round-off. A box without volume gives a number in
 * [0, 1].
 */
double plane_box_volume(const double n[DIM], double alpha, const double lo[DIM],
                        const double hi[DIM]);

/*
 * Find the foot x = alpha n/|n|_2^2 of the plane, its point nearest to the
 * centre of the cell; n = 0 gives the centre. The plane of a cell nearly empty
 * or full beside one of its faces has it in the middle of that face, at however
 * small a tilt, while the centroid of the cut runs into a corner. It may lie
 * outside the cell, by 0.11 (2D) or 0.19 (3D) at most.
 */
void plane_foot(const double n[DIM], double alpha, double x[DIM]);

/*
 * Find the normal of the surface, |n|_1 = 1, from the volume fractions of the
 * cell and its neighbours: exact for a plane, and the mixed Youngs-centred
 * normal [aulisa_2007] where no plane fits.
 *
 * c[(i+1) + 3 (j+1) + 9 (k+1)] is the fraction c_k of the neighbour at offset
 * o_k = (i, j, k), each -1, 0 or 1.
 *
 * Mixed normal n_m: candidates are Youngs' gradient and, for each direction d,
 * the slopes of the three-cell columns along d (centred differences). The
 * centred candidate with the largest own component |n_d| is kept, then that or
 * Youngs', whichever has the smaller largest component. On a plane it is wrong
 * by up to 0.8 (2D) or 1.3 (3D) degrees.
 *
 * Fit n_f: from n_m, damped Gauss-Newton steps lower the misfit of LVIRA
 * [pilliod_puckett_2004],
 *
 *   E(n) = sum_k [V(n, alpha(n) - n . o_k) - c_k]^2,  V(n, alpha(n)) = c_0
 *                                                                        (3)
 *
 * A step that does not lower E is halved; at most 8 are tried. The result is
 *
 *   n = n_m + w (n_f - n_m),  w = max(1 - E(n_f)/E(n_m), E(n_m)/E_r) <= 1  (4)
 *
 * that is n_f for a plane, where E falls to round-off, and nearly n_m on a
 * curved surface, where E hardly falls and n_f is worse. Where n_m misses the
 * stencil by more than E_r = 0.1 (2D) or 1 (3D), as in threads one or two cells
 * wide, n_f keeps threads whole (docs/notes/planes.md). n_m stays if it fits to
 * 1e-13, if no step lowers E, or if c_0 is not in (0, 1).
 *
 * Accuracy: a plane to 1e-12 radian; to 1e-6 (3D) where c_0 or 1 - c_0 is
 * below 1e-6 and known to round-off only. On a circle or sphere of radius R
 * cells the normal at the centroid of the cut is first order, so the position
 * is second order: rms 0.2/R (2D), 0.24/R to 0.36/R (3D) radian for R = 4 to
 * 64. Errors of c below 1e-4 turn a plane's normal by up to 10 (2D) or 30 (3D)
 * times their size.
 *
 * Two directions that tie to 1e-10 are averaged, and sums are paired so that
 * all axes are treated alike: a reflected stencil gives the reflected normal
 * bit for bit, a stencil with its axes exchanged the exchanged normal to
 * round-off. n = 0 for a uniform stencil and for one with no preferred
 * direction.
 *
 * known: false for cells that the fit leaves out, those beyond a wall; their c
 * (a mirror image, say) then only helps to find a start. NULL: all are known.
 */
void plane_normal(const double c[PLANE_STENCIL],
                  const bool known[PLANE_STENCIL], double n[DIM]);

#endif
