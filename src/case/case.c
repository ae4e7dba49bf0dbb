/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/case.h"

#include <errno.h>
#include <lauxlib.h>
#include <string.h>

#include "case_file.h"
#include "library.h"
#include "talus/error.h"
#include "talus/memory.h"

enum { LARGEST_FILE = 16 << 20 };

char *case_read_text(const char *path) {
  FILE *f = fopen(path, "rb");
  if (f == NULL) return NULL;
  size_t size = 0, room = 4096;
  char *text = MEM_NEW(char, room);
  errno = 0;
  for (size_t n; (n = fread(text + size, 1, room - size - 1, f)) > 0;) {
    size += n;
    if (size + 1 == room) text = mem_resize(text, room *= 2, 1);
    if (size > LARGEST_FILE) {
      errno = EFBIG;
      break;
    }
  }
  int error = errno;
  bool failed = ferror(f) || size > LARGEST_FILE;
  fclose(f);
  text[size] = '\0';
  if (!failed) return text;
  mem_free(text);
  errno = error;
  return NULL;
}

/* Make "column" of "runs/column.lua". */
static void name_of(const char *path, size_t size, char *name) {
  const char *slash = strrchr(path, '/');
  const char *base = slash != NULL ? slash + 1 : path;
  const char *dot = strrchr(base, '.');
  size_t n = dot != NULL && dot > base ? (size_t)(dot - base) : strlen(base);
  snprintf(name, size, "%.*s", (int)n, base);
}

static struct case_file *case_new(const char *path, const char *text,
                                  int noverrides, char *const overrides[]) {
  struct case_file *file = MEM_NEW(struct case_file, 1);
  file->path = text_copy(path);
  file->text = text_copy(text);
  file->sandbox = sandbox_new(path, library_open);
  file->L = sandbox_state(file->sandbox);
  file->noverrides = noverrides;
  file->overrides = overrides;
  name_of(path, sizeof file->params.name, file->params.name);
  param_install(file);
  return file;
}

struct case_file *case_load_text(const char *path, const char *text,
                                 int noverrides, char *const overrides[]) {
  struct case_file *file = case_new(path, text, noverrides, overrides);
  file->loading = true;
  sandbox_set_loud(file->sandbox, true);
  const char *error = sandbox_run(file->sandbox, file->text);
  if (error != NULL && sandbox_was_late(file->sandbox))
    USER_ERROR_ALONE("%s", error);
  if (error != NULL) USER_ERROR("%s", error);
  param_check_overrides(file);
  if (!lua_istable(file->L, -1))
    USER_ERROR(
        "%s returns %s, a case must end in: return { dimension = 2, "
        "domain = { ... }, ... } (see: talus help case)",
        path, lua_isnil(file->L, -1) ? "nothing" : luaL_typename(file->L, -1));
  build_params(file);
  function_try_all(file);
  file->loading = false;
  file->noverrides = 0;
  file->overrides = NULL;
  return file;
}

void case_destroy(struct case_file *file) {
  if (file == NULL) return;
  rheology_release(&file->params.grains.rheology);
  rheology_release(&file->params.gas.rheology);
  mem_free(file->params.own);
  rows_destroy(file);
  patches_destroy(file);
  sandbox_destroy(file->sandbox);
  mem_free(file->text);
  mem_free(file->path);
  mem_free(file);
}

const struct params *case_params(const struct case_file *file) {
  return &file->params;
}

const char *case_note(const struct case_file *file) {
  return *file->note != '\0' ? file->note : NULL;
}

const char *case_parameter(const struct case_file *file, const char *name) {
  for (int i = 0; i < file->ndeclared; i++)
    if (strcmp(file->rows[i].key, name) == 0) return file->rows[i].value;
  return NULL;
}

int case_dimension(const char *path, int noverrides, char *const overrides[]) {
  char *text = case_read_text(path);
  if (text == NULL) return 0;
  struct case_file *file = case_new(path, text, noverrides, overrides);
  mem_free(text);
  int dimension = 0;
  if (sandbox_run(file->sandbox, file->text) == NULL &&
      lua_istable(file->L, -1)) {
    lua_getfield(file->L, -1, "dimension");
    if (lua_isinteger(file->L, -1)) dimension = (int)lua_tointeger(file->L, -1);
  }
  case_destroy(file);
  return dimension;
}
