/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/same_case.h"

#include <mpi.h>
#include <stddef.h>
#include <stdint.h>

#include "talus/case.h"
#include "talus/error.h"
#include "talus/memory.h"

const char *same_case_difference(const struct case_file *file) {
  const char *key = NULL;
  uint64_t checksum;
  int n = 0, most = 0;
  while (case_checksum(file, n, &checksum) != NULL) n++;
  MPI_CHECK(MPI_Allreduce(&n, &most, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD));
  uint64_t *mine = MEM_NEW(uint64_t, 2 * (size_t)most);
  uint64_t *all = MEM_NEW(uint64_t, 2 * (size_t)most);
  for (int i = 0; i < most; i++) {
    case_checksum(file, i, &mine[2 * i]);
    mine[2 * i + 1] = ~mine[2 * i]; /* whose largest is that of the least */
  }
  MPI_CHECK(MPI_Allreduce(mine, all, 2 * most, MPI_UINT64_T, MPI_MAX,
                          MPI_COMM_WORLD));
  for (int i = 0; i < most && key == NULL; i++) {
    if (all[2 * i] == (uint64_t)~all[2 * i + 1]) continue;
    key = case_checksum(file, i, &checksum);
    if (key == NULL) key = "?"; /* others have more */
  }
  mem_free(mine);
  mem_free(all);
  return key;
}
