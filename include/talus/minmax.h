/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smaller and larger of two numbers, inline: fmin and fmax of C are calls, as
 * they must tell NaN from numbers. Here a NaN in b is passed over, so that
 *   most = max2(most, value)
 * is the largest of the numbers among the values; a NaN in a stays. */
#ifndef TALUS_MINMAX_H
#define TALUS_MINMAX_H

static inline double min2(double a, double b) { return b < a ? b : a; }

static inline double max2(double a, double b) { return b > a ? b : a; }

#endif
