/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/series.h"

#include "talus/csv.h"
#include "talus/memory.h"

struct series {
  struct csv *csv;
};

static const char name[] = "series.csv";
static const char header[] =
    "step,time,dt,cells,front,height,volume,kinetic,potential,dissipated,"
    "max_speed,pressure_iterations,viscous_iterations,wall_seconds,droplets,"
    "droplet_volume,numerical,divergence_volume,pressure_residual,"
    "viscous_residual,mean_shear_rate,repeat_change,work_of_changes,"
    "given_to_gas";

void series_check(const char *directory, const struct csv_mark *mark,
                  int64_t last_step, int every) {
  const struct csv_expected expected = {.name = name,
                                        .header = header,
                                        .mark = *mark,
                                        .last = (double)last_step,
                                        .every = every > 1 ? every : 1};
  csv_check(directory, &expected);
}

struct series *series_open(const char *directory, const struct csv_mark *kept) {
  struct series *series = MEM_NEW(struct series, 1);
  series->csv = csv_open(directory, name, header, kept);
  return series;
}

struct csv_mark series_sync(struct series *series) {
  return csv_sync(series->csv);
}

void series_write(struct series *series, const struct series_row *row) {
  struct csv *csv = series->csv;
  csv_integer(csv, row->step);
  csv_real(csv, row->time);
  csv_real(csv, row->dt);
  csv_integer(csv, row->cells);
  csv_short(csv, row->front);
  csv_short(csv, row->height);
  csv_real(csv, row->volume);
  csv_short(csv, row->kinetic);
  csv_short(csv, row->potential);
  csv_short(csv, row->dissipated);
  csv_short(csv, row->max_speed);
  csv_integer(csv, row->pressure_iterations);
  csv_integer(csv, row->viscous_iterations);
  csv_short(csv, row->wall_seconds);
  csv_integer(csv, row->droplets);
  csv_short(csv, row->droplet_volume);
  csv_short(csv, row->numerical);
  csv_real(csv, row->divergence_volume);
  csv_short(csv, row->pressure_residual);
  csv_short(csv, row->viscous_residual);
  csv_short(csv, row->mean_shear_rate);
  csv_short(csv, row->repeat_change);
  csv_short(csv, row->work_of_changes);
  csv_short(csv, row->given_to_gas);
  csv_end_row(csv);
}

void series_close(struct series *series) {
  csv_close(series->csv);
  mem_free(series);
}
