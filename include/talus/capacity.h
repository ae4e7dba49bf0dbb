/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory that the job may use: that of the node, or of the control group (v1 or
 * v2) that a batch system or a container puts it into, shared evenly by the
 * ranks of the node; and what RLIMIT_AS leaves to each process. */
#ifndef TALUS_CAPACITY_H
#define TALUS_CAPACITY_H

/* Return the bytes that each rank may use, the least over all ranks; HUGE_VAL
 * where the system sets no limit and does not say what there is. Collective if
 * MPI runs.
 */
double capacity_per_rank(void);

/* Return the least limit of the control groups that `list` [a file as
 * /proc/self/cgroup] names and of those above them, under `root`
 * [/sys/fs/cgroup]; HUGE_VAL if there is none. Not collective. */
double capacity_of_groups(const char *list, const char *root);

#endif
