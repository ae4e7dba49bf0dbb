/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/capacity.h"

#include <math.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "talus/error.h"

enum { LENGTH = 4096 };

static double least(double a, double b) { return a < b ? a : b; }

/* Return the number in a file; HUGE_VAL for "max", or where there is no such
 * file. */
static double read_limit(const char *path) {
  char text[64] = "";
  char *end;
  FILE *f = fopen(path, "r");
  if (f == NULL) return HUGE_VAL;
  if (fgets(text, sizeof text, f) == NULL) text[0] = '\0';
  fclose(f);
  const double limit = strtod(text, &end);
  /* version 1 says "none" by the largest number of pages */
  return end > text && limit > 0 && limit < 0x1p62 ? limit : HUGE_VAL;
}

/* Return the least limit of a group and of those above it. */
static double limit_of_group(const char *root, const char *folder,
                             const char *group, const char *file) {
  char part[LENGTH], path[3 * LENGTH];
  double limit = HUGE_VAL;
  snprintf(part, sizeof part, "%s", group);
  for (char *slash = part; slash != NULL;) {
    snprintf(path, sizeof path, "%s%s%s/%s", root, folder, part, file);
    limit = least(limit, read_limit(path));
    slash = strrchr(part, '/');
    if (slash != NULL) *slash = '\0';
  }
  return limit;
}

/* Read lines of the form "number:controllers:/group", without controllers in
 * version 2. */
double capacity_of_groups(const char *list, const char *root) {
  char line[LENGTH];
  double limit = HUGE_VAL;
  FILE *f = fopen(list, "r");
  if (f == NULL) return limit;
  while (fgets(line, sizeof line, f) != NULL) {
    line[strcspn(line, "\n")] = '\0';
    char *controllers = strchr(line, ':');
    char *group = controllers ? strchr(controllers + 1, ':') : NULL;
    if (group == NULL) continue;
    *group++ = '\0';
    if (controllers[1] == '\0')
      limit = least(limit, limit_of_group(root, "", group, "memory.max"));
    else if (strstr(controllers, "memory") != NULL)
      limit = least(limit, limit_of_group(root, "/memory", group,
                                          "memory.limit_in_bytes"));
  }
  fclose(f);
  return limit;
}

static double physical_memory(void) {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? (double)pages * (double)size : HUGE_VAL;
}

/* Give the address space that RLIMIT_AS leaves. */
static double address_space_left(void) {
  struct rlimit limit;
  double used = 0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return HUGE_VAL;
  FILE *f = fopen("/proc/self/statm", "r");
  if (f != NULL) {
    if (fscanf(f, "%lf", &used) != 1) used = 0;
    fclose(f);
  }
  const double left =
      (double)limit.rlim_cur - used * (double)sysconf(_SC_PAGESIZE);
  return left > 0 ? left : 0;
}

static int ranks_of_node(void) {
  MPI_Comm node;
  int n;
  MPI_CHECK(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0,
                                MPI_INFO_NULL, &node));
  MPI_CHECK(MPI_Comm_size(node, &n));
  MPI_CHECK(MPI_Comm_free(&node));
  return n;
}

double capacity_per_rank(void) {
  const double node =
      least(physical_memory(),
            capacity_of_groups("/proc/self/cgroup", "/sys/fs/cgroup"));
  const int ranks = base_size() > 1 ? ranks_of_node() : 1;
  double bytes = least(node / ranks, address_space_left());
  if (base_size() > 1)
    MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_DOUBLE, MPI_MIN,
                            MPI_COMM_WORLD));
  return bytes;
}
