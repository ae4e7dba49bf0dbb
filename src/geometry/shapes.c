/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/shapes.h"

#include <math.h>
#include <stdbool.h>

#include "talus/minmax.h"
#include "talus/ring.h"

/* Halvings of a piece on which f is 0 all over. */
enum { BLIND = 6 };
/* Halvings that may be left of a piece where f is a plane. */
enum { FLAT = 2 };

enum { NVERTEX = 1 << DIM, NLATTICE = DIM == 2 ? 9 : 27 };

/* A cell or piece of one, with the level set at its vertices and centre.
 * Vertex v lies on the upper side of axis d when bit d of v is set. */
struct piece {
  double x[DIM], h;
  double vertex[NVERTEX];
  double centre;
};

struct shape {
  shape_level_set f;
  void *context;
  bool rings; /* x[0] is a radius */
};

/* Evaluate f times a power of two, which changes no fraction, so that sums of
 * values near the largest number there is do not overflow. */
static double evaluate(const struct shape *shape, const double x[DIM]) {
  double point[3] = {0., 0., 0.};
  for (int d = 0; d < DIM; d++) point[d] = x[d];
  return 0x1p-8 * shape->f(shape->context, point);
}

/* Is vertex v on the upper (1) or lower (-1) side of axis d? */
static inline int side(int v, int d) { return (v >> d & 1) ? 1 : -1; }

/* Return the largest change of f from the centre to a vertex. */
static double variation(const struct piece *p) {
  double largest = 0.;
  for (int v = 0; v < NVERTEX; v++)
    largest = max2(largest, fabs(p->vertex[v] - p->centre));
  return largest;
}

/* Return 1 if f > 0 at all points of the piece, -1 if f < 0, else 0. Vertices
 * within `tolerance` of 0 do not object. */
static int common_sign(const struct piece *p, double tolerance) {
  int sign = (p->centre > 0.) - (p->centre < 0.);
  for (int v = 0; v < NVERTEX; v++)
    if (sign * p->vertex[v] < -tolerance) return 0;
  return sign;
}

static bool is_positive_somewhere(const struct piece *p) {
  bool found = p->centre > 0.;
  for (int v = 0; v < NVERTEX; v++) found = found || p->vertex[v] > 0.;
  return found;
}

/* Return the slant (ring.h) of a piece, 0 in a plane. */
static double slant(const struct shape *shape, const struct piece *p) {
  return shape->rings ? 0.5 * p->h / p->x[0] : 0;
}

/* Find minus the slope of f, out of the grains; returns how far the vertices
 * are from the plane with that slope through the centre. */
static double fit_plane(const struct piece *p, double n[DIM]) {
  double residual = 0.;
  for (int d = 0; d < DIM; d++) {
    n[d] = 0.;
    for (int v = 0; v < NVERTEX; v++)
      n[d] -= side(v, d) * p->vertex[v] * 2. / NVERTEX;
  }
  for (int v = 0; v < NVERTEX; v++) {
    double linear = p->centre;
    for (int d = 0; d < DIM; d++) linear -= 0.5 * side(v, d) * n[d];
    residual = max2(residual, fabs(p->vertex[v] - linear));
  }
  return residual;
}

/* Return the fraction of a piece that is not halved any more. */
static double cut_piece(const struct shape *shape, const struct piece *p) {
  double mean = 0., n[DIM], norm = 0.;
  const double residual = fit_plane(p, n);
  for (int v = 0; v < NVERTEX; v++) mean += p->vertex[v] / NVERTEX;
  for (int d = 0; d < DIM; d++) norm += fabs(n[d]);
  double alpha = (2. * p->centre + mean) / 3.; /* eq. (2) */
  /* A corner of a box that lies on a vertex, up to round-off in x, must not be
   * taken for a slanted plane. A true plane is always cut. */
  double tolerance = 1e-9 * variation(p);
  int sign = common_sign(p, tolerance);
  if (sign && (residual > tolerance || norm <= 0.)) return sign > 0 ? 1. : 0.;
  if (norm <= 0. && !is_positive_somewhere(p)) return 0.;
  if (norm <= 0.) return alpha > 0. ? 1. : alpha < 0. ? 0. : 0.5;
  return ring_volume(n, alpha, slant(shape, p));
}

