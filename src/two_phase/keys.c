/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a case may say of the two-phase model. */
#include "talus/two_phase/keys.h"
#include "talus/key.h"
#include "talus/params.h"

#define AT(member) offsetof(struct params, member)

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
};
/* clang-format on */

const struct model_keys two_phase_keys = {
    .name = "two_phase",
    .title = "incompressible grains and a light gas, with an interface",
    .keys = KEYS,
    .nkeys = sizeof KEYS / sizeof *KEYS};
