/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/keys.h"

#define PARAM(k) offsetof(struct four_state_keys, param[LEE_HUANG_##k])
#define AT(member) offsetof(struct four_state_keys, member)

/* enum four_state_start */
static const char *const STARTS[] = {"balance", "uniform", NULL};

/* enum four_state_regularisation */
static const char *const REGULARISATIONS[] = {"exponential", "exact", NULL};

/* clang-format off */
static const struct key KEYS[] = {
    {"grains.rho_d", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "2500", .unit = "kg/m^3",
     .offset = PARAM(RHO_D), .help = "density of a grain"},
    {"grains.d", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "1.15e-3", .unit = "m",
     .offset = PARAM(D), .help = "grain diameter"},
    {"grains.e_eff", KEY_NUMBER, .low = 0.01, .high = 0.99, KEY_DEFAULT "0.58",
     .unit = "", .offset = PARAM(E_EFF),
     .help = "effective coefficient of restitution"},
    {"grains.eta_S", KEY_NUMBER, .low = 0, .high = 100, KEY_DEFAULT "0.42",
     .unit = "", .offset = PARAM(ETA_S), .help = "friction coefficient at rest"},
    {"grains.nu_max", KEY_NUMBER, .low = 0.1, .high = 1, KEY_DEFAULT "0.63",
     .unit = "", .offset = PARAM(NU_MAX), .help = "solid fraction, densest"},
    {"grains.nu_min", KEY_NUMBER, .low = 0.1, .high = 1, KEY_DEFAULT "0.57",
     .unit = "", .offset = PARAM(NU_MIN),
     .help = "solid fraction, random loose packing"},
    {"grains.nu_0", KEY_NUMBER, .low = 0.1, .high = 1, KEY_DEFAULT "0.6",
     .unit = "", .offset = PARAM(NU_0), .help = "solid fraction of slow shear"},
    {"grains.a", KEY_NUMBER, .low = 1e-3, .high = 100, KEY_DEFAULT "0.28",
     .unit = "", .offset = PARAM(A), .help = "dilatancy 1/nu = 1/nu_0 + a I^delta"},
    {"grains.delta", KEY_NUMBER, .low = 0.2, .high = 2, KEY_DEFAULT "0.58",
     .unit = "", .offset = PARAM(DELTA), .help = "its exponent"},
    {"grains.K", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "1e8", .unit = "Pa",
     .offset = PARAM(K), .help = "stiffness of the packing"},
    {"grains.chi", KEY_NUMBER, .low = 0.1, .high = 10, KEY_DEFAULT "1.5",
     .unit = "", .offset = PARAM(CHI), .help = "exponent of its pressure"},
    {"grains.regularisation", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "exponential",
     .unit = "", .offset = AT(regularisation), .choices = REGULARISATIONS,
     .help = "friction at small shear rates: exponential falls to 0, by n, as in "
             "the paper; exact keeps the stress of grains at rest, which then "
             "hold still"},
    {"grains.n", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "1e5", .unit = "s",
     .offset = PARAM(N), .help = "regularisation 1 - exp(-n gamma/2) of friction"},
    {"grains.g0_exponent", KEY_NUMBER, .low = 0.5, .high = 3, KEY_DEFAULT "1",
     .unit = "", .offset = PARAM(G0_EXPONENT),
     .help = "of 1 - nu/nu_max in the radial distribution g_0"},
    {"grains.start", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "balance", .unit = "",
     .offset = AT(start), .choices = STARTS,
     .help = "solid fraction at t = 0: such that pressure carries the weight, "
             "or one value, nu_start"},
    {"grains.nu_start", KEY_NUMBER, .low = 1e-3, .high = 1, KEY_DEFAULT "0.575",
     .unit = "", .offset = AT(nu_start),
     .help = "solid fraction of a uniform start, and for heights: volume over it"},
    {"grains.nu_surface", KEY_NUMBER, .low = 1e-3, .high = 0.5, KEY_DEFAULT "0.1",
     .unit = "", .offset = AT(nu_surface),
     .help = "solid fraction whose contour is the surface"},
    {"vacuum", KEY_SECTION, KEY_OPTIONAL, .help = "where grains are few"},
    {"vacuum.nu", KEY_NUMBER, .low = 1e-8, .high = 1e-2, KEY_DEFAULT "1e-4",
     .unit = "", .offset = AT(nu_vacuum), .help = "solid fraction below which there "
     "is none to speak of"},
    {"vacuum.knudsen", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "10", .unit = "d",
     .offset = AT(knudsen),
     .help = "mu_K, kappa and delta are divided by 1 + (mean free path)/this; "
             "inf: they are not, as in the paper"},
    {"vacuum.T_max", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "1",
     .unit = "m^2/s^2", .offset = AT(T_max), .help = "bound on the granular temperature"},
};
/* clang-format on */

/* Keys that mean nothing to compressible grains without gas. */
static const char *const REFUSED[] = {"grains.density", "tracers", NULL};

const struct model_keys four_state_model_keys = {
    .name = "four_state",
    .title = "compressible grains, solid to inertial, in a vacuum",
    .keys = KEYS,
    .nkeys = sizeof KEYS / sizeof *KEYS,
    .own_size = sizeof(struct four_state_keys),
    .refused = REFUSED};
