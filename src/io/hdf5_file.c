/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/hdf5_file.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "disk.h"
#include "talus/error.h"
#include "talus/memory.h"

enum { WORDS_LENGTH = 512, PIECE_LENGTH = 1 << 16 };

struct hdf5_file {
  MPI_Comm comm; /* borrowed */
  int rank, nranks;
  hid_t id;
  hid_t transfer; /* properties of a collective transfer */
  char *path;     /* owned */
  int descriptor; /* of a file being written, on rank 0 of several; else -1 */
};

/* Runs an HDF5 call; ends the program when it returns a negative number. */
#define H5_CHECK(file, call) check((file)->path, #call, (int64_t)(call))

/* Keep the deepest message of HDF5's error stack, which names the cause. */
static herr_t keep_deepest(unsigned n, const H5E_error2_t *error, void *words) {
  (void)n;
  if (error->desc != NULL && error->desc[0] != '\0')
    snprintf(words, WORDS_LENGTH, "%s", error->desc);
  return 0;
}

/* Find what is quoted in "..., error message = 'No space left on device', ...".
 */
static const char *find_cause(char words[WORDS_LENGTH]) {
  char *begin = strchr(words, '\'');
  begin = strstr(words, "error message = '") != NULL
              ? strstr(words, "error message = '") + 17
          : strstr(words, "error string is '") != NULL && begin != NULL
              ? begin + 1
              : NULL;
  if (begin == NULL) return words;
  begin[strcspn(begin, "'")] = '\0';
  return begin;
}

/* Find the errno whose words these are, among those that have advice; else 0.
 */
static int find_errno(const char *words) {
  static const int known[] = {ENOSPC, EDQUOT, EFBIG, ENOENT, ESTALE};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strcmp(words, strerror(known[k])) == 0) return known[k];
  return 0;
}

static int64_t check(const char *path, const char *call, int64_t result) {
  if (result >= 0) return result;
  char words[WORDS_LENGTH] = "no reason given";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_deepest, words);
  const char *cause = find_cause(words);
  FATAL("%s: %s (%.*s)%s", path, cause, (int)strcspn(call, "("), call,
        disk_advice(path, find_errno(cause)));
}

static hid_t memory_type(enum hdf5_type type) {
  return type == HDF5_REAL    ? H5T_NATIVE_DOUBLE
         : type == HDF5_INT64 ? H5T_NATIVE_INT64
                              : H5T_NATIVE_INT8;
}

/* Make the properties by which the file is reached. One rank alone needs no
 * MPI-IO, and the plain driver is faster and reports a full disk in plain
 * words. */
static hid_t access_properties(const struct hdf5_file *file) {
  hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (file->nranks > 1) {
    H5Pset_fapl_mpio(access, file->comm, MPI_INFO_NULL);
    H5Pset_all_coll_metadata_ops(access, true);
    H5Pset_coll_metadata_write(access, true);
  }
  return access;
}

static struct hdf5_file *file_new(MPI_Comm comm, const char *path) {
  struct hdf5_file *file = MEM_NEW(struct hdf5_file, 1);
  file->comm = comm;
  file->descriptor = -1;
  MPI_CHECK(MPI_Comm_rank(comm, &file->rank));
  MPI_CHECK(MPI_Comm_size(comm, &file->nranks));
  file->path = MEM_NEW(char, strlen(path) + 1);
  strcpy(file->path, path);
  file->transfer = H5Pcreate(H5P_DATASET_XFER);
  if (file->nranks > 1) H5Pset_dxpl_mpio(file->transfer, H5FD_MPIO_COLLECTIVE);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* H5_CHECK speaks for it */
  /* HDF5 fails where the file system knows no locks; the directory has ours
   * (lock.h), and nobody opens a file that is being written */
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  return file;
}

static void file_destroy(struct hdf5_file *file) {
  if (file->descriptor >= 0) close(file->descriptor);
  H5Pclose(file->transfer);
  mem_free(file->path);
  mem_free(file);
}

/* Open MPI's own MPI-IO may pass over a full disk in silence when it writes
 * from many ranks. So rank 0 asks for the room before it is written to. */
static void reserve(struct hdf5_file *file, hsize_t begin, hsize_t length) {
  if (file->nranks == 1) return;
  if (file->descriptor >= 0 && length > 0) {
    int error = posix_fallocate(file->descriptor, (off_t)begin, (off_t)length);
    /* others only say that the file system knows no reservations */
    if (error == ENOSPC || error == EFBIG || error == EDQUOT || error == EIO)
      FATAL("%s: %s%s", file->path, strerror(error),
            disk_advice(file->path, error));
  }
  MPI_CHECK(MPI_Barrier(file->comm));
}

