/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A case that ranks understand in different ways is found out. */
#include "talus/same_case.h"

#include <check.h>
#include <string.h>

#include "grid.h"
#include "talus/case.h"
#include "talus/error.h"

static const char TEXT[] =
    "local a, b = param('a', 1), param('b', 2)\n"
    "return { dimension = 2, domain = { size = 4, level = 3 },\n"
    "  gravity = { 0, -1 },\n"
    "  grains = { density = 1, rheology = { 'mu_i', d = 0.05 },\n"
    "    shape = function(x, y) return %s - y end },\n"
    "  gas = { density = 1e-3, rheology = { 'newtonian', eta = 1e-4 } },\n"
    "  boundary = { left = 'slip', right = 'slip', bottom = 'no_slip',\n"
    "    top = 'outflow' }, output = { stop = 1 } }\n";

/* Tell whether `key` is where ranks differ, when the last one has this height
 * of the grains and this override, and the others the usual ones. */
static bool differ_in(const char *key, const char *height,
                      const char *override) {
  const bool last = base_size() > 1 && base_rank() == base_size() - 1;
  char text[1024], word[32];
  char *words[] = {word};
  snprintf(text, sizeof text, TEXT, last ? height : "1");
  strcpy(word, last ? override : "b=2");
  struct case_file *file = case_load_text("x.lua", text, 1, words);
  const char *found = same_case_difference(file);
  const bool good = base_size() == 1 || key == NULL
                        ? found == NULL
                        : found != NULL && strcmp(found, key) == 0;
  case_destroy(file);
  return good;
}

START_TEST(a_difference_between_ranks_is_found) {
  bool good = differ_in(NULL, "1", "b=2");
  good = differ_in("b", "1", "b=2.0000000000000004") && good;
  good = differ_in("grains.shape", "1.0000000000000002", "b=2") && good;
  ck_assert(all_ranks(good));
}
END_TEST

Suite *same_case_suite(void);
Suite *same_case_suite(void) {
  Suite *suite = suite_create("same_case");
  TCase *tcase = tcase_create("same_case");
  tcase_add_test(tcase, a_difference_between_ranks_is_found);
  suite_add_tcase(suite, tcase);
  return suite;
}
