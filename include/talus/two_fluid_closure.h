/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closures of the two-fluid model: what grains (s) and the fluid (f) between
 * them do to each other and to themselves, from numbers of one place. Pure: no
 * mesh, no MPI, no state. This header has their choices and numbers;
 *   two_fluid_drag.h    viscosity of the fluid, drag, regimes
 *   two_fluid_grains.h  pressure and stress of the grains
 *   two_fluid_ktgf.h    the granular temperature of the set ktgf
 *   two_fluid_pair.h    two phases that drag each other over a step
 *
 * Symbols in all of them: phi the solid fraction of the bed (that of a leaf
 * over the part of the leaf that the bed fills), phi_p its plastic packing, p_s
 * the pressure of the grains, eta_f the viscosity of the fluid alone, Theta the
 * granular temperature, u_r = |u_s - u_f|, rho_s and d of a grain. gamma =
 * sqrt(2 D:D) as in rheology.h.
 */
#ifndef TALUS_TWO_FLUID_CLOSURE_H
#define TALUS_TWO_FLUID_CLOSURE_H

#include "talus/key.h"
#include "talus/rheology.h"

/* The choices, in the order of their names. */
enum two_fluid_set {
  TWO_FLUID_CRITICAL_STATE,
  TWO_FLUID_RAUTER,
  TWO_FLUID_MU_I_PHI_I,
  TWO_FLUID_KTGF
};
enum two_fluid_fluid {
  TWO_FLUID_AIR,
  TWO_FLUID_WATER,
  TWO_FLUID_PAC2,
  TWO_FLUID_PAC4,
  TWO_FLUID_OWN /* numbers of the user */
};
enum two_fluid_drag { TWO_FLUID_GIDASPOW, TWO_FLUID_ERGUN, TWO_FLUID_WEN_YU };
enum two_fluid_frictional { TWO_FLUID_JOHNSON_JACKSON, TWO_FLUID_SYAMLAL };
enum two_fluid_friction { TWO_FLUID_SIN, TWO_FLUID_TAN };
enum two_fluid_production { TWO_FLUID_KINETIC, TWO_FLUID_TOTAL };

/* Names of the choices, NULL at the end, for keys of KEY_CHOICE. */
extern const char *const two_fluid_set_names[];
extern const char *const two_fluid_fluid_names[];
extern const char *const two_fluid_drag_names[];
extern const char *const two_fluid_frictional_names[];
extern const char *const two_fluid_friction_names[];
extern const char *const two_fluid_production_names[];

/* Numbers, in the order of two_fluid_numbers. The first part of a name is the
 * section of the case that holds the number; those of a set are for that set
 * alone. */
