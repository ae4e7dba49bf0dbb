/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 files read and written by all ranks together.
 *
 * A dataset has `columns` values per row; the rows of rank 0 come
 * first, then those of rank 1 and so on. Attributes are the same on all ranks.
 * An object is "/" (the file), a group or a dataset.
 *
 * Every function is collective. What the disk or MPI refuses ends the program
 * (FATAL, status EXIT_SYSTEM) with the deepest words HDF5 has for it, but for
 * opening a file and reading what may be missing, which return a verdict that
 * is the same on all ranks.
 */
#ifndef TALUS_HDF5_FILE_H
#define TALUS_HDF5_FILE_H

#include <mpi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct hdf5_file;

enum hdf5_type { HDF5_REAL, HDF5_INT64, HDF5_INT8 };

/* Make a file, or empty the one that is there. Its first `head` bytes (0, 512,
 * 1024, ...) are left to the caller. The path is copied. */
struct hdf5_file *hdf5_create(MPI_Comm comm, const char *path, size_t head);
/* Open a file to read; NULL on all ranks if it is missing or no HDF5 file. */
struct hdf5_file *hdf5_open(MPI_Comm comm, const char *path);
/* Return the communicator that the file was opened on. Not collective. */
MPI_Comm hdf5_comm(const struct hdf5_file *file);
/* Write out everything; with `sync` not before it is on the disk. */
void hdf5_close(struct hdf5_file *file, bool sync);

/* Make a group. */
void hdf5_write_group(struct hdf5_file *file, const char *name);
/* Make a dataset: data [rows][columns], rows of this rank. */
void hdf5_write(struct hdf5_file *file, const char *name, enum hdf5_type type,
                int64_t rows, int columns, const void *data);
/* Write a dataset as hdf5_write, with data [n][columns] of the rows [first,
 * first + n) of this rank made by `fill` a piece at a time, in order, so that
 * none is held whole. A rank has fill called for its own rows only. */
typedef void hdf5_fill(void *context, int64_t first, int64_t n, void *data);
void hdf5_write_pieces(struct hdf5_file *file, const char *name,
                       enum hdf5_type type, int64_t rows, int columns,
                       hdf5_fill *fill, void *context);
/* Read the size of a dataset over all ranks; returns false if there is none, or
 * none of numbers in one or two dimensions. */
bool hdf5_read_size(struct hdf5_file *file, const char *name, int64_t *rows,
                    int *columns);
/* Read rows [first, first + rows), which may differ from rank to rank, of a
 * dataset that exists. */
void hdf5_read(struct hdf5_file *file, const char *name, enum hdf5_type type,
               int64_t first, int64_t rows, int columns, void *data);

/* Write and read attributes: a text, or n numbers (n >= 1). Reading returns
 * false, and leaves the values alone, if there is no attribute of that kind and
 * size. */
void hdf5_write_text(struct hdf5_file *file, const char *object,
                     const char *name, const char *text);
void hdf5_write_real(struct hdf5_file *file, const char *object,
                     const char *name, int n, const double *values);
void hdf5_write_integer(struct hdf5_file *file, const char *object,
                        const char *name, int n, const int64_t *values);
bool hdf5_read_text(struct hdf5_file *file, const char *object,
                    const char *name, size_t size, char *text);
bool hdf5_read_real(struct hdf5_file *file, const char *object,
                    const char *name, int n, double *values);
bool hdf5_read_integer(struct hdf5_file *file, const char *object,
                       const char *name, int n, int64_t *values);

#endif
