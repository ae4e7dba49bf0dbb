/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys of the two-phase model. */
#include "talus/two_phase/keys.h"
#include "talus/key.h"
#include "talus/params.h"

#define AT(member) offsetof(struct params, member)

/* enum limiter */
static const char *const LIMITERS[] = {"none", "minmod", "generalised_minmod",
                                       NULL};
/* enum momentum_advection */
static const char *const ADVECTIONS[] = {"on", "off", NULL};
/* enum permeability */
static const char *const PERMEABILITIES[] = {"auto", "no", "yes", NULL};

/* clang-format off */
static const struct key KEYS[] = {
    {"grains.rheology", KEY_CLOSURE, KEY_NEEDED, .unit = "",
     .offset = AT(grains), .help = "closure, see below"},
    {"grains.permeable", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "auto", .unit = "",
     .offset = AT(permeability), .choices = PERMEABILITIES,
     .help = "does gas that they enclose leave through them? auto: if their "
             "viscosity depends on pressure"},
    {"grains.side_walls", KEY_SECTION, KEY_OPTIONAL,
     .help = "friction of a narrow channel's walls, 2D"},
    {"grains.side_walls.mu", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_NEEDED, .unit = "",
     .offset = AT(side_walls.mu),
     .help = "friction coefficient of grains on them"},
    {"grains.side_walls.width", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "m",
     .offset = AT(side_walls.width), .help = "distance between them"},
    {"gas", KEY_SECTION, KEY_OPTIONAL, .help = "the light phase around them"},
    {"gas.density", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "kg/m^3",
     .offset = AT(gas.density), .help = "density"},
    {"gas.rheology", KEY_CLOSURE, KEY_NEEDED, .unit = "", .offset = AT(gas),
     .help = "closure, see below"},
    {"boundary.pressure_level", KEY_PRESSURE, KEY_ANY, KEY_OPTIONAL, .unit = "Pa",
     .offset = AT(pressure_level),
     .help = "pressure when no boundary sets any: {0, at = \"gas\"}, mean "
             "over the gas, its own weight below the top of the box taken "
             "off, the default if there is gas, or {0, at = {x, y}}, at a "
             "point; a plain number is the mean over the box and "
             "contains the weight of the grains, which drifts as they fall, "
             "so that friction does too"},
    {"solver.picard", KEY_INTEGER, .low = 0, .high = 1000, KEY_DEFAULT "0",
     .unit = "", .offset = AT(picard),
     .help = "repetitions of viscosity and projection in a step"},
    {"solver.theta", KEY_NUMBER, .low = 0.5, .high = 1, KEY_DEFAULT "1",
     .unit = "", .offset = AT(theta),
     .help = "viscous step: 1 backward Euler, 0.5 Crank-Nicolson"},
    {"solver.advection", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "on", .unit = "",
     .offset = AT(advection), .choices = ADVECTIONS,
     .help = "of momentum; off: unsteady Stokes flow, to see what inertia "
             "does. Fractions and tracers are carried in both"},
    {"solver.limiter", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "none", .unit = "",
     .offset = AT(limiter), .choices = LIMITERS,
     .help = "of slopes in momentum advection, for steep velocities"},
};
/* clang-format on */

const struct model_keys two_phase_keys = {
    .name = "two_phase",
    .title = "incompressible grains and a light gas, with an interface",
    .strips = true,
    .keys = KEYS,
    .nkeys = sizeof KEYS / sizeof *KEYS};
