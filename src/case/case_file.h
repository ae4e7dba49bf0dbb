/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Private to src/case: the case while it is read, and what its files offer each
 * other.
 *
 * Convention: a function that reads a value takes it off the top of the Lua
 * stack. `path` is the name of the value for people, "domain.size".
 * Anything wrong ends in USER_ERROR.
 */
#ifndef TALUS_CASE_CASE_FILE_H
#define TALUS_CASE_CASE_FILE_H

#include <lua.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "keys.h"
#include "sandbox.h"
#include "talus/case.h"

enum {
  PATH_LENGTH = 128,
  VALUE_LENGTH = 256,
  CASE_MAX_PARAMETERS = 64,
  CASE_MAX_FUNCTIONS = 32,
  CASE_MAX_PATCHES = PARAMS_MAX_BOUNDARIES - 6,
  CASE_MAX_NAMES = 64 /* words known in one place */
};

/* Largest number but for times and level sets, by size, and its inverse the
 * smallest but for 0: products of some must neither overflow nor vanish. */
#define CASE_LARGEST 1e50

/* One line of what is in use. Texts are owned. */
struct row {
  char *key, *value, *unit, *help;
  const char *origin; /* static */
};

/* A parameter declared by the case. */
struct declaration {
  char name[PARAMS_NAME_LENGTH];
};

/* A function of the case. */
struct case_function {
  struct case_file *file; /* borrowed */
  char path[PATH_LENGTH]; /* the key that holds it */
  int reference;          /* in Lua's registry */
  bool is_viscosity;      /* of shear rate, pressure, time; else of x */
  int nresults, result;   /* it returns so many numbers, this one is meant */
  double most;            /* largest size of a number it may return */
  uint64_t checksum;      /* of what it returned while the case was loading */
  char name[PARAMS_NAME_LENGTH]; /* what it returned last, if a name */
};

/* A side that a function divides. */
struct case_side {
  struct case_file *file; /* borrowed */
  int side;
  struct side_map *map; /* owned; NULL: one boundary all over */
};

struct case_file {
  char *path, *text;       /* owned */
  struct sandbox *sandbox; /* owned */
  lua_State *L;            /* of the sandbox; what the case returned is at 1 */

  int noverrides;
  char *const *overrides; /* borrowed while loading */
  int ndeclared;
  struct declaration declared[CASE_MAX_PARAMETERS];

  int nrows;
  struct row *rows;

  struct params params;
  struct case_function functions[CASE_MAX_FUNCTIONS];
  int nfunctions;
  struct case_function *side_function[6]; /* NULL: one boundary all over */
  char patch[CASE_MAX_PATCHES][PARAMS_NAME_LENGTH];
  int npatches;
  struct case_side side[6];
  double velocity[3];      /* of a uniform initial state */
  bool loading;            /* all ranks do the same */
  char note[VALUE_LENGTH]; /* "": none */
};

/* param.c */

/* Make param() known to the sandbox. Errors are Lua errors. */
void param_install(struct case_file *file);
/* Check that every override has been declared. */
void param_check_overrides(struct case_file *file);

/* Serve everybody (rows.c): copy a text. */
char *text_copy(const char *text);
/* Is a text a name: letters, digits and _, not a digit first, not too long? */
bool is_name(const char *text);
/* Write "section.name" into `path`, cut if too long; `name` alone if section is
 * "". */
void path_join(char path[PATH_LENGTH], const char *section, const char *name);
/* Write `value` as the case would, the shortest text that reads back the same.
 */
void text_number(double value, size_t size, char *text);
/* Append a row; texts are copied. Names are unique: a parameter named like a
 * key of the case gives way and becomes "param.name". */
void rows_add(struct case_file *file, const char *key, const char *value,
              const char *unit, const char *help, const char *origin);
void rows_destroy(struct case_file *file);

/* read.c */

/* Ends the program: "file:line: path = value: message", the value taken from
 * the top of the stack. */