/* Fill the level set on the lattice of half-edges: lattice[i + 3 j + 9 k] lies
 * at (i - 1, j - 1, k - 1) h/2 from the centre. */
static void fill_lattice(const struct shape *shape, const struct piece *p,
                         double lattice[NLATTICE]) {
  for (int s = 0; s < NLATTICE; s++) {
    double x[DIM];
    int rest = s, v = 0;
    bool at_vertex = true;
    for (int d = 0; d < DIM; d++, rest /= 3) {
      int i = rest % 3;
      x[d] = p->x[d] + 0.5 * (i - 1) * p->h;
      if (i == 1) at_vertex = false;
      if (i == 2) v |= 1 << d;
    }
    if (s == NLATTICE / 2)
      lattice[s] = p->centre;
    else
      lattice[s] = at_vertex ? p->vertex[v] : evaluate(shape, x);
  }
}

/* Return the child of p on the side of vertex `child`. */
static struct piece half(const struct shape *shape, const struct piece *p,
                         const double lattice[NLATTICE], int child) {
  static const int stride[3] = {1, 3, 9};
  struct piece q = {.h = 0.5 * p->h};
  for (int d = 0; d < DIM; d++) q.x[d] = p->x[d] + 0.25 * side(child, d) * p->h;
  for (int v = 0; v < NVERTEX; v++) {
    int s = 0;
    for (int d = 0; d < DIM; d++)
      s += stride[d] * ((child >> d & 1) + (v >> d & 1));
    q.vertex[v] = lattice[s];
  }
  q.centre = evaluate(shape, q.x);
  return q;
}

/* Is f that of a plane, up to round-off, all over the lattice? */
static bool is_plane(const struct piece *p, const double lattice[NLATTICE]) {
  const double tolerance = 1e-11 * variation(p);
  double n[DIM];
  if (fit_plane(p, n) > tolerance) return false;
  for (int s = 0; s < NLATTICE; s++) {
    double linear = p->centre;
    for (int d = 0, rest = s; d < DIM; d++, rest /= 3) {
      linear -= 0.5 * (rest % 3 - 1) * n[d];
    }
    if (fabs(lattice[s] - linear) > tolerance) return false;
  }
  return true;
}

/* Return the fraction of a piece that may still be halved `depth` times, and
 * `blind` times where f is 0 all over and tells nothing. */
static double piece_fraction(const struct shape *shape, const struct piece *p,
                             int depth, int blind) {
  const double change = variation(p);
  int sign = common_sign(p, 0.);
  if (sign && fabs(p->centre) > 1.5 * change) return sign > 0 ? 1. : 0.;
  blind = p->centre == 0 && change == 0 ? blind - 1 : BLIND;
  if (depth <= 0 || blind < 0) return cut_piece(shape, p);
  double lattice[NLATTICE], sum = 0.;
  fill_lattice(shape, p, lattice);
  if (depth <= FLAT && is_plane(p, lattice)) return cut_piece(shape, p);
  for (int child = 0; child < NVERTEX; child++) {
    struct piece q = half(shape, p, lattice, child);
    const double part = piece_fraction(shape, &q, depth - 1, blind);
    sum += shape->rings ? q.x[0] / p->x[0] * part : part;
  }
  return sum / NVERTEX;
}

static double fraction(const struct shape *shape, const double centre[DIM],
                       double h, int depth) {
  struct piece p = {.h = h};
  for (int d = 0; d < DIM; d++) p.x[d] = centre[d];
  for (int v = 0; v < NVERTEX; v++) {
    double x[DIM];
    for (int d = 0; d < DIM; d++) x[d] = centre[d] + 0.5 * side(v, d) * h;
    p.vertex[v] = evaluate(shape, x);
  }
  p.centre = evaluate(shape, centre);
  return piece_fraction(shape, &p, depth, BLIND);
}

double shape_fraction(shape_level_set f, void *context,
                      const double centre[DIM], double h, int depth) {
  const struct shape shape = {f, context, false};
  return fraction(&shape, centre, h, depth);
}

double shape_ring_fraction(shape_level_set f, void *context,
                           const double centre[DIM], double h, int depth) {
  const struct shape shape = {f, context, true};
  return fraction(&shape, centre, h, depth);
}