struct hdf5_file *hdf5_create(MPI_Comm comm, const char *path, size_t head) {
  struct hdf5_file *file = file_new(comm, path);
  hid_t access = access_properties(file), layout = H5Pcreate(H5P_FILE_CREATE);
  H5_CHECK(file, H5Pset_userblock(layout, head));
  file->id = H5_CHECK(file, H5Fcreate(path, H5F_ACC_TRUNC, layout, access));
  H5Pclose(layout);
  H5Pclose(access);
  if (file->nranks > 1 && file->rank == 0)
    file->descriptor = open(path, O_RDWR);
  return file;
}

/* Rank 0 looks first: HDF5 on several ranks is noisy about missing files. */
static bool is_hdf5(MPI_Comm comm, const char *path) {
  int rank, good = 0;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  if (rank == 0) good = access(path, R_OK) == 0 && H5Fis_hdf5(path) > 0;
  MPI_CHECK(MPI_Bcast(&good, 1, MPI_INT, 0, comm));
  return good;
}

struct hdf5_file *hdf5_open(MPI_Comm comm, const char *path) {
  struct hdf5_file *file = file_new(comm, path);
  if (!is_hdf5(comm, path)) {
    file_destroy(file);
    return NULL;
  }
  hid_t access = access_properties(file);
  file->id = H5Fopen(path, H5F_ACC_RDONLY, access);
  H5Pclose(access);
  /* A file cut short passes for HDF5 but does not open. */
  int opened = file->id >= 0, all;
  MPI_CHECK(MPI_Allreduce(&opened, &all, 1, MPI_INT, MPI_MIN, comm));
  if (all) return file;
  if (opened) H5Fclose(file->id);
  file_destroy(file);
  return NULL;
}

MPI_Comm hdf5_comm(const struct hdf5_file *file) { return file->comm; }

/* Bring a file to the disk; HDF5's own flush leaves the data to the operating
 * system. */
static void sync_path(const char *path) {
  FILE *f = fopen(path, "r+b");
  if (f == NULL || fsync(fileno(f)) != 0) disk_fail(path, errno);
  fclose(f);
}

void hdf5_close(struct hdf5_file *file, bool sync) {
  H5_CHECK(file, H5Fclose(file->id));
  /* what HDF5 wrote besides data may have met a full disk too and left holes,
   * which this tries to fill */
  struct stat status = {.st_size = 0};
  if (file->descriptor >= 0) fstat(file->descriptor, &status);
  reserve(file, 0, (hsize_t)status.st_size);
  if (sync && file->rank == 0) sync_path(file->path);
  if (sync) MPI_CHECK(MPI_Barrier(file->comm));
  file_destroy(file);
}

