/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case without grains, which may be meant but mostly is a slip of a sign. */
#ifndef TALUS_NO_GRAINS_H
#define TALUS_NO_GRAINS_H

struct params;

/* Warn if the volume of grains at the start is 0 and no inflow brings any. */
void no_grains_warn(const struct params *params, double volume);

#endif
