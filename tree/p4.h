/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one header that sees p4est: p4est names stand for p8est in 3D. */
#ifndef TALUS_TREE_P4_H
#define TALUS_TREE_P4_H

#if DIM == 2
#include <p4est_bits.h>
#include <p4est_communication.h>
#include <p4est_extended.h>
#include <p4est_io.h>
#else
#include <p4est_to_p8est.h>
#include <p8est_bits.h>
#include <p8est_communication.h>
#include <p8est_extended.h>
#include <p8est_io.h>
#endif

#endif
