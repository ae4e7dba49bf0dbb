/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Roots of a function of one variable, by Brent's method as GSL has it. */
#ifndef TALUS_ROOTS_H
#define TALUS_ROOTS_H

/*
 * Find the root of f(x, context) between low and high, to the last bits; the
 * end with the smaller |f| where f does not change sign or low >= high, as
 * rounding may have it. What GSL objects to, as a function that is not finite
 * on the way, ends in its error handler (rheology_begin).
 */
double root_between(double (*f)(double, void *), void *context, double low,
                    double high);

/*
 * Find x >= 0, of order 1, where f(x, &slope, context) = target, f rising
 * without bound: Newton's method, halved towards the bracket where it would
 * leave it, to 1e-14. low: any x where f is less; guess: where to begin, for
 * convex f best a little above.
 */
double root_of_rising(double (*f)(double x, double *slope, const void *context),
                      const void *context, double target, double low,
                      double guess);

#endif
