/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seals: whatever happens to a checkpoint is seen, on every number of ranks. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "grid.h"
#include "talus/checkpoint.h"
#include "talus/field.h"
#include "talus/remap.h"
#include "talus/seal.h"

enum { DAMAGES = 200, PAGE = 4096 };

static char directory[64], path[128]; /* of this test, on all ranks */

struct bytes {
  unsigned char *data; /* owned */
  size_t n;
};

static struct bytes read_bytes(void) {
  struct bytes bytes = {NULL, 0};
  FILE *f = fopen(path, "rb");
  if (f == NULL) FATAL("no checkpoint");
  fseek(f, 0, SEEK_END);
  bytes.n = (size_t)ftell(f);
  rewind(f);
  bytes.data = MEM_NEW(unsigned char, bytes.n + PAGE);
  if (fread(bytes.data, 1, bytes.n, f) != bytes.n) FATAL("cannot read");
  fclose(f);
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD)); /* before anybody writes */
  return bytes;
}

/* Rank 0 writes the bytes, all wait for them. */
static void write_bytes(const unsigned char *data, size_t n) {
  if (base_rank() == 0) {
    FILE *f = fopen(path, "wb");
    if (f == NULL || fwrite(data, 1, n, f) != n) FATAL("cannot write");
    fclose(f);
  }
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
}

/* Write a checkpoint with some leaves, a field and parameters. */
static void write_checkpoint(void) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 2, false, 2, 4);
  struct mesh *mesh = mesh_new(forest);
  struct fields fields = {.n = 0};
  double time = 1.0 / 3;
  const struct scalar list = {"time", SCALAR_REAL, 0, 0, 1};
  const struct scalars scalars = {1, &list, &time};
  struct field *field = fields_add(&fields, mesh, "a", "m/s", "a field",
                                   FIELD_CELL, &remap_linear);
  field->restart = true;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    field->v[i] = sin(7 * mesh->x[i][0]);
  checkpoint_write(path, "model", mesh, &fields, 1, &scalars,
                   "name,value\na,1\n");
  fields_destroy(&fields);
  mesh_destroy(mesh);
  forest_destroy(forest);
}

static void begin(void) {
  strcpy(directory, "/tmp/talus-seal-XXXXXX");
  if (base_rank() == 0 && mkdtemp(directory) == NULL) FATAL("no directory");
  MPI_CHECK(
      MPI_Bcast(directory, sizeof directory, MPI_CHAR, 0, MPI_COMM_WORLD));
  snprintf(path, sizeof path, "%s/checkpoint.h5", directory);
  write_checkpoint();
}

static void end(void) {
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  if (base_rank() != 0) return;
  unlink(path);
  rmdir(directory);
}

static enum seal_verdict verdict(void) {
  struct seal_report report;
  seal_check(MPI_COMM_WORLD, path, &report);
  return report.verdict;
}

static bool is_refused(void) {
  const enum seal_verdict found = verdict();
  return found == SEAL_DAMAGED || found == SEAL_NONE;
}

static size_t random_below(size_t n) {
  return ((size_t)rand() * ((size_t)RAND_MAX + 1) + (size_t)rand()) % n;
}

/* Damage a file as disks and users do: a bit, a page of zeros, a cut, bytes of
 * noise, more bytes at the end. */
static void damage(struct bytes *bytes, int kind) {
  const size_t place = random_below(bytes->n);
  size_t n = bytes->n - place;
  if (kind == 0) {
    bytes->data[place] ^= (unsigned char)(1 << random_below(8));
  } else if (kind == 1) {
    const size_t page = place / PAGE * PAGE;
    n = bytes->n - page < PAGE ? bytes->n - page : PAGE;
    memset(bytes->data + page, 0, n);
  } else if (kind == 2) {
    bytes->n = place;
  } else if (kind == 3) {
    for (size_t k = place; k < place + 16 && k < bytes->n; k++)
      bytes->data[k] = (unsigned char)random_below(256);
  } else {
    bytes->n += 1 + random_below(PAGE);
  }
}

START_TEST(damage_anywhere_is_seen) {
  struct bytes sound = read_bytes();
  int seen = 0, harmless = 0;
  srand(1);
  for (int k = 0; k < DAMAGES; k++) {
    struct bytes bytes = {MEM_NEW(unsigned char, sound.n + PAGE), sound.n};
    memcpy(bytes.data, sound.data, sound.n + PAGE);
    damage(&bytes, k % 5);
    const bool same =
        bytes.n == sound.n && memcmp(bytes.data, sound.data, sound.n) == 0;
    write_bytes(bytes.data, bytes.n);
    const bool refused = is_refused();
    harmless += same && !refused;
    seen += !same && refused;
    mem_free(bytes.data);
  }
  /* a page may have been zero before */
  bool good = seen + harmless == DAMAGES && seen > DAMAGES * 9 / 10;
  write_bytes(sound.data, sound.n);
  good = good && verdict() == SEAL_SOUND;
  mem_free(sound.data);
  ck_assert(all_ranks(good));
}
END_TEST

/* Each bit of the seal itself, whose last bytes are zeros. */
START_TEST(every_bit_of_the_seal_counts) {
  struct bytes bytes = read_bytes();
  bool good = true;
  for (size_t k = 0; k < 8 * SEAL_LENGTH; k += 5) {
    bytes.data[k / 8] ^= (unsigned char)(1 << k % 8);
    write_bytes(bytes.data, bytes.n);
    good = good && is_refused();
    bytes.data[k / 8] ^= (unsigned char)(1 << k % 8);
  }
  mem_free(bytes.data);
  ck_assert(all_ranks(good));
}
END_TEST

START_TEST(other_formats_are_told_from_damage) {
  struct seal_report report;
  seal_write(MPI_COMM_WORLD, path, 7);
  seal_check(MPI_COMM_WORLD, path, &report);
  bool good = report.verdict == SEAL_SOUND && report.format == 7;
  struct bytes bytes = read_bytes();
  write_bytes(bytes.data + SEAL_LENGTH, bytes.n - SEAL_LENGTH);
  good = good && verdict() == SEAL_UNSEALED; /* as before format 2 */
  write_bytes((const unsigned char *)"text\n", 5);
  good = good && verdict() == SEAL_NONE;
  write_bytes(bytes.data, 100);
  good = good && verdict() == SEAL_DAMAGED;
  write_bytes(bytes.data, 0);
  good = good && verdict() == SEAL_NONE;
  if (base_rank() == 0) unlink(path);
  good = good && verdict() == SEAL_NONE;
  mem_free(bytes.data);
  ck_assert(all_ranks(good));
}
END_TEST

Suite *seal_suite(void);
Suite *seal_suite(void) {
  Suite *suite = suite_create("seal");
  TCase *tcase = tcase_create("files"), *alone = tcase_create("bits");
  tcase_set_tags(alone, "one_rank");
  tcase_add_checked_fixture(tcase, begin, end);
  tcase_add_checked_fixture(alone, begin, end);
  tcase_add_test(tcase, damage_anywhere_is_seen);
  tcase_add_test(alone, every_bit_of_the_seal_counts);
  tcase_add_test(tcase, other_formats_are_told_from_damage);
  suite_add_tcase(suite, tcase);
  suite_add_tcase(suite, alone);
  return suite;
}
