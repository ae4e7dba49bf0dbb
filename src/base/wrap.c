/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/wrap.h"

#include <string.h>

enum { WIDTH = 79 };

void wrap_print(FILE *f, int indent, const char *text) {
  while (*text != '\0') {
    const size_t room = (size_t)(WIDTH - indent);
    size_t n = strlen(text);
    if (n > room) {
      for (n = room; n > 0 && text[n] != ' ';) n--;
      if (n == 0) n = room;
    }
    fprintf(f, "%.*s\n", (int)n, text);
    text += n + strspn(text + n, " ");
    if (*text != '\0') fprintf(f, "%*s", indent, "");
  }
}
