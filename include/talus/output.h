/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output: the directory of a run, and what all its files have in common. */
#ifndef TALUS_OUTPUT_H
#define TALUS_OUTPUT_H

#include <stdbool.h>
#include <stdio.h>

struct hdf5_file;

/* End the program (USER_ERROR) unless `directory` can be written to, or can be
 * made. Leaves no trace. Collective. */
void output_check_directory(const char *directory);
/* Make the directory, and those above it, if missing. Collective; USER_ERROR
 * if that fails. */
void output_make_directory(const char *directory);
/* Tell if the directory holds a table, the parameters or the log of a run, and
 * not a checkpoint alone. Collective. */
bool output_holds_tables(const char *directory);
/* Return `directory`/`name`; the caller frees it with mem_free. Not collective.
 */
char *output_path(const char *directory, const char *name);

/* Return what `write` prints on rank 0 (NULL: nothing) as a text on every rank,
 * to be freed with mem_free. Collective. */
char *output_parameters(void (*write)(void *context, FILE *f), void *context);
/* Write a text to directory/name. Collective. */
void output_write_text(const char *directory, const char *name,
                       const char *text);

/* Write the heading of an HDF5 file: attribute `version`, and a group
 * `parameters` with one text attribute per line `name,value,...` of the csv
 * text but the first, which is its header. Collective. */
void output_write_heading(struct hdf5_file *file, const char *parameters);

/* Write the shortest decimal number that reads back as the same double into
 * `text` [32]; returns `text`. */
char *output_number(double value, char text[32]);

/* End the program unless everything written to `f` has reached the operating
 * system. Not collective. */
void output_flush(FILE *f, const char *path);

#endif
