/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_closure.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "two_fluid_sets.h"

const char *const two_fluid_set_names[] = {"critical_state", "rauter",
                                           "mu_i_phi_i", "ktgf", NULL};
const char *const two_fluid_fluid_names[] = {"air",  "water", "pac2",
                                             "pac4", "own",   NULL};
const char *const two_fluid_drag_names[] = {"gidaspow", "ergun", "wen_yu",
                                            NULL};
const char *const two_fluid_frictional_names[] = {"johnson_jackson", "syamlal",
                                                  NULL};
const char *const two_fluid_friction_names[] = {"sin", "tan", NULL};
const char *const two_fluid_production_names[] = {"kinetic", "total", NULL};

/* [busch_johansen_2020, table 2], with eta_0 = eta_inf where it is Newtonian:
 * density, eta_0, eta_inf, lambda, n. */
static const double FLUIDS[][5] = {
    [TWO_FLUID_AIR] = {1.225, 1.79e-5, 1.79e-5, 0, 1},
    [TWO_FLUID_WATER] = {998, 1.002e-3, 1.002e-3, 0, 1},
    [TWO_FLUID_PAC2] = {1000, 7.21e-2, 1.002e-3, 1.09e-2, 0.586},
    [TWO_FLUID_PAC4] = {1000, 0.214, 1.002e-3, 2.61e-2, 0.608},
};

void two_fluid_take_fluid(struct two_fluid_closure *c,
                          enum two_fluid_fluid fluid) {
  memcpy(c->param + TWO_FLUID_FLUID_DENSITY, FLUIDS[fluid], sizeof *FLUIDS);
}

void two_fluid_closure_init(struct two_fluid_closure *c,
                            enum two_fluid_set set) {
  *c = (struct two_fluid_closure){.set = set};
  for (int k = 0; k < TWO_FLUID_NKEYS; k++)
    c->param[k] = strtod(two_fluid_numbers[k].fallback, NULL);
  two_fluid_take_fluid(c, TWO_FLUID_WATER);
}

int two_fluid_find_number(const char *section, const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s.%s", section, name);
  for (int k = 0; k < TWO_FLUID_NKEYS; k++)
    if (strcmp(two_fluid_numbers[k].path, path) == 0) return k;
  return -1;
}

/* Gather the numbers of the set that the others call by other names. */
static struct two_fluid_shearing shearing(const struct two_fluid_closure *c) {
  const double *v = c->param;
  switch (c->set) {
    case TWO_FLUID_CRITICAL_STATE:
      return (struct two_fluid_shearing){
          v[TWO_FLUID_CS_MU_1],      v[TWO_FLUID_CS_MU_2],
          v[TWO_FLUID_CS_J_0],       1,
          v[TWO_FLUID_CS_INERTIAL],  v[TWO_FLUID_CS_PHI_M],
          v[TWO_FLUID_CS_PORES],     v[TWO_FLUID_CS_STIFFNESS],
          v[TWO_FLUID_CS_PHI_P_LOW], v[TWO_FLUID_CS_PHI_MAX],
          v[TWO_FLUID_CS_RELAX]};
    case TWO_FLUID_RAUTER:
      return (struct two_fluid_shearing){
          v[TWO_FLUID_RA_MU_1],     v[TWO_FLUID_RA_MU_2],
          v[TWO_FLUID_RA_J_0],      1,
          v[TWO_FLUID_RA_INERTIAL], v[TWO_FLUID_RA_PHI_M],
          v[TWO_FLUID_RA_PORES],    v[TWO_FLUID_RA_STIFFNESS],
          v[TWO_FLUID_RA_PHI_RLP],  v[TWO_FLUID_RA_PHI_RCP],
          v[TWO_FLUID_RA_RELAX]};
    case TWO_FLUID_MU_I_PHI_I: {
      const double b = v[TWO_FLUID_MI_SLOPE] / v[TWO_FLUID_MI_PHI_M];
      return (struct two_fluid_shearing){v[TWO_FLUID_MI_MU_1],
                                         v[TWO_FLUID_MI_MU_2],
                                         v[TWO_FLUID_MI_I_0],
                                         0,
                                         b * b,
                                         v[TWO_FLUID_MI_PHI_M],
                                         v[TWO_FLUID_MI_PORES],
                                         v[TWO_FLUID_MI_STIFFNESS],
                                         v[TWO_FLUID_MI_PHI_RLP],
                                         v[TWO_FLUID_MI_PHI_RCP],
                                         v[TWO_FLUID_MI_RELAX]};
    }
    case TWO_FLUID_KTGF:
      break;
  }
  return (struct two_fluid_shearing){.phi_m = 1};
}

/* Say what is wrong with the numbers of a set that shears. */
static const char *wrong_shearing(const struct two_fluid_closure *c) {
  const struct two_fluid_shearing *by = &c->by;
  if (c->set == TWO_FLUID_KTGF) return NULL;
  if (by->mu_2 < by->mu_1)
    return "mu_2 is less than mu_1; friction must not fall with shear";
  if (by->low > by->pole - 0.02)
    return c->set == TWO_FLUID_CRITICAL_STATE
               ? "phi_p_low must be at least 0.02 below phi_max"
               : "phi_rlp must be at least 0.02 below phi_rcp";
  if (c->set == TWO_FLUID_MU_I_PHI_I && by->pole > by->phi_m)
    return "phi_rcp is more than phi_m, and what rests would be denser than "
           "all that flows, and burst; take phi_rcp = phi_m";
  if (c->set == TWO_FLUID_CRITICAL_STATE &&
      c->param[TWO_FLUID_CS_PHI_P_HIGH] < by->low)
    return "phi_p_high is less than phi_p_low";
  if (c->set == TWO_FLUID_CRITICAL_STATE &&
      c->param[TWO_FLUID_CS_PHI_C] > by->phi_m)
    return "phi_c is more than phi_m, which no sheared bed has";
  return NULL;
}

static const char *wrong_kinetic(const struct two_fluid_closure *c) {
  const double *v = c->param;
  if (c->set != TWO_FLUID_KTGF) return NULL;
  if (v[TWO_FLUID_KT_PHI_FR] > v[TWO_FLUID_KT_PHI_MAX] - 0.02)
    return "phi_fr must be at least 0.02 below phi_max";
  if (v[TWO_FLUID_KT_PHI_STAR] > v[TWO_FLUID_KT_PHI_MAX] - 0.02)
    return "phi_star must be at least 0.02 below phi_max";
  return NULL;
}

const char *two_fluid_prepare(struct two_fluid_closure *c) {
  const double *v = c->param;
  c->by = shearing(c);
  if (v[TWO_FLUID_FLUID_DENSITY] >= v[TWO_FLUID_GRAINS_DENSITY])
    return "the fluid is as dense as the grains or denser; grains must sink";
  if (v[TWO_FLUID_DRAG_BLEND_HIGH] < v[TWO_FLUID_DRAG_BLEND_LOW])
    return "blend_high is less than blend_low";
  const char *wrong = wrong_shearing(c);
  return wrong != NULL ? wrong : wrong_kinetic(c);
}
