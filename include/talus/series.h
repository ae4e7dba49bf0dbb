/* SPDX-License-Identifier: GPL-3.0-or-later */
/* series.csv: one row of numbers per logged step. */
#ifndef TALUS_SERIES_H
#define TALUS_SERIES_H

#include <stdint.h>

#include "talus/csv.h"

/* A row, in the order and under the names of the columns. */
struct series_row {
  int64_t step;
  double time, dt;      /* s */
  int64_t cells;        /* leaves over all ranks */
  double front, height; /* m, of the heap (diagnostics.h) */
  double volume;        /* of the grains, droplets and all, m^DIM */
  double kinetic, potential, dissipated;           /* J/m (2D), J (3D) */
  double max_speed;                                /* of the grains, m/s */
  int64_t pressure_iterations, viscous_iterations; /* of this step */
  double wall_seconds;                             /* since the first step */
  int64_t droplets;      /* sets of grains apart from the heap */
  double droplet_volume; /* m^DIM */
  double numerical; /* energy lost to the scheme: initial + work_of_changes -
                       kinetic - potential - dissipated - given_to_gas */
  double divergence_volume; /* sum over steps of sum c div u dt V, m^DIM */
  double pressure_residual, viscous_residual; /* in units of the tolerance */
  double mean_shear_rate; /* of the grains, 1/s: tells when they come to rest */
  double repeat_change;   /* of the velocity in the last Picard repetition, m/s,
                             0 without */
  double work_of_changes; /* energy that restarts with another gravity or
                             density have added */
  double given_to_gas;    /* energy of the gas more than at first, and what
                             viscosity has taken from it */
};

struct series;

/* USER_ERROR unless directory/series.csv has the rows of the mark, which was
 * made after `last_step`; `every` of params.h serves the message. Collective.
 */
void series_check(const char *directory, const struct csv_mark *mark,
                  int64_t last_step, int every);
/* Open directory/series.csv: afresh, or after the rows of `kept`, if not NULL.
 * Collective. */
struct series *series_open(const char *directory, const struct csv_mark *kept);
/* csv_sync. */
struct csv_mark series_sync(struct series *series);
/* Add a row; the values of rank 0 count. */
void series_write(struct series *series, const struct series_row *row);
void series_close(struct series *series);

#endif
