/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names that a tracer cannot have, as a field or a dataset has them. The mesh
 * test of the suite `names` compares them with the fields of a simulation. */
#include <string.h>

#include "case_file.h"

/* A name that ends in _ stands for all that begin so. */
static const char *const TAKEN[] = {
    /* simulation */
    "fraction", "pressure", "density", "viscosity", "velocity", "acceleration",
    "frozen", "plane", "band", "wall_", "shear_rate", "stress", "acceleration_",
    "face_", "velocity_", "viscous_", "normal_", "old_", "cell_", "source",
    "carrier", "stress_", "strain_", "yield_stress", "yield_state",
    /* snapshots and checkpoints */
    "cells", "vertices", "level", "levels", "fields", "parameters", "partition",
    "state", "time", "step",
    /* columns of profile.csv */
    "x", "y", "height"};

static bool is_output(const char *name) {
  const struct rheology_model *model;
  for (int i = 0; (model = rheology_get(i)) != NULL; i++)
    for (int k = 0; k < model->noutputs; k++)
      if (strcmp(name, model->outputs[k].name) == 0) return true;
  return false;
}

bool case_name_is_taken(const char *name) {
  for (size_t i = 0; i < sizeof TAKEN / sizeof *TAKEN; i++) {
    const size_t n = strlen(TAKEN[i]);
    const bool prefix = TAKEN[i][n - 1] == '_';
    if (strncmp(name, TAKEN[i], n) == 0 && (prefix || name[n] == '\0'))
      return true;
  }
  return is_output(name);
}
