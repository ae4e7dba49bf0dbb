/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A flat surface at rest that crosses a level jump stays at rest, whatever the
 * ratio of densities, where the surface lies in its leaves, and which way
 * gravity points. The steps are long and the tolerances loose, as in a
 * collapse: what round-off leaves may not grow from step to step.
 *
 * Before pressure was interpolated by density (mesh_fill_potential) a gas leaf
 * on the coarse side gave its children the pressure of the grains below it, and
 * speeds grew by 3.5, 8, 30 a step at ratios of 1e4, 1e5, 1e6. */
#include <check.h>

#include "sim.h"
#include "talus/vof.h"

Suite *still_suite(void);

enum { LEVEL = 4, STEPS = 40 };
static const double DT = 0.1;

struct surface {
  double shift;  /* of the surface from the centre of the box */
  double tilt;   /* its slope along x, perpendicular to gravity */
  bool friction; /* grains, else water */
};

static double height_below(void *context, const double x[3]) {
  const struct surface *s = context;
  return 0.5 + s->shift - s->tilt * (x[0] - 0.5) - x[DIM - 1];
}

/* Ask for fine leaves in the left half. */
static double half(void *context, const double x[3]) {
  (void)context;
  return x[0] < 0.5 ? LEVEL : LEVEL - 1;
}

static struct params still_params(struct surface *surface, double ratio) {
  const double length = sqrt(1 + surface->tilt * surface->tilt);
  struct params p = box_params(LEVEL);
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = LEVEL, .function = {half, NULL}};
  p.shape = (struct function){height_below, surface};
  p.gravity[0] = -surface->tilt / length;
  p.gravity[DIM - 1] = -1 / length;
  p.pressure_at = PRESSURE_AT_GAS;
  p.gas.density = 1 / ratio;
  p.gas.rheology = newtonian(1e-5);
  p.tolerance_pressure = p.tolerance_viscous = 1e-4;
  if (!surface->friction) return p;
  rheology_release(&p.grains.rheology);
  rheology_init(&p.grains.rheology, rheology_find("mu_i"));
  rheology_set(&p.grains.rheology, "d", 0.01);
  rheology_set(&p.grains.rheology, "eta_min", 1e-4);
  rheology_set(&p.grains.rheology, "eta_max", 10);
  rheology_set(&p.grains.rheology, "rho", 1);
  return p;
}

static const struct surface SURFACE[] = {
    {0, 0, false},      {0.02, 0, false},    {-0.013, 0, false},
    {0.0003, 0, false}, {0, 0, true},        {0.02, 0, true},
    {0.05, 0, true},    {0.011, 0.2, false}, {0, 0.5, true}};
enum { NSURFACES = sizeof SURFACE / sizeof *SURFACE };

START_TEST(a_surface_across_levels_stays_at_rest) {
  struct surface surface = SURFACE[_i];
  for (double ratio = 1e3; ratio < 2e6; ratio *= DIM == 2 ? 10 : 1e3) {
    struct params params = still_params(&surface, ratio);
    struct two_phase *sim = sim_start(&params);
    /* grains that just cut a leaf of gas add VOF_EMPTY ratio to its weight */
    const double dust = VOF_EMPTY * ratio * DT;
    double speed = 0;
    bool done = true;
    for (int k = 0; k < STEPS && done; k++) {
      done = step_advance(sim, DT) == EXIT_DONE;
      speed = larger(speed, largest(sim, sim->u));
    }
    two_phase_destroy(sim);
    ck_assert(done);
    /* 1e-7 sqrt(9.81) m/s of a box of 1 m */
    ck_assert_double_le(speed, larger(3e-8, dust));
  }
}
END_TEST

Suite *still_suite(void) {
  Suite *suite = suite_create("still");
  TCase *alone = tcase_create("level"), *tcase = tcase_create("tilted");
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(alone, a_surface_across_levels_stays_at_rest, 0, 7);
  tcase_add_loop_test(tcase, a_surface_across_levels_stays_at_rest, 7,
                      NSURFACES);
  suite_add_tcase(suite, alone);
  suite_add_tcase(suite, tcase);
  return suite;
}
