/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys of the two-fluid model: choices and numbers of its closures
 * (two_fluid_closure.h), and of the start. */
#ifndef TALUS_TWO_FLUID_KEYS_H
#define TALUS_TWO_FLUID_KEYS_H

#include "talus/key.h"
#include "talus/two_fluid_closure.h"

enum two_fluid_start {
  TWO_FLUID_SETTLED, /* the pressure of the grains carries their weight */
  TWO_FLUID_PATCHED, /* one solid fraction, alpha_start */
  TWO_FLUID_DENSE    /* likewise, with the plastic packing in balance */
};

enum two_fluid_surface {
  TWO_FLUID_NO_SURFACE, /* closures and fluxes have the alpha of leaves */
  TWO_FLUID_PLANES      /* surface.h */
};

enum two_fluid_regularisation {
  TWO_FLUID_CLIP, /* their viscosity is at most eta_max */
  TWO_FLUID_EXACT /* yield.h */
};

struct two_fluid_keys {
  struct two_fluid_closure closure; /* prepared by the model */
  enum two_fluid_fluid fluid;
  enum two_fluid_start start;
  enum two_fluid_surface surface;
  enum two_fluid_regularisation regularisation; /* of the grains */
  double alpha_start;   /* solid fraction of a patched or dense start */
  double alpha_surface; /* the contour that is the surface */
  double phi_p;         /* plastic packing at the start */
  double eta_max;       /* cap on the viscosity of the grains, Pa s; 0: by the
                           weight of the heap */
  double gamma_r;       /* 1/s, regularisation of their yield stress */
};

extern const struct model_keys two_fluid_model_keys;

#endif
