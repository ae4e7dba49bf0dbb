/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of the parameters in use, for the terminal and parameters.csv. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "case_file.h"
#include "talus/csv_row.h"
#include "talus/memory.h"

char *text_copy(const char *text) {
  size_t size = strlen(text) + 1;
  char *copy = MEM_NEW(char, size);
  memcpy(copy, text, size);
  return copy;
}

static size_t append(char path[PATH_LENGTH], size_t used, const char *text) {
  for (; *text != '\0' && used < PATH_LENGTH - 1; text++) path[used++] = *text;
  path[used] = '\0';
  return used;
}

bool is_name(const char *text) {
  const char *at = text;
  if (!isalpha((unsigned char)*at) && *at != '_') return false;
  while (isalnum((unsigned char)*at) || *at == '_') at++;
  return *at == '\0' && at - text < PARAMS_NAME_LENGTH;
}

void path_join(char path[PATH_LENGTH], const char *section, const char *name) {
  size_t used = append(path, 0, section);
  if (used > 0) used = append(path, used, ".");
  append(path, used, name);
}

void text_number(double value, size_t size, char *text) {
  for (int digits = 6; digits <= 17; digits++) {
    snprintf(text, size, "%.*g", digits, value);
    if (strtod(text, NULL) == value) return;
  }
}

static void give_way(struct case_file *file, const char *key) {
  for (int i = 0; i < file->nrows; i++) {
    if (strcmp(file->rows[i].key, key) != 0) continue;
    char path[PATH_LENGTH];
    path_join(path, "param", key);
    mem_free(file->rows[i].key);
    file->rows[i].key = text_copy(path);
  }
}

void rows_add(struct case_file *file, const char *key, const char *value,
              const char *unit, const char *help, const char *origin) {
  give_way(file, key);
  file->rows =
      mem_resize(file->rows, (size_t)file->nrows + 1, sizeof *file->rows);
  file->rows[file->nrows++] = (struct row){.key = text_copy(key),
                                           .value = text_copy(value),
                                           .unit = text_copy(unit),
                                           .help = text_copy(help),
                                           .origin = origin};
}

void rows_destroy(struct case_file *file) {
  for (int i = 0; i < file->nrows; i++) {
    struct row *row = &file->rows[i];
    mem_free(row->key);
    mem_free(row->value);
    mem_free(row->unit);
    mem_free(row->help);
  }
  mem_free(file->rows);
}

void case_print(const struct case_file *file, FILE *f) {
  for (int i = 0; i < file->nrows; i++) {
    const struct row *row = &file->rows[i];
    const char *mark = strcmp(row->origin, "case") == 0 ? "" : row->origin;
    fprintf(f, "%-26s = %-20s  %-6s  %s%s%s%s\n", row->key, row->value,
            *row->unit ? row->unit : "-", row->help, *mark ? " [" : "", mark,
            *mark ? "]" : "");
  }
}

void case_write_parameters(const struct case_file *file, FILE *f) {
  struct csv_row line = {0};
  fputs("key,value,unit,origin\n", f);
  for (int i = 0; i < file->nrows; i++) {
    const struct row *row = &file->rows[i];
    csv_row_add(&line, row->key);
    csv_row_add(&line, row->value);
    csv_row_add(&line, row->unit);
    csv_row_add(&line, row->origin);
    csv_row_write(&line, f);
  }
  csv_row_free(&line);
}
