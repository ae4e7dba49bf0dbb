/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/keys.h"

#include "talus/params.h"

#define AT(member) offsetof(struct two_fluid_keys, member)
#define CLOSURE(member) AT(closure.member)

/* enum two_fluid_start */
static const char *const STARTS[] = {"settled", "patched", "dense", NULL};

/* enum two_fluid_surface */
static const char *const SURFACES[] = {"none", "planes", NULL};

/* enum two_fluid_regularisation */
static const char *const REGULARISATIONS[] = {"clip", "exact", NULL};

/* clang-format would take three times the lines. */
/* clang-format off */
static const struct key KEYS[] = {
    {"grains.start", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "settled", .unit = "",
     .offset = AT(start), .choices = STARTS,
     .help = "solid fraction at t = 0: such that the pressure of the grains "
             "carries their weight; alpha_start everywhere; or that, with a "
             "plastic packing that makes it carry the weight"},
    {"grains.surface", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "planes", .unit = "",
     .offset = AT(surface), .choices = SURFACES,
     .help = "surface of beds inside closures and fluxes: a plane in each "
             "leaf, by which heaps stand; or none, all is of the solid "
             "fraction of leaves, by which they level out"},
    {"grains.alpha_start", KEY_NUMBER, .low = 1e-4, .high = 0.74, KEY_DEFAULT "0.6",
     .unit = "", .offset = AT(alpha_start),
     .help = "solid fraction of a patched or dense start, and for heights: "
             "volume over it"},
    {"grains.phi_p", KEY_NUMBER, .low = 0.1, .high = 0.74, KEY_DEFAULT "0.54",
     .unit = "", .offset = AT(phi_p),
     .help = "plastic packing at t = 0, of critical_state; not of a dense start"},
    {"grains.alpha_surface", KEY_NUMBER, .low = 1e-4, .high = 0.6, KEY_DEFAULT "0.3",
     .unit = "", .offset = AT(alpha_surface),
     .help = "solid fraction whose contour is the surface"},
    {"grains.regularisation", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "exact", .unit = "",
     .offset = AT(regularisation), .choices = REGULARISATIONS,
     .help = "how friction becomes a viscosity at small shear rates: exact "
             "keeps the stress of grains at rest, which then hold still; clip "
             "caps it"},
    {"grains.eta_max", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "0", .unit = "Pa s",
     .offset = AT(eta_max),
     .help = "cap of clip on the viscosity, by which slopes creep; 0: "
             "such that the first heap creeps at 1e-4 sqrt(g H); run.log tells"},
    {"grains.gamma_r", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "0", .unit = "1/s",
     .offset = AT(gamma_r),
     .help = "shear rate below which friction falls to 0; 0: only eta_max bounds it"},
    {"fluid", KEY_SECTION, KEY_NEEDED, .choices = two_fluid_fluid_names,
     .offset = AT(fluid), .help = "the fluid between the grains"},
    {"closure", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "critical_state", .unit = "",
     .offset = CLOSURE(set), .choices = two_fluid_set_names,
     .help = "set of closures of the grains; each has a section of its own"},
    {"drag", KEY_SECTION, KEY_DEFAULT "gidaspow", .choices = two_fluid_drag_names,
     .offset = CLOSURE(drag), .help = "of grains and fluid on each other"},
    {"critical_state", KEY_SECTION, KEY_OPTIONAL, .help = "closures that know loose from dense grains by a plastic packing"},
    {"rauter", KEY_SECTION, KEY_OPTIONAL, .help = "closures of a critical state that forgets"},
    {"mu_i_phi_i", KEY_SECTION, KEY_OPTIONAL, .help = "mu(I) and phi(I), for grains in a gas"},
    {"ktgf", KEY_SECTION, KEY_OPTIONAL, .help = "kinetic theory of granular flow, with friction"},
    {"ktgf.frictional_pressure", KEY_CHOICE, KEY_ANY,
     KEY_DEFAULT "johnson_jackson", .unit = "",
     .offset = CLOSURE(frictional_pressure),
     .choices = two_fluid_frictional_names,
     .help = "pressure of grains that rub"},
    {"ktgf.friction", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "sin", .unit = "",
     .offset = CLOSURE(friction), .choices = two_fluid_friction_names,
     .help = "yield stress over pressure: sine or tangent of `angle`"},
    {"ktgf.production", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "kinetic", .unit = "",
     .offset = CLOSURE(production), .choices = two_fluid_production_names,
     .help = "of the granular temperature: by the kinetic stress, or the whole"},
};
/* clang-format on */

_Static_assert(TWO_FLUID_GRAINS_DENSITY == 0 && CLOSURE(set) == 0,
               "offsets of two_fluid_numbers are those of struct "
               "two_fluid_keys");

const struct model_keys two_fluid_model_keys = {
    .name = "two_fluid",
    .title = "grains and the fluid between them, which may move apart",
    .keys = KEYS,
    .nkeys = sizeof KEYS / sizeof *KEYS,
    /* but for the first, which is a key of all models */
    .more = two_fluid_numbers + 1,
    .nmore = TWO_FLUID_NKEYS - 1,
    .own_size = sizeof(struct two_fluid_keys)};
