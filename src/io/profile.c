/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/profile.h"

#include <stdint.h>

#include "talus/csv.h"
#include "talus/error.h"
#include "talus/memory.h"

static const char name[] = "profile.csv";
static const char *const header =
    DIM == 2 ? "time,x,height" : "time,x,y,height";

struct profile {
  struct csv *csv;
};

void profile_check(const char *directory, const struct csv_mark *mark,
                   double last_time) {
  const struct csv_expected expected = {
      .name = name, .header = header, .mark = *mark, .last = last_time};
  csv_check(directory, &expected);
}

struct profile *profile_open(const char *directory,
                             const struct csv_mark *kept) {
  struct profile *profile = MEM_NEW(struct profile, 1);
  profile->csv = csv_open(directory, name, header, kept);
  return profile;
}

struct csv_mark profile_sync(struct profile *profile) {
  return csv_sync(profile->csv);
}

/* Whether column (i, j) or one beside it has some height. */
static bool is_listed(const int n[2], const double *height, int i, int j) {
  for (int b = j - 1; b <= j + 1; b++)
    for (int a = i - 1; a <= i + 1; a++)
      if (a >= 0 && a < n[0] && b >= 0 && b < n[1] &&
          height[(int64_t)b * n[0] + a] > 0)
        return true;
  return false;
}

void profile_write(struct profile *profile, double time, const int n[2],
                   const double first[2], double spacing,
                   const double *height) {
  if (base_rank() != 0) return;
  for (int j = 0; j < n[1]; j++) {
    for (int i = 0; i < n[0]; i++) {
      if (!is_listed(n, height, i, j)) continue;
      csv_real(profile->csv, time);
      csv_real(profile->csv, first[0] + i * spacing);
      if (DIM == 3) csv_real(profile->csv, first[1] + j * spacing);
      csv_short(profile->csv, height[(int64_t)j * n[0] + i]);
      csv_end_row(profile->csv);
    }
  }
}

void profile_close(struct profile *profile) {
  csv_close(profile->csv);
  mem_free(profile);
}