void hdf5_write_group(struct hdf5_file *file, const char *name) {
  hid_t group = H5_CHECK(
      file, H5Gcreate2(file->id, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5_CHECK(file, H5Gclose(group));
}

/* Select rows [first, first + rows) of the dataspace of a file, and the same
 * number in memory; a rank without rows takes part with nothing selected. */
static hid_t select_rows(struct hdf5_file *file, hid_t space, int64_t first,
                         int64_t rows, int columns) {
  hsize_t start[2] = {(hsize_t)first, 0};
  hsize_t count[2] = {(hsize_t)rows, (hsize_t)columns};
  hid_t memory =
      H5_CHECK(file, H5Screate_simple(columns == 1 ? 1 : 2, count, NULL));
  if (rows > 0) {
    H5_CHECK(file, H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL,
                                       count, NULL));
  } else {
    H5_CHECK(file, H5Sselect_none(space));
    H5_CHECK(file, H5Sselect_none(memory));
  }
  return memory;
}

/* Find where the rows of this rank begin, and how many there are of all ranks.
 */
static void place_rows(MPI_Comm comm, int64_t rows, int64_t *first,
                       int64_t *all) {
  MPI_CHECK(MPI_Allreduce(&rows, all, 1, MPI_INT64_T, MPI_SUM, comm));
  MPI_CHECK(MPI_Scan(&rows, first, 1, MPI_INT64_T, MPI_SUM, comm));
  *first -= rows;
}

/* A dataset while it is written. */
struct dataset {
  hid_t set, space;
  enum hdf5_type type;
  int columns;
  int64_t first; /* row of all that this rank begins with */
};

static struct dataset dataset_create(struct hdf5_file *file, const char *name,
                                     enum hdf5_type type, int64_t rows,
                                     int columns) {
  struct dataset dataset = {.type = type, .columns = columns};
  int64_t all;
  place_rows(file->comm, rows, &dataset.first, &all);
  hsize_t size[2] = {(hsize_t)all, (hsize_t)columns};
  dataset.space =
      H5_CHECK(file, H5Screate_simple(columns == 1 ? 1 : 2, size, NULL));
  dataset.set = H5_CHECK(
      file, H5Dcreate2(file->id, name, memory_type(type), dataset.space,
                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  /* parallel HDF5 has its place from the start */
  haddr_t begin = H5Dget_offset(dataset.set);
  if (begin != HADDR_UNDEF)
    reserve(file, begin, H5Dget_storage_size(dataset.set));
  return dataset;
}

/* Write rows [first, first + rows) of those of this rank. */
static void dataset_write(struct hdf5_file *file, const struct dataset *dataset,
                          int64_t first, int64_t rows, const void *data) {
  hid_t memory = select_rows(file, dataset->space, dataset->first + first, rows,
                             dataset->columns);
  H5_CHECK(file, H5Dwrite(dataset->set, memory_type(dataset->type), memory,
                          dataset->space, file->transfer, data));
  H5_CHECK(file, H5Sclose(memory));
}

static void dataset_close(struct hdf5_file *file, struct dataset *dataset) {
  H5_CHECK(file, H5Dclose(dataset->set));
  H5_CHECK(file, H5Sclose(dataset->space));
}

void hdf5_write(struct hdf5_file *file, const char *name, enum hdf5_type type,
                int64_t rows, int columns, const void *data) {
  struct dataset dataset = dataset_create(file, name, type, rows, columns);
  dataset_write(file, &dataset, 0, rows, data);
  dataset_close(file, &dataset);
}

void hdf5_write_pieces(struct hdf5_file *file, const char *name,
                       enum hdf5_type type, int64_t rows, int columns,
                       hdf5_fill *fill, void *context) {
  const int64_t most = PIECE_LENGTH / columns;
  struct dataset dataset = dataset_create(file, name, type, rows, columns);
  double *data = MEM_NEW(double, PIECE_LENGTH); /* no type is wider */
  int64_t end;
  MPI_CHECK(MPI_Allreduce(&rows, &end, 1, MPI_INT64_T, MPI_MAX, file->comm));
  for (int64_t first = 0; first < end; first += most) {
    const int64_t left = rows > first ? rows - first : 0;
    const int64_t n = left < most ? left : most;
    if (n > 0) fill(context, first, n, data);
    dataset_write(file, &dataset, n > 0 ? first : 0, n, data);
  }
  mem_free(data);
  dataset_close(file, &dataset);
}

bool hdf5_read_size(struct hdf5_file *file, const char *name, int64_t *rows,
                    int *columns) {
  hid_t set = H5Dopen2(file->id, name, H5P_DEFAULT);
  if (set < 0) return false;
  hid_t space = H5_CHECK(file, H5Dget_space(set));
  hid_t type = H5_CHECK(file, H5Dget_type(set));
  const H5T_class_t kind = H5Tget_class(type);
  H5_CHECK(file, H5Tclose(type));
  hsize_t size[2] = {0, 1};
  bool good = (kind == H5T_INTEGER || kind == H5T_FLOAT) &&
              H5Sget_simple_extent_ndims(space) <= 2 &&
              H5Sget_simple_extent_dims(space, size, NULL) >= 1;
  *rows = (int64_t)size[0];
  *columns = (int)size[1];
  H5_CHECK(file, H5Sclose(space));
  H5_CHECK(file, H5Dclose(set));
  return good;
}

void hdf5_read(struct hdf5_file *file, const char *name, enum hdf5_type type,
               int64_t first, int64_t rows, int columns, void *data) {
  hid_t set = H5_CHECK(file, H5Dopen2(file->id, name, H5P_DEFAULT));
  hid_t space = H5_CHECK(file, H5Dget_space(set));
  hid_t memory = select_rows(file, space, first, rows, columns);
  H5_CHECK(file, H5Dread(set, memory_type(type), memory, space, file->transfer,
                         data));
  H5_CHECK(file, H5Sclose(memory));
  H5_CHECK(file, H5Sclose(space));
  H5_CHECK(file, H5Dclose(set));
}

static void write_attribute(struct hdf5_file *file, const char *object,
                            const char *name, hid_t type, hid_t space,
                            const void *values) {
  hid_t attribute =
      H5_CHECK(file, H5Acreate_by_name(file->id, object, name, type, space,
                                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5_CHECK(file, H5Awrite(attribute, type, values));
  H5_CHECK(file, H5Aclose(attribute));
  H5_CHECK(file, H5Sclose(space));
}

/* Make a scalar for one number, as readers expect, else a vector. */
static hid_t number_space(struct hdf5_file *file, int n) {
  hsize_t size = (hsize_t)n;
  return H5_CHECK(
      file, n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, NULL));
}

/* Make the type of a text. Strings are stored without their final zero, at most
 * what an attribute of HDF5 1.10 can hold. */
static hid_t text_type(struct hdf5_file *file, size_t length) {
  hid_t type = H5_CHECK(file, H5Tcopy(H5T_C_S1));
  H5_CHECK(file, H5Tset_size(type, length > 0 ? length : 1));
  H5_CHECK(file, H5Tset_strpad(type, H5T_STR_NULLPAD));
  H5_CHECK(file, H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

void hdf5_write_text(struct hdf5_file *file, const char *object,
                     const char *name, const char *text) {
  enum { LONGEST = 60000 };
  size_t length = strlen(text);
  hid_t type = text_type(file, length < LONGEST ? length : LONGEST);
  write_attribute(file, object, name, type, number_space(file, 1), text);
  H5_CHECK(file, H5Tclose(type));
}

void hdf5_write_real(struct hdf5_file *file, const char *object,
                     const char *name, int n, const double *values) {
  write_attribute(file, object, name, H5T_NATIVE_DOUBLE, number_space(file, n),
                  values);
}

void hdf5_write_integer(struct hdf5_file *file, const char *object,
                        const char *name, int n, const int64_t *values) {
  write_attribute(file, object, name, H5T_NATIVE_INT64, number_space(file, n),
                  values);
}

/* Open an attribute if it is there and of class `kind` with n values; else
 * returns -1. */
static hid_t open_attribute(struct hdf5_file *file, const char *object,
                            const char *name, H5T_class_t kind, int64_t n) {
  if (H5Aexists_by_name(file->id, object, name, H5P_DEFAULT) <= 0) return -1;
  hid_t attribute = H5_CHECK(
      file, H5Aopen_by_name(file->id, object, name, H5P_DEFAULT, H5P_DEFAULT));
  hid_t type = H5_CHECK(file, H5Aget_type(attribute));
  hid_t space = H5_CHECK(file, H5Aget_space(attribute));
  bool good = H5Tget_class(type) == kind &&
              (int64_t)H5Sget_simple_extent_npoints(space) == n;
  H5_CHECK(file, H5Sclose(space));
  H5_CHECK(file, H5Tclose(type));
  if (good) return attribute;
  H5_CHECK(file, H5Aclose(attribute));
  return -1;
}

bool hdf5_read_text(struct hdf5_file *file, const char *object,
                    const char *name, size_t size, char *text) {
  hid_t attribute = open_attribute(file, object, name, H5T_STRING, 1);
  if (attribute < 0) return false;
  hid_t type = text_type(file, size - 1);
  memset(text, 0, size);
  H5_CHECK(file, H5Aread(attribute, type, text));
  H5_CHECK(file, H5Tclose(type));
  H5_CHECK(file, H5Aclose(attribute));
  return true;
}

static bool read_numbers(struct hdf5_file *file, const char *object,
                         const char *name, H5T_class_t kind, hid_t type, int n,
                         void *values) {
  hid_t attribute = open_attribute(file, object, name, kind, n);
  if (attribute < 0) return false;
  H5_CHECK(file, H5Aread(attribute, type, values));
  H5_CHECK(file, H5Aclose(attribute));
  return true;
}

bool hdf5_read_real(struct hdf5_file *file, const char *object,
                    const char *name, int n, double *values) {
  return read_numbers(file, object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, n,
                      values);
}

bool hdf5_read_integer(struct hdf5_file *file, const char *object,
                       const char *name, int n, int64_t *values) {
  return read_numbers(file, object, name, H5T_INTEGER, H5T_NATIVE_INT64, n,
                      values);
}