enum two_fluid_param {
  TWO_FLUID_GRAINS_DENSITY,
  TWO_FLUID_FLUID_DENSITY,
  TWO_FLUID_FLUID_ETA_0,
  TWO_FLUID_FLUID_ETA_INF,
  TWO_FLUID_FLUID_LAMBDA,
  TWO_FLUID_FLUID_N,
  TWO_FLUID_GRAINS_D,
  TWO_FLUID_DRAG_ERGUN_VISCOUS,
  TWO_FLUID_DRAG_ERGUN_INERTIAL,
  TWO_FLUID_DRAG_WEN_YU_EXPONENT,
  TWO_FLUID_DRAG_WEN_YU_FACTOR,
  TWO_FLUID_DRAG_WEN_YU_POWER,
  TWO_FLUID_DRAG_WEN_YU_LEAST,
  TWO_FLUID_DRAG_BLEND_LOW,
  TWO_FLUID_DRAG_BLEND_HIGH,
  TWO_FLUID_CS_MU_1, /* CS: critical_state */
  TWO_FLUID_CS_MU_2,
  TWO_FLUID_CS_J_0,
  TWO_FLUID_CS_INERTIAL,
  TWO_FLUID_CS_PHI_M,
  TWO_FLUID_CS_PORES,
  TWO_FLUID_CS_STIFFNESS,
  TWO_FLUID_CS_PHI_MAX,
  TWO_FLUID_CS_PHI_C,
  TWO_FLUID_CS_DILATANCY,
  TWO_FLUID_CS_DILATANCY_MAX,
  TWO_FLUID_CS_PHI_P_LOW,
  TWO_FLUID_CS_PHI_P_HIGH,
  TWO_FLUID_CS_P_LEAST,
  TWO_FLUID_CS_RELAX,
  TWO_FLUID_RA_MU_1, /* RA: rauter */
  TWO_FLUID_RA_MU_2,
  TWO_FLUID_RA_J_0,
  TWO_FLUID_RA_INERTIAL,
  TWO_FLUID_RA_PHI_M,
  TWO_FLUID_RA_PORES,
  TWO_FLUID_RA_STIFFNESS,
  TWO_FLUID_RA_PHI_RLP,
  TWO_FLUID_RA_PHI_RCP,
  TWO_FLUID_RA_RELAX,
  TWO_FLUID_MI_MU_1, /* MI: mu_i_phi_i */
  TWO_FLUID_MI_MU_2,
  TWO_FLUID_MI_I_0,
  TWO_FLUID_MI_SLOPE,
  TWO_FLUID_MI_PHI_M,
  TWO_FLUID_MI_PORES,
  TWO_FLUID_MI_STIFFNESS,
  TWO_FLUID_MI_PHI_RLP,
  TWO_FLUID_MI_PHI_RCP,
  TWO_FLUID_MI_RELAX,
  TWO_FLUID_KT_E, /* KT: ktgf */
  TWO_FLUID_KT_PHI_MAX,
  TWO_FLUID_KT_PHI_FR,
  TWO_FLUID_KT_STIFFNESS,
  TWO_FLUID_KT_ANGLE,
  TWO_FLUID_KT_SYAMLAL,
  TWO_FLUID_KT_PHI_STAR,
  TWO_FLUID_NKEYS
};

/* Numbers that the sets of grains but ktgf share, made by two_fluid_prepare. */
struct two_fluid_shearing {
  double mu_1, mu_2, number_0; /* number_0: J_0 or I_0 */
  double viscous, inertial;    /* X = viscous eta_f gamma
                                    + inertial rho d^2 gamma^2 */
  double phi_m, pores;
  double stiffness, low, pole; /* of p_c; low: phi_rlp, unless phi_p is */
  double relax;                /* of X, over phi gamma */
};

/* The closures of a case: choices and numbers. Copies are independent. */
struct two_fluid_closure {
  enum two_fluid_set set;
  enum two_fluid_drag drag;
  enum two_fluid_frictional frictional_pressure;
  enum two_fluid_friction friction;
  enum two_fluid_production production;
  double param[TWO_FLUID_NKEYS];
  struct two_fluid_shearing by; /* by two_fluid_prepare */
};

/* Names of the numbers in a case, "section.name", and their ranges; offsets are
 * in struct two_fluid_closure. Without a default: those of a fluid, which may
 * have a name. The density of a grain is a key of all models. */
extern const struct key two_fluid_numbers[TWO_FLUID_NKEYS];

/* Set the defaults of a set of closures in water. */
void two_fluid_closure_init(struct two_fluid_closure *c,
                            enum two_fluid_set set);
/* Set the five numbers of a fluid known by name, not TWO_FLUID_OWN. */
void two_fluid_take_fluid(struct two_fluid_closure *c,
                          enum two_fluid_fluid fluid);
/* Return the index of `section`.`name`, -1 if there is none. */
int two_fluid_find_number(const char *section, const char *name);
/* Make what the functions below need, once all numbers are set. Returns NULL,
 * or what is wrong with the numbers taken together. */
const char *two_fluid_prepare(struct two_fluid_closure *c);

#endif