_Noreturn void read_fail(struct case_file *file, const char *path,
                         const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Fails likewise, without a value. */
_Noreturn void read_fail_at(struct case_file *file, const char *path,
                            const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Check that the table on top, which stays, has only these keys and
 * `npositions` elements. */
void read_known_only(struct case_file *file, const char *path, int n,
                     const char *const *names, int npositions);
/* List the names of the table on top in alphabetical order, as Lua's own order
 * differs between ranks; they live as long as the table. Returns how many. */
int read_names(struct case_file *file, const char *path, int max,
               const char **names);
/* Store a value as the key says, or its default, in `base` + offset, and add a
 * row. Only plain types, up to KEY_TEXT. Returns whether it was given. */
bool read_value(struct case_file *file, const struct key *key, const char *path,
                void *base);
/* Read a finite number within the range of the key. */
double read_number(struct case_file *file, const struct key *key,
                   const char *path);
/* Write "; did you mean `x`?" if a word looks like it, then all words. */
void read_suggest(const char *word, int n, const char *const *names,
                  size_t size, char *text);

/* checksum.c */

/* Continue a checksum with n bytes. */
uint64_t checksum_add(uint64_t checksum, const void *data, size_t n);

/* function.c */

/* Is grains.shape, if there is one, not positive somewhere in the box? As
 * case_finds_grains. */
bool case_finds_gas(const struct case_file *file);

/* Keep the function on top for later. Adds a row. */
struct case_function *function_keep(struct case_file *file, const char *path,
                                    const char *unit, const char *help,
                                    int nresults);
/* Return one of the results as the struct that `params` holds. */
struct function function_result(struct case_file *file,
                                struct case_function *function, int result);
/* Make a function that was kept the viscosity of a closure: the context of
 * rheology->user. */
void function_set_viscosity(struct case_function *function,
                            struct rheology *rheology);
/* Return the name that a function returns at x, valid until the next call. */
const char *function_name(struct case_function *function, const double x[3]);
/* Ends the program; only this rank may know. */
_Noreturn void function_fail(struct case_function *function, const double x[3],
                             const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Call every function at points all over the box, so that most of what can go
 * wrong does so before anything is written. */
void function_try_all(struct case_file *file);

/* Read the whole table that the case returns (build.c). */
void build_params(struct case_file *file);

/* The types of key that have an inner life. */

/* Read a closure (closure.c). */
void closure_read(struct case_file *file, const struct key *key);
bool closure_depends_on_pressure(const struct rheology *rheology);

/* Read a side and what follows from it (boundary.c). */
void boundary_read_side(struct case_file *file, const struct key *key);
void boundary_read_patches(struct case_file *file);
void boundary_check(struct case_file *file);
/* Refuse what does not go with the coordinates; boundaries have been read. */
void coordinates_check(struct case_file *file);

/* patches.c */

/* Map the sides that functions divide, and put into words what the patches
 * cover. A patch that is narrower than a face is an error. */
void patches_map(struct case_file *file);
void patches_destroy(struct case_file *file);
/* Find the path of a boundary that is an outflow on some part of some side;
 * returns false if there is none. */
bool patches_find_outflow(const struct case_file *file, char path[PATH_LENGTH]);

/* Read boundary.pressure_level, and check whether it is needed (pressure.c). */
void pressure_read(struct case_file *file, const struct key *key);
void pressure_check(struct case_file *file);

/* Read the criteria of adaptation (criteria.c). */
void criteria_read(struct case_file *file, const struct key *key);

/* Read the initial state (initial.c). */
void initial_read_shape(struct case_file *file, const struct key *key);
void initial_read_velocity(struct case_file *file, const struct key *key);
void initial_read_tracers(struct case_file *file, const struct key *key);

/* Read lists of times, and what tests expect (output_keys.c). */
void output_read_times(struct case_file *file, const struct key *key);
void output_read_expect(struct case_file *file, const struct key *key);

#endif
