/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/profile.h"

#include <stdint.h>
#include <stdio.h>

#include "talus/csv.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/params.h"

enum { HEADER_LENGTH = 32 + PARAMS_MAX_TRACERS * PARAMS_NAME_LENGTH };

static const char name[] = "profile.csv";

struct profile {
  struct csv *csv;
  int ntracers;
};

static void write_header(const struct params *params,
                         char header[HEADER_LENGTH]) {
  size_t used =
      (size_t)snprintf(header, HEADER_LENGTH, "%s",
                       DIM == 2 ? "time,x,height" : "time,x,y,height");
  for (int k = 0; k < params->ntracers; k++)
    used += (size_t)snprintf(header + used, HEADER_LENGTH - used, ",%s",
                             params->tracer[k].name);
}

void profile_check(const char *directory, const struct params *params,
                   const struct csv_mark *mark, double last_time) {
  char header[HEADER_LENGTH];
  const struct csv_expected expected = {
      .name = name, .header = header, .mark = *mark, .last = last_time};
  write_header(params, header);
  csv_check(directory, &expected);
}

struct profile *profile_open(const char *directory, const struct params *params,
                             const struct csv_mark *kept) {
  struct profile *profile = MEM_NEW(struct profile, 1);
  char header[HEADER_LENGTH];
  write_header(params, header);
  profile->csv = csv_open(directory, name, header, kept);
  profile->ntracers = params->ntracers;
  return profile;
}

struct csv_mark profile_sync(struct profile *profile) {
  return csv_sync(profile->csv);
}

/* Tell whether column (i, j) or one beside it has some height. */
static bool is_listed(const int n[2], const double *height, int i, int j) {
  for (int b = j - 1; b <= j + 1; b++)
    for (int a = i - 1; a <= i + 1; a++)
      if (a >= 0 && a < n[0] && b >= 0 && b < n[1] &&
          height[(int64_t)b * n[0] + a] > 0)
        return true;
  return false;
}

void profile_write(struct profile *profile, double time, const int n[2],
                   const double first[2], double spacing, const double *height,
                   double *const *layer) {
  if (base_rank() != 0) return;
  for (int j = 0; j < n[1]; j++) {
    for (int i = 0; i < n[0]; i++) {
      if (!is_listed(n, height, i, j)) continue;
      csv_real(profile->csv, time);
      csv_real(profile->csv, first[0] + i * spacing);
      if (DIM == 3) csv_real(profile->csv, first[1] + j * spacing);
      const int64_t column = (int64_t)j * n[0] + i;
      csv_short(profile->csv, height[column]);
      for (int k = 0; k < profile->ntracers; k++)
        csv_short(profile->csv, layer[k][column]);
      csv_end_row(profile->csv);
    }
  }
}

void profile_close(struct profile *profile) {
  csv_close(profile->csv);
  mem_free(profile);
}
