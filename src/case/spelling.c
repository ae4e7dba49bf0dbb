/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/spelling.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

enum { LONGEST = 63 }; /* letters compared */

static int length(const char *word) {
  size_t n = strlen(word);
  return n < LONGEST ? (int)n : LONGEST;
}

static bool differ(char a, char b) {
  return tolower((unsigned char)a) != tolower((unsigned char)b);
}

static int least(int a, int b) { return a < b ? a : b; }

/* Compute Damerau's distance, optimal alignment: row[0] is the line before the
 * last, row[1] the last, row[2] the one being made. */
static int distance(const char *a, const char *b) {
  int row[3][LONGEST + 1] = {{0}};
  int na = length(a), nb = length(b);
  for (int j = 0; j <= nb; j++) row[1][j] = j;
  for (int i = 1; i <= na; i++) {
    row[2][0] = i;
    for (int j = 1; j <= nb; j++) {
      int d = row[1][j - 1] + differ(a[i - 1], b[j - 1]);
      d = least(d, least(row[1][j], row[2][j - 1]) + 1);
      if (i > 1 && j > 1 && !differ(a[i - 1], b[j - 2]) &&
          !differ(a[i - 2], b[j - 1]))
        d = least(d, row[0][j - 2] + 1);
      row[2][j] = d;
    }
    memmove(row[0], row[1], sizeof row[0] * 2);
  }
  return row[1][nb];
}

const char *spelling_nearest(const char *word, int n,
                             const char *const *words) {
  const char *best = NULL;
  int best_distance = 0;
  for (int i = 0; i < n; i++) {
    if (words[i] == NULL) continue;
    int d = distance(word, words[i]);
    int longer = length(word);
    if (length(words[i]) > longer) longer = length(words[i]);
    if (3 * d > longer || (best != NULL && d >= best_distance)) continue;
    best = words[i];
    best_distance = d;
  }
  return best;
}
