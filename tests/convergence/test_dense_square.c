/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A dense square that moves at U = 1 through light gas at rest, without
 * gravity, in a periodic box of 4 D, 32 cells per edge D. Grains 1e3 to 1e6
 * times as dense as the gas, their viscosity 1e-2 rho U D, that of the gas 1e-5
 * at 1e3 and 1e6. The gas can take next to nothing of the momentum of the
 * square (its own mass is 1.5 % of it at 1e3, and only what it drags along
 * counts), which hence moves on as it is: exact in the limit of no gas. From
 * step 2, when the start by a jolt is over, over a travel of 3 D: the speed of
 * its centre of volume, and its shape against the square shifted by the travel.
 *
 * The shape is not that of the limit at 1e3, as such soft grains give way. The
 * pressure of the gas varies around the square by a few rho_gas U^2 over D, and
 * the surface moves apart under it by
 *   K/4 (rho_gas/rho) (U t)^2/D on a perimeter of 4 D, K of order one,
 * so that a part K (rho_gas/rho) (U t/D)^2 of the area is out of place: 2.7e-2
 * at 1e3 for K = 3, and less in proportion to the gas. With rho_gas and eta_gas
 * smaller by the same factor the gas flows alike (Re = 100) and K stays: 3.2e-2
 * at 1e3, 3.8e-3 at 1e4, 1.7e-3 at 1e5, where the scheme alone is left; on 16
 * cells 3.4e-2, 6.3e-3, 4.4e-3. So K = 3.4 on both grids. The bar is
 *   0.005 + 3.5 (rho_gas/rho) (U t/D)^2.
 * Before the grains beside the surface were kept from feeling the velocity
 * gradient of the gas (skin.h) it was 4.3e-2, 2.5e-2, 2.3e-2. "exact": with a
 * yield stress of 1e-9 rho U^2, so that grains and gas are mixed as an exact
 * yield does it (two_phase/yield_faces.h). */
#include "dense_body.h"

static void run(struct report *report) {
  static const struct {
    const char *grid;
    double ratio, eta_gas;
    bool exact;
  } run[] = {{"density 1e3", 1e3, 1e-5, false},
             {"density 1e4 Re 100", 1e4, 1e-6, false},
             {"density 1e5 Re 100", 1e5, 1e-7, false},
             {"density 1e6", 1e6, 1e-5, false},
             {"density 1e3 exact", 1e3, 1e-5, true},
             {"density 1e6 exact", 1e6, 1e-5, true}};
  for (size_t k = 0; k < sizeof run / sizeof *run; k++) {
    dense_report(report, run[k].grid,
                 &(struct dense_body){.ratio = run[k].ratio,
                                      .eta_gas = run[k].eta_gas,
                                      .exact = run[k].exact,
                                      .level = 7});
  }
}

const struct convergence_case dense_square_case = {
    "dense_square", "dense square through light gas", 2, false, run};
