/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_dense_square.c in 3D: a quarter of a dense cube of 32 cells along its
 * edges, between mirrors, with the bars of 2D. Along z with a density of 1e3
 * and along x with 1e6, where the error of the shape is that of the scheme
 * alone, 2.6e-3, most of it at the twelve edges: on 16 cells 1.3e-2, and over
 * the bar.
 */
#include "dense_body.h"

static void run(struct report *report) {
  dense_report(report, "density 1e6",
               &(struct dense_body){.ratio = 1e6,
                                    .eta_gas = 1e-5,
                                    .axis = 0,
                                    .level = 7,
                                    .quarter = true});
  dense_report(report, "density 1e3",
               &(struct dense_body){.ratio = 1e3,
                                    .eta_gas = 1e-5,
                                    .axis = 2,
                                    .level = 7,
                                    .quarter = true});
}

const struct convergence_case dense_cube_case = {
    "dense_cube", "dense cube through light gas", 3, false, run};
