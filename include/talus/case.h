/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The case file: Lua in, a checked `struct params` out.
 *
 * A case is a Lua 5.4 file that returns one table. It runs in a sandbox: math,
 * string, table, utf8 and the plain functions of the language, no files, no
 * processes, no other modules, bounded instructions, time and memory, the same
 * pseudo-random numbers each time and no addresses, so that every rank and
 * every restart sees the same case. `param(name, default, help)` returns a
 * value that the command line may override as name=value.
 *
 * Every key of the returned table is checked against one table of known keys
 * (src/case/keys.c), which `talus help case` prints. Whatever is wrong with a
 * case is a USER_ERROR that names file, line, key, value and what is allowed.
 *
 * Nothing here talks to other ranks: every rank loads the same text.
 */
#ifndef TALUS_CASE_H
#define TALUS_CASE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "talus/params.h"

struct case_file;

/* Deepest levels and most trees that a case may ask for, those of the forest; a
 * program knows the forest of one dimension only. */
enum { CASE_MAX_LEVEL_2D = 24, CASE_MAX_LEVEL_3D = 16, CASE_MAX_TREES = 32767 };

/*
 * Return the text of a file, owned by the caller (mem_free), or NULL and errno
 * if it cannot be read. Files of more than 16 MB are refused (EFBIG). Not
 * collective.
 */
char *case_read_text(const char *path);

/*
 * Run and check a case. Collective in that all ranks must pass the same; any
 * fault of the case or of an override is a USER_ERROR.
 *   path       for messages, and the name of the case is made from it
 *   text       what the file holds, copied
 *   overrides  [noverrides] "name=value" from the command line, borrowed until
 *              the call returns
 * returns  the case, owned by the caller
 */
struct case_file *case_load_text(const char *path, const char *text,
                                 int noverrides, char *const overrides[]);

/* Free the case and with it the functions that its params hold. */
void case_destroy(struct case_file *file);

/* Return the description of the case, owned by the case and valid while it
 * lives. Its functions may be called on any rank; if one fails there the
 * program ends, as a USER_ERROR_ALONE that names the point. */
const struct params *case_params(const struct case_file *file);

/* Return one line about what is no error of the case but worth a word; NULL if
 * there is nothing. */
const char *case_note(const struct case_file *file);

/* Return the value of what the case declares as param(name, ...), as text that
 * the case owns; NULL if it declares no such thing. */
const char *case_parameter(const struct case_file *file, const char *name);

/* Tell whether grains.shape is positive at a point of a lattice of some 70,000
 * over the box, or the grains fill it. */
bool case_finds_grains(const struct case_file *file);

/* Print every parameter in use, one `key = value  unit  meaning` a line, those
 * declared by param() first. Defaults are marked. */
void case_print(const struct case_file *file, FILE *f);

/* Write the same as csv: a header `key,value,unit,origin`, origin one of
 * default, case, command line. Fields are quoted where csv needs it. */
void case_write_parameters(const struct case_file *file, FILE *f);

/* Return the checksum of row i of what is in use (below) or, behind the rows,
 * of what function i returned while the case was loaded. Returns its key, which
 * the case owns; NULL past the last. */
const char *case_checksum(const struct case_file *file, int i,
                          uint64_t *checksum);

/* Tell if a field, a dataset or an output of some closure has this name, so
 * that a tracer cannot have it. */
bool case_name_is_taken(const char *name);

/* Return the `dimension` that the case gives, 0 if it cannot be found out;
 * prints nothing, as running the case will tell why. */
int case_dimension(const char *path, int noverrides, char *const overrides[]);

/* Print how a case is written and the table of its keys. */
void case_help(FILE *f);

#endif
