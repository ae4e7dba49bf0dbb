/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Message plans: which entries of an array go to which rank, and where what
 * arrives is put. Made once per mesh, used by every fill. */
#ifndef TALUS_PLAN_H
#define TALUS_PLAN_H

#include <mpi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct plan {
  MPI_Comm comm;
  int rank, nranks;
  int32_t *send_begin, *recv_begin; /* [nranks + 1] */
  int32_t *send_index, *recv_index; /* array entries, by rank */
  double *buffer;                   /* grows to the largest use */
  MPI_Request *request;             /* [2 nranks] */
  int64_t capacity;
};

/* Names an entry that one rank asks of another, by a Morton key and a tag. */
struct plan_request {
  uint64_t key;
  int32_t tag;
  int32_t rank;  /* who is asked */
  int32_t index; /* where the answer goes in the asker's array */
};

/* Make a type of MPI for things of so many bytes, to be freed by the caller. */
MPI_Datatype plan_type_new(size_t bytes);
/* Begin an empty plan. */
void plan_begin(struct plan *plan, MPI_Comm comm);
void plan_end(struct plan *plan);
/* Fix the receiving half from n requests (sorted by rank in place) and tell
 * the others. Returns what is asked of this rank, [*nasked], owned by the
 * caller; its `rank` is the asker. The caller sets plan->send_index
 * [*nasked] in that order. Collective. */
struct plan_request *plan_ask(struct plan *plan, int64_t n,
                              struct plan_request *request, int64_t *nasked);
/* Send v[k][send_index] and put (or add) what arrives into v[k][recv_index];
 * each index stands for `block` consecutive entries. Collective. */
void plan_run(struct plan *plan, int n, double *const v[], int block, bool add);
/* Run a plan as plan_run, in single precision, block = 1. */
void plan_run_float(struct plan *plan, int n, float *const v[], bool add);

#endif
