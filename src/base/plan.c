/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/plan.h"

#include <stdlib.h>
#include <string.h>

#include "talus/count.h"
#include "talus/error.h"
#include "talus/memory.h"

enum { TAG_PLAN = 71 };

static const char NUMBERS[] = "numbers";

void plan_begin(struct plan *plan, MPI_Comm comm) {
  memset(plan, 0, sizeof *plan);
  plan->comm = comm;
  MPI_CHECK(MPI_Comm_rank(comm, &plan->rank));
  MPI_CHECK(MPI_Comm_size(comm, &plan->nranks));
  plan->send_begin = MEM_NEW(int32_t, plan->nranks + 1);
  plan->recv_begin = MEM_NEW(int32_t, plan->nranks + 1);
  plan->request = MEM_NEW(MPI_Request, 2 * plan->nranks);
}

void plan_end(struct plan *plan) {
  mem_free(plan->send_begin);
  mem_free(plan->recv_begin);
  mem_free(plan->send_index);
  mem_free(plan->recv_index);
  mem_free(plan->buffer);
  mem_free(plan->request);
  memset(plan, 0, sizeof *plan);
}

static int by_rank(const void *a, const void *b) {
  const struct plan_request *p = a, *q = b;
  if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
  if (p->index != q->index) return p->index < q->index ? -1 : 1;
  return 0;
}

MPI_Datatype plan_type_new(size_t bytes) {
  MPI_Datatype type;
  MPI_CHECK(MPI_Type_contiguous((int)bytes, MPI_BYTE, &type));
  MPI_CHECK(MPI_Type_commit(&type));
  return type;
}

struct plan_request *plan_ask(struct plan *plan, int64_t n,
                              struct plan_request *request, int64_t *nasked) {
  const int nranks = plan->nranks;
  int *count = MEM_NEW(int, 2 * nranks), *asked = count + nranks;
  count_index(n, "requests");
  if (n > 0) qsort(request, (size_t)n, sizeof *request, by_rank);
  plan->recv_index = MEM_NEW(int32_t, n);
  for (int64_t i = 0; i < n; i++) {
    count[request[i].rank]++;
    plan->recv_begin[request[i].rank + 1]++;
    plan->recv_index[i] = request[i].index;
    request[i].rank = plan->rank; /* the receiver sees who asks */
  }
  MPI_CHECK(MPI_Alltoall(count, 1, MPI_INT, asked, 1, MPI_INT, plan->comm));
  for (int r = 0; r < nranks; r++) {
    plan->send_begin[r + 1] =
        count_index((int64_t)plan->send_begin[r] + asked[r], "requests");
    plan->recv_begin[r + 1] += plan->recv_begin[r];
  }
  *nasked = plan->send_begin[nranks];
  struct plan_request *out = MEM_NEW(struct plan_request, *nasked);
  MPI_Datatype type = plan_type_new(sizeof *out);
  MPI_CHECK(MPI_Alltoallv(request, count, plan->recv_begin, type, out, asked,
                          plan->send_begin, type, plan->comm));
  MPI_CHECK(MPI_Type_free(&type));
  plan->send_index = MEM_NEW(int32_t, *nasked);
  mem_free(count);
  return out;
}

static void pack(const struct plan *plan, int n, double *const v[], int block,
                 double *out) {
  for (int r = 0; r < plan->nranks; r++) {
    for (int k = 0; k < n; k++) {
      for (int32_t i = plan->send_begin[r]; i < plan->send_begin[r + 1]; i++) {
        const double *from = v[k] + (int64_t)plan->send_index[i] * block;
        for (int b = 0; b < block; b++) *out++ = from[b];
      }
    }
  }
}

static void unpack(const struct plan *plan, int n, double *const v[], int block,
                   bool add, const double *in) {
  for (int r = 0; r < plan->nranks; r++) {
    for (int k = 0; k < n; k++) {
      for (int32_t i = plan->recv_begin[r]; i < plan->recv_begin[r + 1]; i++) {
        double *to = v[k] + (int64_t)plan->recv_index[i] * block;
        for (int b = 0; b < block; b++, in++) {
          to[b] = add ? to[b] + *in : *in;
        }
      }
    }
  }
}

/* Make room in the buffer for `each` numbers per index, those that are sent
 * first. */
static void reserve(struct plan *plan, int64_t each) {
  const int64_t n = ((int64_t)plan->send_begin[plan->nranks] +
                     plan->recv_begin[plan->nranks]) *
                    each;
  if (n <= plan->capacity) return;
  plan->capacity = n;
  plan->buffer = mem_resize(plan->buffer, (size_t)n, sizeof(double));
}

/* Return where in the buffer the arriving numbers begin. */
static double *arrivals(const struct plan *plan, int64_t each) {
  return plan->buffer + plan->send_begin[plan->nranks] * each;
}

static void exchange(struct plan *plan, int64_t each) {
  double *out = plan->buffer, *in = arrivals(plan, each);
  int nrequests = 0;
  for (int r = 0; r < plan->nranks; r++) {
    int64_t begin = plan->recv_begin[r] * each;
    int64_t end = plan->recv_begin[r + 1] * each;
    if (end > begin) {
      MPI_CHECK(MPI_Irecv(in + begin, count_index(end - begin, NUMBERS),
                          MPI_DOUBLE, r, TAG_PLAN, plan->comm,
                          &plan->request[nrequests++]));
    }
  }
  for (int r = 0; r < plan->nranks; r++) {
    int64_t begin = plan->send_begin[r] * each;
    int64_t end = plan->send_begin[r + 1] * each;
    if (end > begin) {
      MPI_CHECK(MPI_Isend(out + begin, count_index(end - begin, NUMBERS),
                          MPI_DOUBLE, r, TAG_PLAN, plan->comm,
                          &plan->request[nrequests++]));
    }
  }
  MPI_CHECK(MPI_Waitall(nrequests, plan->request, MPI_STATUSES_IGNORE));
}

void plan_run(struct plan *plan, int n, double *const v[], int block,
              bool add) {
  if (plan->nranks == 1) return;
  const int64_t each = (int64_t)n * block;
  reserve(plan, each);
  pack(plan, n, v, block, plan->buffer);
  exchange(plan, each);
  unpack(plan, n, v, block, add, arrivals(plan, each));
}

void plan_run_float(struct plan *plan, int n, float *const v[], bool add) {
  if (plan->nranks == 1) return;
  reserve(plan, n);
  double *out = plan->buffer;
  for (int r = 0; r < plan->nranks; r++) {
    for (int k = 0; k < n; k++) {
      for (int32_t i = plan->send_begin[r]; i < plan->send_begin[r + 1]; i++) {
        *out++ = (double)v[k][plan->send_index[i]];
      }
    }
  }
  exchange(plan, n);
  const double *in = arrivals(plan, n);
  for (int r = 0; r < plan->nranks; r++) {
    for (int k = 0; k < n; k++) {
      for (int32_t i = plan->recv_begin[r]; i < plan->recv_begin[r + 1]; i++) {
        float *to = &v[k][plan->recv_index[i]];
        *to = (float)(add ? (double)*to + *in : *in);
        in++;
      }
    }
  }
}
